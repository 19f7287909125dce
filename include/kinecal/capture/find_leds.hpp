// LEDs of a robot as features: each is switched on and off, and found by what lights and goes out.
//
// Observations: the camera's, points in its optical frame; the chain's, the LEDs where its link has
// them.  Both have the same features in the same order, ids are places in the list of LEDs.
// Source: Fetch paper, III-A; settings as in upstream's capture.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "kinecal/capture/led_search.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Switches LEDs and finds those that the camera sees.
///
/// A view after a switch is one that was taken a while after it: `settle`, or the time between two
/// views if that is longer, so that its exposure does not include the switch.
/// @param after   the robot has been still since then
/// @param joints  of the robot since then, for views that come without
/// @return        what was found; its refusal names each LED that was not, and why
/// @throws        PoseError, ConnectionError: as the camera and the lamp do
template <Camera C, Lamp L>
[[nodiscard]] Found find_leds(const LedFinder& finder, C& camera, L& lamp, Stamp after,
                              const MeasuredJoints& joints = {}) {
  constexpr Stamp kLongest = std::chrono::seconds(1);
  Stamp last = after, wait = finder.settle;
  const auto view_with = [&](int code) {
    last = std::max(last, lamp.light(code));
    View view = camera.next_view(last + wait);
    last = std::max(last, view.stamp);
    return view;
  };
  const View first = view_with(0);
  View second = camera.next_view(last);
  if (second.joints.names.empty()) second.joints = joints;
  wait = std::max(wait, std::min(kLongest, second.stamp - first.stamp));
  last = std::max(last, second.stamp);
  LedSearch search(finder, first, second);
  while (const auto led = search.next()) {
    const View lit = view_with(finder.leds[*led].code);
    search.pulse(*led, lit, view_with(0));
  }
  return search.found();
}

}  // namespace kinecal
