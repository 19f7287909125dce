// Frames whose place the samples leave open: for judge.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"

namespace kinecal::detail {

/// True if combinations that change no residual move a frame's origin in all three directions.
/// @param origin  x, y and z, by number in the table
[[nodiscard]] inline bool is_anywhere(const Assessment& step, const std::array<int, 3>& origin) {
  Eigen::MatrixXd moves(3, std::ssize(step.observability.unobservable));
  moves.setZero();
  for (Eigen::Index c = 0; c < moves.cols(); ++c) {
    for (const auto& [parameter, factor] :
         step.observability.unobservable[static_cast<std::size_t>(c)]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (origin[axis] == parameter) moves(static_cast<Eigen::Index>(axis), c) = factor;
      }
    }
    moves.col(c).normalize();
  }
  constexpr double kInOnePlane = 1e-3;  // least singular value, of the largest
  const Eigen::VectorXd squares = eigenpairs(moves * moves.transpose()).values;
  return squares(0) > kInOnePlane * kInOnePlane * squares(2);
}

/// True if a sensor or target hangs on a pose that was measured, as of a flange.
[[nodiscard]] inline bool has_measured_pose(const AnyProblem& problem) {
  const std::map<std::string, double> joints = repeatable_joints(problem);
  return std::any_of(joints.begin(), joints.end(), [](const auto& joint) {
    return floating_coordinate(joint.first).has_value();
  });
}

/// Numbers of a frame whose place is arbitrary must not get into the robot's files.
inline void judge_places(const Assessment& step, const ParameterTable& table,
                         Judgement& judgement) {
  std::string frames;
  for (const int p : step.parameters) {
    const std::string& name = table[p].name;
    const std::string frame = name.substr(0, name.rfind('_'));
    if (name != parameter_name(frame, kFrameAxes[0])) continue;
    std::array<int, 3> origin = {};
    bool is_open = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = table.find(parameter_name(frame, kFrameAxes[axis]));
      const auto deviation = origin[axis] < 0 ? std::nullopt : step.deviation(origin[axis]);
      is_open = is_open && deviation && std::isinf(*deviation);
    }
    if (!is_open || !is_anywhere(step, origin)) continue;
    frames += (frames.empty() ? "'" : ", '") + frame + "'";
  }
  if (frames.empty()) return;
  judgement.add(Grade::do_not_use,
                "these samples leave open in all directions where " + frames +
                    " is: such numbers are arbitrary; record poses that turn "
                    "about two axes",
                {Remedy::Kind::record});
}

/// The same beside a measured flange, where such a frame is what is sought.  Frames between joints may be anywhere because
/// one makes up for another.
inline void judge_places(const AnyProblem& problem, const Assessment& step,
                         const ParameterTable& table, Judgement& judgement) {
  if (has_measured_pose(problem)) judge_places(step, table, judgement);
}

}  // namespace kinecal::detail
