// What a sample says of a joint, for joint models.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/kinematics/gravity_load.hpp"
#include "kinecal/parameters/joint_models/joint_model.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// The only name of a sample that has one letter more or less at its end than the joint: of names as short as
/// "a3", did_you_mean() finds none.
[[nodiscard]] inline std::string did_you_mean_longer(const std::string& joint,
                                                     const std::vector<std::string>& names) {
  std::string found;
  for (const std::string& name : names) {
    const auto& [shorter, longer] =
        std::minmax(joint, name, [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (shorter.size() + 1 != longer.size() || !longer.starts_with(shorter)) continue;
    if (!found.empty()) return "";
    found = name;
  }
  return found.empty() ? "" : "; did you mean '" + found + "'?";
}

/// "joint 'elbow' is not in the sample", or that the pose of a floating joint is not, with the
/// nearest name.
/// @param joint  or a coordinate of a floating joint
/// @param whose  follows the sentence: "; sensor 'camera' needs it"
[[nodiscard]] inline std::string missing_text(const Sample& sample, const std::string& joint,
                                              const std::string& whose = "") {
  const std::optional<FloatingCoordinate> part = floating_coordinate(joint);
  if (!part) {
    const std::string near = did_you_mean(joint, sample.joint_names);
    return "joint '" + joint + "' is not in the sample" + whose +
           (near.empty() ? did_you_mean_longer(joint, sample.joint_names) : near);
  }
  std::vector<std::string> names;
  for (const auto& [name, pose] : sample.poses) names.push_back(name);
  return "the pose of floating joint '" + part->joint + "' is not in the sample" + whose +
         did_you_mean(part->joint, names);
}

/// The measured position of a joint, or of a coordinate of a floating joint.
/// @throws SampleError  if it is missing or not a number
[[nodiscard]] inline double position_in(const Sample& sample, const std::string& joint) {
  const std::optional<double> position = sample.position(joint);
  if (!position) throw SampleError(missing_text(sample, joint));
  if (!std::isfinite(*position)) {
    const std::optional<FloatingCoordinate> part = floating_coordinate(joint);
    throw SampleError(
        (part ? "the pose of floating joint '" + part->joint : "the position of joint '" + joint) +
        "' is not a number");
  }
  return *position;
}

/// The loads of all joints in a sample, computed when they are needed.  Joints that the sample does
/// not have stand at zero.
class SampleLoads {
 public:
  /// @param robot  must outlive this, like the sample
  SampleLoads(const Robot& robot, const Sample& sample) : robot_(robot), sample_(sample) {}

  [[nodiscard]] const Robot& robot() const { return robot_; }
  /// Of all links and the payload.
  /// @param at_rest  without the payload, if the sample does not have it; else that is an error
  [[nodiscard]] double of_links(const std::string& joint, bool at_rest) {
    if (!of_links_) {
      of_links_ = loads().of_links();
      const std::string& link = robot_.weight().payload;
      const auto payload = sample_.conditions.find("payload");
      if (!link.empty() && payload == sample_.conditions.end() && !at_rest) {
        std::vector<std::string> names;
        for (const auto& [name, value] : sample_.conditions) names.push_back(name);
        throw SampleError("condition 'payload' is not in the sample, which payload_link '" + link +
                          "' carries: 0 if it carries none" + did_you_mean("payload", names));
      }
      if (!link.empty() && payload != sample_.conditions.end()) {
        loads().add(link, Vector3<double>::Zero(), payload->second, *of_links_);
      }
    }
    return of(joint, *of_links_);
  }
  /// Of one kilogram at the origin of a link.
  [[nodiscard]] double of_kilogram(const std::string& joint, const std::string& link) {
    const auto [known, is_new] = of_kilogram_.try_emplace(link);
    if (is_new) loads().add(link, Vector3<double>::Zero(), 1.0, known->second);
    return of(joint, known->second);
  }

 private:
  [[nodiscard]] static double of(const std::string& joint, const GravityLoads::ByJoint& loads) {
    const auto known = loads.find(joint);
    return known == loads.end() ? 0.0 : known->second;
  }
  [[nodiscard]] GravityLoads& loads() {
    if (!loads_) {
      loads_.emplace(
          robot_, [&](const std::string& joint) { return sample_.position(joint).value_or(0.0); });
    }
    return *loads_;
  }

  const Robot& robot_;
  const Sample& sample_;
  std::optional<GravityLoads> loads_;
  std::optional<GravityLoads::ByJoint> of_links_;
  std::map<std::string, GravityLoads::ByJoint> of_kilogram_;  ///< by link
};

/// What a sample says of a joint.
class SampleReading final : public JointReading {
 public:
  /// @param joint  all three must outlive this
  /// @param at_rest  what is unknown of velocity and direction is zero, not an error
  SampleReading(const Sample& sample, const std::string& joint, SampleLoads& loads, bool at_rest)
      : sample_(sample),
        joint_(joint),
        driver_(drive(loads.robot(), loads.robot().joint(joint)).joint),
        loads_(loads),
        at_rest_(at_rest) {}

  [[nodiscard]] double position() const override { return position_in(sample_, driver_); }
  [[nodiscard]] double position_of(const std::string& joint) const override {
    return position_in(sample_, joint);
  }
  [[nodiscard]] double velocity() const override {
    if (const auto velocity = sample_.velocity(driver_)) return *velocity;
    if (at_rest_) return 0.0;
    throw SampleError("the velocity of joint '" + joint_ +
                      "' is not in the sample; a lag needs it: record it, or write it as "
                      "'velocity' beside 'position'");
  }
  [[nodiscard]] double direction() const override {
    constexpr double kMoves = 1e-3;  // rad/s or m/s
    const double velocity = sample_.velocity(driver_).value_or(0.0);
    if (std::abs(velocity) > kMoves) return velocity > 0.0 ? 1.0 : -1.0;
    if (const auto move = sample_.move(driver_))
      return *move > 0.0 ? 1.0 : *move < 0.0 ? -1.0 : 0.0;
    if (at_rest_) return 0.0;
    throw SampleError("the direction in which joint '" + joint_ +
                      "' moved last is unknown; backlash needs samples in the order of their "
                      "recording, or velocities");
  }
  [[nodiscard]] double load() const override { return loads_.of_links(joint_, at_rest_); }
  [[nodiscard]] double load_of(const std::string& link) const override {
    return loads_.of_kilogram(joint_, link);
  }

 private:
  const Sample& sample_;
  const std::string& joint_;
  std::string driver_;  ///< the joint that drives it: itself unless it mimics
  SampleLoads& loads_;
  bool at_rest_;
};

}  // namespace kinecal::detail
