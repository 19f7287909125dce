// Wrong inputs on real recordings, and what they do to the result: none that makes it three times as bad, on
// samples that are right, is called good.  Those that nothing in the samples shows are listed with the reason.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/solve/statistics.hpp"
#include "support/wrong_recordings.hpp"

namespace kinecal {
namespace {

using test::Mutation;
using test::mutations;
using test::Recording;

/// What the program does with an input.
struct Outcome {
  bool refused = false;  ///< before solving
  Judgement judgement;
  double error = 0.0;  ///< on samples that are right, metres
};

Outcome outcome_of(const Recording& of) {
  Outcome outcome;
  PreparedCalibration prepared = prepare(test::setup_of(of));
  outcome.refused = !prepared.diagnostics.errors.empty();
  if (outcome.refused) return outcome;
  const CalibratedRobot calibrated =
      calibrate_robot(std::move(prepared), {.solving = {.threads = 1}});
  outcome.judgement = calibrated.judgement;
  const std::unique_ptr<AnyProblem> right =
      calibrated.setup.calibration.steps.back().problem->without_samples();
  for (const Sample& sample : of.right) right->add_sample(sample);
  double squares = 0.0, count = 0.0;
  for (const std::vector<double>& norms : feature_norms(*right, calibrated.result.table.values())) {
    for (const double norm : norms) squares += norm * norm, count += 1.0;
  }
  outcome.error = std::sqrt(squares / count);
  return outcome;
}

/// What nothing in the samples shows, and why.
const std::map<std::string, std::string>& undetectable() {
  const std::string socket_by_socket =
      "the samples are those of sockets that are elsewhere: they were recorded one after the other";
  const std::string own_errors =
      "sockets 51 in place of 50 mm apart change lengths by 2.2 mm, as the URDF's own errors do";
  static const std::map<std::string, std::string> all = {
      {"panda points_2_percent_larger", own_errors},
      {"panda x_2_percent_longer", own_errors},
      {"panda bump_of_3_mm", socket_by_socket},
      {"kuka bump_of_3_mm", socket_by_socket},
      {"kuka eccentric_joint_4", "the joint moves little, and free frames do the same"},
      {"panda eccentric_joint_4",
       "the same: the noise would fall to 78 %, as it does on right samples"},
  };
  return all;
}

class HarmfulInputs : public testing::TestWithParam<const char*> {};

TEST_P(HarmfulInputs, AreNotCalledGood) {
  KINECAL_NEEDS_RECORDING(GetParam());
  const Recording right = test::recording(GetParam());
  const Outcome clean = outcome_of(right);
  EXPECT_NE(clean.judgement.verdict, Grade::do_not_use) << clean.judgement.reasons.front();
  int harmful = 0, good = 0;
  for (const Mutation& mutation : mutations()) {
    Recording wrong = right;
    mutation.change(wrong);
    const Outcome outcome = outcome_of(wrong);
    const double times = outcome.error / clean.error;
    const bool is_good = !outcome.refused && outcome.judgement.verdict == Grade::good;
    harmful += !outcome.refused && times >= 3.0 ? 1 : 0;
    good += is_good ? 1 : 0;
    std::printf("%-12s %-28s %-14s %8.3f mm %7.1f times  %s\n", right.name.c_str(), mutation.name,
                outcome.refused ? "refused" : to_string(outcome.judgement.verdict).data(),
                1e3 * outcome.error, times,
                outcome.judgement.reasons.empty()
                    ? ""
                    : outcome.judgement.reasons.front().substr(0, 150).c_str());
    const std::string key = right.name + " " + mutation.name;
    if (undetectable().contains(key)) continue;
    EXPECT_FALSE(is_good && times >= 3.0) << key << ": " << times << " times the error, and good";
  }
  std::printf("%s: %zu wrong inputs, %d harmful, %d called good\n", right.name.c_str(),
              mutations().size(), harmful, good);
}

INSTANTIATE_TEST_SUITE_P(OnRealRobots, HarmfulInputs,
                         testing::Values("ur5", "ur5_offsets", "panda", "kuka"),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace kinecal
