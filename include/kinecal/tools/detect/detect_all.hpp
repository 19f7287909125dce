// The whole of a detection: finders look at photographs and recordings, and boards that look alike when they are
// turned are put right.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/tools/detect/board_turns.hpp"
#include "kinecal/tools/detect/look.hpp"

namespace kinecal {

/// Photographs of one of several cameras.
struct CameraImages {
  std::string camera;  ///< its name and its frame
  std::vector<PosedImage> images;
};

/// What is looked at, and by what.
struct DetectionInput {
  CaptureConfig config;                   ///< its finders
  std::optional<Robot> robot = {};        ///< where regions and boards are
  std::optional<CameraInfo> camera = {};  ///< of the photographs
  std::string frame = {};                 ///< of their camera
  std::vector<PosedImage> images = {};    ///< photographs
  std::vector<CameraImages> rig = {};     ///< photographs of several cameras, see rig_views.hpp
  std::vector<RecordedViews> recordings = {};
  BoardLinks links = {};
};

/// How it is looked at.
struct DetectionOptions {
  int threads = 0;           ///< zero: one per core
  bool thumbnails = false;   ///< for a contact sheet
  ProgressMeter meter = {};  ///< called now and then
};

/// What was found.
struct DetectedSamples {
  std::vector<Look> looks;  ///< at each photograph and standstill, without their samples
  std::vector<Sample>
      samples;  ///< in the order of the looks; of several cameras, of the photographs' names
  std::size_t used = 0;      ///< looks that gave samples
  std::size_t features = 0;  ///< in all of them
};

/// The finders of a configuration.
/// @param errors  receives those that cannot work
[[nodiscard]] std::vector<ViewFinder> make_finders(const DetectionInput& input,
                                                   std::vector<std::string>& errors);

/// Looks at everything.
/// @param diagnostics  receives what was turned as notes; a warning if that cannot be decided
[[nodiscard]] DetectedSamples detect_all(const DetectionInput& input,
                                         const DetectionOptions& options, Diagnostics& diagnostics);

}  // namespace kinecal
