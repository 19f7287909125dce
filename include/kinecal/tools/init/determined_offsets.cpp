// Definitions of determined_offsets.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/determined_offsets.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

namespace detail {
namespace {

// Random positions of joints.

/// From -1 to 1; equal for equal seeds on every platform.
[[nodiscard]] double random_number(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
}

/// A joint of a robot, or a coordinate of a floating one.
[[nodiscard]] Joint driven(const Robot& robot, const std::string& name) {
  const auto part = floating_coordinate(name);
  if (!part) return robot.joint(name);
  return {name, part->index < 3 ? JointType::prismatic : JointType::continuous, {}, {}};
}

/// A position within limits; without limits, up to half a turn or half a metre to either side.
[[nodiscard]] double random_position(const Joint& joint, std::mt19937_64& random) {
  const double most = turns(joint.type) ? std::numbers::pi : 0.5, share = random_number(random);
  const bool limited = joint.type != JointType::continuous && joint.limits &&
                       joint.limits->upper > joint.limits->lower;
  if (!limited) return most * share;
  return 0.5 * (joint.limits->lower + joint.limits->upper) +
         0.5 * share * (joint.limits->upper - joint.limits->lower);
}

// Random poses of a robot, and what a sensor measures in them.

using NamedNumbers = std::map<std::string, double>;      ///< of joints: radians and metres
using NamedPoses = std::map<std::string, Pose<double>>;  ///< corrections of frames

/// A robot with a target and a sensor in generated poses.
class GeneratedPoses {
 public:
  /// @param frames  joints that may have corrections
  /// @param count   of them
  GeneratedPoses(const Robot& robot, MeasuredTarget measured, const std::set<std::string>& frames,
                 std::size_t count = 60, std::uint64_t seed = 1)
      : robot_(robot),
        count_(count),
        random_(seed),
        measured_(std::move(measured)),
        tips_({{measured_.target, measured_.target_frame}}),
        to_sensor_(make_chain(robot, measured_.base, measured_.sensor, frames)) {
    tips_.insert(tips_.end(), measured_.more_tips.begin(), measured_.more_tips.end());
    for (const FurtherTip& tip : tips_)
      to_tips_.push_back(make_chain(robot, measured_.base, tip.link, frames));
    std::set<std::string> drives;
    const auto add_drives = [&](const RuntimeChain& chain) {
      for (const ChainJoint& joint : chain.joints) {
        if (moves(joint.type)) drives.insert(joint.drive.joint);
      }
    };
    for (const RuntimeChain& chain : to_tips_) add_drives(chain);
    add_drives(to_sensor_);
    place();
    if (measured_.contact == Contact::none) {
      generate(drives);
    } else {
      touch(drives);
    }
  }

  /// Positions by joint.
  [[nodiscard]] const std::vector<NamedNumbers>& poses() const { return poses_; }
  /// Which tip touches in a pose: each in turn, after all sockets.
  [[nodiscard]] std::size_t tip_of(std::size_t pose) const {
    return sockets_.empty() ? 0 : pose / sockets_.size() % tips_.size();
  }
  /// Where what is touched is in its link.
  [[nodiscard]] const Pose<double>& link_T_sensor() const { return link_T_sensor_; }
  /// Of a distance sensor in each pose, metres; else empty.
  [[nodiscard]] const std::vector<double>& distances() const { return distances_; }

  /// The points that the sensor measures in all poses (3 or, in pixels, 2 each).
  /// @param offsets      of joints
  /// @param corrections  of frames
  /// @param socket       of several, the only one whose frame has the correction of the sensor's frame; -1: all have it
  [[nodiscard]] Eigen::VectorXd measured(const NamedNumbers& offsets, const NamedPoses& corrections,
                                         int socket = -1) const {
    if (measured_.contact != Contact::none) return touched(offsets, corrections, socket);
    const Eigen::Index rows = row_count();
    Eigen::VectorXd all(rows * static_cast<Eigen::Index>(poses_.size() * points_.size()));
    Eigen::Index at = 0;
    for (const NamedNumbers& pose : poses_) {
      const Pose<double> sensor_T_target = seen_from(pose, offsets, corrections);
      for (const Vector3<double>& point : points_) {
        const Vector3<double> p = sensor_T_target * point;
        all.segment(at, rows) =
            in_pixels() ? Eigen::VectorXd(p.head<2>() / p.z()) : Eigen::VectorXd(p);
        at += rows;
      }
    }
    return all;
  }

  /// Components of the sensor's frame that its contact shows: x y z and rotations about them.
  [[nodiscard]] std::array<bool, 6> sensor_axes() const {
    switch (measured_.contact) {
      case Contact::none:
      case Contact::grip:
        return {true, true, true, true, true, true};
      case Contact::line:
        return {true, true, false, true, true, false};
      case Contact::plane:
        return {false, false, true, true, true, false};
      case Contact::gravity:
        return {};
      case Contact::point:
      case Contact::sphere:
        break;
    }
    return shown_axes(measured_.layout);
  }

  /// How the camera's parameters change these: focal lengths, centre and, with depth, its offset
  /// and scale.
  [[nodiscard]] std::vector<Eigen::VectorXd> camera_columns() const {
    if (!measured_.is_camera) return {};
    const Eigen::VectorXd all = measured({}, {});
    const Eigen::Index rows = row_count();
    std::vector<Eigen::VectorXd> columns(in_pixels() ? 4 : 6, Eigen::VectorXd::Zero(all.size()));
    for (Eigen::Index at = 0; at < all.size(); at += rows) {
      const double z = in_pixels() ? 1.0 : all(at + 2);
      columns[0](at) = all(at);
      columns[1](at + 1) = all(at + 1);
      columns[2](at) = columns[3](at + 1) = z;
      if (in_pixels()) continue;
      columns[4].segment(at, rows) = all.segment(at, rows) / z;
      columns[5].segment(at, rows) = all.segment(at, rows);
    }
    return columns;
  }

 private:
  [[nodiscard]] bool in_pixels() const { return measured_.is_camera && !measured_.has_depth; }
  [[nodiscard]] Eigen::Index row_count() const { return in_pixels() ? 2 : 3; }

  [[nodiscard]] Pose<double> end_of(const RuntimeChain& chain, const NamedNumbers& pose,
                                    const NamedNumbers& offsets,
                                    const NamedPoses& corrections) const {
    Corrections<double> of(chain.joints.size());
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const auto found = corrections.find(chain.joints[i].name);
      if (found != corrections.end()) of[i].frame = found->second;
    }
    const auto at = [&](const std::string& joint) {
      const auto offset = offsets.find(joint);
      return pose.at(joint) + (offset == offsets.end() ? 0.0 : offset->second);
    };
    return forward_kinematics(chain, at, of);
  }

  [[nodiscard]] Pose<double> seen_from(const NamedNumbers& pose, const NamedNumbers& offsets,
                                       const NamedPoses& corrections, std::size_t tip = 0) const {
    const auto correction = [&](const std::string& frame) {
      const auto found = corrections.find(frame);
      return found == corrections.end() ? Pose<double>() : found->second;
    };
    const Pose<double> base_T_target = end_of(to_tips_[tip], pose, offsets, corrections) *
                                       link_T_target_ * correction(tips_[tip].frame);
    const Pose<double> base_T_sensor = end_of(to_sensor_, pose, offsets, corrections) *
                                       link_T_sensor_ * correction(measured_.sensor_frame);
    return base_T_sensor.inverse() * base_T_target;
  }

  /// What a contact shows of what touches it.
  /// @param seen    in the frame of the contact; of a point, its place
  /// @param socket  that is touched, in this frame
  [[nodiscard]] Eigen::VectorXd shown(const Pose<double>& seen,
                                      const Vector3<double>& socket) const {
    const Vector3<double> p = seen.translation - socket;
    switch (measured_.contact) {
      case Contact::grip: {
        Eigen::VectorXd pose(6);
        pose << p, log(seen.rotation);
        return pose;
      }
      case Contact::line:
        return p.head<2>();
      case Contact::plane:
        return p.tail<1>();
      case Contact::sphere:
        return Eigen::VectorXd::Constant(1, p.norm());
      case Contact::none:
      case Contact::gravity:
      case Contact::point:
        break;
    }
    return p;
  }
  /// Of several sockets, the one that is touched in a pose.
  [[nodiscard]] std::size_t socket_of(std::size_t pose) const { return pose % sockets_.size(); }

  [[nodiscard]] Eigen::VectorXd touched(const NamedNumbers& offsets, const NamedPoses& corrections,
                                        int socket) const {
    const Eigen::Index rows = shown({}, Vector3<double>::UnitX()).size();
    Eigen::VectorXd all(rows * static_cast<Eigen::Index>(poses_.size()));
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      NamedPoses of_pose = corrections;
      if (socket >= 0 && socket_of(i) != static_cast<std::size_t>(socket)) {
        of_pose.erase(measured_.sensor_frame);
      }
      if (measured_.contact == Contact::gravity) {
        // What it reads in this pose, in the base as the offsets have it; the correction is that of gravity.
        const Matrix3<double> before = seen_from(poses_[i], {}, {}).rotation;
        all.segment(static_cast<Eigen::Index>(i) * rows, rows) =
            seen_from(poses_[i], offsets, of_pose).rotation * before.row(2).transpose();
        continue;
      }
      Pose<double> seen = seen_from(poses_[i], offsets, of_pose, tip_of(i));
      if (!distances_.empty()) seen.translation = seen * Vector3<double>(0.0, 0.0, distances_[i]);
      all.segment(static_cast<Eigen::Index>(i) * rows, rows) = shown(seen, sockets_[socket_of(i)]);
    }
    return all;
  }

  /// Random poses in which the tip touches: the contact is where the tip is in a first pose.
  void touch(const std::set<std::string>& drives) {
    constexpr int kTries = 3000;
    constexpr double kRadius = 0.2, kApart = 0.1;  // metres
    if (measured_.contact == Contact::gravity) sockets_ = {Vector3<double>::Zero()};
    const auto random_pose = [&] {
      NamedNumbers pose;
      for (const std::string& joint : drives)
        pose[joint] = random_position(driven(robot_, joint), random_);
      return pose;
    };
    const auto tip_in_base = [&](const NamedNumbers& pose, std::size_t tip) {
      return (end_of(to_tips_[tip], pose, {}, {}) * link_T_target_).translation;
    };
    const bool is_known = measured_.sensor_frame.empty();  // where what is touched is
    while (measured_.contact == Contact::gravity && poses_.size() < count_) {
      poses_.push_back(random_pose());
    }
    for (int i = 0; i < (is_known ? 1 : kTries) && poses_.empty(); ++i) {
      if (measured_.contact == Contact::grip) {
        link_T_sensor_ = random_grip();
      } else if (!is_known) {
        // A contact in the middle of what random poses reach, not at its border.
        Vector3<double> middle = Vector3<double>::Zero();
        constexpr std::size_t kMean = 3;
        for (std::size_t k = 0; k < kMean; ++k)
          middle += tip_in_base(random_pose(), k % tips_.size()) / kMean;
        const Pose<double> base_T_sensor = end_of(to_sensor_, random_pose(), {}, {});
        link_T_sensor_.translation = base_T_sensor.inverse() * middle;
        if (measured_.contact == Contact::sphere) {
          link_T_sensor_.translation += kRadius * Vector3<double>(0.6, 0.0, -0.8);
        }
      }
      sockets_ = measured_.layout;
      for (int k = 0; k < measured_.places && measured_.layout.empty(); ++k) {
        sockets_.emplace_back(kApart * k, k > 1 ? kApart : 0.0, 0.0);
      }
      radius_ = measured_.contact == Contact::sphere ? kRadius : 0.0;
      distances_.clear();
      for (int n = 0; n < static_cast<int>(20 * count_) && poses_.size() < count_; ++n) {
        NamedNumbers pose = random_pose();
        const bool has_tip = measured_.is_point || measured_.contact == Contact::grip;
        const bool touches = has_tip ? reach(pose, drives) : measures(pose);
        if (touches) poses_.push_back(std::move(pose));
      }
      if (poses_.size() < count_ / 3)
        poses_.clear(), distances_.clear();  // hardly reachable: another place
    }
  }

  /// How one hand may stand in the other, with something between them that both hold.
  [[nodiscard]] Pose<double> random_grip() {
    constexpr double kBetween = 0.3;  // metres
    const auto random_vector = [&] {
      const double x = random_number(random_), y = random_number(random_);
      return Vector3<double>(x, y, random_number(random_));
    };
    return {exp(Vector3<double>(std::numbers::pi * random_vector())),
            kBetween * random_vector().normalized()};
  }

  /// Whether a distance sensor measures the plane in a pose; keeps its distance.
  [[nodiscard]] bool measures(const NamedNumbers& pose) {
    constexpr double kLeast = 0.02, kMost = 0.6;  // metres
    const Pose<double> seen = seen_from(pose, {}, {});
    const double distance = -seen.translation.z() / seen.rotation(2, 2);
    if (!(distance > kLeast && distance < kMost)) return false;
    distances_.push_back(distance);
    return true;
  }

  /// Moves a pose until the next contact is touched.
  /// @returns  false if it does not within the limits
  [[nodiscard]] bool reach(NamedNumbers& pose, const std::set<std::string>& drives) const {
    constexpr int kIterations = 30;
    constexpr double kStep = 1e-6, kMost = 0.3, kClose = 1e-9;
    const auto missed = [&](const NamedNumbers& at) -> Eigen::VectorXd {
      const std::size_t next = poses_.size();
      Eigen::VectorXd by = shown(seen_from(at, {}, {}, tip_of(next)), sockets_[socket_of(next)]);
      by.array() -= radius_;
      return by;
    };
    for (int i = 0; i < kIterations; ++i) {
      const Eigen::VectorXd by = missed(pose);
      if (by.norm() < kClose) {
        return std::all_of(drives.begin(), drives.end(), [&](const std::string& name) {
          const Joint joint = driven(robot_, name);
          return joint.type == JointType::continuous || !joint.limits ||
                 (pose.at(name) >= joint.limits->lower && pose.at(name) <= joint.limits->upper);
        });
      }
      Eigen::MatrixXd jacobian(by.size(), static_cast<Eigen::Index>(drives.size()));
      Eigen::Index column = 0;
      for (const std::string& name : drives) {
        NamedNumbers moved = pose;
        moved[name] += kStep;
        jacobian.col(column++) = (missed(moved) - by) / kStep;
      }
      const Eigen::MatrixXd square =
          jacobian * jacobian.transpose() + 1e-8 * Eigen::MatrixXd::Identity(by.size(), by.size());
      Eigen::VectorXd step = -jacobian.transpose() * square.ldlt().solve(by);
      step *= std::min(1.0, kMost / step.lpNorm<Eigen::Infinity>());
      column = 0;
      for (const std::string& name : drives) pose[name] += step(column++);
    }
    return false;
  }

  /// Somewhere, as no place is special: on the axis of the last joint, a reflector would not show it.
  void place() {
    constexpr double kAside = 0.1, kAway = 1.0;  // metres
    const Vector3<double> away(0.5, -0.6, 0.7);
    if (measured_.contact == Contact::grip) return;  // the hands themselves
    link_T_target_.translation = kAside * away;
    if (!measured_.target_frame.empty() && !measured_.is_point) {
      link_T_target_.rotation = exp(Vector3<double>(0.4, 0.9, -0.3));
    }
    if (!measured_.sensor_frame.empty()) {
      link_T_sensor_.translation = kAway * away;
      link_T_sensor_.rotation = exp(Vector3<double>(-0.7, 0.2, 1.1));
    }
    points_ = {Vector3<double>::Zero()};
    if (measured_.is_point) return;
    points_.insert(points_.end(), {{0.15, 0.0, 0.0}, {0.0, 0.12, 0.0}, {0.1, 0.1, 0.05}});
  }

  /// Whether all points are within 60 degrees of the camera's axis.
  /// @param side  1: in front of it; -1: behind it, where the formula holds as well
  [[nodiscard]] bool is_visible(const NamedNumbers& pose, double side) const {
    const Pose<double> sensor_T_target = seen_from(pose, {}, {});
    return std::all_of(points_.begin(), points_.end(), [&](const Vector3<double>& point) {
      const Vector3<double> p = sensor_T_target * point;
      return side * p.z() > 0.1 && p.head<2>().norm() < 1.7 * side * p.z();
    });
  }

  void generate(const std::set<std::string>& drives) {
    constexpr int kTries = 3000;
    std::vector<NamedNumbers> others;  // behind the camera: only if nothing is in front of it
    for (int i = 0; i < kTries && poses_.size() < count_; ++i) {
      NamedNumbers pose;
      for (const std::string& joint : drives) {
        pose[joint] = random_position(driven(robot_, joint), random_);
      }
      if (i == 0 && measured_.is_camera && measured_.target == measured_.base) {
        put_before_camera(pose);
      }
      if (!measured_.is_camera || is_visible(pose, 1.0)) {
        poses_.push_back(pose);
      } else if (others.size() < count_ && is_visible(pose, -1.0)) {
        others.push_back(pose);
      }
    }
    if (poses_.size() < count_ / 2) poses_.insert(poses_.end(), others.begin(), others.end());
  }

  /// Puts a board that stands still where the camera sees it in one pose.
  void put_before_camera(const NamedNumbers& pose) {
    Pose<double> ahead;
    ahead.translation = {0.05, -0.05, 0.7};
    link_T_target_ = end_of(to_tips_.front(), pose, {}, {}).inverse() *
                     (end_of(to_sensor_, pose, {}, {}) * ahead);
    link_T_target_.rotation = link_T_target_.rotation * exp(Vector3<double>(0.3, 0.2, 0.5));
  }

  const Robot& robot_;
  std::size_t count_;
  std::mt19937_64 random_;
  MeasuredTarget measured_;
  std::vector<FurtherTip> tips_;  ///< the target, then further ones
  std::vector<RuntimeChain> to_tips_;
  RuntimeChain to_sensor_;
  Pose<double> link_T_target_, link_T_sensor_;
  std::vector<Vector3<double>> points_;
  std::vector<NamedNumbers> poses_;
  std::vector<Vector3<double>>
      sockets_;          ///< that the tip touches, in the sensor's frame: one, or several
  double radius_ = 0.0;  ///< of a sphere that the tip touches, metres
  std::vector<double>
      distances_;  ///< that a distance sensor measures in each pose, metres; else empty
};

/// Of an offset's effect, what must be left beside free frames.  With a length of 0.5 m, an offset
/// of 1 degree below it moves no point by more than 0.01 mm; axes that a URDF rounds to 1.57 stay
/// parallel.
constexpr double kLeastEffect = 1e-3;

/// A space of columns, as an orthonormal basis.
class Span {
 public:
  /// What is left of a column outside of the space, as a fraction of its length; adds it if that is
  /// enough.
  bool add(const Eigen::VectorXd& column) {
    Eigen::VectorXd left = outside(column);
    if (!(left.norm() > kLeastEffect * column.norm())) return false;
    basis_.push_back(left.normalized());
    return true;
  }
  [[nodiscard]] bool contains(const Eigen::VectorXd& column) const {
    return !(outside(column).norm() > kLeastEffect * column.norm());
  }

 private:
  [[nodiscard]] Eigen::VectorXd outside(Eigen::VectorXd column) const {
    for (int pass = 0; pass < 2; ++pass) {  // the second removes what rounding left
      for (const Eigen::VectorXd& axis : basis_) column -= axis.dot(column) * axis;
    }
    return column;
  }

  std::vector<Eigen::VectorXd> basis_;
};

/// The derivative with respect to one number, by central differences.
/// @param at  callable: number -> the measured points
template <class At>
[[nodiscard]] Eigen::VectorXd derivative(const At& at) {
  constexpr double kStep = 1e-5;
  return (at(kStep) - at(-kStep)) / (2.0 * kStep);
}

/// The axes of a frame: those of a point's do not turn.
[[nodiscard]] std::array<bool, 6> axes_of(bool is_point) {
  return {true, true, true, !is_point, !is_point, !is_point};
}

/// How a frame's axes change what is measured.
/// @param socket  see GeneratedPoses::measured()
[[nodiscard]] std::vector<Eigen::VectorXd> frame_columns(const GeneratedPoses& poses,
                                                         const std::string& frame,
                                                         const std::array<bool, 6>& axes,
                                                         int socket = -1) {
  std::vector<Eigen::VectorXd> columns;
  for (int axis = 0; axis < 6; ++axis) {
    if (!axes[static_cast<std::size_t>(axis)]) continue;
    columns.push_back(derivative([&](double number) {
      Vector3<double> vector = Vector3<double>::Zero();
      vector(axis % 3) = number;
      Pose<double> correction;
      if (axis < 3) {
        correction.translation = vector;
      } else {
        correction.rotation = exp(vector);
      }
      return poses.measured({}, {{frame, correction}}, socket);
    }));
  }
  return columns;
}

/// A free frame with its columns.
struct FrameSpan {
  std::string name;
  std::vector<Eigen::VectorXd> columns;

  [[nodiscard]] bool contains(const Eigen::VectorXd& column) const {
    Span own;
    for (const Eigen::VectorXd& axis : columns) own.add(axis);
    return own.contains(column);
  }
};

/// Adds all columns.
/// @returns  false if one is within the span of the others
bool add_all(Span& span, const std::vector<Eigen::VectorXd>& columns) {
  bool all = true;
  for (const Eigen::VectorXd& column : columns) all = span.add(column) && all;
  return all;
}

}  // namespace
}  // namespace detail

std::array<bool, 6> shown_axes(const std::vector<Vector3<double>>& layout) {
  std::array<bool, 6> axes = {true, true, true, false, false, false};
  for (const Vector3<double>& point : layout) {
    for (int turn = 0; turn < 3; ++turn) {
      if (cross<double>(Vector3<double>::Unit(turn), point).norm() > 0.0) {
        axes[static_cast<std::size_t>(3 + turn)] = true;
      }
    }
  }
  return axes;
}

std::vector<std::string> driven_joints(const Robot& robot, const MeasuredTarget& measured) {
  std::vector<std::string> names;
  std::vector<std::string> ends = {measured.target};
  for (const FurtherTip& tip : measured.more_tips) ends.push_back(tip.link);
  ends.push_back(measured.sensor);
  for (const std::string& end : ends) {
    const RuntimeChain chain = make_chain(robot, measured.base, end);
    for (const ChainJoint& joint : chain.joints) {
      const std::string& name = joint.drive.joint;
      if (!has_position(joint)) continue;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

TouchingPoses touching_poses(const Robot& robot, const MeasuredTarget& measured, std::size_t count,
                             std::uint64_t seed) {
  const detail::GeneratedPoses generated(robot, measured, {}, count, seed);
  TouchingPoses touching{generated.poses(), {}, generated.distances(), generated.link_T_sensor()};
  for (std::size_t i = 0; i < touching.positions.size(); ++i)
    touching.tips.push_back(generated.tip_of(i));
  return touching;
}

OffsetEffects offset_effects(const Robot& robot, const MeasuredTarget& measured,
                             const std::vector<std::string>& frames,
                             const std::vector<std::string>& joints) {
  const std::set<std::string> corrected(frames.begin(), frames.end());
  const detail::GeneratedPoses poses(robot, measured, corrected);
  std::vector<detail::FrameSpan> free;
  const auto add = [&](const std::string& name, const std::array<bool, 6>& axes, int socket = -1) {
    if (!name.empty()) free.push_back({name, detail::frame_columns(poses, name, axes, socket)});
  };
  const bool many = measured.places > 1 && measured.layout.empty();
  for (int k = 0; k < measured.places && many; ++k) {
    add(measured.sensor_frame, poses.sensor_axes(), k);
  }
  if (!many) add(measured.sensor_frame, poses.sensor_axes());
  for (const std::string& frame : frames) add(frame, detail::axes_of(false));
  std::array<bool, 6> target_axes = detail::axes_of(measured.is_point);
  if (measured.contact == Contact::gravity) {
    target_axes = {false, false, false, true, true, true};
  } else if (measured.contact != Contact::none) {
    target_axes[5] = false;  // about the direction of a distance
  }
  add(measured.target_frame, target_axes);
  for (const FurtherTip& tip : measured.more_tips) add(tip.frame, target_axes);

  OffsetEffects effects;
  detail::Span span;
  detail::add_all(span, poses.camera_columns());
  for (Eigen::Index axis = 0; axis < 3 && measured.contact == Contact::gravity; ++axis) {
    Eigen::VectorXd of_gravity = Eigen::VectorXd::Zero(poses.measured({}, {}).size());
    for (Eigen::Index at = axis; at < of_gravity.size(); at += 3) of_gravity(at) = 1.0;
    span.add(of_gravity);
  }
  const bool free_radius = measured.contact == Contact::sphere && !measured.radius_known;
  if (free_radius) span.add(Eigen::VectorXd::Ones(poses.measured({}, {}).size()));
  for (const detail::FrameSpan& frame : free) {
    effects.frames_determined = detail::add_all(span, frame.columns) && effects.frames_determined;
  }
  for (const std::string& joint : joints) {
    OffsetEffect& effect = effects.offsets.emplace_back(OffsetEffect{joint});
    const Eigen::VectorXd column = detail::derivative([&](double number) {
      return poses.measured({{joint, number}}, {});
    });
    // Metres per radian: differences of poses that odometry puts far away are rounded.
    constexpr double kNothing = 1e-6;
    effect.is_seen = column.size() > 0 && column.lpNorm<Eigen::Infinity>() > kNothing;
    effect.determined = effect.is_seen && span.add(column);
    if (effect.determined || !effect.is_seen) continue;
    const auto same = [&](const detail::FrameSpan& f) { return f.contains(column); };
    auto by =
        std::find_if(free.begin(), free.end(), [&](const auto& f) { return f.name == joint; });
    if (by == free.end()) by = std::find_if(free.begin(), free.end(), same);
    if (by != free.end()) effect.imitated_by = by->name;
  }
  return effects;
}

}  // namespace kinecal
