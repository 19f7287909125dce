// SPDX-License-Identifier: Apache-2.0
#include "truth.hpp"

#include <fmt/core.h>

#include <numbers>

#include "kinecal/tools/simulation/simulation_plan.hpp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"
#include "kinecal/trust/verify/pose_change.hpp"

namespace kinecal::cli {

std::string truth_text(const Robot& robot, const std::string& scene, const CalibratedRobot& all) {
  const AnyProblem& problem = *all.setup.calibration.steps.back().problem;
  const auto frames = compared_frames(problem, all.samples);
  if (frames.empty()) return {};
  Diagnostics diagnostics;
  const SimulationPlan plan = read_simulation(robot, scene, "", 0, diagnostics);
  ParameterTable truth = all.result.table;
  for (const Parameter& parameter : plan.setup.truth) {
    if (truth.find(parameter.name) >= 0) truth[parameter.name].value = parameter.value;
  }
  // Where a board is on its link, the simulation does not say by the names of parameters.
  const FrameOnRobot gripper{frames.front().frame.link}, camera{frames.front().in.link};
  const Eigen::VectorXd of_truth = truth.values(), drawn = all.setup.calibration.table.values(),
                        found = all.result.table.values();
  const auto state = [&](const Eigen::VectorXd& values) {
    return RobotState{problem, {values.data(), static_cast<std::size_t>(values.size())}};
  };
  const auto off = [&](const Eigen::VectorXd& values) {
    const PoseChange change =
        pose_change(state(of_truth), state(values), all.samples, gripper, camera);
    return fmt::format("{:.2f} mm, {:.3f} deg", 1e3 * change.position,
                       change.rotation * 180.0 / std::numbers::pi);
  };
  return fmt::format("truth: '{}' in '{}' is off by {}; by the URDF, {}\n", gripper.name(),
                     camera.name(), off(found), off(drawn));
}

}  // namespace kinecal::cli
