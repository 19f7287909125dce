// Compares a joint as constant data with one at run time, field by field, bit for bit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <span>

#include "kinecal/kinematics/robot_data.hpp"

namespace kinecal::test {

/// As bits: -0.0 is not 0.0.
inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

inline bool same_mimic(const MimicData& a, const Mimic& b) {
  return a.joint == b.joint && same_bits({&a.multiplier, 1}, {&b.multiplier, 1}) &&
         same_bits({&a.offset, 1}, {&b.offset, 1});
}

inline bool same_limits(const LimitsData& a, const JointLimits& b) {
  return same_bits({&a.lower, 1}, {&b.lower, 1}) && same_bits({&a.upper, 1}, {&b.upper, 1});
}

inline testing::AssertionResult same_joint(const JointData& data, const Joint& joint) {
  const auto differs = [&](const char* what) {
    return testing::AssertionFailure() << "joint '" << joint.name << "' differs in its " << what;
  };
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = joint.origin.rotation;
  if (data.name != joint.name) return differs("name");
  if (data.type != joint.type) return differs("type");
  if (data.parent != joint.parent) return differs("parent");
  if (data.child != joint.child) return differs("child");
  if (!same_bits(data.origin.rotation, {rotation.data(), 9})) return differs("rotation");
  if (!same_bits(data.origin.translation, {joint.origin.translation.data(), 3})) {
    return differs("translation");
  }
  if (!same_bits(data.axis, {joint.axis.data(), 3})) return differs("axis");
  if (data.mimic.has_value() != joint.mimic.has_value() ||
      (data.mimic && !same_mimic(*data.mimic, *joint.mimic))) {
    return differs("mimic");
  }
  if (data.limits.has_value() != joint.limits.has_value() ||
      (data.limits && !same_limits(*data.limits, *joint.limits))) {
    return differs("limits");
  }
  return testing::AssertionSuccess();
}

}  // namespace kinecal::test
