#include "kinecal/procedure/calibrate_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/arm_scene.hpp"
#include "support/mesh_robot_test.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// A log of the arm in three files of different size.
struct ArmLog {
  explicit ArmLog(int count) : samples(test::arm_samples(robot, count)) {
    for (Sample& sample : samples) {
      sample.source = "x.yaml:" + std::to_string(&sample - samples.data() + 1);
    }
  }

  [[nodiscard]] CalibrationSetup setup() const {
    Diagnostics found;
    return {.robot = robot,
            .config = parse_config(test::kArmConfig, "calibrate.yaml", found),
            .urdf_text = test::kArmUrdf,
            .urdf = "arm.urdf"};
  }
  /// @param order  in which the files a, b, c are given
  [[nodiscard]] CalibratedRobot calibrate(std::vector<int> order, int draw = 3000) {
    RecordedLog log;
    for (const int file : order) log.names.push_back(std::string(1, static_cast<char>('a' + file)));
    log.read = [this, order](int file) {
      ++reads;
      const int of = order[static_cast<std::size_t>(file)];
      const auto at = [&](int part) {
        return samples.begin() + std::ssize(samples) * std::array{0, 2, 3, 8}[part] / 8;
      };
      return std::vector<Sample>(at(of), at(of + 1));
    };
    CalibrationOptions options;
    options.draw = draw;
    return calibrate_log(prepare_log(setup(), log, options), options);
  }
  [[nodiscard]] CalibratedRobot at_once() const {
    CalibrationSetup all = setup();
    all.samples = samples;
    return calibrate_robot(std::move(all));
  }

  Robot robot = parse_urdf(test::kArmUrdf, "arm.urdf");
  std::vector<Sample> samples;
  int reads = 0;
};

void expect_same_values(const CalibratedRobot& a, const CalibratedRobot& b) {
  ASSERT_EQ(a.result.table.size(), b.result.table.size());
  for (int i = 0; i < a.result.table.size(); ++i) {
    EXPECT_EQ(a.result.table[i].value, b.result.table[i].value) << a.result.table[i].name;
  }
  EXPECT_EQ(a.judgement.reasons, b.judgement.reasons);
}

TEST(CalibrateLog, OfFewSamplesIsACalibrationOfAllAtOnceInAnyOrderOfFiles) {
  ArmLog log(80);
  const CalibratedRobot once = log.at_once();
  EXPECT_EQ(once.judgement.verdict, Grade::good);
  for (const std::vector<int>& order : {std::vector{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}) {
    const CalibratedRobot by_log = log.calibrate(order);
    expect_same_values(once, by_log);
    EXPECT_EQ(by_log.drawn, 0);
  }
}

TEST(CalibrateLog, IsSolvedOnAllSamplesAndJudgedOnADraw) {
  ArmLog log(400);
  const CalibratedRobot once = log.at_once(), drawn = log.calibrate({2, 0, 1}, 60);
  EXPECT_EQ(drawn.drawn, 60);
  EXPECT_EQ(drawn.result.steps.back().samples, 400);
  EXPECT_EQ(drawn.judgement.verdict, once.judgement.verdict);
  for (const int p : once.result.calibrated) {
    const double deviation = *once.deviation(p);
    EXPECT_NEAR(drawn.result.table[p].value, once.result.table[p].value, 1e-3 * deviation)
        << once.result.table[p].name;
    EXPECT_NEAR(*drawn.deviation(p) / deviation, 1.0, 0.3);
  }
  // Evenly from all files: at most one sample of each seven is skipped more than its neighbours.
  std::vector<int> numbers = drawn.numbers;
  ASSERT_EQ(numbers.size(), 60u);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  for (std::size_t i = 1; i < numbers.size(); ++i) EXPECT_LE(numbers[i] - numbers[i - 1], 14);
  expect_same_values(drawn, log.calibrate({0, 1, 2}, 60));
}

TEST(CalibrateLog, LeavesOutABadSampleThatTheDrawDoesNotHave) {
  ArmLog log(400);
  const CalibratedRobot right = log.calibrate({0, 1, 2}, 60);
  const auto is_drawn = [&](int number) {
    const std::vector<int>& numbers = right.numbers;
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
  };
  int bad = 200;
  while (is_drawn(bad)) ++bad;
  for (Feature& feature : log.samples[static_cast<std::size_t>(bad - 1)].observations[1].features) {
    feature.point.x() += 0.03;
  }
  const CalibratedRobot calibrated = log.calibrate({0, 1, 2}, 60);
  ASSERT_EQ(calibrated.left_out.size(), 1u);
  EXPECT_EQ(calibrated.left_out[0].number, bad);
  EXPECT_THAT(calibrated.left_out[0].why, HasSubstr("30 mm off"));
  EXPECT_EQ(calibrated.result.steps.back().samples, 399);
  for (const int p : right.result.calibrated) {
    EXPECT_NEAR(calibrated.result.table[p].value, right.result.table[p].value,
                0.3 * *right.deviation(p));
  }
}

TEST(CalibrateLog, RefusesWhatCalibrateRefusesInTheSameWords) {
  ArmLog log(80);
  for (Sample& sample : log.samples) sample.joint_names[1] = "liftt";
  std::string at_once, of_log;
  try {
    (void)log.at_once();
  } catch (const InputError& error) {
    at_once = error.what();
  }
  try {
    (void)log.calibrate({1, 0, 2});
  } catch (const InputError& error) {
    of_log = error.what();
  }
  EXPECT_THAT(at_once, HasSubstr("liftt"));
  EXPECT_EQ(at_once, of_log);
}

TEST(CalibrateLog, OfAMobileBaseIsRefused) {
  Diagnostics found;
  CalibrationSetup setup{
      .robot = test::mobile_manipulator(),
      .config = parse_config("base_link: base_link\nmodels: []\nfree_params: [base_rollout_scale]\n"
                             "error_blocks: [{name: base, type: odometry_to_pose}]\n",
                             "base.yaml", found)};
  RecordedLog log{.names = {"a"}, .read = [](int) { return std::vector<Sample>(40); }};
  EXPECT_THAT(
      test::thrown<InputError>([&] { (void)prepare_log(std::move(setup), std::move(log), {}); }),
      HasSubstr("take all samples at once: use 'kinecal calibrate'"));
}

TEST(CalibrateLog, NamesTheSampleOfAFileThatIsWrong) {
  ArmLog log(400);
  log.samples[390].joint_names[1] = "liftt";
  EXPECT_THAT(test::thrown<InputError>([&] {
                (void)log.calibrate({0, 1, 2}, 60);
              }),
              HasSubstr("x.yaml:391"));
}

/// Logs of an arm that is its own target, in three files.
class LogOfASurface : public test::MeshRobotTest {
 protected:
  CalibratedRobot calibrate(int draw) {
    RecordedLog log{.names = {"a", "b", "c"}};
    log.read = [this](int file) {
      const auto at = [&](int part) { return samples_.begin() + std::ssize(samples_) * part / 3; };
      return std::vector<Sample>(at(file), at(file + 1));
    };
    CalibrationOptions options;
    options.draw = draw;
    return calibrate_log(prepare_log(setup_of(config_), log, options), options);
  }
  CalibratedRobot at_once() {
    CalibrationSetup all = setup_of(config_);
    all.samples = samples_;
    return calibrate_robot(std::move(all));
  }
  /// @param within  standard deviations
  void expect_alike(const CalibratedRobot& log, const CalibratedRobot& once, double within) {
    ASSERT_FALSE(once.result.calibrated.empty());
    for (const int p : once.result.calibrated) {
      EXPECT_NEAR(log.result.table[p].value, once.result.table[p].value,
                  within * *once.deviation(p))
          << once.result.table[p].name;
    }
  }

  std::string config_ = test::mesh_config("", "", "lift, elbow");  // nor is a start known
  std::vector<Sample> samples_ = test::mesh_robot_samples(
      parse_urdf(urdf_, "arm.urdf"),
      {.samples = 24, .pixels = 40, .noise = 0.001, .offsets = {{"lift", 0.02}, {"elbow", -0.03}}});
};

TEST_F(LogOfASurface, IsAssociatedAsACalibrationIs) {
  const CalibratedRobot once = at_once(), whole = calibrate(3000), drawn = calibrate(9);
  EXPECT_EQ(whole.drawn, 0);
  EXPECT_EQ(drawn.drawn, 9);
  EXPECT_EQ(drawn.result.steps.back().samples, 24);
  expect_alike(whole, once, 0.0);
  expect_alike(drawn, once, 0.3);  // what belongs together is found where the draw puts the arm
  EXPECT_NEAR(drawn.result.table["lift"].value, 0.02, 1e-3);
  EXPECT_NEAR(drawn.result.table["elbow"].value, -0.03, 1e-3);
}

/// Sample 14 is in the second file, and not drawn.
TEST_F(LogOfASurface, LeavesOutACloudThatTheDrawDidNotSee) {
  for (Feature& point : samples_[13].observations[0].features) point.point.z() += 0.008;
  const CalibratedRobot once = at_once(), drawn = calibrate(8);
  ASSERT_EQ(once.left_out.size(), 1U);
  EXPECT_EQ(once.left_out[0].number, 14);
  ASSERT_EQ(std::ranges::count(drawn.numbers, 14), 0);
  ASSERT_EQ(drawn.left_out.size(), 1U);
  EXPECT_EQ(drawn.left_out[0].number, 14);
  EXPECT_NEAR(drawn.result.table["lift"].value, 0.02, 1e-3);
}

TEST_F(LogOfASurface, NamesAFileOfSomethingElse) {
  for (std::size_t s = 8; s < 16; ++s) {
    for (Feature& point : samples_[s].observations[0].features) point.point.x() += 0.4;
  }
  EXPECT_THAT(test::thrown<InputError>([&] { (void)calibrate(6); }), HasSubstr("the robot"));
}

}  // namespace
}  // namespace kinecal
