// Definitions of lens_start.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/lens_start.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr int kAngles = 60;  // at which two lenses are compared

/// Angles from the axis outwards, radians; not where tan is infinite.
[[nodiscard]] std::vector<double> angles_up_to(double most_degrees, double limit) {
  const double most = std::min(most_degrees, limit) * std::numbers::pi / 180.0;
  std::vector<double> angles;
  for (int i = 1; i <= kAngles; ++i) angles.push_back(most * i / kAngles);
  return angles;
}

/// Solves rows of a linear system whose columns differ in size by orders of magnitude.
[[nodiscard]] std::vector<double> solved(Eigen::MatrixXd rows, const Eigen::VectorXd& right) {
  const Eigen::VectorXd lengths = rows.colwise().norm();
  rows = rows * lengths.cwiseInverse().asDiagonal();
  const Eigen::VectorXd x =
      lengths.cwiseInverse().cwiseProduct(rows.colPivHouseholderQr().solve(right));
  return {x.begin(), x.end()};
}

[[nodiscard]] std::vector<double> fisheye_start(const RoundLens& like, double most_degrees) {
  const std::vector<double> angles = angles_up_to(most_degrees, 179.0);
  Eigen::MatrixXd rows(kAngles, 4);
  Eigen::VectorXd right(kAngles);
  for (int i = 0; i < kAngles; ++i) {
    const double t = angles[static_cast<std::size_t>(i)], t2 = t * t;
    rows.row(i) << t * t2, t * t2 * t2, t * std::pow(t2, 3), t * std::pow(t2, 4);
    right(i) = like.profile(t) - t;
  }
  return solved(rows, right);
}

/// k1 k2 k3, and k4 k5 k6 of a quotient.
[[nodiscard]] std::vector<double> pinhole_start(const RoundLens& like, double most_degrees,
                                                bool quotient) {
  constexpr double kAlmostFlat = 88.0;
  const std::vector<double> angles = angles_up_to(most_degrees, kAlmostFlat);
  Eigen::MatrixXd rows(kAngles, quotient ? 6 : 3);
  Eigen::VectorXd right(kAngles);
  for (int i = 0; i < kAngles; ++i) {
    const double t = angles[static_cast<std::size_t>(i)], r = std::tan(t), s = like.profile(t);
    const double r2 = r * r, weight = 1.0 / (1.0 + r * r2 * r2 * r2);  // as if solved for s
    for (int k = 0; k < 3; ++k) {
      rows(i, k) = weight * r * std::pow(r2, k + 1);
      if (quotient) rows(i, 3 + k) = -weight * s * std::pow(r2, k + 1);
    }
    right(i) = weight * (s - r);
  }
  return solved(rows, right);
}

[[nodiscard]] std::vector<double> sphere_start(const RoundLens& like, double most_degrees) {
  const std::vector<double> angles = angles_up_to(most_degrees, 179.0);
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> best = {0.0, 0.5};
  for (double xi = -0.9; xi < 1.0; xi += 0.05) {
    for (double alpha = 0.0; alpha < 0.95; alpha += 0.025) {
      double worst = 0.0;
      for (const double t : angles) {
        const Eigen::Vector2d at = DoubleSphere::image(
            Vector3<double>(std::sin(t), 0.0, std::cos(t)), std::array{xi, alpha});
        const double off = std::abs(at.x() - like.profile(t));
        worst = std::isfinite(off) ? std::max(worst, off) : std::numeric_limits<double>::infinity();
      }
      if (worst < least) {
        least = worst;
        best = {xi, alpha};
      }
    }
  }
  return best;
}

}  // namespace
}  // namespace detail

RoundLens rough_pinhole(double focal) {
  return {focal, [](double t) { return std::tan(t); }, [](double s) { return std::atan(s); }};
}

RoundLens rough_fisheye(double focal) {
  return {focal, [](double t) { return t; }, [](double s) { return s; }};
}

std::vector<double> lens_start(std::string_view lens, const RoundLens& like, double most_degrees) {
  if (lens == Equidistant::kName) return detail::fisheye_start(like, most_degrees);
  if (lens == DoubleSphere::kName) return detail::sphere_start(like, most_degrees);
  const bool quotient = lens == RationalPolynomial::kName || lens == ThinPrism::kName;
  if (!quotient && lens != PlumbBob::kName) {
    throw std::invalid_argument("there is no lens '" + std::string(lens) + "'");
  }
  const std::vector<double> k = detail::pinhole_start(like, most_degrees, quotient);
  std::vector<double> d = {k[0], k[1], 0.0, 0.0, k[2]};  // k1 k2 p1 p2 k3
  d.insert(d.end(), k.begin() + 3, k.end());
  if (lens == ThinPrism::kName) d.resize(12, 0.0);
  return d;
}

}  // namespace kinecal
