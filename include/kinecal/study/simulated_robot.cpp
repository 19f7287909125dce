// Definitions of simulated_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/study/render.hpp"

namespace kinecal {

namespace detail {

// State of a simulated robot over time.

[[nodiscard]] inline Stamp stamp_of(double seconds) {
  constexpr double kMost = 9e9;  // a Stamp has nanoseconds in 63 bits
  return Stamp(std::llround(1e9 * std::clamp(seconds, -kMost, kMost)));
}
[[nodiscard]] inline double seconds_of(Stamp stamp) {
  return 1e-9 * static_cast<double>(stamp.count());
}

/// Adds the errors of a setup's truth to its camera.
[[nodiscard]] inline SimulatedSetup with_camera_errors(SimulatedSetup setup) {
  for (std::size_t i = 0; i < setup.camera.errors.size(); ++i) {
    const std::string_view part = kCameraErrors[i];
    const int index = setup.truth.find(parameter_name(setup.camera_name, part));
    if (index >= 0) setup.camera.errors[i] = setup.truth[index].value;
  }
  return setup;
}

/// Positions of the joints, after the last command.
class Joints {
 public:
  explicit Joints(const SimulatedSetup& setup) : setup_(setup) {
    for (const Joint& joint : setup.robot.joints()) {
      if (!moves(joint.type) || joint.mimic) continue;
      const double given = setup.start.contains(joint.name) ? setup.start.at(joint.name) : 0.0;
      double position = given;
      if (joint.limits && joint.limits->lower <= joint.limits->upper) {
        position = std::clamp(given, joint.limits->lower, joint.limits->upper);
      }
      motions_[joint.name] = JointMotion(position, position, setup.drive);
      unseen_[joint.name] = 0.0;
    }
  }

  /// @throws PoseError  if a joint cannot go there
  void check(const JointTarget& target) const {
    if (target.names.size() != target.positions.size()) {
      throw PoseError(std::to_string(target.names.size()) + " joints and " +
                      std::to_string(target.positions.size()) + " positions for them");
    }
    if (!(target.velocity_factor > 0.0) || target.velocity_factor > 1.0) {
      throw PoseError("velocity factor must be above 0 and at most 1, is " +
                      std::to_string(target.velocity_factor));
    }
    for (std::size_t i = 0; i < target.names.size(); ++i) {
      check(target.names[i], target.positions[i]);
    }
  }

  /// Starts to move at a time.
  void move(const JointTarget& target, double now, SeededRandom& random) {
    const Positions from = encoders(now);
    start_ = now;
    outlier_.clear();
    Positions to = from;
    for (std::size_t i = 0; i < target.names.size(); ++i) to[target.names[i]] = target.positions[i];
    std::vector<std::string> moving;
    for (auto& [name, motion] : motions_) {
      double end = to.at(name);
      if (name == setup_.faults.stuck_joint) end = 0.5 * (from.at(name) + end);
      motion = JointMotion(from.at(name), end, drive_of(name), target.velocity_factor);
      if (motion.direction() == 0) continue;
      moving.push_back(name);
      unseen_[name] = setup_.timing.repeatability * random.normal() -
                      0.5 * setup_.timing.backlash * motion.direction();
    }
    const bool is_outlier = random.uniform(0.0, 1.0) < setup_.faults.outliers;
    if (!is_outlier || moving.empty()) return;
    const int which = random.integer(0, static_cast<int>(moving.size()) - 1);
    outlier_ = moving[static_cast<std::size_t>(which)];
    outlier_size_ = random.either_sign(setup_.faults.outlier_size, setup_.faults.outlier_size);
  }

  /// Encoder readings without noise.
  [[nodiscard]] Positions encoders(double now) const {
    Positions positions;
    for (const auto& [name, motion] : motions_) positions[name] = motion.position(now - start_);
    return positions;
  }

  /// True positions of the joints.
  [[nodiscard]] Positions truth(double now) const {
    Positions positions = encoders(now);
    for (auto& [name, position] : positions) position += unseen_.at(name);
    if (!outlier_.empty()) positions[outlier_] += outlier_size_;
    return positions;
  }

  /// Time at which all motion has stopped, seconds.
  [[nodiscard]] double rest() const {
    double latest = 0.0;
    for (const auto& [name, motion] : motions_) latest = std::max(latest, motion.rest());
    return start_ + latest;
  }

  /// When the last motion began, seconds.
  [[nodiscard]] double start() const { return start_; }

 private:
  void check(const std::string& name, double position) const {
    if (!motions_.contains(name)) {
      std::vector<std::string> names;
      for (const auto& [known, motion] : motions_) names.push_back(known);
      throw PoseError("no joint '" + name + "' that moves" + did_you_mean(name, names));
    }
    if (!std::isfinite(position)) throw PoseError("joint '" + name + "': not a finite position");
    const Joint& joint = setup_.robot.joint(name);
    constexpr double kRounding = 1e-6;  // of positions in files
    if (joint.type == JointType::continuous || !joint.limits) return;
    if (position < joint.limits->lower - kRounding || position > joint.limits->upper + kRounding) {
      throw PoseError("joint '" + name + "' cannot move to " + std::to_string(position) +
                      "; its limits are " + std::to_string(joint.limits->lower) + " and " +
                      std::to_string(joint.limits->upper));
    }
  }

  [[nodiscard]] JointDrive drive_of(const std::string& name) const {
    JointDrive drive = setup_.drive;
    constexpr double kSliding = 0.1;
    const double factor = turns(setup_.robot.joint(name).type) ? 1.0 : kSliding;
    drive.swing *= factor;
    drive.acceleration *= factor;
    const auto known = setup_.speeds.find(name);
    drive.speed = known != setup_.speeds.end() ? known->second : drive.speed * factor;
    return drive;
  }

  const SimulatedSetup& setup_;
  std::map<std::string, JointMotion> motions_;
  Positions unseen_;  ///< offsets that encoders do not see
  std::string outlier_;
  double outlier_size_ = 0.0, start_ = 0.0;
};

/// Hides a part of a view behind a near object that is not in the scene.
inline void hide_a_part(View& view, SeededRandom& random) {
  constexpr double kDepth = 0.4;  // metres
  const int width = view.image.width, left = random.integer(-width / 4, width - width / 8);
  const int right = left + random.integer(width / 8, width / 2);
  const auto gray = static_cast<std::uint8_t>(random.integer(30, 160));
  for (int v = 0; v < view.image.height; ++v) {
    for (int u = std::max(left, 0); u < std::min(right, width); ++u) {
      view.image(u, v) = gray;
      if (!view.points.empty())
        view.points(u, v) *= static_cast<float>(kDepth) / view.points(u, v).z();
    }
  }
}

}  // namespace detail

struct SimulatedRobot::State {
  explicit State(SimulatedSetup given)
      : setup(detail::with_camera_errors(std::move(given))),
        robot(setup.robot, setup.truth, setup.frames),
        renderer(setup.camera),
        random(setup.seed),
        joints(setup) {}

  SimulatedSetup setup;
  TrueRobot robot;
  Renderer renderer;
  SeededRandom random;
  detail::Joints joints;
  double now = 0.0;                                         ///< seconds
  std::vector<std::pair<double, int>> lamp = {};            ///< when which code was lit
  std::map<std::string, std::optional<Stamp>> newest = {};  ///< stamps, by stream
  Positions pictured = {};                                  ///< where `pictures` are valid
  std::map<int, Picture> pictures = {};                     ///< by code: the robot mostly rests
  Picture smeared = {};                                     ///< with changes during an exposure

  /// The first tick of a rate after a time, seconds.
  static double tick(double after, double rate) {
    constexpr double kRounding = 1e-6;  // of a period; stamps are whole nanoseconds
    return (std::floor(after * rate + kRounding) + 1.0) / rate;
  }

  /// Waits for the next message.
  /// @param shift  of its stamp against the true time, seconds
  /// @returns      its true time, seconds
  double wait(const char* what, Stamp after, double rate, double shift, double ends) {
    check_connection();
    std::optional<Stamp>& last = newest[what];
    constexpr double kPatience = 5.0;  // seconds
    const double earliest = detail::seconds_of(after) - shift;
    const double time = tick(std::max(earliest, joints.start()), rate);
    if (time <= ends && time <= now + kPatience) {
      last = detail::stamp_of(time + shift);
      return time;
    }
    now += kPatience;
    throw SilenceError(std::string("no ") + what + " for 5 s, stamped after " +
                           std::to_string(detail::seconds_of(after)) + " s",
                       what, last);
  }

  void check_connection() const {
    if (now >= setup.faults.connection_ends) throw ConnectionError("the simulated robot is gone");
  }

  Pose<double> in_camera(const std::string& link, const Positions& positions) const {
    const Pose<double> base_T_camera = robot.pose(setup.base, setup.camera.frame, positions);
    const Pose<double> camera_T_base = base_T_camera.inverse();
    return link.empty() ? camera_T_base : camera_T_base * robot.pose(setup.base, link, positions);
  }

  int lit_at(double time) const {
    int code = 0;
    for (const auto& [when, lit] : lamp) {
      if (when <= time) code = lit;
    }
    return code;
  }

  /// The image of an exposure that ends at a time: the mean brightness, and the last depth.
  const Picture& exposed(double time) {
    const double begin = time - setup.timing.exposure;
    if (joints.truth(begin) == joints.truth(time) && lit_at(begin) == lit_at(time)) {
      return picture(time);
    }
    constexpr int kMoments = 8;
    Image<float> sum = picture(begin).brightness;
    for (int i = 1; i < kMoments; ++i) {
      const double moment = begin + setup.timing.exposure * i / (kMoments - 1);
      const Image<float>& more = picture(moment).brightness;
      std::transform(sum.pixels.begin(), sum.pixels.end(), more.pixels.begin(), sum.pixels.begin(),
                     std::plus<>());
    }
    smeared = picture(time);
    std::transform(sum.pixels.begin(), sum.pixels.end(), smeared.brightness.pixels.begin(),
                   [](float all) { return all / kMoments; });
    return smeared;
  }

  const Picture& picture(double time) {
    const Positions positions = joints.truth(time);
    if (positions != pictured) pictures.clear();
    pictured = positions;
    const int code = lit_at(time);
    const auto found = pictures.find(code);
    if (found != pictures.end()) return found->second;
    const auto pose_of = [&](const std::string& link) { return in_camera(link, positions); };
    return pictures[code] = renderer.render(setup.scene, pose_of, code);
  }
};

SimulatedRobot::SimulatedRobot(SimulatedSetup setup) {
  for (const auto& [name, position] : setup.start) {
    if (!moves(setup.robot.joint(name).type)) {
      throw std::invalid_argument("joint '" + name +
                                  "' of a simulated robot's start does not move");
    }
  }
  state_ = std::make_unique<State>(std::move(setup));
  for (const Patch& patch : state_->setup.scene.patches) static_cast<void>(in_camera(patch.link));
  for (const Solid& solid : state_->setup.scene.solids) static_cast<void>(in_camera(solid.link));
}
SimulatedRobot::~SimulatedRobot() = default;
SimulatedRobot::SimulatedRobot(SimulatedRobot&&) noexcept = default;
SimulatedRobot& SimulatedRobot::operator=(SimulatedRobot&&) noexcept = default;

void SimulatedRobot::move(const JointTarget& target) {
  state_->check_connection();
  state_->joints.check(target);
  state_->joints.move(target, state_->now, state_->random);
}

MeasuredJoints SimulatedRobot::next_joints(Stamp after) {
  State& s = *state_;
  const double time =
      s.wait("joint positions", after, s.setup.timing.joint_rate, 0.0, s.setup.faults.joints_end);
  s.now = std::max(s.now, time);
  MeasuredJoints measured;
  measured.stamp = detail::stamp_of(time);
  for (const auto& [name, position] : s.joints.encoders(time)) {
    measured.names.push_back(name);
    measured.positions.push_back(position + s.setup.timing.encoder_noise * s.random.normal());
  }
  return measured;
}

View SimulatedRobot::next_view(Stamp after) {
  State& s = *state_;
  const SimulatedTiming& timing = s.setup.timing;
  const Faults& faults = s.setup.faults;
  const double shift = timing.late_stamps + faults.other_clock;
  const double time = s.wait("images", after, timing.image_rate, shift, faults.views_end);
  s.now = std::max(s.now, time + timing.image_latency);
  View view = photograph(s.setup.camera, s.renderer.lens(), s.exposed(time), s.random);
  view.stamp = detail::stamp_of(time + shift);
  if (faults.no_camera_info) view.camera.reset();
  if (s.random.uniform(0.0, 1.0) < faults.passer_by) detail::hide_a_part(view, s.random);
  return view;
}

Stamp SimulatedRobot::light(int code) {
  State& s = *state_;
  s.check_connection();
  s.now += s.setup.timing.lamp_latency;
  s.lamp.emplace_back(s.now, code == s.setup.faults.dark_led ? 0 : code);
  return detail::stamp_of(s.now - s.setup.timing.lamp_answers_early);
}

void SimulatedRobot::wait_for_rest() {
  state_->now = std::max(state_->now, state_->joints.rest());
}

Stamp SimulatedRobot::now() const {
  return detail::stamp_of(state_->now);
}

Positions SimulatedRobot::true_positions() const {
  return state_->joints.truth(state_->now);
}

Pose<double> SimulatedRobot::in_camera(const std::string& link) const {
  return state_->in_camera(link, true_positions());
}

const SimulatedLens& SimulatedRobot::lens() const {
  return state_->renderer.lens();
}

const SimulatedSetup& SimulatedRobot::setup() const {
  return state_->setup;
}

}  // namespace kinecal
