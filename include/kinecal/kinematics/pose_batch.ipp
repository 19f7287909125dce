// Definitions of pose_batch.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/geometry/sin_cos.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/kinematics/pose_batch.hpp"

namespace kinecal {

namespace detail {

/// Joint positions of as many poses as a packet has lanes.
using PackedPositions = Eigen::Map<const Eigen::Matrix<Packet, Eigen::Dynamic, 1>>;

/// Their motions: sine and cosine of all lanes at once.
template <>
struct JointStatesAt<PackedPositions> {
  const PackedPositions& q;

  [[nodiscard]] JointState<Packet> operator[](std::size_t i) const {
    const Packet& position = q(static_cast<Eigen::Index>(i));
    const SinCos<Packet> at = sin_cos(position);
    return {position, at.cos, at.sin};
  }
};

/// The packets of one batch of rows.
struct PoseBatch {
  std::vector<Packet> positions = {};  ///< (joints)
  std::vector<Packet> jacobian = {};   ///< (6 x joints), column by column
};

/// Poses, and Jacobians if wanted, of the rows from `first` on; lanes beyond the last row repeat it.
KINECAL_FLATTEN inline void evaluate_batch(const ChainOfColumns& of,
                                           std::span<const double> positions, std::size_t first,
                                           std::size_t rows, std::span<double> poses,
                                           std::span<double> jacobians, PoseBatch& batch) {
  const std::size_t joints = of.joints.size(), columns = static_cast<std::size_t>(of.columns);
  for (std::size_t j = 0; j < joints; ++j) {
    const PositionColumn& joint = of.joints[j];
    for (std::size_t lane = 0; lane < Packet::size(); ++lane) {
      const std::size_t row = std::min(first + lane, rows - 1);
      const double at = joint.column < 0
                            ? 0.0
                            : positions[row * columns + static_cast<std::size_t>(joint.column)];
      batch.positions[j].set(lane, joint.multiplier * at + joint.offset);
    }
  }
  const PackedPositions q(batch.positions.data(), static_cast<Eigen::Index>(joints));
  Pose<Packet> pose;
  if (jacobians.empty()) {
    pose = forward_kinematics(of.chain, q);
  } else {
    pose = geometric_jacobian(of.chain, q,
                              Eigen::Map<Eigen::Matrix<Packet, 6, Eigen::Dynamic>>(
                                  batch.jacobian.data(), 6, static_cast<Eigen::Index>(joints)));
  }
  for (std::size_t lane = 0; lane < std::min(Packet::size(), rows - first); ++lane) {
    double* out = &poses[16 * (first + lane)];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) out[4 * i + k] = pose.rotation(i, k)[lane];
      out[4 * i + 3] = pose.translation(i)[lane];
      out[12 + i] = 0.0;
    }
    out[15] = 1.0;
    if (jacobians.empty()) continue;
    double* derivative = &jacobians[6 * columns * (first + lane)];
    std::fill_n(derivative, 6 * columns, 0.0);
    for (std::size_t j = 0; j < joints; ++j) {
      const PositionColumn& joint = of.joints[j];
      if (joint.column < 0) continue;
      for (std::size_t i = 0; i < 6; ++i) {
        derivative[i * columns + static_cast<std::size_t>(joint.column)] +=
            joint.multiplier * batch.jacobian[6 * j + i][lane];
      }
    }
  }
}

}  // namespace detail

KINECAL_INLINE ChainOfColumns make_chain_of_columns(const Robot& robot, const std::string& base,
                                                    const std::string& tip,
                                                    const std::vector<std::string>& names) {
  ChainOfColumns result{.chain = make_chain(robot, base, tip),
                        .columns = static_cast<int>(names.size())};
  for (const ChainJoint& joint : result.chain.joints) {
    PositionColumn column{.multiplier = joint.drive.multiplier, .offset = joint.drive.offset};
    const auto found = std::find(names.begin(), names.end(), joint.drive.joint);
    if (found != names.end()) column.column = static_cast<int>(found - names.begin());
    result.joints.push_back(column);
  }
  return result;
}

KINECAL_INLINE void forward_kinematics(const ChainOfColumns& chain,
                                       std::span<const double> positions, std::span<double> poses,
                                       std::span<double> jacobians) {
  const std::size_t rows = poses.size() / 16, columns = static_cast<std::size_t>(chain.columns);
  if (poses.size() % 16 != 0 || positions.size() != rows * columns ||
      (!jacobians.empty() && jacobians.size() != 6 * rows * columns) ||
      chain.joints.size() != chain.chain.joints.size()) {
    throw std::invalid_argument("forward kinematics of arrays whose sizes do not go together");
  }
  detail::PoseBatch batch{.positions = std::vector<Packet>(chain.joints.size()),
                          .jacobian = std::vector<Packet>(6 * chain.joints.size())};
  for (std::size_t first = 0; first < rows; first += Packet::size()) {
    detail::evaluate_batch(chain, positions, first, rows, poses, jacobians, batch);
  }
}

}  // namespace kinecal
