// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/tell_apart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "kinecal/config/assemble.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/study/sample_design.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/study/select_poses.hpp"
#include "kinecal/tools/identify/open_config.hpp"
#include "support/error_of.hpp"
#include "support/paths.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// A UR5e whose tracker has seen its shoulder between 0.1 and 0.9 rad.
class TellApart : public testing::Test {
 protected:
  TellApart() {
    SeededRandom random(5);
    for (int i = 0; i < 150; ++i) {
      Sample& sample = samples_.emplace_back();
      for (const Joint& joint : robot_.joints()) {
        if (!moves(joint.type)) continue;
        sample.joint_names.push_back(joint.name);
        sample.joint_positions.push_back(joint.name == "shoulder_lift_joint"
                                             ? 0.5 + 0.15 * random.normal()
                                             : random.uniform(-2.0, 2.0));
      }
      sample.observations = {{"arm", {{"smr", Vector3<double>::Zero()}}},
                             {"tracker", {{"tracker_frame", random.normal_vector()}}}};
    }
    config_ = config_from_samples(robot_, samples_);
  }
  [[nodiscard]] Explanations freed(const std::string& a, const std::string& b) const {
    return free_explanations(config_, robot_, samples_, {a, b});
  }

  Robot robot_ = read_urdf(test::source_folder() + "/examples/robots/ur5e/ur5e.urdf");
  std::vector<Sample> samples_;
  Config config_;
};

/// Two standard deviations, and the size of their correlation.
struct Known {
  double a = 0.0, b = 0.0, correlation = 0.0;
};

TEST_F(TellApart, ChosenPosesKnowAZeroAndAGearMuchBetterThanRandomOnes) {
  const Explanations both = freed("shoulder_lift_joint", "shoulder_lift_joint_gear_ratio");
  Diagnostics diagnostics;
  const Calibration calibration = assemble(both.config, robot_, samples_, diagnostics);
  ASSERT_THAT(diagnostics.errors, testing::IsEmpty());
  const CalibrationStep& step = calibration.steps.front();
  ParameterTable truth = calibration.table;
  for (const auto& [name, value] :
       {std::pair("tracker_frame_x", 1.5), std::pair("smr_z", 0.06), std::pair("smr_x", 0.02)}) {
    truth[name].value = value;
  }
  const Eigen::VectorXd values = truth.values();
  const ParameterValues at(values.data(), static_cast<std::size_t>(values.size()));
  const MakeProblem make = [&] { return step.problem->without_samples(); };
  const StudyDesign design =
      study_design(make, step.free, at, exact_samples(make, at, samples_), MeasurementNoise{});
  PoseCandidates candidates;
  for (const SampleDesign& sample : design.samples) {
    candidates.information.push_back(sample.information);
    candidates.scores.push_back(sample.scores);
  }
  const int a = step.free.column(truth.find("shoulder_lift_joint")),
            b = step.free.column(truth.find("shoulder_lift_joint_gear_ratio"));
  candidates.goal = goal_of_parameters(candidates, {a, b});
  const auto known = [&](const std::vector<int>& chosen) {
    const Eigen::MatrixXd c = expected_uncertainty(design, chosen).covariance.matrix();
    return Known{std::sqrt(c(a, a)), std::sqrt(c(b, b)),
                 std::abs(c(a, b)) / std::sqrt(c(a, a) * c(b, b))};
  };
  constexpr int kCount = 12;
  const Known chosen = known(select_poses(candidates, {.count = kCount}).chosen);
  std::vector<double> of_a, of_b;
  SeededRandom random(9);
  for (int set = 0; set < 101; ++set) {
    std::vector<int> some;
    while (std::ssize(some) < kCount) {
      const int pose = random.integer(0, static_cast<int>(samples_.size()) - 1);
      if (std::find(some.begin(), some.end(), pose) == some.end()) some.push_back(pose);
    }
    const Known of = known(some);
    of_a.push_back(of.a);
    of_b.push_back(of.b);
  }
  const auto median = [](std::vector<double>& all) {
    std::nth_element(all.begin(), all.begin() + 50, all.end());
    return all[50];
  };
  const double random_a = median(of_a), random_b = median(of_b);
  std::printf("zero: %.2g rad, of random poses %.2g; gear: %.2g, of random poses %.2g\n", chosen.a,
              random_a, chosen.b, random_b);
  EXPECT_LT(chosen.a, 0.6 * random_a);
  EXPECT_LT(chosen.b, 0.5 * random_b);
}

TEST_F(TellApart, FreesBothAndKeepsWhatIsFree) {
  const Explanations both = freed("elbow_joint_x", "wrist_1_joint_b");
  EXPECT_THAT(both.parameters[0], UnorderedElementsAre("elbow_joint_x"));
  EXPECT_THAT(both.parameters[1], UnorderedElementsAre("wrist_1_joint_b"));
  const auto names = [](const Config& config) {
    std::set<std::string> all;
    for (const auto& free : free_parameters(config.steps.front())) all.insert(free.name);
    return all;
  };
  const std::set<std::string> before = names(config_), after = names(both.config);
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
  EXPECT_EQ(after.size(), before.size() + 2);
  EXPECT_THAT(freed("elbow_joint", "elbow_joint_eccentric_sin").parameters[1],
              UnorderedElementsAre("elbow_joint_eccentric_sin", "elbow_joint_eccentric_cos"));
}

TEST_F(TellApart, RefusesNamesThatAreNone) {
  const auto message = [&](const std::string& a, const std::string& b) {
    return test::error_of([&] { (void)freed(a, b); });
  };
  EXPECT_THAT(message("elbow_jiont", "elbow_joint_x"),
              HasSubstr("'elbow_jiont' is not a candidate of 'kinecal identify'; did you mean "
                        "'elbow_joint'?"));
  EXPECT_THAT(message("elbow_joint", "elbow_joint"), HasSubstr("are the same"));
  EXPECT_THAT(message("tracker_frame_x", "elbow_joint"), HasSubstr("always free"));
}

}  // namespace
}  // namespace kinecal
