// Planes through the points of two sensors: residual and derivatives, one lane after the other.
//
// The normal of a plane is an eigenvector.  Its iteration stops at a different step for each
// sample, so it does not run in packets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "kinecal/crate/feature_rows.hpp"
#include "kinecal/errors/error_block.hpp"
#include "kinecal/errors/plane_fit.hpp"

namespace kinecal {

/// Why the features of a sensor in one sample do not determine a plane; empty if they do.
template <class S>
[[nodiscard]] std::string why_no_plane(const PackedObservation<S>& seen) {
  static_assert(kLanes<S> == 1, "one sample");
  std::vector<Vector3<double>> points;
  for (std::size_t i = 0; i < seen.measured.size(); ++i) {
    if (seen.usable[i] == 0.0) continue;
    if (seen.chain[i] != seen.chain[0]) return "the points of a plane are in several frames";
    if (!seen.depth_camera) {
      points.push_back(seen.measured[i]);
      continue;
    }
    const DepthCamera<>& camera = *seen.depth_camera;
    const std::array<double, 6> recorded = {0, 0, 0, 0, camera.z_offset, camera.z_scaling - 1.0};
    points.push_back(camera.point(seen.measured[i], recorded));
  }
  if (points.size() < 3) return "a plane takes three points or more";
  return PlaneFit<S>(points).determined() ? "" : "its points span no plane";
}

namespace detail {

template <class S>
[[nodiscard]] Vector3<double> lane_of(const Vector3<S>& p, int i) {
  return {lane(p.x(), i), lane(p.y(), i), lane(p.z(), i)};
}

/// The planes of one lane and their derivatives.
template <PlanePairBlock B, class S>
class PlaneLane {
 public:
  static constexpr int kSize = kResiduals<B>;  ///< residuals of one feature
  using Rows = FeatureRows<double, kSize, 2>;

  PlaneLane(const B& block, std::span<const SensorView<S>* const> views, int lane)
      : views_(views), lane_(lane) {
    std::array<Plane<J>, 2> planes;
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t i = 0; i < views[s]->points().size(); ++i) {
        if (kinecal::lane(views[s]->observation().usable[i], lane) == 0.0) continue;
        features_[s].push_back(i);
        points_[s].push_back(lane_of(views[s]->points()[i], lane));
      }
      if (points_[s].empty()) return;  // a lane without a sample
      const PlaneFit<LaneOf<S>>& fit = fits_.emplace_back(points_[s]);
      determined_ = fit.determined() && (s == 0 || determined_);
      const int first = 6 * static_cast<int>(s);
      planes[s] = {point_jets<J>(fit.plane().centroid, first),
                   point_jets<J>(fit.plane().normal, first + 3)};
    }
    residual_ = block(planes[0], planes[1]);
    empty_ = false;
  }

  [[nodiscard]] Rows rows(bool derivatives) const {
    Rows rows;
    rows.weight = empty_ ? 0.0 : 1.0;
    rows.residual.setZero();
    for (auto& body : rows.by_body) body.setZero();
    for (auto& camera : rows.by_camera) camera.setZero();
    if (empty_) return rows;
    rows.residual = values_of(residual_);
    if (!determined_) rows.residual.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!derivatives || !determined_) return rows;
    for (std::size_t s = 0; s < 2; ++s) {
      const int variable = 6 * static_cast<int>(s);
      const auto by_centroid = derivatives_by<3>(residual_, variable);
      const auto by_normal = derivatives_by<3>(residual_, variable + 3);
      for (std::size_t n = 0; n < features_[s].size(); ++n) {
        const Vector3<double>& p = points_[s][n];
        const Eigen::Matrix<double, kSize, 3> by_point =
            by_centroid * fits_[s].centroid_by_point() + by_normal * fits_[s].normal_by_point(p);
        Rows of_point;
        of_point.set_point(s, p, by_point);
        rows.by_body[s] += of_point.by_body[s];
        const std::vector<Vector3<double>> motion = camera_motion(s, features_[s][n]);
        const std::size_t first = s == 0 ? 0 : views_[0]->num_camera_motions();
        for (std::size_t k = 0; k < motion.size(); ++k) {
          rows.by_camera[first + k] += by_point * motion[k];
        }
      }
    }
    return rows;
  }

 private:
  using J = Jet<double, 12>;

  [[nodiscard]] std::vector<Vector3<double>> camera_motion(std::size_t s, std::size_t i) const {
    std::vector<Vector3<double>> motion;
    views_[s]->for_each_camera_motion(
        i, [&](const Vector3<S>& m) { motion.push_back(lane_of(m, lane_)); });
    return motion;
  }

  std::span<const SensorView<S>* const> views_;
  int lane_;
  std::array<std::vector<std::size_t>, 2> features_;
  std::array<std::vector<Vector3<double>>, 2> points_;
  std::vector<PlaneFit<LaneOf<S>>> fits_;
  Eigen::Matrix<J, kSize, 1> residual_;
  bool empty_ = true, determined_ = false;
};

}  // namespace detail

/// Residual and derivatives of the planes through all features of two sensors.
template <PlanePairBlock B, class S>
[[nodiscard]] FeatureRows<S, kResiduals<B>, 2> plane_rows(
    const B& block, std::span<const SensorView<S>* const> views, bool derivatives) {
  FeatureRows<S, kResiduals<B>, 2> rows;
  rows.cameras = views[0]->num_camera_motions() + views[1]->num_camera_motions();
  for (int i = 0; i < kLanes<S>; ++i) {
    const auto one = detail::PlaneLane<B, S>(block, views, i).rows(derivatives);
    set_lane(rows.weight, i, one.weight);
    for (int m = 0; m < kResiduals<B>; ++m) {
      set_lane(rows.residual(m), i, one.residual(m));
      for (std::size_t s = 0; s < 2; ++s) {
        for (int k = 0; k < 6; ++k) set_lane(rows.by_body[s](m, k), i, one.by_body[s](m, k));
      }
      for (std::size_t c = 0; c < rows.cameras; ++c) {
        set_lane(rows.by_camera[c](m), i, one.by_camera[c](m));
      }
    }
  }
  return rows;
}

}  // namespace kinecal
