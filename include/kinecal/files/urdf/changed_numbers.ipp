// The numbers of a joint that a calibration has changed in a URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal::detail {

/// A list of numbers in a joint: an attribute of one of its elements.
struct JointNumbers {
  const char *element, *attribute;
  std::size_t size;
};

inline constexpr std::array<JointNumbers, 10> kPatchedNumbers = {
    {{"origin", "xyz", 3},
     {"origin", "rpy", 3},
     {"limit", "lower", 1},
     {"limit", "upper", 1},
     {"safety_controller", "soft_lower_limit", 1},
     {"safety_controller", "soft_upper_limit", 1},
     {"calibration", "rising", 1},
     {"calibration", "falling", 1},
     {"mimic", "multiplier", 1},
     {"mimic", "offset", 1}}};

/// The values that a joint has after the calibration, and had before, where they differ.
struct ChangedNumbers {
  JointNumbers of;
  std::vector<double> before, after;

  /// `xyz="0.1 0 0" of <origin>`
  [[nodiscard]] std::string text() const {
    std::string all;
    for (const double value : after) all += (all.empty() ? "" : " ") + xml_number(value);
    return fmt::format("{}=\"{}\" of <{}>", of.attribute, all, of.element);
  }
};

[[nodiscard]] inline std::vector<ChangedNumbers> changed_numbers(const UrdfText& original,
                                                                 const UrdfText& calibrated,
                                                                 const std::string& joint) {
  std::vector<ChangedNumbers> changes;
  Diagnostics ignored;  // the reader of URDFs has reported them
  for (const JointNumbers& of : kPatchedNumbers) {
    const auto numbers = [&](const UrdfText& source) {
      return source.numbers(source.joint(joint).child(of.element), of.attribute, of.size, ignored);
    };
    ChangedNumbers change{of, numbers(original), numbers(calibrated)};
    if (change.before != change.after) changes.push_back(std::move(change));
  }
  return changes;
}

[[nodiscard]] inline bool same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kSame = 1e-9;  // of numbers that xacro has rounded
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::abs(x - y) <= kSame * (1.0 + std::abs(y));
  });
}

}  // namespace kinecal::detail
