// Losses by their names in configurations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "kinecal/errors/loss.hpp"

namespace kinecal::detail {

inline constexpr std::array<std::pair<std::string_view, LossType>, 4> kLosses = {
    {{"none", LossType::none},
     {"huber", LossType::huber},
     {"cauchy", LossType::cauchy},
     {"tukey", LossType::tukey}}};

/// The loss of a name; LossType::none for any other name.
[[nodiscard]] inline LossType loss_type(std::string_view name) {
  for (const auto& [of, type] : kLosses) {
    if (of == name) return type;
  }
  return LossType::none;
}

[[nodiscard]] inline std::string loss_name(LossType type) {
  for (const auto& [name, of] : kLosses) {
    if (of == type) return std::string(name);
  }
  return "none";
}

}  // namespace kinecal::detail
