// What is said of real data: models that are compared by held-out error, and parameters to hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kinecal/files/results/result_files.hpp"
#include "kinecal/trust.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/redrawn.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using test::calibrate_files;
using test::Calibrated;
using test::data_folder;

std::vector<Sample> samples_of(const std::filesystem::path& file) {
  Diagnostics diagnostics;
  return read_samples(file.string(), diagnostics);
}

Assessment assessed(const Calibrated& calibrated) {
  return assess(calibrated.calibration, calibrated.result, calibrated.samples).back();
}

/// Root of the mean squared distance on other samples at the values of a calibration, millimetres.
double error_on(const Calibrated& calibrated, const std::filesystem::path& config,
                const std::vector<Sample>& samples) {
  Diagnostics diagnostics;
  const Config read = read_config(config.string(), diagnostics);
  const Calibration other = assemble(read, calibrated.robot, samples, diagnostics);
  const Eigen::VectorXd values = calibrated.result.table.values();
  const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
  return 1e3 * block_statistics(*other.steps[0].problem, all, all)[0].after.rms;
}

TEST(RealResults, TheFullModelOfTheUr5IsBestOnHeldOutPoses) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto folder = data_folder() / "ur5_tracker";
  const std::vector<Sample> random = samples_of(folder / "random.yaml");
  std::printf(
      "UR5 and tracker, mm    parameters  fitted (grid)  held out (5 folds)  random poses\n");
  double before_folds = 1e300, before_random = 1e300;
  for (const char* config : {"base_tool.yaml", "offsets.yaml", "full.yaml"}) {
    const Calibrated grid =
        calibrate_files(folder / "ur5.urdf", folder / config, folder / "grid.yaml");
    ASSERT_TRUE(grid.result.converged) << grid.result.termination;
    const Assessment found = assessed(grid);
    const double held_out = 1e3 * found.held_out[0].held_out;
    const double on_random = error_on(grid, folder / config, random);
    std::printf("%-22s %11d %14.4f %19.4f %13.4f\n", config, found.uncertainty.determined,
                1e3 * found.held_out[0].fitted, held_out, on_random);
    EXPECT_NEAR(1e3 * found.held_out[0].fitted, grid.rms_mm(), 1e-6);
    EXPECT_LT(held_out, 0.9 * before_folds) << config;
    EXPECT_LT(on_random, 0.9 * before_random) << config;
    before_folds = held_out;
    before_random = on_random;
  }
  EXPECT_NEAR(before_random, 0.104237, 2e-5);  // the reference
}

struct Region {
  const char* folder;
  const char* train;
  std::vector<const char*> others;
};

TEST(RealResults, ThePandaIsBetterInRegionsThatWereNotFittedThanItsDrawing) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const auto data = data_folder() / "mukca_panda";
  const std::string text = test::text_of(data / "panda.urdf");
  std::printf("Panda, mm: fitted, held out (5 folds), other regions\n");
  for (const Region& region :
       {Region{"panda_6", "front", {"left", "right"}},
        Region{
            "panda_2", "front_center", {"front_left", "front_right", "mid-high", "back_left"}}}) {
    const auto folder = data / region.folder;
    for (const char* config : {"stable.yaml", "minimal.yaml", "frames.yaml"}) {
      const Calibrated train = calibrate_files(data / "panda.urdf", folder / config,
                                               folder / (std::string(region.train) + ".yaml"));
      const HeldOutError error = assessed(train).held_out[0];
      std::printf("  %s %-13s %8.4f %8.4f ", region.folder, config, 1e3 * error.fitted,
                  1e3 * error.held_out);
      EXPECT_LT(error.held_out, 1.5 * error.fitted);
      const Robot robot = parse_urdf(
          patch_urdf(text, "panda.urdf", train.robot,
                     joint_patches(train.robot, train.result.table), OffsetStyle::origin),
          "calibrated.urdf");
      for (const std::string other : region.others) {
        const auto fixture = folder / (other + "_fixture.yaml");
        const std::vector<Sample> samples = samples_of(folder / (other + ".yaml"));
        const double drawing =
            test::calibrate_samples(read_urdf((data / "panda.urdf").string()), fixture, samples)
                .rms_mm();
        const double calibrated = test::calibrate_samples(robot, fixture, samples).rms_mm();
        std::printf(" %s %.4f (drawing %.3f)", other.c_str(), calibrated, drawing);
        EXPECT_LT(calibrated, 0.2 * drawing) << other;
      }
      std::printf("\n");
    }
  }
}

/// The cost without the parameters that are named as a set to hold, and how many they are.
std::pair<std::size_t, double> without_what_is_to_be_held(const Calibrated& all) {
  const CalibrationStep& step = all.calibration.steps.back();
  const Eigen::VectorXd values = all.result.table.values();
  const Observability found = observability(
      *step.problem, step.free, {values.data(), static_cast<std::size_t>(values.size())});
  std::vector<int> kept = step.free.parameters();
  std::erase_if(kept, [&](int p) {
    return std::find(found.hold.begin(), found.hold.end(), p) != found.hold.end();
  });
  Eigen::VectorXd start = all.calibration.table.values();
  for (const int p : kept) {  // virtual frames start where they were found
    if (!all.robot.has_joint(step.problem->owners()[static_cast<std::size_t>(p)])) {
      start(p) = values(p);
    }
  }
  const StepResult held = solve(*step.problem, FreeSet(kept, all.calibration.table.size()), start);
  EXPECT_TRUE(held.converged) << held.termination;
  return {found.hold.size(), held.final_cost};
}

TEST(RealResults, ASetOf24ParametersOfTheUr5CanBeHeldAtTheSameCost) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto folder = data_folder() / "ur5_tracker";
  const std::vector<Sample> all = samples_of(folder / "grid.yaml");
  const auto step = static_cast<std::size_t>(1000 / test::repetitions(1000, 250));
  std::vector<Sample> samples;  // of all parts of the grid
  for (std::size_t i = 0; i < all.size(); i += step) samples.push_back(all[i]);
  const Calibrated grid = test::calibrate_samples(read_urdf((folder / "ur5.urdf").string()),
                                                  folder / "redundant.yaml", samples);
  const auto [count, cost] = without_what_is_to_be_held(grid);
  std::printf("UR5, redundant.yaml: %zu of 51 parameters to hold; cost %.12e, held %.12e\n", count,
              grid.cost(), cost);
  EXPECT_EQ(count, 24u);
  EXPECT_NEAR(cost / grid.cost(), 1.0, 1e-9);
}

TEST(RealResults, ASetOf21ParametersOfThePandaCanBeHeldAtTheSameCost) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const auto data = data_folder() / "mukca_panda";
  const Calibrated front = calibrate_files(data / "panda.urdf", data / "panda_6/redundant.yaml",
                                           data / "panda_6/front.yaml");
  const auto [count, cost] = without_what_is_to_be_held(front);
  std::printf("Panda, redundant.yaml: %zu of 51 parameters to hold; cost %.12e, held %.12e\n",
              count, front.cost(), cost);
  EXPECT_EQ(count, 21u);  // rank 30, of an independent implementation
  EXPECT_NEAR(cost / front.cost(), 1.0, 1e-9);
}

constexpr const test::RecordingKind& kUr5 = test::kRecordingKinds[0];

TEST(RealResults, HoldForOtherSamplesOfTheSameRecording) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const int draws = test::repetitions(40, 4);
  int alarms = 0;
  for (int draw = 0; draw < draws; ++draw) {
    alarms += test::Redrawn(kUr5, static_cast<unsigned>(draw)).check(0.05).holds ? 0 : 1;
  }
  EXPECT_LE(alarms, test::binomial_band(draws, 0.05, 1e-3).most);
}

TEST(RealResults, AReflectorBumpedByAMillimetreIsNamedAlongAnyAxis) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const int draws = test::repetitions(12, 3);
  for (int draw = 0; draw < draws; ++draw) {
    test::Redrawn redrawn(kUr5, static_cast<unsigned>(100 + draw));
    for (Sample& sample : redrawn.fresh) {
      sample.observations[0].features[0].point(draw % 3) -= 1e-3;  // of the arm's: in the tool
    }
    const Drift drift = redrawn.check(0.01);
    ASSERT_FALSE(drift.holds);
    const auto named = std::find_if(
        drift.movers.begin(), drift.movers.begin() + drift.alike, [](const Mover& mover) {
          return mover.owner == "smr" ||
                 std::find(mover.same.begin(), mover.same.end(), "smr") != mover.same.end();
        });
    ASSERT_NE(named, drift.movers.begin() + drift.alike) << drift.movers.front().owner;
    ASSERT_GE(named->change.size(), 3u);  // x, y, z, and turns: the point is 1 mm beside its frame
    EXPECT_TRUE(named->explains);
    EXPECT_NEAR(std::hypot(named->change[0], named->change[1], named->change[2]), 1e-3, 3e-4);
  }
}

}  // namespace
}  // namespace kinecal
