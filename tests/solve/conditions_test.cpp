// Error blocks that take conditions of a sample: what was put in is found, and what is missing is
// named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "kinecal/solve/solve.hpp"
#include "support/open_scene.hpp"
#include "support/sums.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using test::ThermalBar;
using testing::HasSubstr;

template <class S>
BasicProblem<S> bar_problem() {
  return test::open_problem<S>(ThermalBar{}, {"arm", "elbow_point"}, {.scale = 1000.0});
}

/// Samples whose bar has exactly the length of its temperature and load.
template <class S>
std::vector<Sample> bar_samples(const BasicProblem<S>& problem, const Eigen::VectorXd& truth) {
  const std::span<const double> x(truth.data(), static_cast<std::size_t>(truth.size()));
  const double length = truth(problem.table().index("block_length")),
               expansion = truth(problem.table().index("block_expansion"));
  std::vector<Sample> samples = test::open_samples(problem, x, 25);
  for (Sample& sample : samples) {
    const double warmer = sample.conditions.at("temperature") - 20.0;
    const double true_length =
        length * (1.0 + expansion * warmer) - ThermalBar{}.bend * sample.conditions.at("load");
    const Pose<double> hand = test::tip_pose(problem, 0, "hand", sample, x),
                       forearm = test::tip_pose(problem, 3, "forearm", sample, x);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3<double> a = hand * sample.observations[0].features[i].point;
      Vector3<double>& other = sample.observations[3].features[i].point;
      const Vector3<double> b = forearm * other;
      other = forearm.inverse() * Vector3<double>(a + true_length * (b - a).normalized());
    }
  }
  return samples;
}

template <class S>
class Conditions : public testing::Test {};
using Scalars = testing::Types<double, Packet>;
TYPED_TEST_SUITE(Conditions, Scalars);

TYPED_TEST(Conditions, LetABarsExpansionBeFound) {
  BasicProblem<TypeParam> problem = bar_problem<TypeParam>();
  Eigen::VectorXd truth = problem.table().values();
  truth(problem.table().index("block_length")) = 0.38;
  truth(problem.table().index("block_expansion")) = 2e-3;
  truth(problem.table().index("wrist")) = 0.02;
  for (const Sample& sample : bar_samples(problem, truth)) problem.add_sample(sample);
  Eigen::VectorXd values = problem.table().values();
  const FreeSet free = test::free_of(problem.table(), {"wrist", "block_length", "block_expansion"});
  const StepResult result = solve(problem, free, values);
  ASSERT_TRUE(result.converged) << result.termination;
  EXPECT_LE((values - truth).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Conditions, ThatAreMissingAreNamed) {
  Problem problem = bar_problem<Packet>();
  Sample sample = bar_samples(problem, problem.table().values())[0];
  sample.source = "s.yaml:12";
  const auto message = [&] {
    return test::thrown<SampleError>([&] { problem.add_sample(sample); }, "no error");
  };
  const double temperature = sample.conditions.at("temperature");
  sample.conditions.erase("temperature");
  sample.conditions["temperatur"] = temperature;
  EXPECT_EQ(message(),
            "s.yaml:12: error block 'block': condition 'temperature' is not in the sample; did you "
            "mean 'temperatur'?");
  for (const double wrong : {std::nan(""), HUGE_VAL}) {
    sample.conditions["temperature"] = wrong;
    EXPECT_EQ(message(),
              "s.yaml:12: error block 'block': condition 'temperature' is not a finite number");
  }
  EXPECT_EQ(problem.num_samples(), 0);
  sample.conditions["temperature"] = temperature;
  EXPECT_EQ(message(), "no error");
  sample.conditions.erase("load");  // a feature of either sensor may have it
  for (std::size_t i = 0; i < 4; ++i) {
    sample.observations[i % 2 == 0 ? 0 : 3].features[i].conditions = {{"load", 0.5}};
  }
  EXPECT_EQ(message(), "no error");
  sample.observations[3].features[1].conditions = {{"loud", 0.5}};
  EXPECT_EQ(
      message(),
      "s.yaml:12: error block 'block': condition 'load' is not in feature 2 or the sample; did "
      "you mean 'loud'?");
  sample.conditions.clear();
  sample.observations[3].features.clear();
  EXPECT_EQ(message(), "no error") << "the block does not take this sample";
}

/// A wall whose normal and distance each point brings with it.
struct WallOfPoint {
  static constexpr const char* kUnit = "m";
  static constexpr std::array<std::string_view, 4> kConditions = {"nx", "ny", "nz", "d"};

  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p,
                                                  const std::array<Q, 4>& wall) const {
    return Eigen::Matrix<S, 1, 1>(p.x() * wall[0] + p.y() * wall[1] + p.z() * wall[2] + wall[3]);
  }
};

/// Points that each lie on a wall of their own: the zero of the wrist is found, also after the walls were replaced.
TYPED_TEST(Conditions, OfFeaturesAreTheirNormals) {
  using test::open_problem;
  BasicProblem<TypeParam> problem = open_problem<TypeParam>(WallOfPoint{}, {"arm"});
  Eigen::VectorXd truth = problem.table().values();
  const auto wrist = problem.table().index("wrist");
  const FreeSet free = test::free_of(problem.table(), {"wrist"});
  const auto on_walls = [&](double zero) {
    truth(wrist) = zero;
    const std::span<const double> x(truth.data(), static_cast<std::size_t>(truth.size()));
    std::vector<Sample> samples = test::open_samples(problem, x, 9);
    for (Sample& sample : samples) {
      const Pose<double> hand = test::tip_pose(problem, 0, "hand", sample, x);
      double turn = zero;
      for (Feature& feature : sample.observations[0].features) {
        turn += 1.0;
        const Vector3<double> n(std::sin(turn), std::cos(turn), 0.3);
        feature.conditions = {
            {"nx", n.x()}, {"ny", n.y()}, {"nz", n.z()}, {"d", -n.dot(hand * feature.point)}};
      }
    }
    return samples;
  };
  for (const Sample& sample : on_walls(0.02)) problem.add_sample(sample);
  for (const double zero : {0.02, -0.03}) {
    const std::vector<Sample> samples = on_walls(zero);
    for (std::size_t i = 0; zero < 0.0 && i < samples.size(); ++i) {
      problem.set_measurements(static_cast<int>(i), samples[i].observations[0]);
    }
    Eigen::VectorXd values = problem.table().values();
    ASSERT_TRUE(solve(problem, free, values).converged);
    EXPECT_NEAR(values(wrist), zero, 1e-12);
  }
}

}  // namespace
}  // namespace kinecal
