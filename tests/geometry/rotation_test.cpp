#include "kinecal/geometry/rotation.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRoundingOfUnits = 4e-15;  // a few operations on numbers of size one

/// Rotation vectors where something could go wrong: zero, tiny, around the switch to the series
/// (0.5), random, near pi and at pi.
std::vector<Vector3<double>> difficult_vectors() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3<double>> vectors = {Vector3<double>::Zero()};
  for (double angle : {1e-300, 1e-20, 1e-8, 1e-4, 0.01, 0.4999999, 0.5000001, 1.0, 2.5, kPi - 1e-3,
                       kPi - 1e-8, kPi}) {
    for (int i = 0; i < 5; ++i) {
      Vector3<double> axis(normal(random), normal(random), normal(random));
      vectors.push_back(axis.normalized() * angle);
    }
    for (int i = 0; i < 3; ++i) vectors.push_back(Vector3<double>::Unit(i) * angle);
  }
  return vectors;
}

TEST(Rotation, ExpIsARotationMatrix) {
  for (const auto& w : difficult_vectors()) {
    const Matrix3<double> r = exp(w);
    EXPECT_TRUE((r * r.transpose()).isIdentity(kRoundingOfUnits)) << w.transpose();
    EXPECT_NEAR(r.determinant(), 1.0, kRoundingOfUnits);
  }
}

TEST(Rotation, ExpTurnsByTheLengthOfTheVector) {
  const Matrix3<double> r = exp(Vector3<double>(0.0, 0.0, 0.3));
  EXPECT_NEAR(r(0, 0), std::cos(0.3), kRoundingOfUnits);
  EXPECT_NEAR(r(1, 0), std::sin(0.3), kRoundingOfUnits);
}

TEST(Rotation, ExpIsTheTurnOfAQuaternionAboutAnyAxis) {
  for (const auto& w : difficult_vectors()) {
    const double half = 0.5 * w.norm();
    const Vector3<double> axis = w.norm() > 0.0 ? Vector3<double>(w / w.norm()) : w;
    const Vector3<double> v = std::sin(half) * axis;
    const Matrix3<double> expected =
        Eigen::Quaterniond(std::cos(half), v.x(), v.y(), v.z()).toRotationMatrix();
    EXPECT_TRUE(exp(w).isApprox(expected, kRoundingOfUnits)) << w.transpose();
  }
}

TEST(Rotation, LogUndoesExpAlsoAtZeroAndNearPi) {
  for (const auto& w : difficult_vectors()) {
    const Vector3<double> back = log(exp(w));
    // At pi itself the sign of the axis is free.
    const double error =
        std::min((back - w).norm(), w.norm() > kPi - 1e-12 ? (back + w).norm() : 9);
    EXPECT_LE(error, 2e-15 + 4e-15 * w.norm()) << "w = " << w.transpose();
  }
}

TEST(Rotation, LogOfATinyRotationKeepsItsRelativeAccuracy) {
  const Vector3<double> w(1e-12, -2e-12, 3e-12);
  EXPECT_LE((log(exp(w)) - w).norm(), 1e-15 * w.norm());
}

using Jet3 = ceres::Jet<double, 3>;

Vector3<Jet3> jets(const Vector3<double>& w) {
  return {Jet3(w.x(), 0), Jet3(w.y(), 1), Jet3(w.z(), 2)};
}

TEST(Rotation, LeftJacobianIsTheDerivativeOfExp) {
  for (const auto& w : difficult_vectors()) {
    const Matrix3<Jet3> r = exp(jets(w));
    const Matrix3<double> value = exp(w), jacobian = left_jacobian(w);
    for (int k = 0; k < 3; ++k) {
      Matrix3<double> derivative;
      for (int i = 0; i < 9; ++i) derivative(i) = r(i).v(k);
      const Matrix3<double> expected = cross_matrix<double>(jacobian.col(k)) * value;
      EXPECT_LE((derivative - expected).norm(), 1e-13) << "w = " << w.transpose();
    }
  }
}

TEST(Rotation, LogDifferentiatesThroughZeroAndNearPi) {
  for (const auto& w : difficult_vectors()) {
    if (w.norm() > kPi - 1e-6) continue;  // the derivative of log itself grows without bound
    const Vector3<Jet3> back = log(exp(jets(w)));
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE((back(i).v - Vector3<double>::Unit(i)).norm(), 1e-11) << w.transpose();
    }
  }
}

TEST(Rpy, MatchesTheProductOfThreeAxisRotations) {
  const Vector3<double> rpy(0.3, -0.7, 2.1);
  const Matrix3<double> expected = exp(Vector3<double>(0, 0, rpy.z())) *
                                   exp(Vector3<double>(0, rpy.y(), 0)) *
                                   exp(Vector3<double>(rpy.x(), 0, 0));
  EXPECT_TRUE(rotation_from_rpy(rpy).isApprox(expected, kRoundingOfUnits));
}

TEST(Rpy, IsFoundAgainFromTheRotationAlsoInGimbalLock) {
  for (double pitch : {0.0, 1e-9, 0.5, kPi / 2 - 1e-7, kPi / 2 - 1e-13, kPi / 2, -kPi / 2}) {
    const Matrix3<double> r = rotation_from_rpy({0.4, pitch, -2.0});
    EXPECT_LE((rotation_from_rpy(rpy_from_rotation(r)) - r).norm(), 2e-12) << "pitch " << pitch;
  }
  const Vector3<double> rpy(0.4, kPi / 2 - 1e-5, -2.0);
  EXPECT_LE((rpy_from_rotation(rotation_from_rpy(rpy)) - rpy).norm(), 1e-10);
}

TEST(Pose, ComposesAndInverts) {
  const Pose<double> a{exp(Vector3<double>(0.1, 0.2, 0.3)), {1, 2, 3}};
  const Pose<double> b{exp(Vector3<double>(-0.5, 0.1, 0.9)), {-1, 0.5, 2}};
  const Vector3<double> p(0.3, -0.2, 0.7);
  EXPECT_LE((a * b * p - a * (b * p)).norm(), kRoundingOfUnits);
  EXPECT_LE((a.inverse() * (a * p) - p).norm(), kRoundingOfUnits);
}

}  // namespace
}  // namespace kinecal
