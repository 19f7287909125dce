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

#include "kinecal/study/robot_state.ipp"

namespace kinecal {

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
