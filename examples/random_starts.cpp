// A study: does a calibration depend on where it starts?
//
//   random_starts_study [COUNT=1000] [SEED=1]
//
// Each of COUNT random robots has an arm of 5 to 8 joints and a pan-tilt head with an RGB-D camera,
// its own true errors, and 50 noisy samples of four LEDs.  It is calibrated twice: from the truth,
// and from a robot aligned by eye, 4 degrees off in every joint and 3 cm and 5
// degrees off in every frame, with the camera as its driver reports it.  Both must end at the same
// cost.  (Not at the same parameters: the cost is flat along unobservable combinations.)
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "kinecal/errors.hpp"
#include "kinecal/solve.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

constexpr int kSamples = 50;
constexpr double kJointError = 4.0 * kDegree;
constexpr double kFrameShift = 0.03;  // metres
constexpr double kFrameTurn = 5.0 * kDegree;
/// Costs with a smaller relative difference count as equal.
constexpr double kSameCost = 1e-6;
/// Free frames: the head on the torso, the camera in the head, and the LEDs in the gripper, which
/// no drawing shows.
const std::set<std::string> kFrames = {"head_pan", "camera_mount", "leds"};
const std::vector<Vector3<double>> kLeds = {
    {0.03, 0.035, 0.0}, {-0.03, 0.035, 0.01}, {-0.03, -0.035, 0.0}, {0.03, -0.035, 0.01}};
constexpr int kFeatures = kSamples * 4;  // LEDs

std::string arm_joint(int i) {
  return "arm_" + std::to_string(i);
}

/// An arm with a joint every 10 to 30 cm.  Half of the robots have joints about x, y and z, as
/// commercial arms have; the other half about any axis.
std::vector<Joint> random_arm(SeededRandom& random) {
  using enum JointType;
  const int count = random.integer(5, 8);
  const bool skew = random.uniform(0.0, 1.0) < 0.5;
  std::vector<Joint> arm;
  std::string parent = "torso";
  Pose<double> origin{Matrix3<double>::Identity(),
                      {0.1, random.either_sign(0.0, 0.2), random.uniform(0.2, 0.4)}};
  int last = -1;
  for (int i = 0; i < count; ++i) {
    const int axis = last < 0 ? random.integer(0, 2) : (last + random.integer(1, 2)) % 3;
    last = axis;
    const Vector3<double> square = Vector3<double>::Unit(axis);
    const Vector3<double> along = skew ? random.direction() : square;
    arm.push_back({arm_joint(i), revolute, parent, "link_" + std::to_string(i), origin, along});
    parent = arm.back().child;
    const Vector3<double> bend = (skew ? 0.5 : 0.0) * random.direction();
    const Vector3<double> way = Vector3<double>::UnitX() + bend;
    origin = {exp(bend), random.uniform(0.1, 0.3) * way.normalized()};
  }
  arm.push_back({"wrist_mount", fixed, parent, "gripper", origin});
  return arm;
}

Robot random_robot(SeededRandom& random) {
  using enum JointType;
  std::vector<Joint> joints = random_arm(random);
  const auto at = [](double x, double y, double z) {
    return Pose<double>{Matrix3<double>::Identity(), {x, y, z}};
  };
  const double side = random.either_sign(0.0, 0.1), height = random.uniform(0.4, 0.8);
  const double neck = random.uniform(0.0, 0.15), nose = random.uniform(0.0, 0.1);
  joints.push_back({"head_pan", revolute, "torso", "head", at(0.0, side, height), {0, 0, 1}});
  joints.push_back({"head_tilt", revolute, "head", "face", at(neck, 0, 0.06), {0, 1, 0}});
  joints.push_back({"camera_mount", fixed, "face", "camera_body", at(nose, 0.02, 0.02)});
  Matrix3<double> optical;  // x right, y down, z forward
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  joints.push_back({"camera_optical", fixed, "camera_body", "optical", {optical, {0, 0, 0}}});
  return Robot("random_robot", joints);
}

/// The errors of the true robot, as `value`.
ParameterTable random_truth(const Robot& robot, SeededRandom& random) {
  ParameterTable truth;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.name == "head_pan")
      continue;  // the pan zero is the yaw of its frame
    truth.add({.name = joint.name, .value = random.either_sign(0.0, 2.0) * kDegree});
  }
  for (const std::string& frame : kFrames) {
    const Vector3<double> shift = 0.01 * random.direction(), turn = 0.03 * random.direction();
    for (int k = 0; k < 6; ++k) {
      truth.add({.name = parameter_name(frame, kFrameAxes[static_cast<std::size_t>(k)]),
                 .value = k < 3 ? shift(k) : turn(k - 3)});
    }
  }
  for (std::size_t i = 0; i < DepthCamera::kParameters.size(); ++i) {
    truth.add({.name = parameter_name("camera", DepthCamera::kParameters[i].name),
               .value = random.either_sign(0.0, i == 4 ? 0.008 : 0.015)});
  }
  return truth;
}

Problem make_problem(const Robot& robot, const ParameterTable& table) {
  Problem problem(robot, "torso", table, kFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "gripper"});
  problem.add_sensor(DepthCamera{}, {"camera", "optical"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  return problem;
}

/// Turns the head roughly to the gripper and takes a sample; nullopt if it does not see all LEDs.
std::optional<Sample> look(const TrueRobot& robot, const TrueCamera& camera, Positions positions,
                           SeededRandom& random) {
  const auto gripper_from = [&](const char* link) {
    return robot.pose(link, "gripper", positions).translation;
  };
  const Vector3<double> beside = gripper_from("head");
  positions["head_pan"] = std::atan2(beside.y(), beside.x()) + random.uniform(-0.4, 0.4);
  const Vector3<double> below = gripper_from("face");
  positions["head_tilt"] = std::atan2(-below.z(), below.x()) + random.uniform(-0.3, 0.3);
  const Pose<double> camera_T_leds = robot.pose("optical", "gripper", positions, "leds");
  Observation known{"arm", {}}, seen{"camera", {}, example_camera_info()};
  for (const Vector3<double>& led : kLeds) {
    const Vector3<double> p = camera_T_leds * led;
    if (p.z() < 0.3 || p.z() > 1.5 || !is_in_image(camera.driver(), p)) return std::nullopt;
    known.features.push_back({"leds", led});
    seen.features.push_back(camera.record(p, random));
  }
  Sample sample = sample_at(positions);
  sample.observations = {known, seen};
  return sample;
}

/// Adds samples at random poses of the arm.
void add_samples(Problem& problem, const Robot& robot, const ParameterTable& truth,
                 SeededRandom& random) {
  const TrueRobot true_robot(robot, truth, kFrames);
  const TrueCamera camera(truth, "optical");
  while (problem.num_samples() < kSamples) {
    Positions positions;
    for (const Joint& joint : robot.joints()) {
      if (moves(joint.type)) positions[joint.name] = 0.0;
      if (joint.name.starts_with("arm_")) positions[joint.name] = random.uniform(-2.0, 2.0);
    }
    if (const auto sample = look(true_robot, camera, positions, random))
      problem.add_sample(*sample);
  }
}

/// A start as from aligning by eye.
Eigen::VectorXd by_eye(const ParameterTable& truth, SeededRandom& random) {
  Eigen::VectorXd start = truth.values();
  for (int i = 0; i < truth.size(); ++i) {
    const std::string& name = truth[i].name;
    if (name.starts_with("camera_") && !name.starts_with("camera_mount")) start(i) = 0.0;
    if (name.starts_with("arm_") || name == "head_tilt") {
      start(i) += random.either_sign(kJointError, kJointError);
    }
  }
  for (const std::string& frame : kFrames) {
    const int first = truth.index(parameter_name(frame, "x"));
    const Vector3<double> xyz = start.segment<3>(first), abc = start.segment<3>(first + 3);
    const Vector3<double> turn = kFrameTurn * random.direction();
    start.segment<3>(first) = xyz + kFrameShift * random.direction();
    start.segment<3>(first + 3) = log(Matrix3<double>(exp(abc) * exp(turn)));
  }
  return start;
}

/// Both calibrations of one robot.
struct Outcome {
  StepResult from_truth, by_eye;

  /// Relative; positive if the start by eye ended at a higher cost.
  [[nodiscard]] double difference() const {
    return (by_eye.final_cost - from_truth.final_cost) / from_truth.final_cost;
  }
  [[nodiscard]] bool same() const {
    return from_truth.converged && by_eye.converged && std::abs(difference()) < kSameCost;
  }
};

Outcome calibrate_twice(std::uint64_t seed) {
  SeededRandom random(seed);
  const Robot robot = random_robot(random);
  const ParameterTable truth = random_truth(robot, random);
  Problem problem = make_problem(robot, truth);
  add_samples(problem, robot, truth, random);
  std::vector<int> all;
  for (int i = 0; i < truth.size(); ++i) all.push_back(i);
  const FreeSet free(all, truth.size());
  Eigen::VectorXd from_truth = truth.values(), start = by_eye(truth, random);
  return {solve(problem, free, from_truth), solve(problem, free, start)};
}

/// All robots together.
struct Study {
  int same = 0;
  double worst = 0.0;           ///< relative difference of the costs
  std::vector<int> iterations;  ///< of the calibrations that start by eye
  std::vector<double> off, on;  ///< distance of arm and camera before and after, mm

  void add(const Outcome& outcome) {
    const auto rms_mm = [](double cost) { return 1e3 * std::sqrt(2.0 * cost / kFeatures); };
    same += outcome.same() ? 1 : 0;
    worst = std::max(worst, std::abs(outcome.difference()));
    iterations.push_back(outcome.by_eye.iterations);
    off.push_back(rms_mm(outcome.by_eye.initial_cost));
    on.push_back(rms_mm(outcome.by_eye.final_cost));
  }

  void print(double seconds) {
    for (auto* distances : {&off, &on}) std::sort(distances->begin(), distances->end());
    std::sort(iterations.begin(), iterations.end());
    const std::size_t half = iterations.size() / 2;
    std::printf("robots                       %zu\n", iterations.size());
    std::printf("same cost as from the truth  %d\n", same);
    std::printf("worst relative difference    %.1e\n", worst);
    std::printf("distance at the start        median %.1f mm, most %.1f mm\n", off[half],
                off.back());
    std::printf("distance at the end          median %.2f mm, most %.2f mm\n", on[half], on.back());
    std::printf("iterations                   median %d, most %d\n", iterations[half],
                iterations.back());
    std::printf("seconds                      %.1f\n", seconds);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  const long first_seed = argc > 2 ? std::atol(argv[2]) : 1;
  if (count < 1 || argc > 3) {
    std::fprintf(stderr, "usage: random_starts_study [COUNT=1000] [SEED=1]\n");
    return 2;
  }
  std::printf(
      "Starting %.0f degrees off in every joint, %.0f cm and %.0f degrees in every frame:\n",
      kJointError / kDegree, kFrameShift * 100, kFrameTurn / kDegree);
  const auto begin = std::chrono::steady_clock::now();
  Study study;
  for (int n = 0; n < count; ++n) {
    const Outcome outcome = calibrate_twice(static_cast<std::uint64_t>(first_seed + n));
    study.add(outcome);
    if (outcome.same()) continue;
    std::printf("seed %ld: cost %.6e from the truth, %.6e (%+.1e) by eye\n", first_seed + n,
                outcome.from_truth.final_cost, outcome.by_eye.final_cost, outcome.difference());
    std::printf("  %s\n  %s\n", outcome.from_truth.termination.c_str(),
                outcome.by_eye.termination.c_str());
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  study.print(seconds.count());
  return study.same == count ? 0 : 1;
}
