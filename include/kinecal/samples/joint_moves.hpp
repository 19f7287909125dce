// The direction from which each joint came to its pose, from the order of a recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <span>
#include <string>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Sets Sample::joint_moves: the distance of each joint from where it stood before, in the samples
/// of one recording.  Smaller distances than 1e-3 (radians or metres) are no move: the joint keeps
/// the direction in which it moved last.
/// @param samples  in the order of the recording
inline void set_joint_moves(std::span<Sample> samples) {
  constexpr double kStill = 1e-3;
  struct Last {
    double position, move;
  };
  std::map<std::string, Last> last;
  for (Sample& sample : samples) {
    sample.joint_moves.assign(sample.joint_names.size(), 0.0);
    for (std::size_t i = 0; i < sample.joint_names.size() && i < sample.joint_positions.size();
         ++i) {
      const double position = sample.joint_positions[i];
      auto [known, is_new] = last.try_emplace(sample.joint_names[i], Last{position, 0.0});
      if (const double move = position - known->second.position; std::abs(move) > kStill) {
        known->second = {position, move};
      }
      sample.joint_moves[i] = known->second.move;
    }
  }
}

}  // namespace kinecal
