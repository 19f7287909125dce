// Definitions of homography.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/homography.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace kinecal {

namespace detail {
namespace {

constexpr double kPointsOnALine = 1e-9;  // of singular values, relative: points on one line

/// Moves the mean of points to the origin and their mean distance from it to one.
[[nodiscard]] Matrix3<double> plane_normalization(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  double size = 0.0;
  for (const auto& p : points) size += (p - mean).norm() / static_cast<double>(points.size());
  const double scale = size > 0.0 ? 1.0 / size : 1.0;
  Matrix3<double> n = Matrix3<double>::Identity();
  n(0, 0) = n(1, 1) = scale;
  n.col(2).head<2>() = -scale * mean;
  return n;
}

}  // namespace
}  // namespace detail

Eigen::Vector2d mapped(const Matrix3<double>& h, const Eigen::Vector2d& point) {
  const Vector3<double> p = h * Vector3<double>(point.x(), point.y(), 1.0);
  return {p.x() / p.z(), p.y() / p.z()};
}

std::optional<Matrix3<double>> homography(const std::vector<Eigen::Vector2d>& from,
                                          const std::vector<Eigen::Vector2d>& to,
                                          const std::vector<double>& weights) {
  if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
  const Matrix3<double> a = detail::plane_normalization(from), b = detail::plane_normalization(to);
  Eigen::Matrix<double, 9, 9> sums = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d p = mapped(a, from[i]), q = mapped(b, to[i]);
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y(), -q.x(),  //
        0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y(), -q.y();
    sums += (weights.empty() ? 1.0 : weights[i]) * (rows.transpose() * rows);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(sums);
  const auto& values = eigen.eigenvalues();
  if (!(values(1) > detail::kPointsOnALine * values(8))) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  const Matrix3<double> normal =
      (Matrix3<double>() << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8)).finished();
  return Matrix3<double>(b.inverse() * normal * a);
}

std::optional<Pose<double>> plane_pose(const std::vector<Eigen::Vector2d>& plane,
                                       const std::vector<Eigen::Vector2d>& rays) {
  const auto h = homography(plane, rays);
  if (!h) return std::nullopt;
  // H = s (r1 r2 t), and the points are in front of the camera.
  const double scale = std::sqrt(h->col(0).norm() * h->col(1).norm());
  double depths = 0.0;
  for (const Eigen::Vector2d& p : plane) depths += h->row(2).dot(p.homogeneous());
  const Matrix3<double> m = *h / (depths < 0.0 ? -scale : scale);
  Matrix3<double> axes;
  axes << m.col(0), m.col(1), m.col(0).cross(m.col(1));
  const Eigen::JacobiSVD<Matrix3<double>> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose<double> pose;
  pose.rotation = svd.matrixU() * svd.matrixV().transpose();
  pose.translation = m.col(2);
  if (!pose.rotation.allFinite() || pose.rotation.determinant() < 0.0) return std::nullopt;
  return pose;
}

Matrix3<double> turn_to_axis(const std::vector<Vector3<double>>& directions) {
  Vector3<double> mean = Vector3<double>::Zero();
  for (const Vector3<double>& direction : directions) mean += direction.normalized();
  return Eigen::Quaterniond::FromTwoVectors(mean, Vector3<double>::UnitZ()).toRotationMatrix();
}

std::optional<Pose<double>> plane_pose(const std::vector<Eigen::Vector2d>& plane,
                                       const std::vector<Vector3<double>>& directions) {
  const Matrix3<double> turn = turn_to_axis(directions);
  std::vector<Eigen::Vector2d> rays;
  for (const Vector3<double>& direction : directions) {
    const Vector3<double> turned = turn * direction;
    if (!(turned.z() > 0.0)) return std::nullopt;
    rays.emplace_back(turned.hnormalized());
  }
  const auto seen = plane_pose(plane, rays);
  if (!seen) return std::nullopt;
  return Pose<double>{turn.transpose() * seen->rotation, turn.transpose() * seen->translation};
}

std::optional<Pose<double>> rigid_fit(const std::vector<Vector3<double>>& in_a,
                                      const std::vector<Vector3<double>>& in_b) {
  if (in_a.size() < 3 || in_a.size() != in_b.size()) return std::nullopt;
  const double n = static_cast<double>(in_a.size());
  Vector3<double> mean_a = Vector3<double>::Zero(), mean_b = mean_a;
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    mean_a += in_a[i] / n;
    mean_b += in_b[i] / n;
  }
  Matrix3<double> sums = Matrix3<double>::Zero();
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    sums += (in_a[i] - mean_a) * (in_b[i] - mean_b).transpose();
  }
  const Eigen::JacobiSVD<Matrix3<double>> svd(sums, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()(1) > detail::kPointsOnALine * svd.singularValues()(0)))
    return std::nullopt;
  Vector3<double> signs = Vector3<double>::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  Pose<double> a_T_b;
  a_T_b.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  a_T_b.translation = mean_a - a_T_b.rotation * mean_b;
  return a_T_b;
}

}  // namespace kinecal
