// SPDX-License-Identifier: Apache-2.0
#include "robot_link.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <variant>

#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/robots/pipe_robot.hpp"
#include "kinecal/robots/ros_robot.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// A robot that is arm, camera and lamp at once: each finder uses the same ones.
template <class R>
AnyRobot whole_robot(std::shared_ptr<R> robot, const CaptureConfig& config) {
  AnyRobot any{any_arm(*robot), {}, {}};
  for (const CaptureFinder& finder : config.finders) {
    any.cameras[finder.name] = any_camera(*robot);
    any.lamps[finder.name] = any_lamp(*robot);
  }
  any.owner = std::move(robot);
  return any;
}

using Limits = std::map<std::string, double>;

/// A simulation; its joints are as fast as the URDF allows, unless the scene has a speed for all.
AnyRobot simulated(const std::string& scene, const CaptureConfig& config, const Robot& robot,
                   const Limits& limits) {
  Diagnostics diagnostics;
  SimulationPlan plan = read_simulation(robot, scene, "", 0, diagnostics);
  print_or_throw(diagnostics);
  if (plan.setup.drive.speed == JointDrive{}.speed) plan.setup.speeds = limits;
  return whole_robot(std::make_shared<SimulatedRobot>(plan.setup), config);
}

/// What is behind a bridge.
struct RosParts {
  RosParts(const std::string& url, const std::string& joints)
      : bridge({.url = url}, joints.empty() ? "/joint_states" : joints) {}

  RosBridge bridge;
  std::unique_ptr<RosArm> arm = {};
  std::vector<std::unique_ptr<RosCamera>> cameras = {};
  std::vector<std::unique_ptr<RosLamp>> lamps = {};
};

/// Topics of a finder's camera.
RosCameraOptions camera_topics(const CaptureFinder& finder, const std::string& depth) {
  RosCameraOptions options;
  if (std::holds_alternative<ScanFinder>(finder.settings)) {
    options.cloud = finder.topic;
    return options;
  }
  options.camera_info = finder.camera_info;
  if (finder.type.ends_with("2d")) {
    options.image = finder.topic;
  } else if (depth.empty()) {
    options.cloud = finder.topic;
  } else {
    options.depth = depth;
    if (finder.type != "PlaneFinder" && finder.type != "RobotFinder") options.image = finder.topic;
  }
  return options;
}

AnyRobot behind_bridge(const std::string& url, const CaptureConfig& config, const Limits& limits,
                       MovedBy mover, const LinkTopics& topics) {
  auto parts = std::make_shared<RosParts>(url, topics.joints);
  RosArmOptions arm;
  arm.duration = config.duration;
  constexpr double kPeak = 15.0 / 8.0;  // of a spline from rest to rest, times its mean velocity
  for (const auto& [joint, limit] : limits) {
    arm.speeds[joint] = std::min(arm.speed, limit / kPeak);
  }
  for (const CaptureChain& chain : config.chains) {
    if (mover == MovedBy::controllers) {
      arm.controllers.push_back({chain.topic, chain.joints});
    } else {
      arm.measured.insert(arm.measured.end(), chain.joints.begin(), chain.joints.end());
    }
  }
  parts->arm = std::make_unique<RosArm>(parts->bridge, arm);
  AnyRobot any{any_arm(*parts->arm), {}, {}};
  for (const CaptureFinder& finder : config.finders) {
    if (std::holds_alternative<TouchFinder>(finder.settings)) continue;
    parts->cameras.push_back(
        std::make_unique<RosCamera>(parts->bridge, camera_topics(finder, topics.depth)));
    any.cameras[finder.name] = any_camera(*parts->cameras.back());
    if (finder.action.empty()) continue;
    parts->lamps.push_back(std::make_unique<RosLamp>(parts->bridge, finder.action));
    any.lamps[finder.name] = any_lamp(*parts->lamps.back());
  }
  any.owner = std::move(parts);
  return any;
}

}  // namespace

std::string urdf_of(const std::string& urdf, const std::string& address) {
  if (!urdf.empty()) return read_urdf_text(urdf);
  if (address.starts_with("ws://")) return robot_description({.url = address});
  throw InputError("--urdf is required: " + address + " does not have the URDF");
}

AnyRobot connect(const std::string& address, const CaptureConfig& config, const Robot& robot,
                 const Limits& limits, MovedBy mover, const LinkTopics& topics) {
  const auto after = [&](std::string_view scheme) { return address.substr(scheme.size()); };
  if (address.starts_with("ws://")) return behind_bridge(address, config, limits, mover, topics);
  if (!topics.joints.empty() || !topics.depth.empty()) {
    throw InputError("--joint-states and --depth name topics of a bridge; " + address +
                     " has no topics");
  }
  if (address.starts_with("pipe:")) {
    if (after("pipe:").find_first_not_of(' ') == std::string::npos) {
      throw InputError("--robot: '" + address + "' has no command; write pipe:COMMAND");
    }
    return whole_robot(
        std::make_shared<PipeRobot>(
            PipeOptions{.command = after("pipe:"),
                        .interrupted = [] { return Interruption::is_asked(); },
                        .slow = [](const std::string& what) { say(stderr, "note: {}\n", what); }}),
        config);
  }
  if (address.starts_with(kSimulated)) return simulated(after(kSimulated), config, robot, limits);
  throw InputError("--robot: '" + address +
                   "' is not an address; write ws://HOST:PORT, pipe:COMMAND or simulated:SCENE");
}

}  // namespace kinecal::cli
