// The real data sets, against the figures of an independent implementation (data/README.md): costs
// and RMS, never raw parameters.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <random>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using test::calibrate_files;
using test::calibrate_samples;
using test::data_folder;

constexpr double kCostTolerance = 1e-6;  // relative; both solvers stop at their rounding
constexpr double kRmsTolerance = 1e-5;   // millimetres: the last digit of the reference figures

void expect_cost(double cost, double reference) {
  EXPECT_NEAR(cost / reference, 1.0, kCostTolerance) << cost << " against " << reference;
}

TEST(FetchSynth, ReachesTheReferenceCostFromTheUnmodifiedRos1File) {
  KINECAL_NEEDS_DATA("fetch");
  const auto folder = data_folder() / "fetch/synth";
  const auto fetch = calibrate_files(folder / "fetch_arm_head.urdf", folder / "calibrate.yaml",
                                     folder / "samples.yaml");
  const StepResult& step = fetch.result.steps[0];
  EXPECT_TRUE(fetch.result.converged) << fetch.result.termination;
  EXPECT_NEAR(step.initial_cost / 0.1016012191, 1.0, 1e-9);
  expect_cost(step.final_cost, 8.019441481e-4);
  EXPECT_EQ(step.num_parameters, 26);
  EXPECT_EQ(step.num_residuals, 100 * (12 + 7));
  EXPECT_NEAR(1e3 / std::sqrt(3.0) * fetch.result.blocks[0].before.rms, 13.012892, 1e-6);
  EXPECT_NEAR(1e3 / std::sqrt(3.0) * fetch.result.blocks[0].after.rms, 1.037741, 1e-6);
}

TEST(FetchSynth, TheTruthCostsWhatItShould) {
  KINECAL_NEEDS_DATA("fetch");
  const auto folder = data_folder() / "fetch/synth";
  auto fetch = calibrate_files(folder / "fetch_arm_head.urdf", folder / "calibrate.yaml",
                               folder / "samples.yaml");
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(fetch.result.table.size());
  for (const auto& line : YAML::LoadFile((folder / "truth.yaml").string())) {
    truth(fetch.result.table.index(line.first.as<std::string>())) = line.second.as<double>();
  }
  const double cost =
      normal_equations(*fetch.calibration.steps[0].problem,
                       {truth.data(), static_cast<std::size_t>(truth.size())}, nullptr)
          .cost;
  EXPECT_NEAR(cost / 1.036399372e-3, 1.0, 1e-9);
}

TEST(Fetch, OwnConfigurationsFitTheWholeRobot) {
  KINECAL_NEEDS_DATA("fetch");
  const Robot robot = read_urdf((data_folder() / "fetch/fetch.urdf").string());
  for (const char* name : {"fetch/calibrate.yaml", "fetch/calibrate_with_ground.yaml"}) {
    Diagnostics diagnostics;
    const Config config = read_config((data_folder() / name).string(), diagnostics);
    (void)assemble(config, robot, {}, diagnostics);
    EXPECT_TRUE(diagnostics.errors.empty()) << diagnostics.errors.front();
  }
}

TEST(Fetch, AFrameThatTheSamplesDoNotTouchKeepsItsValueWithAWarning) {
  KINECAL_NEEDS_DATA("fetch");
  const auto synth = data_folder() / "fetch/synth";
  const auto fetch =
      calibrate_files(synth / "fetch_arm_head.urdf", data_folder() / "fetch/calibrate.yaml",
                      synth / "samples.yaml");
  expect_cost(fetch.cost(), 8.019441481e-4);
  const auto& warnings = fetch.diagnostics.warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) {
    return w.find("'checkerboard'") != std::string::npos;
  }));
  EXPECT_EQ(fetch.result.table["checkerboard_x"].value, 0.0);
}

// UR5 and laser tracker: 1000 poses of a grid for the fit, 20 random ones held out.

struct TrackerCase {
  const char* config;
  double cost, grid_rms, random_rms;
};

class Ur5Tracker : public testing::TestWithParam<TrackerCase> {};

TEST_P(Ur5Tracker, ReachesTheReferenceOnTheGridAndOnPosesThatWereNotFitted) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const TrackerCase& expected = GetParam();
  const auto folder = data_folder() / "ur5_tracker";
  const auto grid =
      calibrate_files(folder / "ur5.urdf", folder / expected.config, folder / "grid.yaml");
  EXPECT_TRUE(grid.result.converged) << grid.result.termination;
  expect_cost(grid.cost(), expected.cost);
  EXPECT_NEAR(grid.rms_mm(), expected.grid_rms, kRmsTolerance);

  Diagnostics diagnostics;
  const auto random = read_samples((folder / "random.yaml").string(), diagnostics);
  const Config config = read_config((folder / expected.config).string(), diagnostics);
  const Calibration held_out = assemble(config, grid.robot, random, diagnostics);
  const Eigen::VectorXd values = grid.result.table.values();
  const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
  const double rms = block_statistics(*held_out.steps[0].problem, all, all)[0].after.rms * 1e3;
  EXPECT_NEAR(rms, expected.random_rms, 2 * kRmsTolerance);
}

INSTANTIATE_TEST_SUITE_P(
    Configurations, Ur5Tracker,
    testing::Values(TrackerCase{"base_tool.yaml", 2.459152229e-4, 0.701306, 0.560718},
                    TrackerCase{"offsets.yaml", 1.572936374e-4, 0.560881, 0.382203},
                    TrackerCase{"full.yaml", 6.233928757e-6, 0.111660, 0.104237},
                    TrackerCase{"weak.yaml", 6.231394249e-6, 0.111637, 0.104367},
                    TrackerCase{"redundant.yaml", 6.231394249e-6, 0.111637, 0.104367}),
    [](const auto& test) {
      const std::string name = test.param.config;
      return name.substr(0, name.find('.'));
    });

TEST(Ur5Tracker, RedundantParametersReachTheSameCostFromAnyOrderOfTheSamples) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto folder = data_folder() / "ur5_tracker";
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_samples((folder / "grid.yaml").string(), diagnostics);
  const Robot robot = read_urdf((folder / "ur5.urdf").string());
  std::mt19937 random(5);
  for (int order = 0; order < test::repetitions(3, 1); ++order) {
    std::shuffle(samples.begin(), samples.end(), random);
    const auto shuffled = calibrate_samples(robot, folder / "redundant.yaml", samples);
    EXPECT_TRUE(shuffled.result.converged) << shuffled.result.termination;
    expect_cost(shuffled.cost(), 6.231394249e-6);
  }
}

// Panda, a ball in two sockets: fitted in one region, held out in others.

struct PandaCase {
  const char* folder;
  const char* train;
  const char* config;
  double cost, train_rms;
  std::vector<std::pair<const char*, double>> held_out;  ///< region, fit RMS in mm
};

void PrintTo(const PandaCase& c, std::ostream* out) {
  *out << c.folder << "/" << c.config;
}

class MukcaPanda : public testing::TestWithParam<PandaCase> {};

TEST_P(MukcaPanda, WrittenUrdfReachesTheReferenceInRegionsThatWereNotFitted) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const PandaCase& expected = GetParam();
  const auto data = data_folder() / "mukca_panda", folder = data / expected.folder;
  const auto train = calibrate_files(data / "panda.urdf", folder / expected.config,
                                     folder / (std::string(expected.train) + ".yaml"));
  EXPECT_TRUE(train.result.converged) << train.result.termination;
  expect_cost(train.cost(), expected.cost);
  EXPECT_NEAR(train.rms_mm(), expected.train_rms, kRmsTolerance);

  const std::string text = test::text_of(data / "panda.urdf");
  const std::string calibrated =
      patch_urdf(text, "panda.urdf", train.robot, joint_patches(train.robot, train.result.table),
                 OffsetStyle::origin);
  const Robot robot = parse_urdf(calibrated, "calibrated.urdf");
  for (const auto& [region, rms] : expected.held_out) {
    Diagnostics diagnostics;
    const auto fit = calibrate_samples(
        robot, folder / (std::string(region) + "_fixture.yaml"),
        read_samples((folder / (std::string(region) + ".yaml")).string(), diagnostics));
    EXPECT_NEAR(fit.rms_mm(), rms, 2 * kRmsTolerance) << region;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Configurations, MukcaPanda,
    testing::Values(
        PandaCase{"panda_6",
                  "front",
                  "minimal.yaml",
                  1.169456536e-6,
                  0.194228,
                  {{"left", 0.260036}, {"right", 0.307303}}},
        PandaCase{"panda_6",
                  "front",
                  "stable.yaml",
                  1.263745341e-6,
                  0.201906,
                  {{"left", 0.270672}, {"right", 0.323136}}},
        PandaCase{"panda_6",
                  "front",
                  "frames.yaml",
                  1.356061661e-6,
                  0.195816,
                  {{"left", 0.264849}, {"right", 0.314274}}},
        PandaCase{"panda_2",
                  "front_center",
                  "minimal.yaml",
                  9.588253667e-7,
                  0.178776,
                  {{"front_left", 0.464333},
                   {"front_right", 0.483762},
                   {"mid-high", 0.440007},
                   {"back_left", 0.391221}}},
        PandaCase{"panda_2",
                  "front_center",
                  "stable.yaml",
                  9.678876781e-7,
                  0.179619,
                  {{"front_left", 0.466335},
                   {"front_right", 0.487140},
                   {"mid-high", 0.440450},
                   {"back_left", 0.390697}}},
        PandaCase{"panda_2",
                  "front_center",
                  "frames.yaml",
                  1.232490840e-6,
                  0.180012,
                  {{"front_left", 0.463258},
                   {"front_right", 0.451584},
                   {"mid-high", 0.429358},
                   {"back_left", 0.388347}}},
        PandaCase{"panda_6", "front", "redundant.yaml", 1.169456536e-6, 0.194228, {}},
        PandaCase{"panda_2", "front_center", "redundant.yaml", 9.588253667e-7, 0.178776, {}}));

}  // namespace
}  // namespace kinecal
