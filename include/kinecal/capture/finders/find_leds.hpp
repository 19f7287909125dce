// LEDs of a robot as features: switches each on and off, and finds what lights up and goes out.
//
// Observations: the camera's points in its optical frame, and the LEDs' positions in the chain's
// link.  Both list the same features in the same order; ids are places in the list of LEDs.
// Source: Fetch paper, III-A; settings as in upstream's capture.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "kinecal/capture/finders/led_search.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Switches LEDs and finds those that the camera sees.
///
/// A view counts after a switch only if it was taken at least `settle` later, or the time between
/// two views if that is longer, so that its exposure does not include the switch.
/// @param after   the robot has been still since this time
/// @param joints  positions since then, for views without joints
/// @return        the LEDs found; its refusal names each missing LED, with the reason
/// @throws        PoseError, ConnectionError: like the camera and the lamp
template <RobotCamera C, RobotLamp L>
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
