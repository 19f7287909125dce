// Poses and Jacobians of many joint positions at once, in packets: what callers with arrays take.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/kinematics/chain.hpp"

namespace kinecal {

/// Where a joint of a chain finds its position in an array: multiplier * column + offset.
struct PositionColumn {
  int column = -1;          ///< -1: it stays at the offset
  double multiplier = 1.0;  ///< of a mimic joint
  double offset = 0.0;      ///< radians or metres
};

/// A chain whose joint positions are columns of an array.
struct ChainOfColumns {
  RuntimeChain chain = {};
  std::vector<PositionColumn> joints = {};  ///< of the chain, in its order
  int columns = 0;                          ///< of the array
};

/// The chain between two links, with positions by the names of joints.
/// @param names  of the columns; joints without one stay at zero
/// @throws RobotError  if a link does not exist (with the nearest name), or see make_chain()
[[nodiscard]] ChainOfColumns make_chain_of_columns(const Robot& robot, const std::string& base,
                                                   const std::string& tip,
                                                   const std::vector<std::string>& names);

/// Forward kinematics of each row.
/// @param positions  (n x columns) row by row, radians or metres
/// @param poses      out: (n x 4 x 4) row by row, base_T_tip
/// @param jacobians  out: (n x 6 x columns) row by row: linear, then angular velocity of the tip in the base for that of a
///                   column (see geometric_jacobian()); empty: not wanted
/// @throws std::invalid_argument  if a size is not that of the others
void forward_kinematics(const ChainOfColumns& chain, std::span<const double> positions,
                        std::span<double> poses, std::span<double> jacobians = {});

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/kinematics/pose_batch.ipp"
#endif
