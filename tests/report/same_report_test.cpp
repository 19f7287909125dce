// Same input, same report: whatever the number of threads.
#include <gtest/gtest.h>

#include "kinecal/report/json.hpp"
#include "support/simulated.hpp"

namespace kinecal {
namespace {

/// What is reported, without the time that it took.
std::pair<std::string, std::string> report(const test::Simulated& simulated,
                                           const std::vector<Sample>& samples, int threads,
                                           int starts) {
  const Calibration calibration = simulated.calibration(samples);
  SolveOptions solving;
  solving.threads = threads;
  solving.random_starts = starts;
  CalibrationResult result = calibrate(calibration, {}, solving);
  for (StepResult& step : result.steps) step.seconds = 0.0;
  const Findings found = findings_of(
      simulated.robot, calibration, judge_result(calibration, std::move(result), samples), samples);
  EXPECT_EQ(found.judgement.verdict, Grade::good) << summary_text(found);
  return {json_report(found), summary_text(found)};
}

TEST(SameReport, WhateverTheNumberOfThreads) {
  const test::Simulated fetch = test::fetch_and_leds(40);
  const std::vector<Sample> samples = fetch.samples(5);
  for (const int starts : {0, 3}) {
    const auto [json, summary] = report(fetch, samples, 1, starts);
    EXPECT_GT(json.size(), 1000u);
    for (const int threads : {1, 4}) {
      const auto [same_json, same_summary] = report(fetch, samples, threads, starts);
      EXPECT_EQ(same_json, json) << threads << " threads";
      EXPECT_EQ(same_summary, summary) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace kinecal
