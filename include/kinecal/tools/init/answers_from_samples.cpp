// Definitions of answers_from_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/answers_from_samples.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/expected_joints.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/shell_command.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/possible_targets.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal {

namespace detail {
namespace {

// The joints that samples have.

/// @throws InputError  if the samples have joints, but none of the robot's
void check_joints_of(const Robot& robot, const std::vector<Sample>& samples) {
  std::set<std::string> names;
  for (const Sample& sample : samples) {
    names.insert(sample.joint_names.begin(), sample.joint_names.end());
  }
  if (names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return robot.has_joint(name);
      })) {
    return;
  }
  const std::string expected = expected_joints(robot, {names.begin(), names.end()});
  throw InputError(
      fmt::format("--from: none of the joints of the samples ({}, ...) is in the URDF of '{}'{}",
                  *names.begin(), robot.name(),
                  expected.empty() ? "; give the URDF of their robot" : expected));
}

/// The link from which all joints are in the samples, if both ends hang on it: the joint of a rail or a torso that
/// nobody recorded moves them together.  Empty if no joint is missing, or one beyond a recorded joint.
[[nodiscard]] std::string recorded_base(const Robot& robot, const std::vector<Sample>& samples,
                                        const InitAnswers& answers) {
  const std::string& end = needs_arm(answers.target) ? answers.arm : answers.camera;
  if (!robot.has_link(end)) return "";
  const bool has_both = needs_arm(answers.target) && needs_camera(answers.target);
  std::set<std::string> of_other;  // joints that move the other end, too
  if (has_both && robot.has_link(answers.camera)) {
    for (const Joint* joint : joints_to_root(robot, answers.camera)) of_other.insert(joint->name);
  }
  std::string base;
  for (const Joint* joint : joints_to_root(robot, end)) {  // from the end
    if (joint->type == JointType::floating || joint->type == JointType::planar) break;
    if (!moves(joint->type)) continue;
    const std::string driver = drive(robot, *joint).joint;
    const bool is_recorded = std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
      return sample.position(driver).has_value();
    });
    if (is_recorded && !base.empty()) return "";
    if (is_recorded || !base.empty()) continue;
    if (has_both && !of_other.contains(joint->name)) return "";
    base = joint->child;
  }
  return base;
}

// What samples have of each sensor.

/// What the samples have of one sensor.
struct SeenSensor {
  std::string name;
  std::vector<std::string> frames = {};  ///< of its features
  bool is_camera = false;
  bool in_pixels = true;  ///< every z is zero
  bool varies = false;    ///< its features differ between samples
  std::size_t alone = 0;  ///< samples in which only it observes
  std::vector<Feature> first = {};
};

void add_features(SeenSensor& sensor, const Observation& seen) {
  sensor.is_camera = sensor.is_camera || seen.camera.has_value();
  for (const Feature& feature : seen.features) {
    if (std::find(sensor.frames.begin(), sensor.frames.end(), feature.frame) ==
        sensor.frames.end()) {
      sensor.frames.push_back(feature.frame);
    }
    sensor.in_pixels = sensor.in_pixels && feature.point.z() == 0.0;
    // Of the same feature: a view may have only some corners of a board.
    const auto before =
        std::find_if(sensor.first.begin(), sensor.first.end(), [&](const Feature& known) {
          return known.frame == feature.frame && known.id == feature.id &&
                 (feature.id || &known - sensor.first.data() == &feature - seen.features.data());
        });
    if (before == sensor.first.end()) {
      sensor.first.push_back(feature);
    } else if ((before->point - feature.point).norm() > 1e-6) {
      sensor.varies = true;
    }
  }
}

/// All sensors, in the order of their first observations.
[[nodiscard]] std::vector<SeenSensor> sensors_of(std::span<const Sample> samples) {
  std::vector<SeenSensor> sensors;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      auto sensor = std::find_if(sensors.begin(), sensors.end(),
                                 [&](const SeenSensor& s) { return s.name == seen.sensor; });
      if (sensor == sensors.end()) {
        sensors.push_back({seen.sensor});
        sensor = std::prev(sensors.end());
      }
      add_features(*sensor, seen);
      if (sample.observations.size() == 1) ++sensor->alone;
    }
  }
  return sensors;
}

[[nodiscard]] std::string names_of(const std::vector<const SeenSensor*>& sensors) {
  std::string names;
  for (const SeenSensor* sensor : sensors) {
    names += (names.empty() ? "'" : ", '") + sensor->name + "'";
  }
  return names;
}

/// The sum of the ranges of a link's own joints in the samples: those that do not move a camera.
[[nodiscard]] double motion_of(const Robot& robot, std::span<const Sample> samples,
                               const std::string& end, const std::string& camera) {
  std::set<std::string> shared;
  if (!camera.empty()) {
    for (const Joint* joint : joints_to_root(robot, camera)) shared.insert(joint->name);
  }
  double sum = 0.0;
  for (const Joint* joint : joints_to_root(robot, end)) {
    if (!moves(joint->type) || shared.contains(joint->name)) continue;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Sample& sample : samples) {
      const auto position = sample.position(drive(robot, *joint).joint);
      if (!position) continue;
      least = std::min(least, *position);
      most = std::max(most, *position);
    }
    if (most > least) sum += most - least;
  }
  return sum;
}

/// The arm that moves most in the samples, without a camera; empty if none does.
[[nodiscard]] std::string moving_arm(const Robot& robot, std::span<const Sample> samples,
                                     const std::string& camera) {
  constexpr double kStill = 1e-3;  // radians or metres
  std::string best;
  double most = kStill;
  for (const std::string& end : propose_arms(robot)) {
    const double motion = motion_of(robot, samples, end, camera);
    if (motion <= most) continue;
    most = motion;
    best = end;
  }
  return best;
}

/// @throws InputError  if a sensor without camera_info has points that can only be pixels
void check_no_pixels(const std::vector<const SeenSensor*>& chains) {
  constexpr double kMost = 20.0;  // metres in a plane
  for (const SeenSensor* sensor : chains) {
    const bool is_far = std::any_of(
        sensor->first.begin(), sensor->first.end(),
        [](const Feature& feature) { return feature.point.cwiseAbs().maxCoeff() > kMost; });
    if (!sensor->varies || !sensor->in_pixels || !is_far) continue;
    throw InputError(
        "--from: sensor '" + sensor->name +
        "' has no camera_info, but its features look like pixels; record it, or give " +
        ShellCommand().add_option("--camera", {sensor->name + "=FILE"}).str() +
        " to kinecal identify or calibrate");
  }
}

/// The different points of a sensor's features.
[[nodiscard]] std::vector<Vector3<double>> places_of(std::span<const Sample> samples,
                                                     const std::string& sensor) {
  std::vector<Vector3<double>> places;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(sensor);
    if (seen == nullptr) continue;
    for (const Feature& feature : seen->features) {
      const bool is_known = std::find(places.begin(), places.end(), feature.point) != places.end();
      if (!is_known) places.push_back(feature.point);
    }
  }
  return places;
}

/// The center of the sphere on which the end of an arm is in the samples, by the URDF: |p|^2 = 2 c.p + k, linear.
[[nodiscard]] Vector3<double> center_of(const Robot& robot, std::span<const Sample> samples,
                                        const InitAnswers& answers) {
  const std::string base = answers.base.empty() ? propose_base(robot, answers.arm) : answers.base;
  const RuntimeChain chain = make_chain(robot, base, answers.arm);
  Eigen::Matrix4d square = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Sample& sample : samples) {
    const Vector3<double> p = forward_kinematics(chain, [&](const std::string& joint) {
                                return sample.position(joint).value_or(0.0);
                              }).translation;
    const Eigen::Vector4d row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
    square += row * row.transpose();
    right += row * p.squaredNorm();
  }
  constexpr double kTiny = 1e-9;  // points in a plane have no center: the nearest one
  square.diagonal().array() += kTiny * square.trace();
  return Eigen::Vector4d(square.ldlt().solve(right)).head<3>();
}

/// Several arms, whose sensors have the names of their links, and the sensor of what they touch.
/// @throws InputError  if there is not one sensor with another name
void add_several_touching(const Robot& robot, std::span<const Sample> samples,
                          const std::vector<const SeenSensor*>& chains, InitAnswers& answers) {
  std::vector<const SeenSensor*> arms, others;
  for (const SeenSensor* sensor : chains)
    (robot.has_link(sensor->name) ? arms : others).push_back(sensor);
  if (others.size() != 1) {
    throw InputError(
        fmt::format("--from: several arms touch something, so all sensors but one have the names "
                    "of the arms' links; these are {}",
                    names_of(chains)));
  }
  answers.tracker = others.front()->name;
  answers.places = others.front()->frames;
  if (answers.target == InitTarget::sockets && others.front()->varies)
    answers.layout = places_of(samples, answers.tracker);
  answers.arm = answers.holder = arms.front()->name;
  answers.target_frame = arms.front()->frames.front();
  for (auto arm = arms.begin() + 1; arm != arms.end(); ++arm)
    answers.more_arms.push_back({(*arm)->name, (*arm)->frames.front()});
}

/// The axes of an accelerometer: one sensor, as gravity is touched by nothing.
/// @throws InputError  if there are several
void add_accelerometer(const Robot& robot, std::span<const Sample> samples,
                       const std::vector<const SeenSensor*>& chains, InitAnswers& answers) {
  if (chains.size() != 1) {
    throw InputError(fmt::format(
        "--from: of an accelerometer, samples have one sensor, its axes, and what it reads as "
        "conditions, not {}",
        chains.empty() ? std::string("no sensor") : names_of(chains)));
  }
  answers.holder = chains.front()->name;
  if (answers.target_frame.empty()) answers.target_frame = chains.front()->frames.front();
  if (answers.arm.empty() && robot.has_link(answers.target_frame)) {
    answers.arm = answers.target_frame;  // the frame_id of a bag
  }
  if (answers.arm.empty()) answers.arm = moving_arm(robot, samples, "");
}

/// A tip and what it touches: two sensors without a camera, neither of which measures.
/// @throws InputError  if there are not two
void add_touched(const Robot& robot, std::span<const Sample> samples,
                 const std::vector<const SeenSensor*>& chains, InitAnswers& answers) {
  if (answers.target == InitTarget::gravity) {
    return add_accelerometer(robot, samples, chains, answers);
  }
  const bool are_several = chains.size() > 2 && (answers.target == InitTarget::point ||
                                                 answers.target == InitTarget::sockets);
  if (are_several) return add_several_touching(robot, samples, chains, answers);
  if (chains.size() != 2) {
    throw InputError(
        fmt::format("--from: a tip touches something, so samples have two sensors "
                    "without a camera, not {}",
                    chains.empty() ? std::string("none") : names_of(chains)));
  }
  const bool arm_is_last = chains[1]->name == "arm" || (chains[0]->varies && !chains[1]->varies);
  const SeenSensor &held = *chains[arm_is_last ? 1 : 0], &touched = *chains[arm_is_last ? 0 : 1];
  answers.holder = held.name;
  answers.tracker = touched.name;
  if (answers.target_frame.empty()) answers.target_frame = held.frames.front();
  answers.places = touched.frames;
  if (answers.target == InitTarget::grip && answers.arm.empty()) answers.arm = held.frames.front();
  if (answers.target == InitTarget::sockets && touched.varies) {
    answers.layout = places_of(samples, touched.name);
  }
  if (answers.arm.empty()) answers.arm = moving_arm(robot, samples, "");
  const bool is_sphere = answers.target == InitTarget::sphere || answers.target == InitTarget::bar;
  if (is_sphere && robot.has_link(answers.arm)) answers.center = center_of(robot, samples, answers);
}

/// A reflector and a tracker: two sensors without a camera, one of which always reports the same.
void add_tracker(const Robot& robot, std::span<const Sample> samples,
                 const std::vector<const SeenSensor*>& chains, InitAnswers& answers) {
  if (chains.size() == 2 && !chains[0]->varies && !chains[1]->varies) {
    throw InputError("--from: the points of " + names_of(chains) +
                     " are the same in all samples: neither measures anything.  If a tip touched "
                     "something, say what: --target point, sockets, plane, line, sphere or bar");
  }
  const SeenSensor& varying = *chains[chains.front()->varies ? 0 : 1];
  if (chains.size() == 2 && 2 * places_of(samples, varying.name).size() <= samples.size() &&
      samples.size() > 3) {
    // No instrument reads the very same numbers again.
    answers.target = InitTarget::sockets;
    return add_touched(robot, samples, {chains[chains.front()->varies ? 1 : 0], &varying}, answers);
  }
  if (chains.size() != 2 || chains[0]->varies == chains[1]->varies) {
    throw InputError(
        "--from: the samples have no camera, and not one sensor with fixed points and one with "
        "measured ones (a tracker), but " +
        (chains.empty() ? std::string("no sensor") : names_of(chains)) +
        "; give --target and write the configuration for these");
  }
  const SeenSensor& held = *chains[chains[0]->varies ? 1 : 0];
  const SeenSensor& tracker = *chains[chains[0]->varies ? 0 : 1];
  answers.target = InitTarget::tracker;
  answers.holder = held.name;
  answers.tracker = tracker.name;
  if (answers.tracker_frame.empty()) answers.tracker_frame = tracker.frames.front();
  if (answers.target_frame.empty()) {
    answers.target_frame = held.frames.front();
    answers.more_reflectors.assign(held.frames.begin() + 1, held.frames.end());
  }
  if (answers.arm.empty()) answers.arm = moving_arm(robot, samples, "");
}

/// The link of a camera.
[[nodiscard]] std::string camera_link(const Robot& robot, const SeenSensor& camera) {
  if (robot.has_link(camera.frames.front())) return camera.frames.front();
  const std::vector<std::string> proposed = propose_cameras(robot);
  if (proposed.size() == 1) return proposed.front();
  throw InputError(fmt::format(
      "--camera: the features of camera '{}' are in frame '{}', which is not a link of the URDF; "
      "give the link of its optical frame, or add it to the URDF",
      camera.name, camera.frames.front()));
}

/// What holds a board that a camera sees: the arm that moves, or the world.
void add_board_holder(const Robot& robot, std::span<const Sample> samples, InitAnswers& answers) {
  const bool given = !answers.arm.empty();
  const std::string arm = given ? answers.arm : moving_arm(robot, samples, answers.camera);
  const bool held =
      !arm.empty() && why_no_target(robot, InitTarget::checkerboard, arm, answers.camera).empty();
  answers.target = held ? InitTarget::checkerboard : InitTarget::world_checkerboard;
  if (held) answers.arm = arm;
}

/// A camera, and what it sees.
void add_camera(const Robot& robot, std::span<const Sample> samples, const SeenSensor& camera,
                const std::vector<const SeenSensor*>& chains, InitAnswers& answers) {
  answers.camera_name = camera.name;
  answers.camera_type = camera.in_pixels ? "camera2d" : "camera3d";
  if (answers.camera.empty()) answers.camera = camera_link(robot, camera);
  if (chains.empty()) {
    answers.target = InitTarget::ground;
    return;
  }
  if (chains.size() > 1) {
    throw InputError("--from: camera '" + camera.name + "' sees the points of " + names_of(chains) +
                     "; init writes a configuration for one of them");
  }
  const SeenSensor& holder = *chains.front();
  answers.holder = holder.name;
  answers.with_ground = camera.alone > 0 && !camera.in_pixels;
  const std::string& frame = holder.frames.front();
  if (robot.has_link(frame)) {
    answers.target = InitTarget::leds;
    answers.arm = frame;
    return;
  }
  if (answers.target_frame.empty()) answers.target_frame = frame;
  add_board_holder(robot, samples, answers);
}

}  // namespace
}  // namespace detail

InitAnswers answers_from_samples(const Robot& robot, std::span<const Sample> all,
                                 InitAnswers given) {
  if (all.empty()) throw InputError("--from: there are no samples");
  std::vector<Sample> samples;
  std::copy_if(all.begin(), all.end(), std::back_inserter(samples), has_numbers);
  if (samples.empty()) throw InputError("--from: each sample has a feature that is not a number");
  detail::check_joints_of(robot, samples);
  if (samples.size() == 1)
    throw InputError("--from: there is only one sample, which does not show what moves");
  const std::vector<detail::SeenSensor> sensors = detail::sensors_of(samples);
  std::vector<const detail::SeenSensor*> cameras, chains;
  for (const detail::SeenSensor& sensor : sensors) {
    if (!sensor.frames.empty()) (sensor.is_camera ? cameras : chains).push_back(&sensor);
  }
  if (cameras.size() > 1) {
    throw InputError("--from: the samples have several cameras, " + detail::names_of(cameras) +
                     "; init writes a configuration for one: give it the samples of one");
  }
  if (is_touched(given.target)) {
    detail::add_touched(robot, samples, chains, given);
  } else if (cameras.empty()) {
    detail::check_no_pixels(chains);
    detail::add_tracker(robot, samples, chains, given);
  } else {
    detail::add_camera(robot, samples, *cameras.front(), chains, given);
  }
  if (needs_arm(given.target) && given.arm.empty()) {
    throw InputError("--arm: no arm of the URDF moves in the samples; give the link at its end");
  }
  if (given.base.empty()) given.base = detail::recorded_base(robot, samples, given);
  return given;
}

}  // namespace kinecal
