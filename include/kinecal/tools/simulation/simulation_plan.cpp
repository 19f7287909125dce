// Definitions of simulation_plan.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/simulation_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/simulation/place_target.ipp"

namespace kinecal {

namespace detail {
namespace {

// Errors, motion and faults of a scene file.

/// @returns  errors given in the file
[[nodiscard]] ParameterTable read_errors(ConfigMap& map, ErrorSizes& errors) {
  ParameterTable given;
  for (const auto& [key, value] : {std::pair{"joint", &errors.joint},
                                   {"sliding", &errors.sliding},
                                   {"position", &errors.position},
                                   {"rotation", &errors.rotation},
                                   {"intrinsics", &errors.intrinsics},
                                   {"z_offset", &errors.z_offset},
                                   {"z_scaling", &errors.z_scaling}}) {
    constexpr double kMost = 1.0;  // radians, metres, or 100 %
    *value = map.number(key, *value);
    if (*value >= 0.0 && *value <= kMost) continue;
    map.error(map.find(key)->place,
              fmt::format("{} is {}, not between 0 and {} (radians, metres, or a share)", key,
                          *value, kMost));
  }
  if (auto values = map.map("values", "values")) {
    for (const ConfigEntry& entry : values->entries()) {
      given.add({.name = entry.key, .value = values->number(entry.key, 0.0)});
    }
  }
  map.report_unknown();
  return given;
}

/// Reads the noise of features; that of joints follows from the motion.
void read_noise(ConfigMap& map, MeasurementNoise& noise) {
  for (const auto& [key, value] :
       {std::pair{"pixel", &noise.pixel}, {"point", &noise.point}, {"rotation", &noise.rotation}}) {
    *value = map.number(key, *value);
    if (*value < 0.0) map.error(map.find(key)->place, std::string(key) + " is below zero");
  }
  map.report_unknown();
}

void read_motion(ConfigMap& map, SimulatedSetup& setup) {
  SimulatedTiming& timing = setup.timing;
  setup.drive.speed = map.positive("speed", setup.drive.speed);
  timing.image_rate = map.positive("image_rate", timing.image_rate);
  for (const auto& [key, value] : {std::pair{"encoder_noise", &timing.encoder_noise},
                                   {"repeatability", &timing.repeatability},
                                   {"backlash", &timing.backlash},
                                   {"image_latency", &timing.image_latency},
                                   {"exposure_time", &timing.exposure},
                                   {"late_stamps", &timing.late_stamps},
                                   {"lamp_latency", &timing.lamp_latency}}) {
    *value = map.number(key, *value);
  }
  map.report_unknown();
}

void read_faults(ConfigMap& map, Faults& faults) {
  faults.stuck_joint = map.text("stuck_joint").value_or("");
  for (const auto& [key, value] : {std::pair{"joints_end", &faults.joints_end},
                                   {"views_end", &faults.views_end},
                                   {"connection_ends", &faults.connection_ends},
                                   {"other_clock", &faults.other_clock},
                                   {"passer_by", &faults.passer_by},
                                   {"outliers", &faults.outliers},
                                   {"outlier_size", &faults.outlier_size}}) {
    *value = map.number(key, *value);
  }
  if (map.peek("dark_led") != nullptr) faults.dark_led = map.count("dark_led", 0);
  faults.no_camera_info = map.flag("no_camera_info", false);
  map.report_unknown();
}

// Reads the keys of a scene file.
//
//   seed: 1                         same seed: same robot, noise and faults
//   camera:
//     frame: LINK, name: camera, type: camera3d | camera2d, info: FILE, image: raw | rectified
//     blur: 0.6 (pixels), exposure: 1.0, noise: 1.5 (of 255), nearest: 0.3, farthest: 5.0 (metres)
//     depth_noise: 0.001 (at 1 m), disparity_step: 0.125 (pixels), holes: true
//   target:
//     type: leds | checkerboard | apriltag | aprilgrid | ground | robot, link: LINK, xyz: [x, y, z], rpy: [r, p, y]
//     columns: 6, rows: 5, size: 0.025, leds: [[x, y, z], ...]
//   errors:                         each between half of it and all of it, with either sign
//     joint: 0.05, sliding: 0.01, position: 0.01, rotation: 0.02, intrinsics: 0.01, z_offset:
//     0.005, z_scaling: 0.01, values: {shoulder_pan_joint: 0.03}
//   noise: {pixel: 0.3, point: 5e-5 (metres), rotation: 1e-4}
//   motion: {speed: 1.0, encoder_noise: 2e-5, repeatability: 5e-5, backlash: 1e-4, image_rate: 15,
//            image_latency: 0.06, exposure_time: 0.0 (seconds), late_stamps: 0.0, lamp_latency:
//            0.04}
//   faults: {stuck_joint: NAME, joints_end: 60.0, views_end: 60.0, connection_ends: 60.0,
//            other_clock: 100.0, dark_led: 1, no_camera_info: true, passer_by: 0.1, outliers: 0.05}
//   poses: 30, or poses: FILE       as robot_calibration has them

/// The path of a file named in a scene, relative to the scene.
[[nodiscard]] std::string beside(const SourceLocation& place, const std::string& file) {
  return (std::filesystem::path(place.file).parent_path() / file).string();
}

[[nodiscard]] std::optional<Vector3<double>> read_vector(ConfigMap& map, const ConfigEntry& entry) {
  Vector3<double> vector = Vector3<double>::Zero();
  bool is_vector = entry.value.is_list() && entry.value.items.size() == 3;
  for (Eigen::Index i = 0; is_vector && i < 3; ++i) {
    const auto number = config_number(entry.value.items[static_cast<std::size_t>(i)]);
    is_vector = number && std::isfinite(*number);
    if (is_vector) vector(i) = *number;
  }
  if (is_vector) return vector;
  map.error(entry.place, (entry.key.empty() ? "a point" : entry.key) + " is " +
                             describe_config(entry.value) + ", not three numbers");
  return std::nullopt;
}

/// One of a few words; an error and nullopt for any other.
[[nodiscard]] std::optional<std::string> read_word(ConfigMap& map, const std::string& key,
                                                   const std::vector<std::string>& words) {
  std::optional<std::string> word = map.text(key);
  if (!word || std::find(words.begin(), words.end(), *word) != words.end()) return word;
  std::string all;
  for (const std::string& known : words) all += (all.empty() ? "" : ", ") + known;
  map.error(map.find(key)->place, key + " is '" + *word + "', not one of " + all);
  return std::nullopt;
}

/// The name of a link; an error and nullopt if the robot has no such link.
[[nodiscard]] std::optional<std::string> read_link(ConfigMap& map, const std::string& key,
                                                   const Robot& robot) {
  std::optional<std::string> link = map.text(key);
  if (!link || robot.has_link(*link)) return link;
  map.error(map.find(key)->place, key + ": no link '" + *link + "' in the URDF" +
                                      did_you_mean(*link, robot.link_names()));
  return std::nullopt;
}

void read_camera(ConfigMap& map, SimulationPlan& plan) {
  SimulatedCamera& camera = plan.setup.camera;
  camera.frame = read_link(map, "frame", plan.setup.robot).value_or(camera.frame);
  plan.setup.camera_name = map.text("name").value_or(plan.setup.camera_name);
  plan.camera_type = read_word(map, "type", {"camera3d", "camera2d"}).value_or("");
  if (const auto file = map.text("info")) {
    camera.info = read_camera_argument(beside(map.place(), *file), map.diagnostics());
  }
  const auto image = read_word(map, "image", {"raw", "rectified"});
  if (image) camera.image = *image == "raw" ? ImageKind::raw : ImageKind::rectified;
  for (const auto& [key, value] : {std::pair{"blur", &camera.blur},
                                   {"exposure", &camera.exposure},
                                   {"noise", &camera.noise},
                                   {"nearest", &camera.nearest},
                                   {"farthest", &camera.farthest},
                                   {"depth_noise", &camera.depth_noise},
                                   {"disparity_step", &camera.disparity_step}}) {
    *value = map.number(key, *value);
    if (*value < 0.0) map.error(map.find(key)->place, std::string(key) + " is below zero");
  }
  camera.has_holes = map.flag("holes", camera.has_holes);
  map.report_unknown();
}

void read_target(ConfigMap& map, SimulationPlan& plan) {
  SimulatedTarget& target = plan.target;
  target.type =
      read_word(map, "type", {"leds", "checkerboard", "apriltag", "aprilgrid", "ground", "robot"})
          .value_or(target.type);
  target.link = read_link(map, "link", plan.setup.robot).value_or("");
  target.columns = map.count("columns", target.columns);
  target.rows = map.count("rows", target.rows);
  target.size = map.positive("size", target.size);
  target.has_pose = map.peek("xyz") != nullptr || map.peek("rpy") != nullptr;
  if (const ConfigEntry* xyz = map.find("xyz")) {
    target.pose.translation = read_vector(map, *xyz).value_or(Vector3<double>::Zero());
  }
  if (const ConfigEntry* rpy = map.find("rpy")) {
    target.pose.rotation =
        rotation_from_rpy(read_vector(map, *rpy).value_or(Vector3<double>::Zero()));
  }
  const ConfigEntry* given = map.peek("leds");
  for (const ConfigEntry& led : map.list("leds")) {
    target.leds.push_back(read_vector(map, led).value_or(Vector3<double>::Zero()));
  }
  if (given != nullptr && given->value.is_list() && target.leds.empty()) {
    map.error(given->place, "leds is empty; give the point of at least one LED, or leave it out");
  }
  map.report_unknown();
}

void read_plan_poses(ConfigMap& map, SimulationPlan& plan) {
  const ConfigEntry* entry = map.find("poses");
  if (entry == nullptr) return;
  if (config_number(entry->value)) {
    plan.poses = map.count("poses", plan.poses);
  } else if (const auto file = map.text("poses")) {
    for (CapturePose& pose : read_poses_yaml(beside(map.place(), *file), map.diagnostics())) {
      plan.given.push_back({std::move(pose.joint_names), std::move(pose.positions)});
    }
  }
}

/// Sets the noise of features from that of the camera and of the joints.
void set_noise(SimulationPlan& plan) {
  const SimulatedTiming& timing = plan.setup.timing;
  plan.noise.depth = plan.setup.camera.depth_noise;
  plan.noise.joint = std::hypot(timing.encoder_noise, timing.repeatability, 0.5 * timing.backlash);
}

/// Reads a scene file into a plan.
/// @returns  errors given in the file
[[nodiscard]] ParameterTable read_scene(const std::string& path, SimulationPlan& plan,
                                        Diagnostics& diagnostics) {
  ParameterTable given;
  const YamlNode content = load_config(path, diagnostics);
  if (!content.is_map()) {
    diagnostics.error({path, 0}, describe_wrong_file(content, "a scene"));
    return given;
  }
  ConfigMap map(content, {path, content.line}, "", diagnostics);
  plan.setup.seed = static_cast<std::uint64_t>(map.count("seed", 1));
  if (auto camera = map.map("camera", "camera")) read_camera(*camera, plan);
  if (auto target = map.map("target", "target")) read_target(*target, plan);
  if (auto errors = map.map("errors", "errors")) given = read_errors(*errors, plan.errors);
  if (auto noise = map.map("noise", "noise")) read_noise(*noise, plan.noise);
  if (auto motion = map.map("motion", "motion")) read_motion(*motion, plan.setup);
  if (auto faults = map.map("faults", "faults")) read_faults(*faults, plan.setup.faults);
  read_plan_poses(map, plan);
  map.report_unknown();
  return given;
}

/// True if no joint moves two links against each other.
[[nodiscard]] bool is_rigid(const Robot& robot, const std::string& a, const std::string& b) {
  return make_chain(robot, a, b, {}).joints.empty();
}

/// Leaves out the links that the camera looks out of: those fixed to it whose box it is in; and those of another base.
[[nodiscard]] std::shared_ptr<const RobotSurface> without_housing(const Robot& robot,
                                                                  const RobotSurface& surface,
                                                                  const std::string& camera) {
  constexpr double kMargin = 0.02;  // metres
  std::vector<SurfaceLink> others;
  for (const SurfaceLink& link : surface.links()) {
    if (propose_base(robot, link.name) != propose_base(robot, camera)) continue;
    const RuntimeChain chain = make_chain(robot, link.name, camera, {});
    const Vector3<double>& eye = chain.tail.translation;
    const SurfaceFacts& facts = link.tree.facts();
    const bool is_inside = ((eye - facts.low).array() > -kMargin).all() &&
                           ((facts.high - eye).array() > -kMargin).all();
    if (!chain.joints.empty() || !is_inside) others.push_back(link);
  }
  return std::make_shared<const RobotSurface>(std::move(others));
}

/// @throws InputError  if the URDF does not say where the camera is: it is its base
void check_camera_has_pose(const Robot& robot, const std::string& base, const std::string& camera) {
  const RuntimeChain chain = make_chain(robot, base, camera, {});
  const bool has_pose = !chain.joints.empty() || chain.tail.translation.norm() > 0.0 ||
                        !chain.tail.rotation.isIdentity();
  if (has_pose) return;
  throw InputError("the URDF has the camera '" + camera + "' in the origin of '" + base +
                   "'; a simulation needs a place from which it sees the robot: write it into the "
                   "<origin> of the camera's joint");
}

/// The link of its own that a robot looks at: the outermost one of the arm that has a surface, else any that has.
/// @param arm  link at its end; empty: the arm carries the camera
/// @throws InputError  if no link with a surface moves against the camera
[[nodiscard]] std::string seen_link(const Robot& robot, const SimulationPlan& plan,
                                    const std::string& arm) {
  const std::string& camera = plan.setup.camera.frame;
  std::vector<std::string> candidates;
  if (!arm.empty()) {
    candidates.push_back(arm);
    for (const Joint* joint : joints_to_root(robot, arm)) candidates.push_back(joint->parent);
  }
  for (const SurfaceLink& link : plan.surface->links()) candidates.push_back(link.name);
  for (const std::string& link : candidates) {
    if (plan.surface->find(link) >= 0 && !is_rigid(robot, link, camera)) return link;
  }
  throw InputError(
      "no link that moves against the camera '" + camera +
      "' has a mesh or shape; name another camera in the scene: camera: {frame: LINK}");
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
  const bool is_given = !link.empty();
  const auto moves_against_camera = [&](const std::string& arm) {
    return propose_base(robot, arm) == base && !is_rigid(robot, arm, camera);
  };
  const auto arm = std::find_if(arms.begin(), arms.end(), moves_against_camera);
  if (link.empty() && plan.target.type != "ground" && arm != arms.end()) link = *arm;
  if (plan.surface != nullptr) {
    check_camera_has_pose(robot, base, camera);
    plan.surface = without_housing(robot, *plan.surface, camera);
    if (!is_given) link = seen_link(robot, plan, link);
    if (plan.surface->find(link) < 0) {
      throw InputError("target: link '" + link + "' has no mesh or shape that the camera '" +
                       camera + "' could see");
    }
  }
  if (link.empty()) link = base;
  if (!robot.has_link(link)) {
    throw InputError("no link '" + link + "' in the URDF" + did_you_mean(link, robot.link_names()));
  }
  const bool stands = is_rigid(robot, base, link);
  answers.target = stands ? InitTarget::world_checkerboard : InitTarget::checkerboard;
  if (plan.target.type == "leds") answers.target = InitTarget::leds;
  if (plan.target.type == "ground") answers.target = InitTarget::ground;
  if (plan.target.type == "robot") answers.target = InitTarget::robot;
  answers.arm = stands ? base : link;
  if (plan.target.type != "robot") link = answers.arm;
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
    } else if (!is_camera && !model.is_surface && plan.target.link.empty()) {
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
                               Diagnostics& diagnostics, const Config* config,
                               const std::function<RobotSurface()>& surface) {
  SimulationPlan plan;
  plan.setup.robot = robot;
  plan.setup.camera.frame.clear();
  ParameterTable given;  // errors given in the scene
  if (!path.empty()) given = detail::read_scene(path, plan, diagnostics);
  detail::set_noise(plan);
  if (!target.empty()) plan.target.type = target;
  if (seed != 0) plan.setup.seed = seed;
  if (plan.target.type == "robot" && !surface) {
    throw InputError(
        "target 'robot' is simulated by 'kinecal simulate', which writes clouds or masks; choose "
        "leds, a board or tags here");
  }
  if (plan.target.type == "robot") plan.surface = std::make_shared<const RobotSurface>(surface());
  if (!diagnostics.errors.empty()) return plan;
  if (config != nullptr && !config->steps.empty()) detail::take_models(*config, plan);
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
