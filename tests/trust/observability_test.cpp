#include "kinecal/trust/observability.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "kinecal/errors.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

Observability of(const test::Calibrated& c) {
  const Eigen::VectorXd values = c.result.table.values();
  const CalibrationStep& step = c.calibration.steps[0];
  return observability(step.problem, step.free,
                       {values.data(), static_cast<std::size_t>(values.size())});
}

/// The factor of a parameter in a combination, 0 if it is not in it.
double factor(const Combination& combination, int parameter) {
  const auto it = std::find_if(combination.begin(), combination.end(),
                               [&](const auto& entry) { return entry.first == parameter; });
  return it == combination.end() ? 0.0 : it->second;
}

/// Rank, condition and the two directions that the independent implementation found.
TEST(Observability, FindsTheTwoDirectionsThatFetchCannotTell) {
  KINECAL_NEEDS_DATA("fetch");
  const auto folder = test::data_folder() / "fetch/synth";
  const auto fetch = test::calibrate_files(folder / "fetch_arm_head.urdf",
                                           folder / "calibrate.yaml", folder / "samples.yaml");
  const Observability found = of(fetch);
  EXPECT_EQ(found.rank, 24);
  ASSERT_EQ(found.unobservable.size(), 2u);
  const auto has = [&](const char* one, const char* other, double ratio) {
    const int a = fetch.result.table.index(one), b = fetch.result.table.index(other);
    return std::any_of(found.unobservable.begin(), found.unobservable.end(), [&](const auto& c) {
      return factor(c, a) != 0.0 && std::abs(factor(c, b) / factor(c, a) - ratio) < 0.01;
    });
  };
  EXPECT_TRUE(has("head_tilt_joint", "head_camera_rgb_joint_b", -1.0));
  EXPECT_TRUE(has("shoulder_pan_joint", "head_pan_joint_c", 1.0));
}

struct RankCase {
  const char *urdf, *config, *samples;
  int rank;
  double condition;
};

TEST(Observability, HasTheRankAndConditionOfTheReference) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  KINECAL_NEEDS_DATA("mukca_panda");
  for (const RankCase& c : {
           RankCase{"ur5_tracker/ur5.urdf", "ur5_tracker/base_tool.yaml", "ur5_tracker/grid.yaml",
                    9, 0},
           RankCase{"ur5_tracker/ur5.urdf", "ur5_tracker/full.yaml", "ur5_tracker/grid.yaml", 25,
                    97},
           RankCase{"ur5_tracker/ur5.urdf", "ur5_tracker/weak.yaml", "ur5_tracker/grid.yaml", 27,
                    1.7e5},
           RankCase{"ur5_tracker/ur5.urdf", "ur5_tracker/redundant.yaml", "ur5_tracker/grid.yaml",
                    27, 0},
           RankCase{"mukca_panda/panda.urdf", "mukca_panda/panda_6/minimal.yaml",
                    "mukca_panda/panda_6/front.yaml", 30, 377},
           RankCase{"mukca_panda/panda.urdf", "mukca_panda/panda_2/minimal.yaml",
                    "mukca_panda/panda_2/front_center.yaml", 30, 4963},
           RankCase{"mukca_panda/panda.urdf", "mukca_panda/panda_2/stable.yaml",
                    "mukca_panda/panda_2/front_center.yaml", 28, 141},
       }) {
    const auto data = test::data_folder();
    const auto calibrated = test::calibrate_files(data / c.urdf, data / c.config, data / c.samples);
    const Observability found = of(calibrated);
    EXPECT_EQ(found.rank, c.rank) << c.config;
    if (c.condition > 0) {
      EXPECT_NEAR(found.condition / c.condition, 1.0, 0.02) << c.config;
    }
  }
}

/// A combination that cannot be told changes no residual, however far one goes along it.
TEST(Observability, ResidualsDoNotChangeAlongWhatCannotBeTold) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, {});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  for (const Sample& s : test::exact_samples(problem, zero, 30)) problem.add_sample(s);
  std::vector<int> offsets;
  for (const char* name : {"torso_joint", "shoulder_pan", "head_pan", "elbow", "head_pan_z"}) {
    offsets.push_back(problem.table().index(name));
  }
  const Observability found =
      observability(problem, FreeSet(offsets, problem.table().size()), zero);
  // The torso carries arm and head alike; both pans turn about parallel axes, but not the same one.
  EXPECT_EQ(found.rank, 4);
  ASSERT_EQ(found.unobservable.size(), 1u);
  ASSERT_EQ(found.unobservable[0].size(), 1u);
  EXPECT_EQ(problem.table()[found.unobservable[0][0].first].name, "torso_joint");
}

}  // namespace
}  // namespace kinecal
