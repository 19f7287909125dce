// Packets as wide as this machine's registers against doubles: cost, gradient, Hessian, residuals and
// Jacobian of every built-in error block.
//
// The other tests are compiled for any processor, so their packets have two lanes.  This one is
// compiled with -O3 -march=native, as users do who want speed, and links no library of kinecal.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "kinecal/testing.hpp"
#include "support/open_scene.hpp"

namespace kinecal {
namespace {

constexpr double kOrderOfSums = 1e-9;  // of the largest number: a thousand products are summed

/// Samples of three layouts: as many features as all sensors have, one less, and with features
/// that are not numbers.
std::vector<Sample> samples_of(const BasicProblem<double>& problem, std::span<const double> x,
                               int count) {
  std::vector<Sample> samples = test::open_samples(problem, x, count);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    for (Observation& seen : samples[n].observations) {
      if (n % 5 == 4) seen.features.pop_back();
      if (n % 5 == 2) seen.features[1].point.x() = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return samples;
}

void expect_equal(const std::string& what, const Eigen::MatrixXd& packets,
                  const Eigen::MatrixXd& numbers) {
  EXPECT_EQ(packets.size(), numbers.size());
  EXPECT_EQ(detail::compare(what, {"packets", packets}, {"doubles", numbers},
                            kOrderOfSums * (1.0 + detail::largest(numbers))),
            kLawsHold);
}

template <class S>
Eigen::MatrixXd residuals_and_jacobian(const BasicProblem<S>& problem, const std::vector<double>& x,
                                       const FreeSet& free) {
  std::map<int, Eigen::MatrixXd> by_sample;
  Eigen::Index count = 0;
  (void)evaluate(problem, x, &free, [&](int, int sample, const TermResiduals& rows) {
    Eigen::MatrixXd& both = by_sample[sample];
    both.resize(rows.residual.size(), 1 + free.size());
    both << rows.residual, rows.jacobian;
    count += both.rows();
  });
  Eigen::MatrixXd all(count, 1 + free.size());
  for (Eigen::Index row = 0; const auto& [sample, both] : by_sample) {
    all.middleRows(row, both.rows()) = both;
    row += both.rows();
  }
  return all;
}

template <ErrorBlock B>
void expect_packets_equal_doubles(const B& block, const std::vector<std::string>& sensors) {
  const TermOptions options{.scale = 1.7, .loss = {LossType::cauchy, 0.5}};
  for (const int count : {1, 3, 8, 13}) {
    SCOPED_TRACE(std::to_string(count) + " samples, " + std::to_string(kLanes<Packet>) + " lanes");
    Problem packets = test::open_problem<Packet>(block, sensors, options);
    BasicProblem<double> numbers = test::open_problem<double>(block, sensors, options);
    const ParameterTable& table = packets.table();
    const std::vector<double> truth = test::random_values(table, 0.05, 4),
                              x = test::random_values(table, 0.05, 5);  // leaves residuals
    std::vector<int> all;
    for (int i = 0; i < table.size(); ++i) all.push_back(i);
    const FreeSet free(all, table.size());
    for (const Sample& sample : samples_of(numbers, truth, count)) {
      packets.add_sample(sample);
      numbers.add_sample(sample);
    }
    const NormalEquations found = normal_equations(packets, x, &free),
                          expected = normal_equations(numbers, x, &free);
    EXPECT_GT(expected.cost, 0.0);
    EXPECT_NEAR(found.cost, expected.cost, kOrderOfSums * expected.cost);
    EXPECT_NEAR(normal_equations(packets, x, nullptr).cost, expected.cost,
                kOrderOfSums * expected.cost);
    expect_equal("gradient", found.gradient, expected.gradient);
    expect_equal("Hessian", found.hessian, expected.hessian);
    expect_equal("residuals and Jacobian", residuals_and_jacobian(packets, x, free),
                 residuals_and_jacobian(numbers, x, free));
  }
}

TEST(Native, PacketsOfPointsEqualDoubles) {
  expect_packets_equal_doubles(PointToPoint{}, {"camera", "arm"});
  expect_packets_equal_doubles(PointToPlane(0.1, 0.2, 2, -0.4), {"camera"});
  expect_packets_equal_doubles(PointToSphere{{0.1, 0.2, 0.3}, 0.4}, {"camera"});
  expect_packets_equal_doubles(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5}), {"arm"});
  expect_packets_equal_doubles(PointDistance{0.3}, {"camera", "elbow_point"});
}

TEST(Native, PacketsOfPixelsPlanesPosesAndRaysEqualDoubles) {
  expect_packets_equal_doubles(PointToPixel{}, {"arm", "eye"});
  expect_packets_equal_doubles(PlaneToPlane{2.0, 3.0}, {"camera", "arm"});
  expect_packets_equal_doubles(PoseToPose{2.0, 0.7}, {"body", "tracker"});
  expect_packets_equal_doubles(RayToRay{}, {"eye", "left"});
}

}  // namespace
}  // namespace kinecal
