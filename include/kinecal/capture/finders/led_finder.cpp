// Definitions of led_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/led_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/capture/finders/view_checks.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {

std::string LedFinder::fault(const View& view) {
  for (const auto& problem : {image_problem, cloud_problem, camera_problem}) {
    if (std::string fault = problem(view); !fault.empty()) return fault;
  }
  return "";
}

std::string LedFinder::called(std::size_t led) const {
  const Led& known = leds[led];
  return "LED " + std::to_string(led) + " (" +
         (known.name.empty() ? "code " + std::to_string(known.code) : known.name) + ")";
}

std::vector<std::string> drop_inconsistent(const LedFinder& finder,
                                           std::vector<PlacedLed>& placed) {
  std::vector<std::string> problems;
  while (true) {
    std::vector<int> wrong(placed.size());
    std::vector<std::string> why(placed.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      for (std::size_t j = 0; j < placed.size(); ++j) {
        const auto [a, p] = placed[i];
        const auto [b, q] = placed[j];
        const double seen = (p - q).norm();
        const double known = (finder.leds[a].position - finder.leds[b].position).norm();
        if (std::abs(seen - known) <= finder.max_inconsistency) continue;
        ++wrong[i];
        why[i] = finder.called(a) + ": it is " + reading(seen, "m") + " from " + finder.called(b) +
                 ", which should be " + reading(known, "m");
      }
    }
    const int most = placed.empty() ? 0 : *std::max_element(wrong.begin(), wrong.end());
    if (most == 0) return problems;
    std::vector<PlacedLed> kept;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (wrong[i] < most) kept.push_back(placed[i]);
      if (wrong[i] == most) problems.push_back(why[i]);
    }
    placed = std::move(kept);
  }
}

}  // namespace kinecal
