// Monte Carlo: how often the 95 % interval of a parameter, and of the gripper's position in the
// camera's frame, covers the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/interval_coverage.hpp"
#include "support/repetitions.hpp"
#include "support/simulated.hpp"

namespace kinecal {
namespace {

using test::Simulated, test::student;

TEST(Student, IsThatOfTheTables) {
  EXPECT_NEAR(student(10.0), 2.228, 3e-3);
  EXPECT_NEAR(student(35.0), 2.030, 1e-3);
  EXPECT_NEAR(student(1e9), 1.960, 1e-3);
}

/// Calibrates samples of a configuration and assesses the result.
struct Calibrated {
  CalibrationResult result;
  Assessment found;
};

Calibrated solve_and_assess(const Calibration& calibration, const std::vector<Sample>& samples) {
  SolveOptions solving;
  solving.threads = 1;
  Calibrated once{calibrate(calibration, {}, solving), {}};
  EXPECT_TRUE(once.result.converged) << once.result.termination;
  once.found = assess(calibration, once.result, samples, {.folds = 0}).back();
  return once;
}

Calibrated calibrate_once(const Simulated& simulated, const std::vector<Sample>& samples) {
  return solve_and_assess(simulated.calibration(samples), samples);
}

/// The same with the noise of each block in place of its sigma, as calibrate_and_judge() does.
Calibrated calibrate_with_estimates(const Simulated& simulated,
                                    const std::vector<Sample>& samples) {
  Calibration calibration = simulated.calibration(samples);
  Calibrated once = solve_and_assess(calibration, samples);
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t b = 0; b < once.found.noise.size(); ++b) {
      calibration.steps.back().set_sigma(static_cast<int>(b), once.found.noise[b].robust);
    }
    once = solve_and_assess(calibration, samples);
  }
  return once;
}

using Calibrate = std::function<Calibrated(const Simulated&, const std::vector<Sample>&)>;

/// How often each interval covers the truth.
class Coverage {
 public:
  Coverage(const Simulated& simulated, const Calibrate& calibrate, int runs)
      : simulated_(simulated), runs_(std::max(2, runs)) {
    const Calibration calibration = simulated.calibration(simulated.exact);
    const FreeSet& free = calibration.steps.back().free;
    find_poses(calibration.table, free);
    for (int run = 0; run < runs_; ++run) {
      const auto seed = static_cast<std::uint64_t>(run) + 1000;
      add(calibrate(simulated, simulated.samples(seed)));
    }
  }

  /// Checks the counts and prints them.
  void check() const {
    const test::Band band = test::binomial_band(runs_, kShare, kTail);
    int least = runs_, most = 0;
    std::string worst;
    for (const auto& [name, covered] : covered_) {
      EXPECT_TRUE(band.contains(covered)) << name << ": " << covered << " of " << runs_;
      if (covered < least) worst = name;
      least = std::min(least, covered);
      most = std::max(most, covered);
    }
    const Mean mean = mean_of(shares_), of_position = position_error_over_stated();
    std::printf(
        "%s: %d calibrations, %zu intervals: %.2f +- %.2f %% cover the truth, the least %d times "
        "(%s), the most %d (chance: %d to %d); errors of position / stated: %.3f +- %.3f\n",
        simulated_.name.c_str(), runs_, covered_.size(), 100.0 * mean.value, 100.0 * mean.deviation,
        least, worst.c_str(), most, band.least, band.most, of_position.value,
        of_position.deviation);
    testing::Test::RecordProperty("coverage", std::to_string(mean.value));
    testing::Test::RecordProperty("position_error_over_stated", std::to_string(of_position.value));
    EXPECT_NEAR(mean.value, kShare, kSigmas * mean.deviation);
    EXPECT_NEAR(of_position.value, 1.0, kSigmas * of_position.deviation);
  }

 private:
  static constexpr double kShare = 0.95;
  // The counts of all tests together, some 200, are within the binomial band by chance but for once in
  // 250 times; seeds are fixed.  Of 500 it is 452 to 493 (90.4 to 98.6 %), of 150 it is 129 to 150, of 20
  // it is 13 to 20: 20 calibrations find only an interval that is much too short.
  static constexpr double kTail = 1e-5;
  static constexpr double kSigmas = 4.0;  // of a mean over the calibrations

  /// A mean over the calibrations, and its standard deviation as they scatter.
  struct Mean {
    double value = 0.0, deviation = 0.0;
  };
  [[nodiscard]] static Mean mean_of(const std::vector<double>& numbers) {
    const auto n = static_cast<double>(numbers.size());
    Mean mean;
    for (const double x : numbers) mean.value += x / n;
    for (const double x : numbers) mean.deviation += (x - mean.value) * (x - mean.value);
    mean.deviation = std::sqrt(mean.deviation / (n * (n - 1.0)));
    return mean;
  }
  /// Root of the ratio of two means, to first order.
  [[nodiscard]] Mean position_error_over_stated() const {
    const double variance = mean_of(variances_).value;
    const double ratio = mean_of(squares_).value / variance;
    std::vector<double> differences;
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      differences.push_back((squares_[i] - ratio * variances_[i]) / variance);
    }
    const double root = std::sqrt(ratio);
    return {root, 0.5 * mean_of(differences).deviation / root};
  }

  /// Poses at which the gripper's position is asked for, and its derivative there.
  void find_poses(const ParameterTable& table, const FreeSet& free) {
    truth_ = simulated_.truth_of(table);
    const std::size_t step = std::max<std::size_t>(1, simulated_.exact.size() / 4);
    for (std::size_t i = 0; i < simulated_.exact.size() && poses_.size() < 4; i += step) {
      const Sample& sample = simulated_.exact[i];
      Eigen::MatrixXd jacobian(3, free.size());
      for (int c = 0; c < free.size(); ++c) {
        constexpr double kStep = 1e-6;
        Eigen::VectorXd above = truth_, below = truth_;
        above(free.parameters()[static_cast<std::size_t>(c)]) += kStep;
        below(free.parameters()[static_cast<std::size_t>(c)]) -= kStep;
        jacobian.col(c) = (simulated_.gripper_in_camera(table, sample, above) -
                           simulated_.gripper_in_camera(table, sample, below)) /
                          (2.0 * kStep);
      }
      poses_.push_back({&sample, jacobian});
    }
  }

  void add(const Calibrated& once) {
    const Assessment& found = once.found;
    double freedom = 0.0;
    for (const BlockNoise& noise : found.noise) freedom += noise.freedom;
    const double width = student(freedom);
    const ParameterTable& table = once.result.table;
    int intervals = 0, hits = 0;
    const auto count = [&](const std::string& name, double error, double deviation) {
      const int hit = std::abs(error) <= width * deviation ? 1 : 0;
      covered_[name] += hit;
      hits += hit;
      ++intervals;
    };
    for (std::size_t c = 0; c < found.parameters.size(); ++c) {
      const double deviation = found.uncertainty.deviation(static_cast<Eigen::Index>(c));
      const Parameter& parameter = table[found.parameters[c]];
      if (!std::isfinite(deviation)) continue;
      count(parameter.name, parameter.value - truth_(found.parameters[c]), deviation);
    }
    const Eigen::VectorXd values = table.values();
    const Eigen::MatrixXd covariance = found.uncertainty.covariance.matrix();
    for (std::size_t p = 0; p < poses_.size(); ++p) {
      const auto& [sample, jacobian] = poses_[p];
      const Vector3<double> error = simulated_.gripper_in_camera(table, *sample, values) -
                                    simulated_.gripper_in_camera(table, *sample, truth_);
      const Eigen::Matrix3d variance = jacobian * covariance * jacobian.transpose();
      for (int k = 0; k < 3; ++k) {
        count("gripper at pose " + std::to_string(p) + " " + "xyz"[k], error(k),
              std::sqrt(variance(k, k)));
      }
    }
    shares_.push_back(static_cast<double>(hits) / intervals);
    ASSERT_TRUE(!found.compared.empty());
    double squares = 0.0;
    for (const Sample& sample : simulated_.exact) {
      squares += (simulated_.gripper_in_camera(table, sample, values) -
                  simulated_.gripper_in_camera(table, sample, truth_))
                     .squaredNorm();
    }
    squares_.push_back(squares / static_cast<double>(simulated_.exact.size()));
    variances_.push_back(found.compared[0].position * found.compared[0].position);
  }

  const Simulated& simulated_;
  int runs_;
  Eigen::VectorXd truth_;
  std::vector<std::pair<const Sample*, Eigen::MatrixXd>> poses_;
  std::map<std::string, int> covered_;
  // Of each calibration:
  std::vector<double> shares_;               ///< of the intervals that cover the truth
  std::vector<double> squares_, variances_;  ///< of positions: errors, and as stated
};

int runs() {
  return test::repetitions_of_study(500, test::kIsSlow ? 20 : 150);
}

TEST(Coverage, OfTheFetchAndItsLeds) {
  const Simulated fetch = test::fetch_and_leds();
  Coverage(fetch, calibrate_once, runs()).check();
}

TEST(Coverage, OfTheFetchWithARobustLossAndOutliers) {
  Simulated fetch = test::fetch_and_leds();
  fetch.name += ", outliers, Huber";
  fetch.outliers = 0.1;
  BlockConfig& block = fetch.config.steps.front().error_blocks.front();
  block.sigma = fetch.sigma;
  block.loss = {"huber", 2.0};
  Coverage(fetch, calibrate_once, runs()).check();
}

TEST(Coverage, OfTheFetchItsLedsAndTheFloorWithSigmasThatAreEstimated) {
  Simulated fetch = test::fetch_and_leds(60, 10);
  fetch.name += " and the floor, estimated sigmas";
  const int some = test::kIsSlow ? 8 : 60;
  Coverage(fetch, calibrate_with_estimates, test::repetitions_of_study(500, some)).check();
}

TEST(Coverage, OfAnArmAndATrackerAtTwentyPoses) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const Simulated ur5 = test::ur5_and_tracker();
  Coverage(ur5, calibrate_once, runs()).check();
}

TEST(Coverage, OfACameraAndABoard) {
  const Simulated board = test::camera_and_board();
  Coverage(board, calibrate_once, runs()).check();
}

TEST(Coverage, OfACameraAndABoardWithARobustLoss) {
  Simulated board = test::camera_and_board();
  board.name += ", outliers, Cauchy";
  board.outliers = 0.1;
  board.config.steps.front().error_blocks.front().sigma = board.sigma;
  board.config.steps.front().error_blocks.front().loss = {"cauchy", 2.4};
  Coverage(board, calibrate_once, runs()).check();
}

}  // namespace
}  // namespace kinecal
