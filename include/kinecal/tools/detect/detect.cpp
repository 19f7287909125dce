// Definitions of detect.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/detect.hpp"

#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/capture/session/session.hpp"

namespace kinecal {
namespace {

constexpr const char* kLedsAlone =
    "LEDs have to be switched while a camera looks, so images alone do not do; capture LEDs on the "
    "robot, or record them while they are switched (--bag)";

}  // namespace

namespace detail {
namespace {

template <class F>
[[nodiscard]] std::function<Found(const View&)> shared_finder(F finder) {
  return [finder = std::make_shared<const F>(std::move(finder))](const View& view) {
    return finder->find(view);
  };
}

[[nodiscard]] std::function<Found(const View&)> finder_of(const FinderSettings& settings) {
  return std::visit(
      [](const auto& chosen) -> std::function<Found(const View&)> {
        using Chosen = std::decay_t<decltype(chosen)>;
        if constexpr (std::is_same_v<Chosen, TouchFinder>) {
          throw std::invalid_argument(
              "no image shows that a tip touches; record it by hand: kinecal capture --manual");
        } else if constexpr (requires { typename Chosen::FinderType; }) {
          return shared_finder(typename Chosen::FinderType(chosen));
        } else if constexpr (Finder<Chosen>) {
          return shared_finder(chosen);
        } else {
          throw std::invalid_argument(kLedsAlone);
        }
      },
      settings);
}

}  // namespace
}  // namespace detail

ViewFinder view_finder(const CaptureFinder& finder, const FinderSettings& settings) {
  try {
    return {finder.name, detail::finder_of(settings)};
  } catch (const std::exception& error) {
    throw InputError(finder.place.str() + ": finder '" + finder.name + "': " + error.what());
  }
}

std::string unusable(const FinderSettings& settings, const View& view) {
  return std::visit(
      [&](const auto& chosen) -> std::string {
        if constexpr (requires { chosen.fault(view); }) {
          return chosen.fault(view);
        } else {
          return view_fault(view, chosen.target.corners);
        }
      },
      settings);
}

Detection detect(const View& view, std::span<const ViewFinder> finders, const std::string& source,
                 const FindLeds& find_leds) {
  Detection detection;
  std::vector<FinderOutcome> outcomes;
  for (const ViewFinder& finder : finders) {
    Found found = !finder.leds ? finder.find(view)
                  : find_leds  ? find_leds(*finder.leds)
                               : refused(kLedsAlone);
    detection.marks.insert(detection.marks.end(), found.marks.begin(), found.marks.end());
    detection.grid.insert(detection.grid.end(), found.grid.begin(), found.grid.end());
    for (const std::string& note : found.notes) {
      if (found) detection.notes.push_back(finder.name + ": " + note);
    }
    if (found) {
      detection.features += found.observations.front().features.size();
      outcomes.push_back({finder.name, {}, std::move(found)});
    } else {
      detection.refused.push_back(finder.name + ": " + found.refusal);
    }
  }
  detection.samples = detail::samples_of(view.joints, outcomes);
  for (Sample& sample : detection.samples) sample.source = source;
  return detection;
}

}  // namespace kinecal
