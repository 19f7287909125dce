// Definitions of measured_poses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/measured_poses.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/used_joints.hpp"

namespace kinecal::detail {

/// Rotations of poses from the first one.
struct PoseTurns {
  Eigen::Vector3d axis =
      Eigen::Vector3d::UnitX();  ///< about which they turn most, in the child; to two digits
  double about = 0.0;            ///< root mean square angle about it, radians
  double others = 0.0;           ///< the same about the axis of second largest angles
};

[[nodiscard]] inline PoseTurns turns_of(std::span<const Sample> samples, const std::string& joint) {
  const Pose<double>* first = nullptr;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const Sample& sample : samples) {
    const auto found = sample.poses.find(joint);
    if (found == sample.poses.end()) continue;
    if (first == nullptr) first = &found->second;
    const Matrix3<double> turn = first->rotation.transpose() * found->second.rotation;
    const Eigen::Vector3d vector = log(turn);
    squares += vector * vector.transpose();
    count += 1.0;
  }
  if (count < 2.0) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / count);
  const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  Eigen::Vector3d axis = solver.eigenvectors().col(2);
  Eigen::Index largest = 0;
  (void)axis.cwiseAbs().maxCoeff(&largest);
  if (axis(largest) < 0.0) axis = -axis;
  for (double& part : axis) part = std::abs(part) < 5e-3 ? 0.0 : part;  // not -0.00
  return {axis, values(2), values(1)};
}

void check_measured_poses(const Config& config, const Robot& robot, std::span<const Sample> samples,
                          Diagnostics& diagnostics) {
  constexpr double kDegree = std::numbers::pi / 180.0, kLeast = 1.0 * kDegree;
  for (const Joint* joint : joints_between(config, robot)) {
    const bool is_own = std::any_of(config.per_sample.begin(), config.per_sample.end(),
                                    [&](const auto& frame) { return frame.name == joint->name; });
    if (joint->type != JointType::floating || is_own || samples.size() < 2) continue;
    const PoseTurns turns = turns_of(samples, joint->name);
    if (turns.about < kLeast) {
      diagnostics.doubt(
          place_of(samples, 0),
          fmt::format("the poses of '{}' do not turn (by {:.2g} deg): where a frame is on '{}' "
                      "cannot be found; record poses that turn about two axes",
                      joint->name, turns.about / kDegree, joint->child));
    } else if (turns.others < kLeast) {
      diagnostics.doubt(
          place_of(samples, 0),
          fmt::format(
              "the poses of '{}' all turn about one axis, ({:.2f}, {:.2f}, {:.2f}) in '{}': "
              "where a frame is along this axis cannot be found; record poses that turn about a "
              "second axis, too",
              joint->name, turns.axis.x(), turns.axis.y(), turns.axis.z(), joint->child));
    }
  }
}

}  // namespace kinecal::detail
