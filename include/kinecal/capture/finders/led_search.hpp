// The search for LEDs, independent of who switches them and takes the views.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/finders/led_difference.hpp"
#include "kinecal/capture/finders/led_finder.hpp"

namespace kinecal {

/// Finds LEDs in dark and lit views.  LEDs that are clear are not switched again; the others take
/// turns until the iterations are used up.
class LedSearch {
 public:
  /// @param finder          kept by reference
  /// @param first,second    two views with all LEDs off; differences between them are motion
  LedSearch(const LedFinder& finder, View first, const View& second);

  /// The next LED to switch; nullopt if the search is over.
  [[nodiscard]] std::optional<std::size_t> next() const;

  /// Adds a view with only this LED lit, and one with all off after it.
  void pulse(std::size_t led, const View& lit, View dark);

  /// The LEDs found.  Its refusal names each missing LED, with the reason.
  [[nodiscard]] Found found() const;

 private:
  struct Tracked {
    LedDifference difference;
    std::optional<PixelCircle> where;  // in the image, from the robot model
    LedSpot spot;
    std::string hopeless;  // why it cannot be seen
  };

  void expect(std::size_t led);
  [[nodiscard]] std::string view_problem(const View& view) const;
  [[nodiscard]] std::string motion_at(const LedSpot& spot) const;
  [[nodiscard]] std::string place(std::size_t led, Vector3<double>& p_camera) const;
  [[nodiscard]] std::string weak(std::size_t led) const;

  const LedFinder& finder_;
  View dark_;
  std::vector<Tracked> leds_;
  ImageMotion motion_;
  std::string refusal_;  // of all
  std::optional<Pose<double>> frame_T_camera_;
  int switches_ = 0;
};

}  // namespace kinecal
