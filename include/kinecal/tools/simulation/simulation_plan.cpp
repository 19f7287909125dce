// Definitions of simulation_plan.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/simulation_plan.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/text/frame_name.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/simulation/place_target.ipp"
#include "kinecal/tools/simulation/read_scene.ipp"

namespace kinecal {

namespace detail {
namespace {

/// True if no joint moves two links against each other.
[[nodiscard]] bool is_rigid(const Robot& robot, const std::string& a, const std::string& b) {
  return make_chain(robot, a, b, {}).joints.empty();
}

/// Fills in the default size of a board.
void complete(SimulatedTarget& target) {
  const bool tags = has_tags(target);
  if (target.columns == 0) target.columns = tags ? 4 : 6;
  if (target.rows == 0) target.rows = tags ? 3 : 5;
  if (target.size == 0.0) target.size = tags ? 0.04 : 0.025;
}

/// The answers for `kinecal init` that lead to this simulation.
[[nodiscard]] InitAnswers answers_of(const Robot& robot, SimulationPlan& plan) {
  InitAnswers answers;
  std::string& camera = plan.setup.camera.frame;
  const std::vector<std::string> cameras = propose_cameras(robot), arms = propose_arms(robot);
  if (camera.empty() && !cameras.empty()) camera = cameras.front();
  if (camera.empty()) {
    throw InputError(
        "no link of the URDF looks like a camera; add it to the URDF, or name its optical frame in "
        "the scene: camera: {frame: LINK}");
  }
  if (!robot.has_link(camera)) {
    throw InputError("no link '" + camera + "' in the URDF" +
                     did_you_mean(camera, robot.link_names()));
  }
  const std::string base = propose_base(robot, camera);
  std::string& link = plan.target.link;
  const auto moves_against_camera = [&](const std::string& arm) {
    return propose_base(robot, arm) == base && !is_rigid(robot, arm, camera);
  };
  const auto arm = std::find_if(arms.begin(), arms.end(), moves_against_camera);
  if (link.empty() && plan.target.type != "ground" && arm != arms.end()) link = *arm;
  if (link.empty()) link = base;
  if (!robot.has_link(link)) {
    throw InputError("no link '" + link + "' in the URDF" + did_you_mean(link, robot.link_names()));
  }
  const bool stands = is_rigid(robot, base, link);
  answers.target = stands ? InitTarget::world_checkerboard : InitTarget::checkerboard;
  if (plan.target.type == "leds") answers.target = InitTarget::leds;
  if (plan.target.type == "ground") answers.target = InitTarget::ground;
  if (stands) link = base;
  answers.arm = link;
  answers.base = base;
  answers.camera = camera;
  if (plan.camera_type.empty()) {
    plan.camera_type = is_board(plan.target) ? "camera2d" : "camera3d";
  }
  answers.camera_type = plan.camera_type;
  answers.camera_name = plan.setup.camera_name;
  return with_proposals(robot, answers);
}

/// Draws the errors of the calibrated parameters.
void draw_truth(const StepConfig& step, SimulationPlan& plan) {
  SeededRandom random(plan.setup.seed);
  const Robot& robot = plan.setup.robot;
  for (const FreeParamConfig& free : free_parameters(step)) {
    const std::string frame = free.name.substr(0, free.name.find_last_of('_'));
    const bool is_of_frame = std::any_of(step.free_frames.begin(), step.free_frames.end(),
                                         [&](const auto& of) { return of.name == frame; });
    if (is_of_frame && !robot.has_joint(frame)) continue;  // the target's
    if (is_of_frame) plan.setup.frames.insert(frame);
    const double size = error_size(robot, free.name, plan.errors);
    plan.setup.truth.add({.name = free.name, .value = random.either_sign(0.5 * size, size)});
  }
}

/// Uses the configuration's camera and link of the target, if the scene gives none.
void take_models(const Config& config, SimulationPlan& plan) {
  const StepConfig& step = config.steps.back();
  for (const ModelConfig& model : step.models) {
    const bool is_camera = model.type.starts_with("camera");
    std::string& camera = plan.setup.camera.frame;
    if (is_camera && (camera.empty() || same_frame(camera, model.frame))) {
      camera = model.frame;
      plan.setup.camera_name = model.name;
      plan.camera_type = model.type;
    } else if (!is_camera && plan.target.link.empty()) {
      plan.target.link = model.frame;
    }
  }
}

/// Uses the errors given in the scene.
void take_values(const ParameterTable& values, const std::string& path, SimulationPlan& plan,
                 Diagnostics& diagnostics) {
  ParameterTable& truth = plan.setup.truth;
  std::vector<std::string> names = plan.setup.robot.joint_names();
  for (const Parameter& parameter : truth) names.push_back(parameter.name);
  for (const Parameter& given : values) {
    const int known = truth.find(given.name);
    const std::string owner = given.name.substr(0, given.name.find_last_of('_'));
    if (known >= 0) {
      truth[known].value = given.value;
    } else if (plan.setup.robot.has_joint(given.name)) {
      truth.add(given);
    } else if (plan.setup.robot.has_joint(owner)) {
      truth.add(given);
      plan.setup.frames.insert(owner);
    } else {
      diagnostics.error(
          {path, 0}, "errors: no parameter '" + given.name + "'" + did_you_mean(given.name, names));
    }
  }
}

/// Adds the target's own frame to the truth, if it is calibrated.
void add_target_frame(const StepConfig& step, SimulationPlan& plan) {
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (frame.name != plan.target_frame || plan.setup.robot.has_joint(frame.name)) continue;
    const Vector3<double> turn = log(plan.target.pose.rotation);
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      plan.setup.truth.add(
          {.name = parameter_name(frame.name, kFrameAxes[static_cast<std::size_t>(axis)]),
           .value = axis < 3 ? plan.target.pose.translation(axis) : turn(axis - 3)});
    }
  }
}

}  // namespace
}  // namespace detail

SimulationPlan read_simulation(const Robot& robot, const std::string& path,
                               const std::string& target, std::uint64_t seed,
                               Diagnostics& diagnostics, const Config* config) {
  SimulationPlan plan;
  plan.setup.robot = robot;
  plan.setup.camera.frame.clear();
  ParameterTable given;  // errors given in the scene
  if (!path.empty()) given = detail::read_scene(path, plan, diagnostics);
  detail::set_noise(plan);
  if (!target.empty()) plan.target.type = target;
  if (seed != 0) plan.setup.seed = seed;
  if (!diagnostics.errors.empty()) return plan;
  if (config != nullptr && !config->steps.empty()) detail::take_models(*config, plan);
  detail::complete(plan.target);
  const InitAnswers answers = detail::answers_of(robot, plan);
  plan.setup.base = answers.base;
  plan.target_frame = needs_target_frame(answers.target) ? answers.target_frame : plan.target.link;
  plan.setup.camera.has_depth = plan.camera_type == "camera3d";
  plan.config = initial_config(robot, answers);
  const Config first = parse_config(plan.config, "calibrate.yaml", diagnostics);
  if (!diagnostics.errors.empty()) return plan;
  const StepConfig& step = first.steps.front();
  for (const ModelConfig& model : step.models) {
    if (model.name != plan.setup.camera_name) plan.chain_sensor = model.name;
  }
  detail::draw_truth(step, plan);
  detail::take_values(given, path, plan, diagnostics);
  detail::place_target(plan);
  detail::furnish(plan);
  detail::add_target_frame(step, plan);
  return plan;
}

std::vector<JointTarget> poses_of(const SimulationPlan& plan) {
  if (!plan.given.empty()) return plan.given;
  try {
    return poses_with_view_of(plan.setup.robot, plan.goal, plan.poses, plan.setup.seed);
  } catch (const std::runtime_error& e) {
    throw InputError(e.what());
  }
}

}  // namespace kinecal
