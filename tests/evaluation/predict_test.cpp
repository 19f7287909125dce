#include "kinecal/evaluation/predict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::StartsWith;

Problem sights() {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"});
  return problem;
}

Eigen::VectorXd some_values(const ParameterTable& table) {
  const std::vector<double> values = test::random_values(table, 0.02, 5);
  return Eigen::VectorXd::Map(values.data(), std::ssize(values));
}

Sample some_sample(const Problem& problem) {
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  return test::exact_samples(problem, zero, 1)[0];
}

TEST(Predict, GivesResidualAndPixelOfEachFeature) {
  const Problem problem = sights();
  const Eigen::VectorXd values = some_values(problem.table());
  Sample sample = some_sample(problem);
  sample.observations[2].features[1].point.x() = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Prediction> all = predict(problem, values, sample);
  ASSERT_EQ(all.size(), 7U);
  for (const Prediction& p : all) {
    if (p.block == "hand_eye") {
      EXPECT_FALSE(p.pixel.has_value());
      EXPECT_EQ(p.residual.size(), 3);
      continue;
    }
    EXPECT_NE(p.feature.place, 1) << "it is not a number";
    const auto place = static_cast<std::size_t>(p.feature.place);
    const Eigen::Vector2d seen = sample.observations[2].features[place].point.head<2>();
    ASSERT_TRUE(p.pixel.has_value());
    EXPECT_LT((*p.pixel - seen - p.residual).norm(), 1e-9) << "feature " << place;
    EXPECT_GT(p.residual.norm(), 0.1) << "the values are not those of the sample";
  }
}

TEST(Predict, NamesWhatIsUndefinedOrDoesNotFit) {
  const Problem problem = sights();
  Eigen::VectorXd values = some_values(problem.table());
  Sample sample = some_sample(problem);
  values(problem.table().index("eye_fx")) = std::numeric_limits<double>::quiet_NaN();
  sample.source = "a.yaml:3";
  EXPECT_THAT(test::thrown<std::domain_error>([&] { (void)predict(problem, values, sample); }),
              StartsWith("a.yaml:3: error block 'reprojection': a residual is "));
  EXPECT_THROW((void)predict(problem, values.head(3), sample), std::invalid_argument);
  sample.joint_names.pop_back();
  EXPECT_THROW((void)predict(problem, values, sample), SampleError);
}

TEST(ParameterValues, AreAnyNumbersInMemory) {
  const Problem problem = test::scene_problem();
  const Eigen::VectorXd values = problem.table().values();
  const std::vector<double> same(values.begin(), values.end());
  EXPECT_EQ(undefined_residual(problem, values), std::nullopt);
  EXPECT_EQ(undefined_residual(problem, problem.table().values()), std::nullopt);
  EXPECT_EQ(undefined_residual(problem, values.head(values.size())), std::nullopt);
  EXPECT_EQ(undefined_residual(problem, same), std::nullopt);
  EXPECT_EQ(undefined_residual(problem, {same.data(), same.size()}), std::nullopt);
  static_assert(!std::convertible_to<Eigen::VectorXf, ParameterValues>);
  static_assert(!std::convertible_to<Eigen::MatrixXd, ParameterValues>);
  static_assert(!std::convertible_to<Eigen::Matrix3d::RowXpr, ParameterValues>, "it has gaps");
}

}  // namespace
}  // namespace kinecal
