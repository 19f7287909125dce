// Driving a simulated base.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/simulated_base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "kinecal/study/seeded_random.hpp"

namespace kinecal {

namespace detail {
namespace {

/// What a base has counted, and where it is.
struct BaseState {
  double left = 0.0, right = 0.0;         ///< positions of the wheels, radians
  double odom_yaw = 0.0, gyro_yaw = 0.0;  ///< radians, without jumps
  double time = 0.0;                      ///< seconds
  PlanarMotion<double> odom = {};         ///< reported
  PlanarMotion<double> true_pose = {};    ///< of the base in the world
};

/// Turns the wheels, and moves the base.
class BaseDriver {
 public:
  BaseDriver(const SimulatedBase& base, std::uint64_t seed) : base_(base), random_(seed) {}

  void begin_run(const BaseRun& run) {
    state_.true_pose = PlanarMotion<double>::at(-0.5 * run.ahead * run.seconds, 0.0,
                                                run.turn == 0.0 ? 0.0 : random_.uniform(-0.1, 0.1));
    of_run_ = 1.0 + base_.of_runs * random_.normal();
    mount_ = base_.mount;
    if (base_.mount_of_runs <= 0.0) return;
    for (double& at : mount_) at += base_.mount_of_runs * random_.normal();
  }
  /// @returns  true if a wheel slipped
  bool step(const BaseRun& run, double seconds) {
    const double track = base_.track_width_scale * base_.drive.track_width;
    const bool slips = random_.uniform(0.0, 1.0) < base_.slip_chance;
    const int slipping = random_.integer(0, 1);
    std::array<double, 2> moved{}, turned{};  // of the left and right wheel, metres and radians
    for (std::size_t i = 0; i < 2; ++i) {
      const double side = i == 0 ? -0.5 : 0.5;
      const double way = seconds * (run.ahead + side * track * run.turn);
      moved[i] = way + base_.rolling * std::sqrt(std::abs(way)) * random_.normal();
      const double rolls =
          of_run_ * (i == 0 ? base_.left_rollout_scale : base_.right_rollout_scale);
      const double slip = slips && slipping == static_cast<int>(i) ? base_.slip : 0.0;
      turned[i] = (way + slip) / (rolls * base_.drive.wheel_radius);
    }
    const double turn = (moved[1] - moved[0]) / track;
    state_.true_pose = state_.true_pose * planar_exp(0.5 * (moved[0] + moved[1]), 0.0, turn);
    state_.left += turned[0];
    state_.right += turned[1];
    const std::array<double, 4> nominal{1.0, 1.0, 1.0, 1.0}, at{turned[0], turned[1], 0.0, 0.0};
    state_.odom = state_.odom * base_.drive.motion(nominal.data(), at.data());
    state_.odom_yaw += base_.drive.wheel_radius * (turned[1] - turned[0]) / base_.drive.track_width;
    state_.gyro_yaw += (turn - base_.imu_bias * seconds) / base_.imu_scale +
                       base_.gyro * std::sqrt(seconds) * random_.normal();
    state_.time += seconds;
    return slips;
  }
  [[nodiscard]] Sample sample(int run) {
    const PlanarMotion<double> laser =
        state_.true_pose * PlanarMotion<double>::at(mount_[0], mount_[1], mount_[2]);
    constexpr double kSeen = 1.0;  // radians
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    const double wall_angle = -laser.angle(), distance = base_.wall - laser.x;
    const bool is_seen = std::abs(wall_angle) < kSeen && distance > 0.0;
    const double position = base_.tracked_position, angle = base_.tracked_angle;
    Sample sample;
    sample.conditions = {
        {"left_wheel", state_.left},
        {"right_wheel", state_.right},
        {"odom_x", state_.odom.x},
        {"odom_y", state_.odom.y},
        {"odom_yaw", state_.odom_yaw},
        {"gyro_yaw", state_.gyro_yaw},
        {"time", state_.time},
        {"track_x", laser.x + position * random_.normal()},
        {"track_y", laser.y + position * random_.normal()},
        {"track_yaw", laser.angle() + angle * random_.normal()},
        {"wall_angle", is_seen ? wall_angle + angle * random_.normal() : kMissing},
        {"wall_distance", is_seen ? distance + base_.wall_distance * random_.normal() : kMissing},
        {kRun, run}};
    return sample;
  }

 private:
  const SimulatedBase& base_;
  SeededRandom random_;
  BaseState state_;
  std::array<double, 3> mount_{};  ///< in this run
  double of_run_ = 1.0;            ///< what wheels roll in this run over what they roll in the mean
};

}  // namespace
}  // namespace detail

std::vector<BaseRun> turns_and_straight_runs() {
  std::vector<BaseRun> runs;
  for (const double speed : {0.5, 1.5, 3.0}) {
    for (const double turn : {speed, -speed}) {
      runs.push_back({0.0, turn, 2.0 * std::numbers::pi / speed});
    }
    for (const double ahead : {0.2 * speed, -0.2 * speed}) {
      runs.push_back({ahead, 0.0, 1.0 / (0.2 * speed)});
    }
  }
  return runs;
}

std::vector<BaseRun> all_runs() {
  std::vector<BaseRun> runs = turns_and_straight_runs();
  for (const double turn : {0.6, -0.6, 0.3, -0.3}) runs.push_back({0.4, turn, 6.0});
  return runs;
}

BaseRecording simulate_base(const SimulatedBase& base, std::span<const BaseRun> runs,
                            std::uint64_t seed) {
  BaseRecording recording;
  detail::BaseDriver driver(base, seed);
  const auto add = [&](int run) {
    recording.samples.push_back(driver.sample(run));
    recording.samples.back().source = "drive.csv:" + std::to_string(recording.samples.size() + 1);
  };
  for (int run = 0; run < static_cast<int>(runs.size()); ++run) {
    const BaseRun& of = runs[static_cast<std::size_t>(run)];
    driver.begin_run(of);
    add(run + 1);
    for (double left = of.seconds; left > 1e-9; left -= base.period) {
      if (driver.step(of, std::min(left, base.period))) {
        recording.slipped.push_back(static_cast<int>(recording.samples.size()));
      }
      add(run + 1);
    }
  }
  return recording;
}

}  // namespace kinecal
