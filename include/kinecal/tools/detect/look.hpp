// What finders find in photographs and recordings, on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/tools/detect/contact_sheet.hpp"
#include "kinecal/tools/detect/detect.hpp"
#include "kinecal/tools/detect/image_folder.hpp"
#include "kinecal/tools/detect/recorded_views.hpp"

namespace kinecal {

/// Makes the finders of a configuration.  Each thread has its own, since libraries keep state.
using MakeFinders = std::function<std::vector<ViewFinder>()>;

/// How views are looked at.
struct LookOptions {
  MakeFinders finders;
  int threads = 0;           ///< zero: one per core
  bool thumbnails = false;   ///< whether they are wanted
  ProgressMeter meter = {};  ///< called now and then
};

/// What was found in a photograph, or in all views of a standstill.
struct Look {
  std::string source;           ///< "images/0001.png", "drive.bag at 12.300 s"
  std::vector<Sample> samples;  ///< empty if nothing was found
  std::size_t features = 0;
  std::vector<std::string>
      refused;  ///< views that were not looked at, and finders, with their reasons
  std::vector<std::string> notes;     ///< of finders
  std::vector<Thumbnail> thumbnails;  ///< of each view
  bool compared = true;               ///< false: a view has a single image, which may have moved
};

/// Looks at photographs.  One that cannot be read is refused.
/// @returns  in the order of the images, whatever the number of threads
[[nodiscard]] std::vector<Look> look_at(const std::vector<PosedImage>& images,
                                        const std::optional<CameraInfo>& camera,
                                        const std::string& frame, const LookOptions& options);

/// Looks at the standstills of a recording.
/// @returns  in the order of time, whatever the number of threads
[[nodiscard]] std::vector<Look> look_at(const RecordedViews& recording, const LookOptions& options);

}  // namespace kinecal
