// State of a simulated robot over time, for simulated_robot.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/study/render.hpp"
#include "kinecal/study/simulated_robot.hpp"

namespace kinecal::detail {

[[nodiscard]] inline Stamp stamp_of(double seconds) {
  constexpr double kMost = 9e9;  // a Stamp has nanoseconds in 63 bits
  return Stamp(std::llround(1e9 * std::clamp(seconds, -kMost, kMost)));
}
[[nodiscard]] inline double seconds_of(Stamp stamp) {
  return 1e-9 * static_cast<double>(stamp.count());
}

/// Adds the errors of a setup's truth to its camera.
[[nodiscard]] inline SimulatedSetup with_camera_errors(SimulatedSetup setup) {
  for (std::size_t i = 0; i < setup.camera.errors.size(); ++i) {
    const std::string_view part = kCameraErrors[i];
    const int index = setup.truth.find(parameter_name(setup.camera_name, part));
    if (index >= 0) setup.camera.errors[i] = setup.truth[index].value;
  }
  return setup;
}

/// Positions of the joints, after the last command.
class Joints {
 public:
  explicit Joints(const SimulatedSetup& setup) : setup_(setup) {
    for (const Joint& joint : setup.robot.joints()) {
      if (!moves(joint.type) || joint.mimic) continue;
      const double given = setup.start.contains(joint.name) ? setup.start.at(joint.name) : 0.0;
      double position = given;
      if (joint.limits && joint.limits->lower <= joint.limits->upper) {
        position = std::clamp(given, joint.limits->lower, joint.limits->upper);
      }
      motions_[joint.name] = JointMotion(position, position, setup.drive);
      unseen_[joint.name] = 0.0;
    }
  }

  /// @throws PoseError  if a joint cannot go there
  void check(const JointTarget& target) const {
    if (target.names.size() != target.positions.size()) {
      throw PoseError(std::to_string(target.names.size()) + " joints and " +
                      std::to_string(target.positions.size()) + " positions for them");
    }
    if (!(target.velocity_factor > 0.0) || target.velocity_factor > 1.0) {
      throw PoseError("velocity factor must be above 0 and at most 1, is " +
                      std::to_string(target.velocity_factor));
    }
    for (std::size_t i = 0; i < target.names.size(); ++i) {
      check(target.names[i], target.positions[i]);
    }
  }

  /// Starts to move at a time.
  void move(const JointTarget& target, double now, SeededRandom& random) {
    const Positions from = encoders(now);
    start_ = now;
    outlier_.clear();
    Positions to = from;
    for (std::size_t i = 0; i < target.names.size(); ++i) to[target.names[i]] = target.positions[i];
    std::vector<std::string> moving;
    for (auto& [name, motion] : motions_) {
      double end = to.at(name);
      if (name == setup_.faults.stuck_joint) end = 0.5 * (from.at(name) + end);
      motion = JointMotion(from.at(name), end, drive_of(name), target.velocity_factor);
      if (motion.direction() == 0) continue;
      moving.push_back(name);
      unseen_[name] = setup_.timing.repeatability * random.normal() -
                      0.5 * setup_.timing.backlash * motion.direction();
    }
    const bool is_outlier = random.uniform(0.0, 1.0) < setup_.faults.outliers;
    if (!is_outlier || moving.empty()) return;
    const int which = random.integer(0, static_cast<int>(moving.size()) - 1);
    outlier_ = moving[static_cast<std::size_t>(which)];
    outlier_size_ = random.either_sign(setup_.faults.outlier_size, setup_.faults.outlier_size);
  }

  /// Encoder readings without noise.
  [[nodiscard]] Positions encoders(double now) const {
    Positions positions;
    for (const auto& [name, motion] : motions_) positions[name] = motion.position(now - start_);
    return positions;
  }

  /// True positions of the joints.
  [[nodiscard]] Positions truth(double now) const {
    Positions positions = encoders(now);
    for (auto& [name, position] : positions) position += unseen_.at(name);
    if (!outlier_.empty()) positions[outlier_] += outlier_size_;
    return positions;
  }

  /// Time at which all motion has stopped, seconds.
  [[nodiscard]] double rest() const {
    double latest = 0.0;
    for (const auto& [name, motion] : motions_) latest = std::max(latest, motion.rest());
    return start_ + latest;
  }

  /// When the last motion began, seconds.
  [[nodiscard]] double start() const { return start_; }

 private:
  void check(const std::string& name, double position) const {
    if (!motions_.contains(name)) {
      std::vector<std::string> names;
      for (const auto& [known, motion] : motions_) names.push_back(known);
      throw PoseError("no joint '" + name + "' that moves" + did_you_mean(name, names));
    }
    if (!std::isfinite(position)) throw PoseError("joint '" + name + "': not a finite position");
    const Joint& joint = setup_.robot.joint(name);
    constexpr double kRounding = 1e-6;  // of positions in files
    if (joint.type == JointType::continuous || !joint.limits) return;
    if (position < joint.limits->lower - kRounding || position > joint.limits->upper + kRounding) {
      throw PoseError("joint '" + name + "' cannot move to " + std::to_string(position) +
                      "; its limits are " + std::to_string(joint.limits->lower) + " and " +
                      std::to_string(joint.limits->upper));
    }
  }

  [[nodiscard]] JointDrive drive_of(const std::string& name) const {
    JointDrive drive = setup_.drive;
    constexpr double kSliding = 0.1;
    const double factor = turns(setup_.robot.joint(name).type) ? 1.0 : kSliding;
    drive.swing *= factor;
    drive.acceleration *= factor;
    const auto known = setup_.speeds.find(name);
    drive.speed = known != setup_.speeds.end() ? known->second : drive.speed * factor;
    return drive;
  }

  const SimulatedSetup& setup_;
  std::map<std::string, JointMotion> motions_;
  Positions unseen_;  ///< offsets that encoders do not see
  std::string outlier_;
  double outlier_size_ = 0.0, start_ = 0.0;
};

/// Hides a part of a view behind a near object that is not in the scene.
inline void hide_a_part(View& view, SeededRandom& random) {
  constexpr double kDepth = 0.4;  // metres
  const int width = view.image.width, left = random.integer(-width / 4, width - width / 8);
  const int right = left + random.integer(width / 8, width / 2);
  const auto gray = static_cast<std::uint8_t>(random.integer(30, 160));
  for (int v = 0; v < view.image.height; ++v) {
    for (int u = std::max(left, 0); u < std::min(right, width); ++u) {
      view.image(u, v) = gray;
      if (!view.points.empty())
        view.points(u, v) *= static_cast<float>(kDepth) / view.points(u, v).z();
    }
  }
}

}  // namespace kinecal::detail
