#include "kinecal/trust/uncertainty/uncertainty.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/solve/stack.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(Uncertainty, IsTheTextbookCovarianceOfOneBlock) {
  test::NoisyScene scene(30);
  const Assessment found = scene.solve_and_assess();
  const Eigen::VectorXd values = scene.values();
  const Stack rows = stack(scene.solved(), scene.free(), scene.span(values));
  const double variance = rows.residual.squaredNorm() / (360.0 - 10.0);
  const Eigen::MatrixXd expected = variance * rows.covariance().value();
  const Eigen::MatrixXd covariance = found.uncertainty.covariance.matrix();
  EXPECT_LT((covariance - expected).norm(), 1e-8 * expected.norm()) << covariance << "\n\n"
                                                                    << expected;
}

/// Share of 95 % intervals that contain the truth.
double coverage(const std::function<void(test::NoisyScene&, unsigned)>& change, int runs) {
  int inside = 0, all = 0;
  for (int run = 0; run < runs; ++run) {
    test::NoisyScene scene(25, static_cast<unsigned>(run));
    change(scene, static_cast<unsigned>(run));
    const Assessment found = scene.solve_and_assess();
    for (std::size_t c = 0; c < found.parameters.size(); ++c) {
      const int p = found.parameters[c];
      const double error = scene.result.table[p].value - scene.truth(p);
      inside += std::abs(error) < 1.96 * found.uncertainty.deviation(static_cast<int>(c));
      ++all;
    }
  }
  return static_cast<double>(inside) / all;
}

TEST(Uncertainty, CoversTheTruthInNineteenOfTwentyCases) {
  const double share = coverage([](test::NoisyScene&, unsigned) {}, 100);
  EXPECT_GT(share, 0.93);
  EXPECT_LT(share, 0.97);
}

TEST(Uncertainty, CoversTheTruthWithoutASigma) {
  const auto without = [](test::NoisyScene& scene, unsigned) { scene.options = {}; };
  const double share = coverage(without, 100);
  EXPECT_GT(share, 0.93);
  EXPECT_LT(share, 0.97);
}

TEST(Uncertainty, CoversTheTruthWithARobustLoss) {
  const auto robust = [](test::NoisyScene& scene, unsigned) {
    scene.options.loss = {LossType::huber, 2.0};
  };
  const double share = coverage(robust, 100);
  EXPECT_GT(share, 0.93);
  EXPECT_LT(share, 0.97);
}

TEST(Uncertainty, IsInfiniteOnlyForWhatIsNotDetermined) {
  test::NoisyScene scene(10);
  scene.names.push_back("shoulder_pan");  // turns arm against head,
  scene.names.push_back("head_pan_c");    // as does this
  const Assessment found = scene.solve_and_assess();
  for (std::size_t c = 0; c < found.parameters.size(); ++c) {
    const std::string& name = scene.result.table[found.parameters[c]].name;
    const double deviation = found.uncertainty.deviation(static_cast<int>(c));
    if (name == "shoulder_pan" || name == "head_pan_c") {
      EXPECT_TRUE(std::isinf(deviation)) << name;
    } else if (name == "elbow" || name == "camera_fx") {
      EXPECT_LT(deviation, 0.01) << name;
    }
  }
}

/// What takes a small part in what nothing determines is off with it: not determined either, unless that
/// part is below its own deviation.
TEST(Uncertainty, IsInfiniteForWhatAnUndeterminedCombinationMovesFurther) {
  test::NoisyScene scene(10);
  for (const char* name : {"shoulder_pan", "head_pan_c"}) scene.names.push_back(name);
  const Assessment found = scene.solve_and_assess();
  const Eigen::VectorXd values = scene.values();
  const Coordinates by = determined_coordinates(scene.solved(), scene.free(), scene.span(values));
  ASSERT_EQ(by.null.cols(), 1);
  const auto pan = std::find(found.parameters.begin(), found.parameters.end(),
                             scene.result.table.index("shoulder_pan"));
  const double turn = 0.4 * 5.0 * std::numbers::pi / 180.0;  // radians
  const Eigen::VectorXd moved = by.null.col(0) / by.null(pan - found.parameters.begin(), 0) * turn;
  for (std::size_t c = 0; c < found.parameters.size(); ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    const double sigma = std::sqrt(found.uncertainty.covariance(i, i));
    const bool is_determined = std::isfinite(found.uncertainty.deviation(i));
    EXPECT_FALSE(is_determined && std::abs(moved(i)) > 2.0 * sigma) << c;
  }
}

TEST(Correlations, AreListedAboveTheLimitTheLargestFirst) {
  Uncertainty known;
  Eigen::Matrix3d covariance;
  covariance << 4.0, 1.9, 0.2, 1.9, 1.0, -0.095, 0.2, -0.095, 0.01;
  known.covariance = covariance;
  known.deviation = covariance.diagonal().cwiseSqrt();
  const std::vector<Correlation> pairs = high_correlations(known);
  ASSERT_EQ(pairs.size(), 3u);  // 0 and 2 are the same up to a factor, 0.95 are the other two
  EXPECT_EQ(pairs[0].b, 2);
  EXPECT_NEAR(pairs[0].coefficient, 1.0, 1e-12);
  EXPECT_NEAR(pairs[2].coefficient, -0.95, 1e-12);
  EXPECT_TRUE(high_correlations(known, 1.0 + 1e-9).empty());
}

}  // namespace
}  // namespace kinecal
