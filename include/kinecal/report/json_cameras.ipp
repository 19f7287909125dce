// How well cameras are known, in the machine-readable report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal::detail {

/// A number of each cell, row by row; null where the lens sees nothing or nothing is known.
template <class Number>
[[nodiscard]] Json json_cells(const ProjectionMap& map, const Number& number) {
  Json all = Json::array();
  for (const KnownPixel& cell : map.cells) all.push_back(number(cell));
  return all;
}

[[nodiscard]] inline Json json(const ProjectionMap& map, const AlikePixels& alike) {
  Json halves;
  if (map.halves) {
    halves = {{"difference", map.halves->difference},
              {"allowed", map.halves->allowed},
              {"chance", map.halves->chance}};
  }
  Json numbers = Json::object();
  for (const CameraNumber& number : map.numbers) {
    numbers[number.name] = {{"value", number.value},
                            {"sigma", number.deviation ? Json(*number.deviation) : Json()}};
  }
  return {{"sensor", map.sensor},
          {"numbers", numbers},
          {"low", map.low},
          {"high", map.high},
          {"columns", map.columns},
          {"rows", map.rows},
          {"distance", map.distance > 0.0 ? Json(map.distance) : Json()},
          {"features", json_cells(map, [](const KnownPixel& cell) { return cell.features; })},
          {"deviation", json_cells(map, [](const KnownPixel& cell) { return cell.deviation(); })},
          {"metres", json_cells(map, [](const KnownPixel& cell) { return cell.metres; })},
          {"difference", json_cells(map, [](const KnownPixel& cell) { return cell.difference; })},
          {"halves", halves},
          {"residuals",
           {{"all", alike.all},
            {"by_place", alike.alike},
            {"chance", alike.chance},
            {"region", alike.region},
            {"pixel", alike.pixel},
            {"there", alike.there}}}};
}

/// The cameras of an assessment.
[[nodiscard]] inline Json json_cameras(const Assessment& step) {
  Json all = Json::array();
  for (std::size_t i = 0; i < step.maps.size(); ++i)
    all.push_back(json(step.maps[i], step.alike[i]));
  return all;
}

}  // namespace kinecal::detail
