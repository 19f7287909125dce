// A study: is the pose of a tracker, a board or a camera found, wherever it is?
//
//   unknown_poses_study [COUNT=1000]
//
// Each data set is calibrated COUNT times, each time with its tracker, fixture, camera or board moved
// to another random pose, of which the configuration says nothing.  All must end at the cost that is
// reached from a known pose.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "support/unknown_poses.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::test;

constexpr double kSameCost = 1e-6;  // relative

/// One calibration, and the cost that it should have.
struct Trial {
  Calibration calibration;
  double reference = 0.0;
};

struct Study {
  const char* name;
  std::function<Trial(std::uint64_t seed)> make;
};

/// The tracker of a recording somewhere else.
std::function<Trial(std::uint64_t)> moved(Scenario scenario, std::string sensor, double reference,
                                          bool yaw_only) {
  return [=](std::uint64_t seed) {
    Scenario other = scenario;
    Chance chance(seed);
    Pose<double> motion = chance.pose(10.0);
    if (yaw_only) {
      motion.rotation = exp(Vector3<double>(0.0, 0.0, chance(-3.14159, 3.14159)));
    }
    move_sensor(other.samples, sensor, motion);
    return Trial{other.calibration(), reference};
  };
}

std::vector<Study> studies() {
  std::vector<Study> all;
  if (std::filesystem::exists(data_folder() / "ur5_tracker")) {
    const std::string folder = "ur5_tracker/";
    const auto ur5 = [&](const char* config, double cost) {
      return moved(recorded(folder + "ur5.urdf", folder + config, folder + "grid.yaml"), "tracker",
                   cost, false);
    };
    all.push_back({"ur5_tracker full", ur5("full.yaml", 6.233928757e-6)});
    all.push_back({"ur5_tracker offsets", ur5("offsets.yaml", 1.572936374e-4)});
  } else {
    std::printf("ur5_tracker is not in %s, left out\n", data_folder().c_str());
  }
  if (std::filesystem::exists(data_folder() / "mukca_panda")) {
    const auto panda = [](const std::string& folder, const char* train, const char* config,
                          double cost, bool yaw_only) {
      const std::string data = "mukca_panda/";
      return moved(
          recorded(data + "panda.urdf", data + folder + "/" + config, data + folder + "/" + train),
          "fixture", cost, yaw_only);
    };
    all.push_back({"panda_6 minimal, yaw",
                   panda("panda_6", "front.yaml", "minimal.yaml", 1.169456536e-6, true)});
    all.push_back({"panda_2 minimal, yaw",
                   panda("panda_2", "front_center.yaml", "minimal.yaml", 9.588253667e-7, true)});
    all.push_back({"panda_6 redundant",
                   panda("panda_6", "front.yaml", "redundant.yaml", 1.169456536e-6, false)});
  } else {
    std::printf("mukca_panda is not in %s, left out\n", data_folder().c_str());
  }
  for (const bool in_hand : {true, false}) {
    all.push_back(
        {in_hand ? "camera2d in the hand" : "camera2d on a bracket", [in_hand](std::uint64_t seed) {
           const Scenario scenario = board_scenario(in_hand, seed);
           Trial trial{scenario.calibration()};
           trial.reference = cost_from_truth(scenario, trial.calibration);
           return trial;
         }});
  }
  return all;
}

/// @returns  how many reached the reference
int run(const Study& study, int count) {
  int good = 0;
  double worst = 0.0;
  std::vector<double> times;
  StartSummary example;
  for (int n = 0; n < count; ++n) {
    const Trial trial = study.make(static_cast<std::uint64_t>(n));
    const auto begin = std::chrono::steady_clock::now();
    const CalibrationResult result = calibrate(trial.calibration, {}, {.threads = 1});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    times.push_back(1e3 * seconds.count());
    const double ratio = result.steps.back().final_cost / trial.reference;
    const bool same = result.converged && std::abs(ratio - 1.0) < kSameCost;
    good += same ? 1 : 0;
    if (same) {
      worst = std::max(worst, std::abs(ratio - 1.0));
      example = result.steps.back().starts;
    } else if (n - good < 5) {
      std::printf("  seed %d: %.6f times the reference; %s; %s\n", n, ratio,
                  result.termination.c_str(), to_string(result.steps.back().starts).c_str());
    }
  }
  std::sort(times.begin(), times.end());
  std::printf("%-24s %5d of %d, worst %.0e, ms: median %.1f, most %.1f\n", study.name, good, count,
              worst, times[times.size() / 2], times.back());
  std::printf("  %s\n", to_string(example).c_str());
  std::fflush(stdout);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  bool all = true;
  for (const Study& study : studies()) {
    if (argc > 2 && std::string(study.name).find(argv[2]) == std::string::npos) continue;
    all = run(study, count) == count && all;
  }
  return all ? 0 : 1;
}
