// Definitions of hand_eye_fit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/hand_eye_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <vector>

#include "kinecal/files/poses/hand_eye_names.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The same motion in two frames.
struct MotionPair {
  Pose<double> of_flange, of_object;  ///< A and B
};

[[nodiscard]] Pose<double> seen_object(const Sample& sample) {
  const Feature& feature = sample.observation(HandEyeNames::kCamera)->features.front();
  return {feature.rotation.value_or(Matrix3<double>::Identity()), feature.point};
}

/// All pairs whose rotations are less than half a turn by so much that noise does not turn their axes round.
[[nodiscard]] std::vector<MotionPair> motion_pairs(std::span<const Sample> samples, bool on_hand) {
  constexpr double kMost = 3.0;  // radians
  std::vector<MotionPair> pairs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Pose<double>& from = samples[i].poses.at(HandEyeNames::kFlangeJoint);
    for (std::size_t j = i + 1; j < samples.size(); ++j) {
      const Pose<double>& to = samples[j].poses.at(HandEyeNames::kFlangeJoint);
      const Pose<double> a = on_hand ? from.inverse() * to : from * to.inverse();
      const Pose<double> b = seen_object(samples[i]) * seen_object(samples[j]).inverse();
      if (log(a.rotation).norm() < kMost && log(b.rotation).norm() < kMost) {
        pairs.push_back({a, b});
      }
    }
  }
  return pairs;
}

[[nodiscard]] Matrix3<double> mount_rotation(const std::vector<MotionPair>& pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [a, b] : pairs) {
    const Eigen::Vector3d of_a = log(a.rotation), of_b = log(b.rotation);
    sum += of_a * of_b.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  const double sign = (u * v.transpose()).determinant();
  return u * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * v.transpose();
}

}  // namespace
}  // namespace detail

HandEyeFit fit_hand_eye(std::span<const Sample> samples, bool camera_on_hand) {
  const std::vector<detail::MotionPair> pairs = detail::motion_pairs(samples, camera_on_hand);
  HandEyeFit fit;
  fit.mount.rotation = detail::mount_rotation(pairs);
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity() * 1e-9;  // where nothing turns
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  const auto left = [](const Pose<double>& a) {
    return Eigen::Matrix3d(a.rotation - Eigen::Matrix3d::Identity());
  };
  const auto right = [&](const detail::MotionPair& pair) {
    return Eigen::Vector3d(fit.mount.rotation * pair.of_object.translation -
                           pair.of_flange.translation);
  };
  for (const detail::MotionPair& pair : pairs) {
    const Eigen::Matrix3d matrix = left(pair.of_flange);
    information += matrix.transpose() * matrix;
    gradient += matrix.transpose() * right(pair);
  }
  fit.mount.translation = information.ldlt().solve(gradient);
  double squares = 0.0, turns = 0.0;
  for (const detail::MotionPair& pair : pairs) {
    const Matrix3<double> by_flange = pair.of_flange.rotation * fit.mount.rotation,
                          by_object = fit.mount.rotation * pair.of_object.rotation;
    turns += log(Matrix3<double>(by_flange.transpose() * by_object)).squaredNorm();
    squares += (left(pair.of_flange) * fit.mount.translation - right(pair)).squaredNorm();
  }
  fit.difference = std::sqrt(squares / static_cast<double>(pairs.size()));
  fit.turn = std::sqrt(turns / static_cast<double>(pairs.size()));
  return fit;
}

}  // namespace kinecal
