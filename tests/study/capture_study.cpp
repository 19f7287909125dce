// Captures, calibrates and judges simulated Fetches: how many fail, how many poses an accuracy takes, and
// how long that is on the robot's clock.
//
//   capture_study [ROBOTS [FIRST_SEED]]     10 by default
//
// Poses are those of the Fetch's calibration_poses.bag ($KINECAL_DATA, by default ../shared/data).
// Time model: study/simulated_robot.hpp; joints at the speeds of the URDF, views at 15 Hz.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "kinecal/capture/finders/find_leds.hpp"
#include "kinecal/capture/session/session.hpp"
#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/procedure/session_end.hpp"
#include "kinecal/procedure/session_follower.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/simulated_fetch.hpp"

namespace kinecal::test {
namespace {

constexpr double kUntil = 2e-3;     // metres: standard deviation of the gripper in the camera
constexpr double kPaper = 3e-3;     // metres: the paper's error of re-projection
constexpr double kOutliers = 0.05;  // of the stops: a joint is elsewhere than it says
constexpr double kVisible = 0.34;   // cosine to the LED's axis: 70 degrees
constexpr double kMinute = 60e9;    // nanoseconds

/// What became of one robot.
struct Outcome {
  int visible = 0, found = 0;             ///< LEDs that could be seen, and of these, found
  int false_finds = 0;                    ///< further than 3 pixels from the LED
  double squares = 0.0;                   ///< of the errors in the image, pixels
  int poses = 0;                          ///< until the accuracy was reached; all if it never was
  double minutes = 0.0;                   ///< of the robot's clock until then
  double error = 0.0;                     ///< re-projection of all poses by the result, metres, RMS
  double before = 0.0;                    ///< the same by the URDF
  bool usable = false;                    ///< the verdict
  std::vector<std::string> reasons = {};  ///< of the verdict
};

/// Compares what was found with where LEDs truly are.
void judge_found(const SimulatedRobot& robot, const Found& found, Outcome& outcome) {
  const Pose<double> camera_T_leds = robot.in_camera(kFetchLedLink);
  const std::vector<Vector3<double>> leds = fetch_leds();
  for (std::size_t i = 0; i < leds.size(); ++i) {
    const Vector3<double> p = camera_T_leds * leds[i];
    const Eigen::Vector2d pixel = robot.lens().project(p);
    const CameraInfo& info = robot.setup().camera.info;
    const double facing = -camera_T_leds.rotation.col(2).dot(p.normalized());
    const bool in_image = p.z() > 0.0 && pixel.x() > 3 && pixel.y() > 3 &&
                          pixel.x() < info.width - 4 && pixel.y() < info.height - 4;
    const bool visible = in_image && facing > kVisible;
    outcome.visible += visible ? 1 : 0;
    if (!found) continue;
    for (const Feature& seen : found.observations[0].features) {
      if (seen.id != static_cast<int>(i)) continue;
      const auto& k = info.p;
      const Eigen::Vector2d at(k[0] * seen.point.x() / seen.point.z() + k[2],
                               k[5] * seen.point.y() / seen.point.z() + k[6]);
      const double off = (at - pixel).norm();
      outcome.found += visible ? 1 : 0;
      outcome.false_finds += off > 3.0 ? 1 : 0;
      outcome.squares += off * off;
    }
  }
}

/// Captures until the accuracy is reached, then calibrates.
Outcome capture(std::uint64_t seed, const std::vector<CapturePose>& all) {
  SimulatedSetup setup = simulated_fetch(seed);
  setup.faults.outliers = kOutliers;
  SimulatedRobot robot(setup);
  LedFinder leds;
  leds.frame = kFetchLedLink;
  for (const Vector3<double>& led : fetch_leds()) {
    const int number = static_cast<int>(leds.leds.size());
    leds.leds.push_back({number + 1, "led" + std::to_string(number + 1), led});
  }
  Diagnostics diagnostics;
  const std::string config_file = source_folder() + "/examples/robots/fetch/calibrate.yaml";
  SessionFollower follower(read_config(config_file, diagnostics), setup.robot);
  std::vector<Sample> samples;
  Accuracy wanted;
  wanted.position = kUntil;
  Outcome outcome;
  std::vector<SessionFinder> finders = {
      {"led_finder", [&](Stamp after) { return robot.next_view(after); },
       [&](const View& still) {
         Found found = find_leds(leds, robot, robot, still.stamp, still.joints);
         judge_found(robot, found, outcome);
         return found;
       }}};
  std::vector<CapturePose> poses = all;
  std::mt19937_64 random(seed);
  std::shuffle(poses.begin(), poses.end(), random);
  bool enough = false;
  NextPose from_list = poses_of(poses);
  const NextPose next = [&]() -> std::optional<CapturePose> {
    if (enough) return std::nullopt;
    return from_list();
  };
  const Stamp start = robot.now();
  run_session(robot, next, finders, [&](const CapturedPose& captured) {
    ++outcome.poses;
    for (const Sample& sample : captured.samples) {
      samples.push_back(sample);
      const FollowedState state = follower.add(sample);
      if (!wanted.reached(state.online)) continue;
      std::vector<Sample> ahead;
      for (auto i = static_cast<std::size_t>(outcome.poses); i < poses.size(); ++i) {
        ahead.push_back(at_pose(poses[i], sample));
      }
      enough = why_go_on(wanted, follower, ahead).empty();
    }
  });
  outcome.minutes = static_cast<double>((robot.now() - start).count()) / kMinute;
  const JudgedResult judged = follower.calibrate_all();
  const TrueRobot truth(setup.robot, setup.truth, setup.frames);
  const TrueRobot drawn(setup.robot, {}, setup.frames);
  const TrueRobot calibrated(setup.robot, judged.result.table, setup.frames);
  outcome.before = led_difference(drawn, truth, samples);
  outcome.error = led_difference(calibrated, truth, samples);
  outcome.reasons = judged.judgement.reasons;
  outcome.usable = judged.judgement.verdict != Grade::do_not_use;
  return outcome;
}

int run(int robots, std::uint64_t first) {
  const std::string bag = (data_folder() / "fetch/calibration_poses.bag").string();
  const std::vector<CapturePose> poses = poses_for(simulated_fetch(first).robot, bag);
  Outcome sum;
  int failures = 0;
  double worst = 0.0;
  for (int i = 0; i < robots; ++i) {
    const Outcome one = capture(first + static_cast<std::uint64_t>(i), poses);
    const bool failed = !one.usable || one.error > kPaper;
    failures += failed ? 1 : 0;
    worst = std::max(worst, one.error);
    std::printf(
        "robot %3d: %3d poses, %4.1f min, LEDs %3d of %3d, %.2f px, %d false; %5.1f mm -> %.2f "
        "mm%s\n",
        i + 1, one.poses, one.minutes, one.found, one.visible,
        std::sqrt(one.squares / std::max(1, one.found)), one.false_finds, 1e3 * one.before,
        1e3 * one.error, failed ? "  FAILED" : "");
    for (const std::string& reason : one.reasons) std::printf("    %s\n", reason.c_str());
    std::fflush(stdout);
    sum.poses += one.poses;
    sum.minutes += one.minutes;
    sum.found += one.found;
    sum.visible += one.visible;
    sum.false_finds += one.false_finds;
    sum.squares += one.squares;
    sum.error += one.error;
  }
  std::printf(
      "%d robots, %d failed; mean: %.1f poses, %.1f min, %.2f mm (worst %.2f); LEDs: %.1f %% "
      "found, "
      "%.2f px RMS, %d false\n",
      robots, failures, 1.0 * sum.poses / robots, sum.minutes / robots, 1e3 * sum.error / robots,
      1e3 * worst, 100.0 * sum.found / std::max(1, sum.visible),
      std::sqrt(sum.squares / std::max(1, sum.found)), sum.false_finds);
  return failures <= robots / 100 ? 0 : 1;
}

}  // namespace
}  // namespace kinecal::test

int main(int argc, char** argv) {
  try {
    return kinecal::test::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 10,
                              argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
