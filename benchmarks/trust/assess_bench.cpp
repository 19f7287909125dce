// What judging a calibration costs, on one thread: 100 samples of the Fetch, four LEDs each.
// Control: the calibration itself, and the five folds solved anew.
//
//   assess_bench [REPETITIONS]     20 by default; the least time of each part is printed
//
// Reads fetch/synth of $KINECAL_DATA, by default ../shared/data beside the checkout; without it the
// exit code is 77, with KINECAL_REQUIRE_DATA=1 it is 1.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/trust.hpp"

namespace kinecal {
namespace {

/// Milliseconds of the fastest of some runs.
double fastest(int repetitions, const std::function<void()>& run) {
  double least = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count());
  }
  return least;
}

SolveOptions one_thread(int starts = 0) {
  SolveOptions options;
  options.threads = 1;
  options.random_starts = starts;
  return options;
}

/// The Fetch, its configuration and its samples.
struct Work {
  Diagnostics diagnostics;
  Robot robot;
  Config config;
  std::vector<Sample> samples;
  Calibration calibration;
  CalibrationResult result;

  explicit Work(const std::filesystem::path& folder)
      : robot(read_urdf((folder / "fetch_arm_head.urdf").string())),
        config(read_config((folder / "calibrate.yaml").string(), diagnostics)),
        samples(read_samples((folder / "samples.yaml").string(), diagnostics)),
        calibration(assemble(config, robot, samples, diagnostics)),
        result(calibrate(calibration, {}, one_thread())) {
    diagnostics.throw_if_errors();
  }

  [[nodiscard]] Assessment assessed(int folds) const {
    return assess(calibration, result, samples, {.folds = folds}).back();
  }
  /// The calibrations without each fold, solved from their start.
  [[nodiscard]] double solve_folds(int folds) const {
    const std::vector<int> fold = folds_of(samples, each_its_own(samples.size()), folds);
    double cost = 0.0;
    for (int k = 0; k < folds; ++k) {
      std::vector<Sample> kept;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (fold[i] != k) kept.push_back(samples[i]);
      }
      Diagnostics ignored;
      const Calibration without = assemble(config, robot, kept, ignored);
      cost += calibrate(without, {}, one_thread()).steps.back().final_cost;
    }
    return cost;
  }
};

/// Milliseconds of the update after each sample but the first ten: the median and the last ones.
struct Updates {
  double median = 0.0, last_ten = 0.0, next_move = 0.0;
};

Updates follow(const Work& work) {
  const CalibrationStep& step = work.calibration.steps.back();
  const ComparedFrames frames = compared_frames(*step.problem, work.samples).front();
  const Eigen::VectorXd values = work.calibration.table.values();
  const auto make = [&] { return step.problem->without_samples(); };
  OnlineCalibration online(make, step.free,
                           {values.data(), static_cast<std::size_t>(values.size())}, frames.frame,
                           frames.in);
  std::vector<double> times;
  for (const Sample& sample : work.samples) {
    times.push_back(fastest(1, [&] { (void)online.add(sample); }));
  }
  Updates updates;
  updates.next_move = fastest(3, [&] { (void)online.next_move(); });
  std::nth_element(times.end() - 10, times.end() - 5, times.end());
  updates.last_ten = *(times.end() - 5);
  times.erase(times.begin(), times.begin() + 10);
  std::nth_element(times.begin(), times.begin() + 45, times.end());
  updates.median = times[45];
  return updates;
}

/// What is timed gives what it should.
bool is_right(const Work& work) {
  constexpr double kCost = 8.019441481e-4;  // of an independent implementation
  const Assessment found = work.assessed(5);
  return std::abs(work.result.steps.back().final_cost / kCost - 1.0) < 1e-6 &&
         work.assessed(0).held_out.empty() && found.held_out.size() == 1 &&
         found.held_out[0].held_out > found.held_out[0].fitted && found.captures.size() == 100 &&
         found.uncertainty.determined == 25 && !found.compared.empty();
}

void print(const char* what, double milliseconds) {
  std::printf("%-58s %8.2f ms\n", what, milliseconds);
}

int run(int repetitions) {
  const char* given = std::getenv("KINECAL_DATA");
  const std::filesystem::path data = given != nullptr ? given : KINECAL_DATA_DEFAULT;
  if (!std::filesystem::exists(data / "fetch/synth")) {
    std::fprintf(stderr, "error: %s does not exist; set KINECAL_DATA to the folder of the data\n",
                 (data / "fetch/synth").c_str());
    return std::getenv("KINECAL_REQUIRE_DATA") != nullptr ? 1 : 77;
  }
  const Work work(data / "fetch/synth");
  if (!is_right(work)) {
    std::fprintf(stderr, "error: the calibration or its assessment is wrong\n");
    return 1;
  }
  const auto time = [&](const auto& part) { return fastest(repetitions, part); };
  const CalibrationStep& step = work.calibration.steps.back();
  const Eigen::VectorXd values = work.result.table.values();
  const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
  const double solving = time([&] { (void)calibrate(work.calibration, {}, one_thread()); });
  const double starts = time([&] { (void)calibrate(work.calibration, {}, one_thread(20)); });
  const double observing = time([&] { (void)observability(*step.problem, step.free, all); });
  const double plain = time([&] { (void)work.assessed(0); });
  const double five = time([&] { (void)work.assessed(5); });
  const double one_out = time([&] { (void)work.assessed(100); });
  const double control = time([&] { (void)work.solve_folds(5); });
  print("observability", observing);
  print("covariance, noise, bad captures, influence, pose", plain - observing);
  print("5 folds", five - plain);
  print("leave-one-out (100 folds)", one_out - plain);
  print("20 random starts", starts - solving);
  print("all of it", one_out + (five - plain) + (starts - solving));
  print("  by default (5 folds, no random starts)", five);
  print("control: the calibration itself", solving);
  print("control: 5 folds assembled and solved anew", control);
  const Updates updates = follow(work);
  print("update after each sample of a session, median", updates.median);
  print("  with 90 to 100 samples, median", updates.last_ten);
  print("  which joint to move next", updates.next_move);
  return 0;
}

}  // namespace
}  // namespace kinecal

int main(int argc, char** argv) {
  try {
    return kinecal::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 20);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
