// Definitions of pose_generation.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/pose_generation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/session/joint_range.ipp"
#include "kinecal/capture/session/robot_body.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

namespace detail {

// Faults of a view of a target.

/// The fault of a view, and its size.
struct ViewFault {
  double size = 0.0;
  std::string what;  ///< of the largest part

  void add(double part, const char* name) {
    if (part > 0.0 && part >= largest_) {
      largest_ = part;
      what = name;
    }
    size += std::max(part, 0.0);
  }

 private:
  double largest_ = 0.0;
};

/// The joints of the goal, or those between its camera and its target.
[[nodiscard]] inline std::set<std::string> moving_joints(const Robot& robot, const ViewGoal& goal) {
  std::set<std::string> names;
  for (const std::string& name : goal.joints) names.insert(drive(robot, robot.joint(name)).joint);
  if (!goal.joints.empty()) return names;
  const RuntimeChain chain = make_chain(robot, goal.camera, goal.target, {});
  for (const ChainJoint& joint : chain.joints) names.insert(std::string(joint.drive.joint));
  return names;
}

/// Where a joint is that does not move, radians or metres.
[[nodiscard]] inline double rest_of(const Joint& joint, const ViewGoal& goal) {
  const auto given = goal.rest.find(joint.name);
  if (given != goal.rest.end()) return given->second;
  return std::clamp(0.0, position_in_range(joint, 0.0), position_in_range(joint, 1.0));
}

// Distance of a pose from a good view of a target.

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
    if (names_.empty()) {
      throw std::invalid_argument("no joint moves '" + goal.camera + "' against '" + goal.target +
                                  "'");
    }
    for (const std::string& name : body_.joints()) joints_.push_back(robot.joint(name));
    for (const std::string& name : names_) chosen_.push_back(index_of(name));
    for (const Joint& joint : joints_) middle_.push_back(rest_of(joint, goal));
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
  /// Positions of the others.
  [[nodiscard]] std::map<std::string, double> held_joints(const Robot& robot) const {
    std::map<std::string, double> held;
    for (const Joint& joint : robot.joints()) {
      if (!names_.contains(joint.name)) held[joint.name] = rest_of(joint, goal_);
    }
    return held;
  }

  [[nodiscard]] std::size_t index_of(const std::string& name) const {
    const std::vector<std::string>& all = body_.joints();
    const auto found = std::find(all.begin(), all.end(), name);
    if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
    throw std::invalid_argument("joint '" + name + "' does not move anything of the robot");
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

using Places = std::vector<std::vector<double>>;

[[nodiscard]] inline double squared_distance(const std::vector<double>& a,
                                             const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Indices of places far from each other: each next one is the farthest from all before.
[[nodiscard]] inline std::vector<std::size_t> spread(const Places& places, std::size_t count) {
  std::vector<double> nearest(places.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> chosen;
  for (std::size_t next = 0; chosen.size() < std::min(count, places.size());) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < places.size(); ++i) {
      nearest[i] = std::min(nearest[i], squared_distance(places[i], places[next]));
    }
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) -
                                    nearest.begin());
  }
  return chosen;
}

/// The same indices, reordered so that each is the nearest to the one before.
[[nodiscard]] inline std::vector<std::size_t> short_ways(const Places& places,
                                                         std::vector<std::size_t> indices) {
  for (std::size_t i = 1; i < indices.size(); ++i) {
    const auto from = static_cast<std::ptrdiff_t>(i);
    const std::vector<double>& here = places[indices[i - 1]];
    const auto nearer = [&](std::size_t a, std::size_t b) {
      return squared_distance(places[a], here) < squared_distance(places[b], here);
    };
    std::iter_swap(indices.begin() + from,
                   std::min_element(indices.begin() + from, indices.end(), nearer));
  }
  return indices;
}

/// Searches from one start: keeps changes of a joint that do not make the view worse.  Once the
/// target is visible, it continues among good poses, or all would lie at the edge of the good
/// region.
/// @param q  in: where to start; out: the last pose that can be used, if there is one
/// @returns  what is wrong with the best pose; empty if one is usable
[[nodiscard]] inline ViewFault search(const ViewSearch& view, std::vector<double>& q,
                                      std::mt19937_64& random) {
  constexpr int kSteps = 400, kWander = 60;
  std::vector<double> here = q;
  ViewFault least = view.fault(here);
  bool is_usable = false;
  for (int n = 0, seen = 0; n < kSteps && seen < kWander; ++n) {
    std::vector<double> other = here;
    view.change(other, random);
    ViewFault fault = view.fault(other);
    if (fault.size > least.size) continue;
    here = std::move(other);
    least = std::move(fault);
    if (least.size > 0.0) continue;
    ++seen;
    least.what = view.obstacle(here);
    if (!least.what.empty()) continue;
    is_usable = true;
    q = here;
  }
  if (is_usable) least.what.clear();
  return least;
}

}  // namespace detail

double floor_height(const Robot& robot, const ViewGoal& goal) {
  const RobotBody body(robot, goal.base, goal.radius);
  const std::set<std::string> moved = detail::moving_joints(robot, goal);
  std::vector<double> rest, elsewhere;
  for (const std::string& name : body.joints()) {
    constexpr double kStep = 0.1;  // radians or metres
    rest.push_back(detail::rest_of(robot.joint(name), goal));
    elsewhere.push_back(rest.back() + (moved.contains(name) ? kStep : 0.0));
  }
  const std::vector<Pose<double>> here = body.poses(rest), there = body.poses(elsewhere);
  constexpr double kMoved = 1e-9, kFlat = 0.01;  // metres; wheels may be a little lower
  double lowest = -kFlat;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const bool moves = (here[i].translation - there[i].translation).norm() > kMoved ||
                       (here[i].rotation - there[i].rotation).norm() > kMoved;
    if (!moves) lowest = std::min(lowest, here[i].translation.z());
  }
  return lowest < -kFlat ? lowest : 0.0;
}

std::vector<JointTarget> poses_with_view_of(const Robot& robot, const ViewGoal& goal, int count,
                                            std::uint64_t seed, int give_up) {
  constexpr int kCandidates = 4, kTries = 40, kMore = 1000;  // per pose; in all
  constexpr double kNear = 0.1;  // fault of a view: a tenth of the image
  const detail::ViewSearch view(robot, goal);
  std::mt19937_64 random(seed);
  detail::Places found, shares;
  detail::ViewFault best;
  best.size = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kTries * count + kMore; ++n) {
    if (static_cast<int>(found.size()) >= kCandidates * count) break;
    if (n > 0 && n == give_up && best.size > kNear) break;
    std::vector<double> q = view.anywhere(random);
    const detail::ViewFault fault = detail::search(view, q, random);
    if (fault.size < best.size) best = fault;
    if (!fault.what.empty()) continue;
    shares.push_back(view.shares(q));
    found.push_back(std::move(q));
  }
  if (found.empty() && count > 0) {
    throw std::runtime_error("no pose in which '" + goal.camera + "' sees the target on '" +
                             goal.target + "'; in the best one " + best.what);
  }
  std::vector<JointTarget> targets;
  const auto chosen = detail::spread(shares, static_cast<std::size_t>(std::max(count, 0)));
  for (const std::size_t i : detail::short_ways(shares, chosen)) {
    targets.push_back(view.target(found[i]));
  }
  return targets;
}

}  // namespace kinecal
