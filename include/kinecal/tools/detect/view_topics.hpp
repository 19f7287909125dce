// Which topics of a recording make the views of each finder.
//
// A finder's topic is the one of its configuration.  If the recording does not have it, but only one
// topic of its kind, that one is taken; otherwise the candidates are named.  Names of image_transport
// (/compressed, /compressedDepth) are those of the raw topic.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// A topic of a recording.
struct RecordedTopic {
  std::string name;           ///< without a leading slash
  std::string type;           ///< "sensor_msgs/Image"
  std::string encoding = {};  ///< of images, as the first message has it; empty of others
};

/// Topics of a camera; empty: none.
struct ViewTopics {
  std::string image = {};        ///< brightness or colour
  std::string depth = {};        ///< registered to the image
  std::string cloud = {};        ///< points; its colour is the image if there is none
  std::string camera_info = {};  ///< settings of the camera

  bool operator==(const ViewTopics&) const = default;  ///< Whether it is the same camera.
};

/// How topics are chosen.
struct ViewWishes {
  std::string file;         ///< name of the recording in messages
  std::string depth = {};   ///< topic of depth that goes with images; empty: the only one
  bool has_camera = false;  ///< whether the user gave the camera's settings: no topic is needed
};

/// The topics of each finder; of one that has none, which is an error, they are empty.
/// @param diagnostics  receives errors, and as notes what was chosen although not named
[[nodiscard]] std::vector<ViewTopics> choose_topics(const std::vector<RecordedTopic>& recorded,
                                                    const std::vector<CaptureFinder>& finders,
                                                    const ViewWishes& wishes,
                                                    Diagnostics& diagnostics);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/tools/detect/view_topics.ipp"
#endif
