// Maps cameras.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/projection_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinecal/geometry/median.hpp"
#include "kinecal/text/image_region.hpp"
#include "kinecal/trust/camera_features.ipp"
#include "kinecal/trust/halves_apart.ipp"
#include "kinecal/trust/projection_derivatives.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The map of one camera.
class CameraMap {
 public:
  CameraMap(const KnownSolution& solution, const SolvedProjection& camera, SeenByCamera seen)
      : camera_(camera), seen_(std::move(seen)) {
    const std::vector<int>& columns = camera.columns();
    covariance_ = solution.uncertainty.covariance.matrix()(columns, columns);
    for (const int c : columns) {
      deviations_.push_back(solution.uncertainty.deviation(c));
      determined_ &= std::isfinite(deviations_.back());
    }
    std::vector<double> known;
    for (const double d : seen_.distances) {
      if (d > 0.0) known.push_back(d);
    }
    distance_ = known.empty() ? 0.0 : median_of(known);
    motion_ = motion();
  }

  /// @param apart   difference of the camera's free parameters between halves
  /// @param allowed  covariance of that difference
  [[nodiscard]] ProjectionMap map(const std::string& name,
                                  const std::optional<Eigen::VectorXd>& apart,
                                  const Eigen::MatrixXd& allowed, double freedom) const {
    ProjectionMap all{.sensor = name, .low = seen_.low, .high = seen_.high};
    all.distance = distance_;
    constexpr int kColumns = 16;
    const double width = all.high[0] - all.low[0], height = all.high[1] - all.low[1];
    all.columns = kColumns;
    all.rows = std::clamp(static_cast<int>(std::lround(kColumns * height / width)), 4, 32);
    std::vector<SolvedProjection::PixelByFree> derivatives;
    for (int r = 0; r < all.rows; ++r) {
      for (int c = 0; c < all.columns; ++c) {
        KnownPixel& cell = all.cells.emplace_back();
        cell.pixel = {all.low[0] + width * (c + 0.5) / all.columns,
                      all.low[1] + height * (r + 0.5) / all.rows};
        derivatives.push_back(set(cell, apart));
      }
    }
    for (const Eigen::Vector2d& pixel : seen_.pixels) {
      const KnownPixel* cell = all.at(pixel.x(), pixel.y());
      if (cell != nullptr) ++all.cells[static_cast<std::size_t>(cell - all.cells.data())].features;
    }
    all.numbers = camera_.numbers(seen_.settings, deviations_);
    if (apart && determined_) all.halves = halves_apart(all, derivatives, allowed, freedom);
    return all;
  }

 private:
  [[nodiscard]] Vector3<double> point(const Eigen::Vector2d& pixel, double distance) const {
    return (distance > 0.0 ? distance : 1.0) * camera_.direction(pixel);
  }
  /// (6 x free) of some features, evenly chosen; without translation where no distance is known.
  [[nodiscard]] Eigen::MatrixXd motion() const {
    constexpr std::size_t kMost = 1000;
    TakenUp taken(std::ssize(camera_.columns()));
    const std::size_t step = 1 + seen_.pixels.size() / kMost;
    for (std::size_t i = 0; i < seen_.pixels.size(); i += step) {
      const double distance = seen_.distances[i];
      const Vector3<double> p = point(seen_.pixels[i], distance);
      taken.add(camera_.by_free(p), SolvedProjection::by_motion(camera_.by_point(p), p,
                                                                distance > 0.0 ? distance_ : 0.0));
    }
    return taken.motion();
  }
  /// Sets what is known of a cell.
  /// @returns  A of the header
  [[nodiscard]] SolvedProjection::PixelByFree set(
      KnownPixel& cell, const std::optional<Eigen::VectorXd>& apart) const {
    const Vector3<double> p = point({cell.pixel[0], cell.pixel[1]}, distance_);
    const SolvedProjection::PixelByPoint by_point = camera_.by_point(p);
    SolvedProjection::PixelByFree a = camera_.by_free(p);
    a += SolvedProjection::by_motion(by_point, p, distance_) * motion_;
    const Eigen::Matrix2d c = a * covariance_ * a.transpose();
    cell.covariance = {c(0, 0), c(1, 1), c(0, 1)};
    const Eigen::Matrix<double, 3, 2> across =
        by_point.transpose() * (by_point * by_point.transpose()).inverse();
    cell.metres =
        distance_ > 0.0 ? std::sqrt(std::max(0.0, (across * c * across.transpose()).trace())) : 0.0;
    if (!determined_ && c.allFinite()) {
      cell.covariance = {HUGE_VAL, HUGE_VAL, 0.0};
      cell.metres = HUGE_VAL;
    }
    cell.difference = apart ? (a * *apart).norm() : 0.0;
    return a;
  }

  const SolvedProjection& camera_;
  SeenByCamera seen_;
  Eigen::MatrixXd covariance_, motion_;
  std::vector<double> deviations_;  ///< of its free parameters
  bool determined_ = true;
  double distance_ = 0.0;
};

}  // namespace
}  // namespace detail

double KnownPixel::deviation() const {
  return std::sqrt(covariance[0] + covariance[1]);
}

const KnownPixel* ProjectionMap::at(double u, double v) const {
  const auto part = [](double x, double from, double to, int parts) {
    return static_cast<int>(std::floor((x - from) / (to - from) * parts));
  };
  if (!(u >= low[0] && u <= high[0] && v >= low[1] && v <= high[1])) return nullptr;
  const int c = std::min(part(u, low[0], high[0], columns), columns - 1);
  const int r = std::min(part(v, low[1], high[1], rows), rows - 1);
  return &cells[static_cast<std::size_t>(r * columns + c)];
}

std::size_t ProjectionMap::region_of(const KnownPixel& cell) const {
  const auto share = [&](std::size_t i) { return (cell.pixel[i] - low[i]) / (high[i] - low[i]); };
  return image_region(share(0), share(1));
}

std::array<double, 3> ProjectionMap::deviations() const {
  std::vector<double> all, of_features;
  for (const KnownPixel& cell : cells) {
    const double deviation = cell.deviation();
    if (std::isnan(deviation)) continue;
    all.push_back(deviation);
    if (cell.features > 0) of_features.push_back(deviation);
  }
  if (all.empty() || of_features.empty()) return {};
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return {*least, median_of(of_features), *most};
}

std::vector<ProjectionMap> projection_maps(const KnownSolution& solution) {
  const AnyProblem& problem = solution.evaluator.problem();
  std::vector<ProjectionMap> maps;
  std::optional<detail::Halves> halves;
  const FeaturePlaces places(problem, solution.values);
  for (std::size_t s = 0; s < problem.sensors().size(); ++s) {
    const MountedSensor& mounted = problem.sensors()[s];
    if (!mounted.sensor().is_camera() || measures_depth(mounted.sensor())) continue;
    detail::SeenByCamera seen = detail::seen_by(solution, places, static_cast<int>(s));
    if (seen.pixels.empty()) continue;
    const detail::SolvedProjection camera(mounted, solution.free, solution.values, seen.settings);
    if (camera.columns().empty()) continue;
    if (maps.empty()) halves = detail::halves_of(solution);
    std::optional<Eigen::VectorXd> apart;
    const auto own = [&](std::size_t half) {
      const Eigen::VectorXd& values = halves->values[half];
      return camera.own({values.data(), static_cast<std::size_t>(values.size())});
    };
    Eigen::MatrixXd allowed;
    if (halves) {
      const std::vector<int>& columns = camera.columns();
      apart = own(0) - own(1);
      allowed =
          halves->covariance(columns, solution.uncertainty.covariance.matrix()(columns, columns));
    }
    maps.push_back(detail::CameraMap(solution, camera, std::move(seen))
                       .map(mounted.mount().name, apart, allowed, solution.poses.count - 1.0));
  }
  return maps;
}

}  // namespace kinecal
