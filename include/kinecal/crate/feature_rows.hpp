// The residual of one feature and its derivatives, before kinematics enters.
//
// Whatever an error block compares, a residual changes only because rigid bodies move (one per
// sensor: everything at the end of its chain) and because camera parameters change:
//
//   dr = sum over bodies of  by_body (v, w)  +  sum over camera parameters of  by_camera dk
//
// with the twist (v, w) of the body in the base.  A point p with dr = D dp gives by_body =
// D [I, -[p]x]: a row d of D becomes (d, p x d).  The free parameters of a chain enter later, once
// for all features: see local_sums.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/crate/sensor_view.hpp"

namespace kinecal {

/// Residual of one feature and its derivatives.
template <class S, int M, int Bodies>
struct FeatureRows {
  /// The most camera parameters that a feature can depend on.
  static constexpr int kMaxCameras = Bodies * DepthCamera<>::kParameters;

  S weight{1.0};                    ///< one, or zero where the feature is missing
  Eigen::Matrix<S, M, 1> residual;  ///< (M) unweighted
  std::array<Eigen::Matrix<S, M, 6>, Bodies> by_body;              ///< by linear, by angular
  std::array<Eigen::Matrix<S, M, 1>, kMaxCameras> by_camera = {};  ///< by each free parameter
  std::size_t cameras = 0;                                         ///< number of them

  /// Sets the rows of a body.
  /// @param p         (3) the feature, metres, in the base
  /// @param by_point  (M x 3) derivative of the residual with respect to p: D
  void set_point(std::size_t body, const Vector3<S>& p, const Eigen::Matrix<S, M, 3>& by_point) {
    for (int row = 0; row < M; ++row) {
      const Vector3<S> d = by_point.row(row);
      by_body[body].row(row) << d.transpose(), cross(p, d).transpose();
    }
  }

  /// Adds the columns of the depth camera that observed the point, if one did.
  void add_camera(const SensorView<S>& view, std::size_t feature,
                  const Eigen::Matrix<S, M, 3>& by_point) {
    view.for_each_camera_motion(
        feature, [&](const Vector3<S>& motion) { by_camera[cameras++] = by_point * motion; });
  }
};

/// The bodies of a feature: the chain at whose end it is, for each sensor of an error block.
template <std::size_t Bodies>
using BodyChains = std::array<std::size_t, Bodies>;

/// Columns of the whole Jacobian on which a feature depends, in this order: those of each body
/// (rotational, then translational), then those of the cameras.  A parameter that moves both bodies
/// occurs twice.
template <class S, std::size_t Bodies>
void local_columns(std::span<const SensorView<S>* const> views, const BodyChains<Bodies>& chains,
                   std::vector<int>& columns) {
  columns.clear();
  const auto append = [&](const std::vector<int>& more) {
    columns.insert(columns.end(), more.begin(), more.end());
  };
  for (std::size_t s = 0; s < Bodies; ++s) {
    const TwistColumns& twists = views[s]->state().twist_columns[chains[s]];
    append(twists.turns);
    append(twists.shifts);
  }
  for (const SensorView<S>* view : views) append(view->state().camera_columns);
}

}  // namespace kinecal
