// Definitions of determined_offsets.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/determined_offsets.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "kinecal/tools/init/generated_poses.ipp"

namespace kinecal {

namespace detail {
namespace {

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

/// How a frame's axes change what is measured.
[[nodiscard]] std::vector<Eigen::VectorXd> frame_columns(const GeneratedPoses& poses,
                                                         const std::string& frame, bool is_point) {
  std::vector<Eigen::VectorXd> columns;
  for (int axis = 0; axis < (is_point ? 3 : 6); ++axis) {
    columns.push_back(derivative([&](double number) {
      Vector3<double> vector = Vector3<double>::Zero();
      vector(axis % 3) = number;
      Pose<double> correction;
      if (axis < 3) {
        correction.translation = vector;
      } else {
        correction.rotation = exp(vector);
      }
      return poses.measured({}, {{frame, correction}});
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

std::vector<std::string> driven_joints(const Robot& robot, const MeasuredTarget& measured) {
  std::vector<std::string> names;
  for (const std::string& end : {measured.target, measured.sensor}) {
    const RuntimeChain chain = make_chain(robot, measured.base, end);
    for (const ChainJoint& joint : chain.joints) {
      const std::string& name = joint.drive.joint;
      if (!has_position(joint)) continue;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

OffsetEffects offset_effects(const Robot& robot, const MeasuredTarget& measured,
                             const std::vector<std::string>& frames,
                             const std::vector<std::string>& joints) {
  const std::set<std::string> corrected(frames.begin(), frames.end());
  const detail::GeneratedPoses poses(robot, measured, corrected);
  std::vector<detail::FrameSpan> free;
  const auto add = [&](const std::string& name, bool is_point) {
    if (!name.empty()) free.push_back({name, detail::frame_columns(poses, name, is_point)});
  };
  add(measured.sensor_frame, false);
  for (const std::string& frame : frames) add(frame, false);
  add(measured.target_frame, measured.is_point);

  OffsetEffects effects;
  detail::Span span;
  detail::add_all(span, poses.camera_columns());
  for (const detail::FrameSpan& frame : free) {
    effects.frames_determined = detail::add_all(span, frame.columns) && effects.frames_determined;
  }
  for (const std::string& joint : joints) {
    OffsetEffect& effect = effects.offsets.emplace_back(OffsetEffect{joint});
    const Eigen::VectorXd column = detail::derivative([&](double number) {
      return poses.measured({{joint, number}}, {});
    });
    constexpr double kNothing = 1e-9;  // metres per radian: rounding of differences
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
