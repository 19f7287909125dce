#include "kinecal/solve/determined_spectrum.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinecal {
namespace {

/// J^T J of rows that see all directions but one.
Eigen::MatrixXd information_without(const Eigen::VectorXd& direction, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd rows =
      Eigen::MatrixXd::NullaryExpr(20, direction.size(), [&] { return normal(random); });
  const Eigen::VectorXd unit = direction.normalized();
  const Eigen::MatrixXd blind = rows - rows * unit * unit.transpose();
  return blind.transpose() * blind;
}

const Eigen::Vector4d kOpen(1.0, 2.0, 0.0, -1.0), kOther(1.0, -1.0, 3.0, 0.5);

TEST(DeterminedSpectrum, OfNoCoordinatesIsEmpty) {
  const detail::Spectrum spectrum(Eigen::MatrixXd(0, 0));
  EXPECT_EQ(spectrum.singular.size(), 0);
  EXPECT_EQ(spectrum.null, 0);
  EXPECT_EQ(spectrum.pseudo_inverse().size(), 0);
}

TEST(DeterminedSpectrum, LosesADirectionThatOnlyTheErrorFreeProblemDetermines) {
  // The error-free problem sees kOpen, and does not see kOther.
  const Eigen::MatrixXd error_free = information_without(kOther, 1);
  detail::Spectrum spectrum(error_free);
  ASSERT_EQ(spectrum.null, 1);
  detail::take_away_null_of(error_free, information_without(kOpen, 2), spectrum);
  EXPECT_EQ(spectrum.null, 2);
  constexpr double kRounding = 1e-9;
  const Eigen::MatrixXd& v = spectrum.vectors;
  EXPECT_LT((v.transpose() * v - Eigen::MatrixXd::Identity(4, 4)).norm(), kRounding);
  EXPECT_EQ(spectrum.singular(1), 0.0);
  EXPECT_GT(spectrum.singular(2), 1e-3);
  EXPECT_LE(spectrum.singular(2), spectrum.singular(3));
  // Both are in what is not determined.
  for (const Eigen::Vector4d& open : {kOpen, kOther}) {
    const Eigen::VectorXd in_scale = spectrum.scale.cwiseProduct(open);
    EXPECT_LT((v.rightCols(2).transpose() * in_scale).norm(), kRounding * in_scale.norm());
  }
}

TEST(DeterminedSpectrum, StaysAsItIsWhereMeasuredPointsShowAsMuch) {
  const Eigen::MatrixXd error_free = information_without(kOther, 1);
  detail::Spectrum spectrum(error_free);
  const detail::Spectrum before = spectrum;
  detail::take_away_null_of(error_free, error_free + Eigen::MatrixXd::Identity(4, 4), spectrum);
  EXPECT_EQ(spectrum.null, 1);
  EXPECT_TRUE(spectrum.vectors == before.vectors);
  EXPECT_TRUE(spectrum.singular == before.singular);
}

}  // namespace
}  // namespace kinecal
