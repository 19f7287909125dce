// Measured and predicted points for each kind of error block.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/trust/feature_places.hpp"

namespace kinecal::detail {

/// A pair of points; nullopt if one of them is NaN.
[[nodiscard]] inline std::optional<ScenePair> scene_pair(const Vector3<double>& measured,
                                                         const Vector3<double>& predicted) {
  if (!measured.allFinite() || !predicted.allFinite()) return std::nullopt;
  const auto numbers = [](const Vector3<double>& p) { return ScenePoint{p.x(), p.y(), p.z()}; };
  return ScenePair{numbers(measured), numbers(predicted)};
}

/// A point, and the point of a line of sight at its depth; nullopt behind the camera.
[[nodiscard]] inline std::optional<ScenePair> pair_at_depth(const PlacedFeature& predicted,
                                                            const PlacedFeature& ray) {
  const double depth = ray.axis.dot(predicted.point - ray.origin);
  if (!(depth > 0.0)) return std::nullopt;
  return scene_pair(ray.origin + ray.point * (depth / ray.axis.dot(ray.point)), predicted.point);
}

/// Where two lines of sight are nearest to each other; nullopt if they are parallel.
[[nodiscard]] inline std::optional<ScenePair> pair_of_rays(const PlacedFeature& a,
                                                           const PlacedFeature& b) {
  const Vector3<double> u = a.point.normalized(), v = b.point.normalized();
  const Vector3<double> way = b.origin - a.origin;
  const double c = u.dot(v), across = 1.0 - c * c;
  if (!(across > 1e-12)) return std::nullopt;
  const double along_a = (way.dot(u) - c * way.dot(v)) / across,
               along_b = (c * way.dot(u) - way.dot(v)) / across;
  return scene_pair(a.origin + u * along_a, b.origin + v * along_b);
}

/// The point at a distance from another one, towards the measured point.
[[nodiscard]] inline std::optional<ScenePair> pair_at_distance(const Vector3<double>& measured,
                                                               const Vector3<double>& from,
                                                               double distance) {
  return scene_pair(measured, from + (measured - from).normalized() * distance);
}

/// The plane through points; nullopt if they do not determine one.
[[nodiscard]] inline std::optional<Plane<double>> plane_through(
    const std::vector<Vector3<double>>& points) {
  if (points.size() < 3) return std::nullopt;
  const PlaneFit<double> fit(points);
  if (!fit.determined()) return std::nullopt;
  return fit.plane();
}

/// The foot of each point of a sensor on the plane of the other sensor's; both ways.
[[nodiscard]] inline std::vector<std::optional<ScenePair>> pairs_of_planes(
    const std::vector<PlacedFeature>& a, const std::vector<PlacedFeature>& b) {
  const auto fit = [](const std::vector<PlacedFeature>& features) {
    std::vector<Vector3<double>> points;
    for (const PlacedFeature& feature : features) {
      if (feature.seen) points.push_back(feature.point);
    }
    return plane_through(points);
  };
  const auto of_a = fit(a), of_b = fit(b);
  if (!of_a || !of_b) return {};
  std::vector<std::optional<ScenePair>> pairs;
  const auto add = [&](const std::vector<PlacedFeature>& features, const Plane<double>& plane) {
    for (const PlacedFeature& feature : features) {
      if (!feature.seen) continue;
      const double off = plane.normal.dot(feature.point - plane.centroid);
      pairs.push_back(scene_pair(feature.point, feature.point - plane.normal * off));
    }
  };
  add(a, *of_b);
  add(b, *of_a);
  return pairs;
}

/// The normal of a plane when only distances of points are known: r = n . p + d.
///
/// In the principal axes of the points, the two components along their extent follow from a linear
/// fit.  Points near a plane hardly determine the third; the length of n gives it, with the sign
/// that fits.
class PlaneOfDistances {
 public:
  void add(const Vector3<double>& p, double r) {
    points_.push_back(p);
    distances_.push_back(r);
  }
  /// (3) unit vector; nullopt if the points are on one line.
  [[nodiscard]] std::optional<Vector3<double>> normal() const {
    const auto plane = plane_through(points_);
    if (!plane) return std::nullopt;
    const Vector3<double>&centroid = plane->centroid, &across = plane->normal;
    double mean = 0.0;
    for (const double r : distances_) mean += r / static_cast<double>(distances_.size());
    Matrix3<double> scatter = Matrix3<double>::Zero();
    Vector3<double> moment = Vector3<double>::Zero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3<double> q = points_[i] - centroid;
      scatter += q * q.transpose();
      moment += q * (distances_[i] - mean);
    }
    // The minimum of |q . n - r|^2 over n perpendicular to `across`: a term holds what is along it
    // at zero.
    const Matrix3<double> out = across * across.transpose(), in = Matrix3<double>::Identity() - out;
    const Matrix3<double> held = in * scatter * in + out * scatter.trace();
    const Vector3<double> along = held.inverse() * (in * moment);
    const double rest = std::sqrt(std::max(0.0, 1.0 - along.squaredNorm()));
    const auto misfit = [&](const Vector3<double>& n) {
      double sum = 0.0;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const double off = n.dot(points_[i] - centroid) - (distances_[i] - mean);
        sum += off * off;
      }
      return sum;
    };
    const Vector3<double> up = along + across * rest, down = along - across * rest;
    return (misfit(up) <= misfit(down) ? up : down).normalized();
  }

 private:
  std::vector<Vector3<double>> points_;
  std::vector<double> distances_;
};

}  // namespace kinecal::detail
