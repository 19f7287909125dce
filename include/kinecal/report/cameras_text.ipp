// How good cameras are, in the text report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/text/image_region.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal::detail {

/// The median over the cells with features of what a point at their distance is known to, metres.
[[nodiscard]] inline double known_metres(const ProjectionMap& map) {
  std::vector<double> metres;
  for (const KnownPixel& cell : map.cells) {
    if (cell.features > 0 && std::isfinite(cell.metres)) metres.push_back(cell.metres);
  }
  return metres.empty() ? 0.0 : median_of(std::move(metres));
}

/// "fx 800.12 +- 0.05, fy 800.3 +- 0.05, cx ... px; k1 -0.2501 +- 0.0003": as camera files have them.
[[nodiscard]] inline std::string numbers_text(const ProjectionMap& map) {
  std::string text;
  for (std::size_t i = 0; i < map.numbers.size(); ++i) {
    const CameraNumber& number = map.numbers[i];
    const bool pixels = number.name.size() == 2 && (number.name[0] == 'f' || number.name[0] == 'c');
    if (!pixels && !number.deviation) continue;
    text += i == 0 ? "" : !pixels && map.numbers[i - 1].name == "cy" ? " px; " : ", ";
    text += number.name +
            (pixels ? fmt::format(" {:.2f}", number.value) : fmt::format(" {:.5g}", number.value));
    if (!number.deviation) continue;
    const double known = *number.deviation;
    text += !std::isfinite(known) ? " not determined"
            : pixels              ? fmt::format(" +- {:.2f}", known)
                                  : fmt::format(" +- {:.2g}", known);
  }
  const bool has_lens = text.find(';') != std::string::npos;
  return text.empty() ? "" : "  " + text + (has_lens ? "" : " px") + "\n";
}

/// "Camera 'eye': a pixel is known to 0.03 px where features are (0.05 mm at 0.8 m), 0.4 px at the worst place of its image".
[[nodiscard]] inline std::string camera_text(const ProjectionMap& map) {
  const auto [least, median, most] = map.deviations();
  std::string text =
      fmt::format("Camera '{}': a pixel is known to {} where features are", map.sensor,
                  std::isfinite(median) ? reading(median, "px") : "nothing");
  if (map.distance > 0.0 && std::isfinite(median)) {
    text += fmt::format(" ({} at {:.2g} m)", reading(known_metres(map), "m"), map.distance);
  }
  if (std::isfinite(most)) {
    text += fmt::format(", to {} at the worst place of its image", reading(most, "px"));
  }
  text += "\n" + numbers_text(map);
  if (map.halves) {
    text += fmt::format("  two halves of the samples differ by {}; the +- allow {}\n",
                        reading(map.halves->difference, "px"), reading(map.halves->allowed, "px"));
  }
  return text;
}

/// "residuals depend on the place in the image by 0.2 px, most at the upper left (+0.3, -0.1 px)"; empty if that is chance.
[[nodiscard]] inline std::string place_text(const AlikePixels& pixels) {
  constexpr double kChance = 0.01;
  if (!(pixels.alike > 0.0) || pixels.chance > kChance) return "";
  return fmt::format(
      "  of the residuals, {} depend on the place in the image, most at the {} ({:+.2f}, {:+.2f} "
      "px)\n",
      reading(pixels.alike, "px"), pixels.region, pixels.there[0], pixels.there[1]);
}

/// "no feature at the top of its image: hold the target there"; empty if features are everywhere.
[[nodiscard]] inline std::string empty_regions_text(const ProjectionMap& map) {
  std::array<bool, kImageRegions> empty;
  empty.fill(true);
  for (const KnownPixel& cell : map.cells) {
    if (cell.features > 0) empty[map.region_of(cell)] = false;
  }
  const std::string regions = image_regions_text(empty);
  return regions.empty() ? ""
                         : "  no feature at " + regions + " of its image: hold the target there\n";
}

[[nodiscard]] inline std::string cameras_text(const Findings& findings) {
  std::string text;
  if (findings.assessments.empty()) return text;
  const Assessment& last = findings.assessments.back();
  for (std::size_t i = 0; i < last.maps.size(); ++i) {
    text +=
        camera_text(last.maps[i]) + place_text(last.alike[i]) + empty_regions_text(last.maps[i]);
  }
  return text;
}

}  // namespace kinecal::detail
