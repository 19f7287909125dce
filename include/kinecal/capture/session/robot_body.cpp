// Definitions of robot_body.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/robot_body.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "kinecal/capture/session/joint_range.ipp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Distance between two line segments, metres.
/// Source: Ericson, Real-Time Collision Detection, 5.1.9.
[[nodiscard]] double segment_distance(const Vector3<double>& a0, const Vector3<double>& a1,
                                      const Vector3<double>& b0, const Vector3<double>& b1) {
  constexpr double kPoint = 1e-12;
  const Vector3<double> a = a1 - a0, b = b1 - b0, r = a0 - b0;
  const double aa = a.dot(a), bb = b.dot(b), br = b.dot(r), ar = a.dot(r), ab = a.dot(b);
  const double determinant = aa * bb - ab * ab;
  double s = 0.0, t = 0.0;
  if (aa > kPoint && determinant > kPoint * aa * bb) {
    s = std::clamp((ab * br - ar * bb) / determinant, 0.0, 1.0);
  }
  if (bb > kPoint) t = std::clamp((ab * s + br) / bb, 0.0, 1.0);
  if (aa > kPoint) s = std::clamp((ab * t - ar) / aa, 0.0, 1.0);
  return (r + s * a - t * b).norm();
}

}  // namespace
}  // namespace detail

RobotBody::RobotBody(const Robot& robot, const std::string& base, double radius,
                     const std::map<std::string, double>& held)
    : radius_(radius) {
  add_links(robot, base);
  add_bones();
  find_neighbours(robot, held);
}

void RobotBody::add_links(const Robot& robot, const std::string& name) {
  const std::string base = make_chain(robot, name, name).base;  // as the robot spells it
  std::string root = base;
  const auto is_connected = [](const Joint& j) {
    return j.type == JointType::fixed || moves(j.type);
  };
  for (const Joint* joint : joints_to_root(robot, base)) {
    if (!is_connected(*joint)) break;
    root = joint->parent;
  }
  std::vector<std::string> names = {root};
  links_[root] = 0;
  bodies_ = {0};
  std::map<std::string, int> indices;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const Joint& joint : robot.joints()) {
      if (joint.parent != names[i] || !is_connected(joint)) continue;
      Step step{joint, i, names.size()};
      if (moves(joint.type)) {
        step.drive = drive(robot, joint);
        const auto [known, is_new] =
            indices.try_emplace(step.drive.joint, static_cast<int>(joints_.size()));
        if (is_new) joints_.push_back(step.drive.joint);
        step.q = known->second;
      }
      links_[joint.child] = names.size();
      bodies_.push_back(moves(joint.type) ? names.size() : bodies_[i]);
      names.push_back(joint.child);
      steps_.push_back(std::move(step));
    }
  }
  base_ = links_.at(base);
}

void RobotBody::add_bones() {
  std::vector<bool> has_child(bodies_.size(), false);
  for (const Step& step : steps_) {
    has_child[step.parent] = true;
    bones_.push_back({step.parent, Vector3<double>::Zero(), step.joint.origin.translation});
  }
  for (std::size_t i = 0; i < has_child.size(); ++i) {
    if (!has_child[i]) bones_.push_back({i, Vector3<double>::Zero(), Vector3<double>::Zero()});
  }
}

void RobotBody::find_neighbours(const Robot& robot, const std::map<std::string, double>& held) {
  for (const Step& step : steps_) {
    neighbours_.insert(std::minmax(bodies_[step.parent], bodies_[step.child]));
  }
  constexpr int kPoses = 200;
  constexpr double kAlmostEvery = 0.9;
  std::mt19937_64 random(1);
  std::map<std::pair<std::size_t, std::size_t>, int> counts;
  std::vector<double> q(joints_.size());
  for (int n = 0; n < kPoses; ++n) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      const auto fixed = held.find(joints_[i]);
      q[i] = fixed != held.end()
                 ? fixed->second
                 : detail::position_in_range(robot.joint(joints_[i]), detail::random_share(random));
    }
    for (const auto& pair : touching(poses(q))) ++counts[pair];
  }
  for (const auto& [pair, count] : counts) {
    if (count >= kAlmostEvery * kPoses) neighbours_.insert(pair);
  }
}

std::size_t RobotBody::link(const std::string& name) const {
  for (const auto& [known, index] : links_) {
    if (same_frame(known, name)) return index;
  }
  std::vector<std::string> names;
  for (const auto& [known, index] : links_) names.push_back(known);
  throw RobotError("no link '" + name + "' is connected to the base" + did_you_mean(name, names));
}

std::vector<Pose<double>> RobotBody::poses(std::span<const double> q) const {
  std::vector<Pose<double>> all(bodies_.size());
  for (const Step& step : steps_) {
    Pose<double>& pose = all[step.child];
    pose = all[step.parent] * step.joint.origin;
    if (step.q < 0) continue;
    const double position =
        step.drive.multiplier * q[static_cast<std::size_t>(step.q)] + step.drive.offset;
    const Vector3<double> motion = step.joint.axis * position;
    if (turns(step.joint.type)) {
      pose.rotation = (pose.rotation * exp(motion)).eval();
    } else {
      pose.translation = pose * motion;
    }
  }
  if (base_ == 0) return all;
  const Pose<double> base_T_root = all[base_].inverse();
  for (Pose<double>& pose : all) pose = base_T_root * pose;
  return all;
}

bool RobotBody::are_neighbours(std::size_t a, std::size_t b) const {
  return a == b || neighbours_.contains(std::minmax(a, b));
}

RobotBody::Pairs RobotBody::touching(const std::vector<Pose<double>>& poses) const {
  Pairs pairs;
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    const std::size_t body = bodies_[bones_[i].link];
    const Vector3<double> a0 = poses[bones_[i].link] * bones_[i].a;
    const Vector3<double> a1 = poses[bones_[i].link] * bones_[i].b;
    for (std::size_t k = 0; k < i; ++k) {
      const std::size_t other = bodies_[bones_[k].link];
      if (are_neighbours(body, other)) continue;
      const Pose<double>& pose = poses[bones_[k].link];
      const double distance =
          detail::segment_distance(a0, a1, pose * bones_[k].a, pose * bones_[k].b);
      if (distance < 2.0 * radius_) pairs.insert(std::minmax(body, other));
    }
  }
  return pairs;
}

bool RobotBody::touches_itself(const std::vector<Pose<double>>& poses) const {
  return !touching(poses).empty();
}

bool RobotBody::is_below(const std::vector<Pose<double>>& poses, double height) const {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (bodies_[i] != bodies_[base_] && poses[i].translation.z() < height) return true;
  }
  return false;
}

bool RobotBody::hides(const std::vector<Pose<double>>& poses, std::size_t a,
                      const Vector3<double>& p_a, std::size_t b, const Vector3<double>& p_b) const {
  return std::any_of(bones_.begin(), bones_.end(), [&](const Bone& bone) {
    const std::size_t body = bodies_[bone.link];
    if (are_neighbours(body, bodies_[a]) || are_neighbours(body, bodies_[b])) return false;
    const Pose<double>& pose = poses[bone.link];
    return detail::segment_distance(p_a, p_b, pose * bone.a, pose * bone.b) < radius_;
  });
}

}  // namespace kinecal
