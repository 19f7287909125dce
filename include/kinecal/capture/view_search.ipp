// Distance of a pose from a good view of a target, for pose_generation.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/joint_range.ipp"
#include "kinecal/capture/pose_generation.hpp"
#include "kinecal/capture/robot_body.hpp"
#include "kinecal/capture/view_fault.ipp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/sensors/lens.hpp"

namespace kinecal::detail {

/// A goal for one robot.
class ViewSearch {
 public:
  ViewSearch(const Robot& robot, const ViewGoal& goal)
      : goal_(goal),
        names_(moving_joints(robot, goal)),
        body_(robot, goal.base, goal.radius, held_joints(robot)),
        camera_(body_.link(goal.camera)),
        target_(body_.link(goal.target)),
        lens_(goal.info, goal.image) {
    if (goal.points.empty()) throw std::invalid_argument("a target without points to look at");
    for (const std::string& name : body_.joints()) joints_.push_back(robot.joint(name));
    for (const std::string& name : names_) chosen_.push_back(index_of(name));
    for (const Joint& joint : joints_) middle_.push_back(rest_of(joint));
    for (const Vector3<double>& point : goal.points) {
      centre_ += point / static_cast<double>(goal.points.size());
    }
  }

  /// Positions of all joints of the body; those that move are random.
  [[nodiscard]] std::vector<double> anywhere(std::mt19937_64& random) const {
    std::vector<double> q = middle_;
    for (const std::size_t i : chosen_) q[i] = position_in_range(joints_[i], random_share(random));
    return q;
  }

  /// Moves one joint, in most cases slightly.
  void change(std::vector<double>& q, std::mt19937_64& random) const {
    constexpr double kFar = 0.3, kNear = 0.2;  // share of changes; of the way
    const std::size_t i = chosen_[random() % chosen_.size()];
    const double way = random_share(random) < kFar ? 1.0 : kNear * random_share(random);
    q[i] += way * (position_in_range(joints_[i], random_share(random)) - q[i]);
  }

  [[nodiscard]] ViewFault fault(const std::vector<double>& q) const {
    const std::vector<Pose<double>> poses = body_.poses(q);
    const Pose<double> camera_T_target = poses[camera_].inverse() * poses[target_];
    ViewFault fault;
    std::array<double, 4> box = {1e9, 1e9, -1e9, -1e9};  // left, top, right, bottom, pixels
    for (const Vector3<double>& point : goal_.points) {
      add_point(camera_T_target * point, fault, box);
    }
    const double needed = goal_.points.size() > 1 ? goal_.least_size : 0.0;
    if (fault.size == 0.0) {
      const double size = std::hypot(box[2] - box[0], box[3] - box[1]) / goal_.info.width;
      fault.add(needed - size, "the target is too small in the image");
    }
    if (goal_.front) {
      const Vector3<double> front = camera_T_target.rotation * goal_.front->normalized();
      const Vector3<double> towards = -(camera_T_target * centre_).normalized();
      fault.add(std::cos(goal_.most_angle) - front.dot(towards),
                "the target is seen from the side or from behind");
    }
    return fault;
  }

  /// Why a view that is good in itself is not possible; empty if it is.
  [[nodiscard]] std::string obstacle(const std::vector<double>& q) const {
    const std::vector<Pose<double>> poses = body_.poses(q);
    if (body_.is_below(poses, goal_.ground)) return "a link is below the ground";
    if (body_.touches_itself(poses)) return "the robot touches itself";
    const Vector3<double>& eye = poses[camera_].translation;
    for (const Vector3<double>& point : goal_.points) {
      if (body_.hides(poses, camera_, eye, target_, poses[target_] * point)) {
        return "the robot hides the target";
      }
    }
    return "";
  }

  /// The joints that move.
  [[nodiscard]] JointTarget target(const std::vector<double>& q) const {
    JointTarget target;
    for (const std::size_t i : chosen_) {
      target.names.push_back(joints_[i].name);
      target.positions.push_back(q[i]);
    }
    return target;
  }

  /// Positions of the moving joints, relative to their ranges.
  [[nodiscard]] std::vector<double> shares(const std::vector<double>& q) const {
    std::vector<double> shares;
    for (const std::size_t i : chosen_) {
      const double low = position_in_range(joints_[i], 0.0);
      shares.push_back((q[i] - low) / (position_in_range(joints_[i], 1.0) - low));
    }
    return shares;
  }

 private:
  /// The joints of the goal, or those between its camera and its target.
  [[nodiscard]] static std::set<std::string> moving_joints(const Robot& robot,
                                                           const ViewGoal& goal) {
    std::set<std::string> names;
    for (const std::string& name : goal.joints) {
      names.insert(drive(robot, robot.joint(name)).joint);
    }
    if (!goal.joints.empty()) return names;
    const RuntimeChain chain = make_chain(robot, goal.camera, goal.target, {});
    for (const ChainJoint& joint : chain.joints) names.insert(std::string(joint.drive.joint));
    if (!names.empty()) return names;
    throw std::invalid_argument("no joint moves '" + goal.camera + "' against '" + goal.target +
                                "'");
  }

  /// Positions of the others.
  [[nodiscard]] std::map<std::string, double> held_joints(const Robot& robot) const {
    std::map<std::string, double> held;
    for (const Joint& joint : robot.joints()) {
      if (!names_.contains(joint.name)) held[joint.name] = rest_of(joint);
    }
    return held;
  }

  [[nodiscard]] std::size_t index_of(const std::string& name) const {
    const std::vector<std::string>& all = body_.joints();
    const auto found = std::find(all.begin(), all.end(), name);
    if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
    throw std::invalid_argument("joint '" + name + "' does not move anything of the robot");
  }

  [[nodiscard]] double rest_of(const Joint& joint) const {
    const auto given = goal_.rest.find(joint.name);
    if (given != goal_.rest.end()) return given->second;
    return std::clamp(0.0, position_in_range(joint, 0.0), position_in_range(joint, 1.0));
  }

  void add_point(const Vector3<double>& p, ViewFault& fault, std::array<double, 4>& box) const {
    constexpr double kMost = 1.0;  // of each part, so that one does not outweigh the others
    if (p.z() < goal_.nearest) {
      constexpr double kBehind = 3.0;
      fault.add(kBehind - p.normalized().z() + std::min(goal_.nearest - p.z(), kMost),
                "the target is behind the camera or too near");
      return;
    }
    fault.add(std::min(p.z() - goal_.farthest, kMost), "the target is too far away");
    const Eigen::Vector2d pixel = lens_.project(p);
    const double u = pixel.x() / (goal_.info.width - 1), v = pixel.y() / (goal_.info.height - 1);
    const double out = std::max(
        {goal_.margin - u, u - 1.0 + goal_.margin, goal_.margin - v, v - 1.0 + goal_.margin});
    // Beyond the image a lens model may bend back: the direction counts, too.
    const double side = std::abs(p.x() / p.z()) - goal_.info.width / lens_.focal_length();
    fault.add(std::min(std::max(out, side), kMost), "the target is not all in the image");
    box = {std::min(box[0], pixel.x()), std::min(box[1], pixel.y()), std::max(box[2], pixel.x()),
           std::max(box[3], pixel.y())};
  }

  const ViewGoal& goal_;
  std::set<std::string> names_;  ///< of the joints that move
  RobotBody body_;
  std::size_t camera_, target_;
  Lens lens_;
  std::vector<Joint> joints_;
  std::vector<std::size_t> chosen_;  ///< indices of those that move
  std::vector<double> middle_;       ///< positions of those that do not
  Vector3<double> centre_ = Vector3<double>::Zero();
};

}  // namespace kinecal::detail
