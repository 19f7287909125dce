// Simulates a calibration of the example robot: samples as a real robot records them, and the true
// values to compare a result with.
//
//   generate_example_samples URDF OUTPUT_FOLDER [--samples 100] [--seed 1]
//
// The true robot differs from the URDF in the zeros of joints, the frames of head and camera, and
// the camera's intrinsics and depth.  The head looks at four LEDs in the gripper, then at the
// floor.  One capture of the LEDs is bad.  The same seed gives the same files.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

constexpr const char* kUsage =
    "usage: generate_example_samples URDF OUTPUT_FOLDER [--samples 100] [--seed 1]\n";
constexpr int kGroundSamples = 25;
constexpr const char* kOpticalFrame = "head_camera_rgb_optical_frame";
constexpr const char* kGripper = "gripper_link";
const std::set<std::string> kFrames = {"head_pan_joint", "head_camera_rgb_joint"};
const std::vector<std::string> kArmJoints = {
    "shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
    "forearm_roll_joint", "wrist_flex_joint",    "wrist_roll_joint"};
/// Metres, in the gripper; they shine upwards, along its z axis.
const std::vector<Vector3<double>> kLeds = {{-0.062, 0.0355, 0.0396},
                                            {-0.115, 0.0355, 0.0396},
                                            {-0.115, -0.0355, 0.0396},
                                            {-0.062, -0.0355, 0.0396}};

struct Options {
  std::string urdf, folder;
  int samples = 100;
  std::uint64_t seed = 1;
};

/// @throws std::invalid_argument  with what is wrong
Options read_options(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc), paths;
  Options options;
  const auto number = [&](std::size_t i) {
    const std::string text = i < words.size() ? words[i] : "";
    const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
    if (text.empty() || !digits || text.size() > 9) {
      throw std::invalid_argument(words[i - 1] + " takes a whole number, not '" + text + "'");
    }
    return std::stoi(text);
  };
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--samples") {
      options.samples = number(++i);
    } else if (words[i] == "--seed") {
      options.seed = static_cast<std::uint64_t>(number(++i));
    } else if (words[i].starts_with("-")) {
      throw std::invalid_argument("unknown option " + words[i]);
    } else {
      paths.push_back(words[i]);
    }
  }
  if (paths.size() != 2) throw std::invalid_argument("a URDF and an output folder are needed");
  options.urdf = paths[0];
  options.folder = paths[1];
  return options;
}

/// Errors of the URDF, by parameter name.
ParameterTable random_truth(SeededRandom& random) {
  ParameterTable truth;
  const auto add = [&](const std::string& name, double value) {
    truth.add({.name = name, .value = value});
  };
  for (const std::string& joint : kArmJoints) add(joint, random.either_sign(1.0, 2.0) * kDegree);
  add("head_tilt_joint", random.either_sign(1.0, 2.0) * kDegree);
  for (const std::string& frame : kFrames) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      add(parameter_name(frame, kFrameAxes[axis]),
          axis < 3 ? random.either_sign(0.003, 0.008) : random.either_sign(0.5, 1.2) * kDegree);
    }
  }
  for (const char* part : {"fx", "fy", "cx", "cy"}) {
    add(parameter_name("camera", part), random.either_sign(0.004, 0.012));
  }
  add("camera_z_offset", random.either_sign(0.004, 0.008));
  add("camera_z_scaling", random.either_sign(0.005, 0.015));
  return truth;
}

/// The robot of this example with its sensors.
struct Simulated {
  TrueRobot robot;
  TrueCamera camera;
};

bool within_limits(const Robot& robot, const Positions& positions) {
  for (const auto& [name, position] : positions) {
    const auto& limits = robot.joint(name).limits;
    if (limits && (position < limits->lower || position > limits->upper)) return false;
  }
  return true;
}

/// All joints with a position of their own, at zero.
Positions zero_positions(const Robot& robot) {
  Positions positions;
  for (const Joint& joint : robot.joints()) {
    if (moves(joint.type) && !joint.mimic) positions[joint.name] = 0.0;
  }
  return positions;
}

/// Turns the head roughly towards the gripper, so that LEDs appear all over the image.
void look_at_gripper(const TrueRobot& robot, Positions& positions, SeededRandom& random) {
  const auto from = [&](const char* link) {
    return robot.pose(link, kGripper, positions).translation;
  };
  const Vector3<double> beside = from("head_pan_link");
  positions["head_pan_joint"] = std::atan2(beside.y(), beside.x()) + random.uniform(-0.4, 0.4);
  const Vector3<double> below = from("head_tilt_link");
  positions["head_tilt_joint"] = std::atan2(-below.z(), below.x()) + random.uniform(-0.3, 0.3);
}

/// True if the gripper is in front of the robot and above its base.
bool is_clear(const TrueRobot& robot, const Positions& positions) {
  const Vector3<double> p_base = robot.pose("base_link", kGripper, positions).translation;
  return p_base.x() > 0.35 && p_base.z() > 0.35;
}

/// The LEDs in the optical frame if the camera sees all of them; otherwise empty.
std::vector<Vector3<double>> visible_leds(const Simulated& simulated, const Positions& positions) {
  if (!within_limits(simulated.robot.robot(), positions)) return {};
  const Pose<double> camera_T_gripper = simulated.robot.pose(kOpticalFrame, kGripper, positions);
  const Vector3<double> way = -camera_T_gripper.translation.normalized();
  constexpr double kLedAngle = 55.0 * kDegree;  // at which an LED is still bright
  if (camera_T_gripper.rotation.col(2).dot(way) < std::cos(kLedAngle)) return {};
  std::vector<Vector3<double>> leds;
  for (const Vector3<double>& led : kLeds) {
    leds.push_back(camera_T_gripper * led);
    const double z = leds.back().z();
    if (z < 0.4 || z > 1.2 || !is_in_image(simulated.camera.driver(), leds.back())) return {};
  }
  return leds;
}

/// A random pose of the arm in which the camera sees the LEDs.
/// @throws std::runtime_error  if it does not find such a pose
Sample led_sample(const Simulated& simulated, SeededRandom& random) {
  const TrueRobot& robot = simulated.robot;
  Positions positions = zero_positions(robot.robot());
  std::vector<Vector3<double>> leds;
  constexpr int kTries = 100000;  // one in a few hundred succeeds
  for (int n = 0; n < kTries && leds.empty(); ++n) {
    positions["torso_lift_joint"] = random.uniform(0.0, 0.3);
    for (const std::string& joint : kArmJoints) {
      const auto& limits = robot.robot().joint(joint).limits;
      positions[joint] = limits ? random.uniform(limits->lower, limits->upper)
                                : random.uniform(-std::numbers::pi, std::numbers::pi);
    }
    if (!is_clear(robot, positions)) continue;
    look_at_gripper(robot, positions, random);
    leds = visible_leds(simulated, positions);
  }
  if (leds.empty()) throw std::runtime_error("no pose in which the camera sees the gripper");
  Sample sample = sample_at(positions);
  Observation camera{"camera", {}, example_camera_info()}, arm{"arm", {}};
  for (std::size_t i = 0; i < kLeds.size(); ++i) {
    camera.features.push_back(simulated.camera.record(leds[i], random));
    arm.features.push_back({kGripper, kLeds[i]});
  }
  sample.observations = {camera, arm};
  return sample;
}

/// The arm tucked, the head towards the floor: a grid of pixels and the floor points they show.
Sample ground_sample(const Simulated& simulated, SeededRandom& random) {
  const TrueRobot& robot = simulated.robot;
  Positions positions = zero_positions(robot.robot());
  const std::vector<double> tucked = {1.32, 1.40, -0.2, 1.72, 0.0, 1.66, 0.0};
  for (std::size_t i = 0; i < tucked.size(); ++i) positions[kArmJoints[i]] = tucked[i];
  positions["torso_lift_joint"] = random.uniform(0.0, 0.3);
  positions["head_pan_joint"] = random.uniform(-0.8, 0.8);
  positions["head_tilt_joint"] = random.uniform(0.75, 1.25);
  const Pose<double> base_T_camera = robot.pose("base_link", kOpticalFrame, positions);
  Observation camera{"camera", {}, example_camera_info()};
  for (const double v : {-0.8, -0.3, 0.2, 0.7}) {  // of half the image
    for (const double u : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
      const Intrinsics& c = simulated.camera.driver();
      const Vector3<double> ray(u * c.cx / c.fx, v * c.cy / c.fy, 1.0);
      const double down = -(base_T_camera.rotation.row(2) * ray).value();
      const double depth = base_T_camera.translation.z() / down;
      if (depth < 0.0 || depth > 3.0) continue;  // the sky, or too far for a good measurement
      camera.features.push_back(simulated.camera.record(ray * depth, random));
    }
  }
  Sample sample = sample_at(positions);
  sample.observations = {camera};
  return sample;
}

/// A bad capture: the arm was still swinging, and the LEDs were 5 cm from where it came to rest.
void spoil(Sample& sample, SeededRandom& random) {
  const Vector3<double> away = 0.05 * random.direction();
  for (Feature& feature : sample.observations[0].features) feature.point += away;
}

void write_truth(const std::filesystem::path& path, const ParameterTable& truth) {
  std::ofstream file(path);
  for (const Parameter& parameter : truth) {
    file << parameter.name << ": " << number_to_yaml(parameter.value) << "\n";
  }
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

void generate(const Options& options) {
  const Robot robot = read_urdf(options.urdf);
  SeededRandom random(options.seed);
  const ParameterTable truth = random_truth(random);
  const Simulated simulated{TrueRobot(robot, truth, kFrames), TrueCamera(truth, kOpticalFrame)};
  std::vector<Sample> samples;
  for (int n = 0; n < options.samples; ++n) samples.push_back(led_sample(simulated, random));
  const int bad = options.samples / 3;
  if (options.samples > 0) spoil(samples[static_cast<std::size_t>(bad)], random);
  for (int n = 0; n < kGroundSamples; ++n) samples.push_back(ground_sample(simulated, random));

  const std::filesystem::path folder = options.folder;
  std::filesystem::create_directories(folder);
  write_truth(folder / "truth.yaml", truth);
  const std::filesystem::path path = folder / "samples.yaml";
  std::ofstream file(path);
  write_samples(file, samples);
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
  std::printf("%s: %d samples of the LEDs (number %d is a bad one), %d of the floor\n",
              path.c_str(), options.samples, bad + 1, kGroundSamples);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  try {
    options = read_options(argc, argv);
  } catch (const std::invalid_argument& e) {
    std::fprintf(stderr, "%s\n%s", e.what(), kUsage);
    return 2;
  }
  try {
    generate(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
