// Chooses the topics of a recording that form the views of each finder.
//
// A finder uses the topic in its configuration.  If the recording lacks it but has only one topic
// of the same kind, that one is used; otherwise the error lists the candidates.  Names of
// image_transport (/compressed, /compressedDepth) count as the raw topic.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// A topic of a recording.
struct RecordedTopic {
  std::string name;           ///< without a leading slash
  std::string type;           ///< "sensor_msgs/Image"
  std::string encoding = {};  ///< of images, from the first message; else empty
};

/// Topics of a camera; empty: none.
struct ViewTopics {
  std::string image = {};        ///< brightness or colour
  std::string depth = {};        ///< registered to the image
  std::string cloud = {};        ///< points, whose colour replaces a missing image, or a scan
  std::string camera_info = {};  ///< settings of the camera

  bool operator==(const ViewTopics&) const = default;  ///< true if it is the same camera
};

/// Wishes for the choice of topics.
struct ViewWishes {
  std::string file;         ///< name of the recording in messages
  std::string depth = {};   ///< topic of the depth for images; empty: the only one
  bool has_camera = false;  ///< the user gave the camera's settings: no topic is needed
};

/// The usual topic of the camera_info of images: "camera/camera_info" for "camera/image/compressed".
[[nodiscard]] std::string camera_info_beside(const std::string& topic);

/// The topics of each finder; empty, with an error, if a finder has no topic.
/// @param diagnostics  receives errors, and notes about unnamed topics that were chosen
[[nodiscard]] std::vector<ViewTopics> choose_topics(const std::vector<RecordedTopic>& recorded,
                                                    const std::vector<CaptureFinder>& finders,
                                                    const ViewWishes& wishes,
                                                    Diagnostics& diagnostics);

}  // namespace kinecal
