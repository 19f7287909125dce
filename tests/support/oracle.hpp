// The oracle: every residual of a problem differentiated by jets through everything, the walk, the
// sensors and the block, one wide jet for all parameters.  Slow and obvious.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "kinecal/crate/evaluate.hpp"

namespace kinecal::test {

/// A sensor's features carried to the base in any scalar.
template <class S>
struct OracleView {
  Pose<S> pose;                    ///< of the sensor's frame in the base
  std::vector<Vector3<S>> points;  ///< in the base
  std::array<S, 6> camera_values;
  PackedObservation<double> seen;
};

template <class S>
OracleView<S> oracle_view(const SensorModel& model, const Sample& sample,
                          const std::vector<S>& values) {
  OracleView<S> view;
  view.seen = model.pack(sample, *sample.observation(model.sensor().name));
  view.camera_values.fill(S(0.0));
  for (std::size_t i = 0; i < model.camera_parameters().size(); ++i) {
    const int p = model.camera_parameters()[i];
    if (p >= 0) view.camera_values[i] = values[static_cast<std::size_t>(p)];
  }
  const auto tip_pose = [&](std::size_t c) {
    const auto corrections =
        corrections_for(model.parameters()[c], std::span<const S>(values.data(), values.size()));
    return forward_kinematics(
        model.chains()[c], [&](const std::string& joint) { return *sample.position(joint); },
        corrections);
  };
  for (std::size_t i = 0; i < view.seen.measured.size(); ++i) {
    const Pose<S> pose = tip_pose(view.seen.chain[i]);
    if (model.sensor().type == SensorType::camera2d) {
      view.pose = pose;
      view.points.emplace_back(Vector3<S>::Zero());
    } else if (model.sensor().type == SensorType::camera3d) {
      view.points.push_back(
          pose * view.seen.depth_camera->point(view.seen.measured[i], view.camera_values));
    } else {
      view.points.push_back(pose * view.seen.measured[i]);
    }
  }
  return view;
}

/// The plane through points in any scalar: solved in double, then one Newton step on
/// (M n - l n, n.n - 1) = 0 in S, which makes value and derivatives exact.
template <class S>
Plane<S> oracle_plane(const std::vector<Vector3<S>>& points) {
  std::vector<Vector3<double>> values;
  Plane<S> plane;
  plane.centroid.setZero();
  for (const auto& p : points) {
    values.push_back(Vector3<double>(p(0).a, p(1).a, p(2).a));
    plane.centroid += p / S(static_cast<double>(points.size()));
  }
  const Vector3<double> n = PlaneFit<double>(values).plane().normal;
  Matrix3<S> scatter = Matrix3<S>::Zero();
  for (const auto& p : points) {
    const Vector3<S> q = p - plane.centroid;
    scatter += q * q.transpose();
  }
  const Vector3<S> start = n.cast<S>();
  const S lambda = start.dot(scatter * start);
  Eigen::Matrix<S, 4, 4> system = Eigen::Matrix<S, 4, 4>::Zero();
  system.template topLeftCorner<3, 3>() = scatter - lambda * Matrix3<S>::Identity();
  system.template topRightCorner<3, 1>() = -start;
  system.template bottomLeftCorner<1, 3>() = S(2.0) * start.transpose();
  Eigen::Matrix<S, 4, 1> rhs;
  rhs << lambda * start - scatter * start, S(1.0) - start.squaredNorm();
  plane.normal = start + system.partialPivLu().solve(rhs).template head<3>();
  return plane;
}

template <class S>
PinholeCamera<S> in_scalar(const PinholeCamera<>& c) {
  PinholeCamera<S> camera{S(c.fx), S(c.fy), S(c.cx), S(c.cy), {}};
  for (std::size_t k = 0; k < c.d.size(); ++k) camera.d[k] = S(c.d[k]);
  return camera;
}

/// Residuals of a block between sensors for one sample, features one after the other.
template <class S, ErrorBlock B>
std::vector<S> oracle_residuals(const B& block, const Problem& problem,
                                const std::vector<int>& sensors, const Sample& sample,
                                const std::vector<S>& values) {
  std::vector<OracleView<S>> views;
  for (int s : sensors) {
    views.push_back(oracle_view(problem.sensors()[static_cast<std::size_t>(s)], sample, values));
  }
  std::vector<S> residuals;
  const auto append = [&](const auto& r) {
    for (Eigen::Index i = 0; i < r.size(); ++i) residuals.push_back(r(i));
  };
  if constexpr (PlanePairBlock<B>) {
    append(block(oracle_plane(views[0].points), oracle_plane(views[1].points)));
  } else {
    for (std::size_t i = 0; i < views[0].points.size(); ++i) {
      if constexpr (SightBlock<B>) {
        const OracleView<S>& camera = views[1];
        std::array<S, 4> parameters;
        std::copy_n(camera.camera_values.begin(), 4, parameters.begin());
        append(block(Sight<S>{camera.pose.inverse() * views[0].points[i], parameters,
                              in_scalar<S>(*camera.seen.pinhole_camera),
                              camera.seen.measured[i].template head<2>().template cast<S>()}));
      } else if constexpr (PointPairBlock<B>) {
        append(block(views[0].points[i], views[1].points[i]));
      } else {
        append(block(views[0].points[i]));
      }
    }
  }
  return residuals;
}

}  // namespace kinecal::test
