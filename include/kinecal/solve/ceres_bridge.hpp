// Adds calibration problems to your own Ceres problem.
//
//   ceres::Problem ceres_problem;
//   CeresBridge bridge(ceres_problem);
//   bridge.add(arm_and_camera, free, values);
//   bridge.add(arm_and_tracker, also_free, values);             // shares the arm's joints
//   ceres_problem.AddResidualBlock(own_cost, nullptr, bridge.block("elbow_flex_joint"));
//
// Each joint, frame and sensor is a parameter block of Ceres, found by name; problems share
// parameters of the same name.  A problem is one residual block, for any number of samples: see
// compressed_cost.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/solve/compressed_cost.hpp"

namespace kinecal {

/// Adds calibration problems to a Ceres problem, and holds their parameters.  Not thread-safe;
/// Ceres itself may evaluate with any number of threads.
class CeresBridge {
 public:
  /// @param problem  must outlive the bridge, or not be used after it: the bridge holds its
  ///                 parameters
  explicit CeresBridge(ceres::Problem& problem) : problem_(problem) {}
  CeresBridge(const CeresBridge&) = delete;             ///< Ceres points into it
  CeresBridge& operator=(const CeresBridge&) = delete;  ///< Ceres points into it

  /// Adds the samples and priors of a problem, with the bounds of its table.
  /// @param problem  must outlive the bridge; do not add samples meanwhile
  /// @param free     the parameters that Ceres may change
  /// @param values   of all parameters of the table: starting values of those that are new to the
  ///                 bridge; held values of the others
  /// @throws std::invalid_argument  if a free parameter belongs to no joint, frame or sensor, or if
  ///                                an existing block of that name has other parameters
  void add(const AnyProblem& problem, const FreeSet& free, const Eigen::VectorXd& values,
           Losses losses = Losses::as_given);

  /// The values of a joint, frame or sensor, in the order of parameters(); Ceres' parameter block.
  /// @throws std::invalid_argument  if no problem has it, with the nearest name
  [[nodiscard]] double* block(const std::string& name);
  /// Names of a block's parameters: "head_pan_joint_x".
  /// @throws std::invalid_argument  as block()
  [[nodiscard]] const std::vector<std::string>& parameters(const std::string& name) const;
  /// Copies the values of the parameters that the table has.
  /// @param values  of all parameters of the table
  void read(const ParameterTable& table, Eigen::VectorXd& values) const;

 private:
  struct Block {
    std::vector<std::string> names;
    std::vector<double> values;
  };
  [[nodiscard]] const Block& find(const std::string& name) const;

  ceres::Problem& problem_;
  std::map<std::string, Block> blocks_;  ///< a node never moves: Ceres points to its values
  std::vector<std::unique_ptr<AnyEvaluator>> evaluators_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/ceres_bridge.ipp"
#endif
