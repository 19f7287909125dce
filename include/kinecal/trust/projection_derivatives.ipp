// Derivatives of a camera's pixels, by its parameters and by its motion.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/trust/projection_map.hpp"

namespace kinecal::detail {

/// A camera at the solution, with its free parameters.
class SolvedProjection {
 public:
  using PixelByFree = Eigen::Matrix<double, 2, Eigen::Dynamic>;  ///< (2 x free), pixels
  using PixelByPoint = Eigen::Matrix<double, 2, 3>;              ///< pixels per metre
  using PixelByMotion =
      Eigen::Matrix<double, 2, 6>;  ///< translation in units of a distance, rotation

  /// @param settings  of its observations
  SolvedProjection(const MountedSensor& camera, const FreeSet& free, ParameterValues values,
                   std::vector<double> settings)
      : camera_(camera), settings_(std::move(settings)), own_(camera.own_values(values)) {
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const int column = camera.parameters()[i] >= 0 ? free.column(camera.parameters()[i]) : -1;
      if (column < 0) continue;
      parameters_.push_back(i);
      columns_.push_back(column);
    }
  }

  /// Columns of its free parameters.
  [[nodiscard]] const std::vector<int>& columns() const { return columns_; }
  /// Its free parameters at some values.
  [[nodiscard]] Eigen::VectorXd own(ParameterValues values) const {
    const std::vector<double> all = camera_.own_values(values);
    Eigen::VectorXd some(std::ssize(parameters_));
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      some(static_cast<Eigen::Index>(i)) = all[parameters_[i]];
    }
    return some;
  }
  /// What camera files have: fx fy cx cy in pixels, and coefficients of the lens.
  /// @param deviations  of its free parameters
  [[nodiscard]] std::vector<CameraNumber> numbers(std::span<const double> settings,
                                                  std::span<const double> deviations) const {
    static constexpr std::array<std::string_view, 4> kIntrinsicNames = {"fx", "fy", "cx", "cy"};
    const std::span<const ParameterInfo> infos = camera_.sensor().parameters();
    std::vector<CameraNumber> all;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      const auto intrinsic =
          std::find(kIntrinsicNames.begin(), kIntrinsicNames.end(), infos[i].name);
      const bool relative = intrinsic != kIntrinsicNames.end();
      if (!relative && settings.size() != infos.size()) continue;  // not those of a lens
      const double was =
          settings[relative ? static_cast<std::size_t>(intrinsic - kIntrinsicNames.begin()) : i];
      CameraNumber number{
          std::string(infos[i].name), relative ? was * (1.0 + own_[i]) : was + own_[i], {}};
      const auto free = std::find(parameters_.begin(), parameters_.end(), i);
      if (free != parameters_.end()) {
        number.deviation = (relative ? was : 1.0) *
                           deviations[static_cast<std::size_t>(free - parameters_.begin())];
      }
      all.push_back(std::move(number));
    }
    return all;
  }
  /// The unit direction of a pixel; NaN where the lens sees nothing.
  [[nodiscard]] Vector3<double> direction(const Eigen::Vector2d& pixel) const {
    return camera_.sensor().place({pixel.x(), pixel.y(), 0.0}, settings_, own_).normalized();
  }
  [[nodiscard]] PixelByFree by_free(const Vector3<double>& p) const {
    constexpr double kStep = 1e-6;
    PixelByFree all(2, std::ssize(parameters_));
    std::vector<double> own = own_;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      double& value = own[parameters_[i]];
      const double at = value;
      value = at + kStep;
      const Eigen::Vector2d above = camera_.sensor().predict(p, settings_, own);
      value = at - kStep;
      const Eigen::Vector2d below = camera_.sensor().predict(p, settings_, own);
      value = at;
      all.col(static_cast<Eigen::Index>(i)) = (above - below) / (2.0 * kStep);
    }
    return all;
  }
  [[nodiscard]] PixelByPoint by_point(const Vector3<double>& p) const {
    const double step = 1e-6 * p.norm();
    PixelByPoint all;
    for (int i = 0; i < 3; ++i) {
      const Vector3<double> off = step * Vector3<double>::Unit(i);
      all.col(i) = (camera_.sensor().predict(p + off, settings_, own_) -
                    camera_.sensor().predict(p - off, settings_, own_)) /
                   (2.0 * step);
    }
    return all;
  }
  /// By a motion of the points against the camera: distance * translation + rotation x p.
  [[nodiscard]] static PixelByMotion by_motion(const PixelByPoint& by_point,
                                               const Vector3<double>& p, double distance) {
    PixelByMotion all;
    all.leftCols<3>() = by_point * distance;
    for (int i = 0; i < 3; ++i) all.col(3 + i) = by_point * Vector3<double>::Unit(i).cross(p);
    return all;
  }

 private:
  const MountedSensor& camera_;
  std::vector<double> settings_, own_;
  std::vector<std::size_t> parameters_;  ///< free ones among its own
  std::vector<int> columns_;
};

/// G of the header: the motion that takes up most of a change of the parameters, from the points of features.
class TakenUp {
 public:
  explicit TakenUp(Eigen::Index free)
      : squares_(Eigen::Matrix<double, 6, 6>::Zero()), products_(Eigen::MatrixXd::Zero(6, free)) {}

  void add(const SolvedProjection::PixelByFree& by_free,
           const SolvedProjection::PixelByMotion& by_motion) {
    if (!by_free.allFinite() || !by_motion.allFinite()) return;
    squares_ += by_motion.transpose() * by_motion;
    products_ += by_motion.transpose() * by_free;
  }
  /// (6 x free)
  [[nodiscard]] Eigen::MatrixXd motion() const {
    return -squares_.completeOrthogonalDecomposition().solve(products_);
  }

 private:
  Eigen::Matrix<double, 6, 6> squares_;
  Eigen::MatrixXd products_;
};

}  // namespace kinecal::detail
