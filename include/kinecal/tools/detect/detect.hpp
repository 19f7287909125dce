// Detects samples in recorded views: runs finders on one view after the other.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/config/capture/capture_config.hpp"

namespace kinecal {

/// A finder of recorded views.
struct ViewFinder {
  std::string name;                             ///< as in the configuration
  std::function<Found(const View& view)> find;  ///< in one view
  std::optional<LedFinder> leds = {};  ///< finds LEDs instead, in views of all their switches
};

/// Finds LEDs in the views that were recorded while they were switched.
using FindLeds = std::function<Found(const LedFinder& finder)>;

/// The result of one view.
struct Detection {
  std::vector<Sample> samples;  ///< empty if nothing was found; several if finders observe with
                                ///< the same sensors
  std::vector<Mark> marks;      ///< of all finders, in pixels of the view
  std::vector<GridLine> grid;   ///< of their targets, in pixels of the view
  std::vector<std::string> refused;  ///< "april_tag_finder: no tag is in the image"
  std::vector<std::string> notes;    ///< "april_tag_finder: the tags are turned by 180 degrees"
  std::size_t features = 0;          ///< found by all finders
};

/// Makes the finder for some settings.
/// @throws InputError  "file:line: ..." if settings are impossible, or the finder needs the robot:
///                     LEDs must be switched
[[nodiscard]] ViewFinder view_finder(const CaptureFinder& finder, const FinderSettings& settings);

/// Why a view cannot be used by a finder, whatever it shows: no image, no camera_info; empty if it
/// can.
[[nodiscard]] std::string unusable(const FinderSettings& settings, const View& view);

/// Runs all finders on a view.
/// @param source     of the samples, for messages: "poses.csv:3"
/// @param find_leds  empty: LEDs are refused
[[nodiscard]] Detection detect(const View& view, std::span<const ViewFinder> finders,
                               const std::string& source, const FindLeds& find_leds = {});

}  // namespace kinecal
