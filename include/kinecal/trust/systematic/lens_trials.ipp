// Lenses that are not as they were taken.
//
// Let the pixels be farther from the principal point c than they were measured, by
//
//   a (p - c) |p - c|^2 / R^3      R the distance of the farthest feature: a pixels there
//
// which is the first term of a lens, k1 = a f^2 / R^3.  A wrong focal length or principal point that is held looks alike:
// the evidence is what is left of a beside these.  A lens of which a coefficient is free fits as well as its model can.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"
#include "kinecal/trust/systematic/systematic_trial.ipp"

namespace kinecal::detail {

// Whether a column beside those of a fit is more than chance, by fits without each pose in turn (jackknife).
//
//   variance = (n - 1) / n sum (a_i - mean a)^2      a_i the column's coefficient without pose i
//
// Rows of a pose may err together in any way.  The degrees of freedom are those of the poses that count: (sum e)^2 / sum e^2,
// e the column's own effect in each, less one.

/// A column's coefficient and the probability that it is as large by chance.
struct ColumnTest {
  double change = 0.0;
  double chance = 1.0;
};

/// Tests the first of some columns beside those of a fit and the other ones.
/// @param added  (rows x columns) derivatives of the weighted residuals
[[nodiscard]] inline ColumnTest test_column(const LinearFit& fit, const Eigen::MatrixXd& added,
                                            const PoseGroups& poses) {
  constexpr double kOwn = 1e-3, kRidge = 1e-10, kAlike = 0.01;
  constexpr std::size_t kFewest = 6;
  const Eigen::Index own = fit.size(), all = own + added.cols();
  Eigen::MatrixXd rows(fit.residual.size(), all);
  rows << fit.jacobian, added;
  Eigen::MatrixXd sums = rows.transpose() * fit.loss.asDiagonal() * rows;
  sums.topLeftCorner(own, own) += fit.prior_hessian;
  Eigen::VectorXd gradient = rows.transpose() * fit.loss.cwiseProduct(fit.residual);
  gradient.head(own) += fit.prior_gradient;
  const Eigen::VectorXd scale = sums.diagonal().unaryExpr(
      [](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 0.0; });
  rows = rows * scale.asDiagonal();
  sums = scale.asDiagonal() * sums * scale.asDiagonal();
  sums.diagonal().array() += kRidge;
  gradient = scale.cwiseProduct(gradient);
  const Ldlt by_own(sums.topLeftCorner(own, own));
  for (Eigen::Index c = own + 1; c < all;
       ++c) {  // what the fit has: beside it, only residuals are left
    const Eigen::VectorXd cross = sums.col(c).head(own);
    if (1.0 - cross.dot(by_own.solve(cross)) > kAlike) continue;
    rows.col(c).setZero();
    sums.row(c).setZero();
    sums.col(c).setZero();
    sums(c, c) = 1.0;
    gradient(c) = 0.0;
  }
  const Eigen::VectorXd of_first =
      Ldlt(sums).solve(Eigen::VectorXd(Eigen::VectorXd::Unit(all, own)));  // column of the inverse
  auto by_pose = blocks_by_pose(fit, poses);
  std::erase_if(by_pose, [&](const std::vector<std::size_t>& blocks) {
    return std::all_of(blocks.begin(), blocks.end(), [&](std::size_t b) {
      return added.middleRows(fit.blocks[b].first, fit.blocks[b].size).isZero(0.0);
    });
  });
  const auto n = static_cast<double>(by_pose.size());
  if (by_pose.size() < kFewest || !(of_first(own) > 0.0) || 1.0 / of_first(own) < kOwn) return {};
  Eigen::VectorXd changes(std::ssize(by_pose)), effects(std::ssize(by_pose));
  for (std::size_t pose = 0; pose < by_pose.size(); ++pose) {
    Eigen::MatrixXd others = sums;
    Eigen::VectorXd of_others = gradient;
    double effect = 0.0;
    for (const std::size_t b : by_pose[pose]) {
      const RowBlock& block = fit.blocks[b];
      const auto of = rows.middleRows(block.first, block.size);
      const auto loss = fit.loss.segment(block.first, block.size);
      others -= of.transpose() * loss.asDiagonal() * of;
      of_others -=
          of.transpose() * loss.cwiseProduct(fit.residual.segment(block.first, block.size));
      effect += (of * of_first).cwiseAbs2().dot(loss);
    }
    const auto at = static_cast<Eigen::Index>(pose);
    changes(at) = -Ldlt(others).solve(of_others)(own);
    effects(at) = effect;
  }
  const double variance = (n - 1.0) / n * (changes.array() - changes.mean()).square().sum();
  const double change = -of_first.dot(gradient);
  const double freedom = effects.sum() * effects.sum() / effects.squaredNorm() - 1.0;
  if (!(variance > 0.0) || !(freedom > 0.0)) return {};
  return {scale(own) * change, f_tail(change * change / variance, 1.0, freedom)};
}

/// A shift of pixels, by their place in units of the radius.
using Shift = Eigen::Vector2d (*)(const Eigen::Vector2d&);

[[nodiscard]] inline Eigen::Vector2d lens_shift(const Eigen::Vector2d& p) {
  return p * p.squaredNorm();
}
/// What looks alike: the scales of u and v, and their shifts.
inline constexpr std::array<Shift, 4> kOtherShifts = {
    [](const Eigen::Vector2d& p) -> Eigen::Vector2d {
      return {p.x(), 0.0};
    },
    [](const Eigen::Vector2d& p) -> Eigen::Vector2d {
      return {0.0, p.y()};
    },
    [](const Eigen::Vector2d&) -> Eigen::Vector2d {
      return {1.0, 0.0};
    },
    [](const Eigen::Vector2d&) -> Eigen::Vector2d {
      return {0.0, 1.0};
    }};

/// A camera's pixels in some samples.
class CameraPixels {
 public:
  CameraPixels(const MountedSensor& mounted, ParameterValues values,
               std::span<const Sample> samples)
      : mounted_(mounted), own_(mounted.own_values(values)) {
    for (const Sample& sample : samples) {
      const Observation* seen = sample.observation(name());
      if (seen == nullptr) continue;
      const Eigen::Vector2d at = center(*seen);
      for (const Feature& feature : seen->features) {
        const double distance = (feature.point.head<2>() - at).norm();
        if (distance > radius_) radius_ = distance;  // not if it is NaN
      }
      if (first_ == nullptr) first_ = seen;
    }
  }

  [[nodiscard]] const std::string& name() const { return mounted_.mount().name; }
  [[nodiscard]] double radius() const { return radius_; }  ///< of the farthest feature, pixels
  [[nodiscard]] double focal_length() const {
    constexpr double kSmall = 1e-3;
    const std::vector<double> settings = mounted_.sensor().settings(*first_);
    const auto at = [&](double x, double y) {
      return mounted_.sensor().predict({x, y, 1.0}, settings, own_);
    };
    return 0.5 *
           ((at(kSmall, 0.0) - at(0.0, 0.0)).norm() + (at(0.0, kSmall) - at(0.0, 0.0)).norm()) /
           kSmall;
  }
  /// Why a lens is not as it was taken, and what to do.
  /// @param k1  by which it differs
  [[nodiscard]] std::string text(double k1) const {
    const auto is_set = [](double number) { return number != 0.0; };
    const std::vector<double> settings = mounted_.sensor().settings(*first_);
    constexpr std::ptrdiff_t kPinhole = 4;  // fx fy cx cy, then those of a lens
    char number[32];
    (void)std::snprintf(number, sizeof number, "%.2g", k1);
    if (std::ssize(settings) > kPinhole &&
        std::any_of(settings.begin() + kPinhole, settings.end(), is_set)) {
      return "the distortion in camera_info is not that of its lens at this resolution and focus; "
             "free its coefficients, or calibrate the lens again; with a k1 that differs by " +
             std::string(number);
    }
    if (first_->camera && std::any_of(first_->camera->d.begin(), first_->camera->d.end(), is_set)) {
      return "its images are taken as rectified, but show the distortion of a lens; write 'image: "
             "raw' if they are raw, or calibrate the lens again; with a k1 of " +
             std::string(number);
    }
    return "its lens is distorted, but camera_info has no distortion; free its coefficients (k1, "
           "k2, p1, p2), or give them (D of camera_info, with 'image: raw'); with a k1 of " +
           std::string(number);
  }

  /// Moves the pixels of an observation by a field of shifts.
  void move(Observation& seen, Shift shift, double step) const {
    const Eigen::Vector2d at = center(seen);
    for (Feature& feature : seen.features) {
      const Eigen::Vector2d place = (feature.point.head<2>() - at) / radius_;
      feature.point.head<2>() += step * shift(place);
    }
  }

 private:
  /// The recorded principal point: a fitted one has moved with the lens.
  [[nodiscard]] Eigen::Vector2d center(const Observation& seen) const {
    return mounted_.sensor().predict({0.0, 0.0, 1.0}, mounted_.sensor().settings(seen));
  }

  const MountedSensor& mounted_;
  std::vector<double> own_;
  double radius_ = 0.0;
  const Observation* first_ = nullptr;
};

/// True if a coefficient of the lens is free.
[[nodiscard]] inline bool has_free_lens(const MountedSensor& mounted, const FreeSet& free) {
  const std::vector<int>& own = mounted.parameters();
  const std::vector<int>& freed = free.parameters();
  const auto from =
      own.begin() + std::min(std::ssize(own), static_cast<std::ptrdiff_t>(kIntrinsics));
  return std::any_of(from, own.end(), [&](int parameter) {
    return std::find(freed.begin(), freed.end(), parameter) != freed.end();
  });
}

/// Columns of pixels shifted by the first term of a lens, and what the fit with it gains.
class LensColumn {
 public:
  LensColumn(const FittedSamples& fitted, const CameraPixels& camera,
             const Eigen::MatrixXd& inverse, MeasurementSlopes& slopes)
      : fitted_(fitted), camera_(camera), slopes_(slopes), slope_(slope(lens_shift)) {
    const LinearFit& fit = fitted.fit;
    const Eigen::VectorXd weighted = fit.loss.cwiseProduct(slope_);
    length_ = weighted.dot(slope_);
    const Fall fall = AddedColumns(Eigen::MatrixXd::Constant(1, 1, length_),
                                   weighted.transpose() * fit.jacobian, inverse)
                          .fall(Eigen::VectorXd::Constant(1, weighted.dot(fit.residual)));
    gain_ = fall.squares;
    farther_ = -fall.change(0);
    const Eigen::ArrayXd squares = fit.loss.array() * fit.residual.array().square();
    all_ = squares.sum();
    own_ = (slope_.array() != 0.0).select(squares, 0.0).sum();
  }

  /// By which pixels at the farthest feature are farther from the center than measured.
  [[nodiscard]] double farther() const { return farther_; }
  /// The part of it that free parameters have not absorbed: what residuals show, pixels.
  [[nodiscard]] double shown() const { return std::copysign(std::sqrt(gain_ / length_), farther_); }
  [[nodiscard]] double noise_left() const { return std::sqrt(std::max(0.0, 1.0 - gain_ / all_)); }
  /// True if the lens matters: half a pixel or more, and the noise of the camera falls to 95 %.  Shifts above half of the
  /// radius are ignored: there the column is mostly noise.
  [[nodiscard]] bool matters() const {
    constexpr double kLeft = 0.95, kPixels = 0.5, kLarge = 0.5;
    return own_ > 0.0 && left() <= kLeft * kLeft * own_ && std::abs(farther_) > kPixels &&
           std::abs(farther_) <= kLarge * camera_.radius();
  }
  /// True if the shift is larger than the noise, and chance does not explain it beside what looks alike.
  [[nodiscard]] bool is_sure(const PoseGroups& poses) const {
    constexpr double kChance = 1e-3;
    Eigen::MatrixXd slopes(slope_.size(), 1 + std::ssize(kOtherShifts));
    slopes.col(0) = slope_;
    for (std::size_t i = 0; i < kOtherShifts.size(); ++i) {
      slopes.col(static_cast<Eigen::Index>(i) + 1) = slope(kOtherShifts[i]);
    }
    const LinearFit& fit = fitted_.fit;
    const double per_pixel = fit.loss.dot(slopes.rightCols(2).rowwise().squaredNorm());
    if (!(farther_ * farther_ * per_pixel > left())) return false;
    const ColumnTest test = test_column(fit, slopes, poses);
    const auto cameras = static_cast<double>(fitted_.problem.sensors().size());
    return test.chance <= kChance / cameras && test.change * farther_ < 0.0;
  }

 private:
  /// Sum of squares of the camera's residuals with the lens.
  [[nodiscard]] double left() const { return std::max(0.0, own_ - gain_); }
  /// (rows) change of weighted residuals per pixel.
  [[nodiscard]] Eigen::VectorXd slope(Shift shift) const {
    constexpr double kStep = 1e-3;  // pixels
    const auto move = [&](Observation& seen) { camera_.move(seen, shift, kStep); };
    return slopes_(camera_.name(), move, kStep);
  }

  const FittedSamples& fitted_;
  const CameraPixels& camera_;
  MeasurementSlopes& slopes_;
  Eigen::VectorXd slope_;
  double length_ = 0.0, gain_ = 0.0, farther_ = 0.0;
  double all_ = 0.0, own_ = 0.0;  ///< sums of squares of all residuals, of the camera's
};

/// Cameras whose lens is not as it was taken.
/// @param inverse  of J^T W J
/// @param slopes   of the same samples
[[nodiscard]] inline std::vector<SystematicError> lens_errors(const FittedSamples& fitted,
                                                              const PoseGroups& poses,
                                                              const Eigen::MatrixXd& inverse,
                                                              MeasurementSlopes& slopes) {
  std::vector<SystematicError> errors;
  for (const MountedSensor& mounted : fitted.problem.sensors()) {
    if (!mounted.sensor().is_camera() || measures_depth(mounted.sensor())) continue;
    if (has_free_lens(mounted, fitted.free)) continue;
    const CameraPixels camera(mounted, fitted.values, fitted.samples);
    if (!(camera.radius() > 0.0)) continue;
    const LensColumn column(fitted, camera, inverse, slopes);
    if (!column.matters() || !column.is_sure(poses)) continue;
    const double f = camera.focal_length(), r = camera.radius();
    char shown[64];
    (void)std::snprintf(shown, sizeof shown, "(%+.1f px at %.0f px)", column.shown(), r);
    SystematicError& error =
        errors.emplace_back(SystematicError{.owner = camera.name(), .course = ErrorCourse::lens});
    error.size = column.farther() * f * f / (r * r * r);
    error.noise_left = column.noise_left();
    error.text = "residuals of '" + error.owner +
                 "' grow with the distance from the center of the image " + shown + ": " +
                 camera.text(error.size);
  }
  return errors;
}

}  // namespace kinecal::detail
