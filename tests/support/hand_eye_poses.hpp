// Simulated hand-eye calibrations: poses of a flange and of a marker in the camera, with their truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "support/unknown_poses.hpp"

namespace kinecal::test {

/// How the flange turns between poses.
enum class FlangeTurns { any, one_axis, none };

/// A camera on the hand and a marker in the world, or the reverse, anywhere.
struct HandEyePoses {
  Pose<double> mount;  ///< flange_T_camera of a camera on the hand, else base_T_camera
  std::vector<Pose<double>> flange, object;  ///< base_T_flange and camera_T_object of each sample

  /// @param position, angle  noise of a pose of the marker, metres and radians
  HandEyePoses(bool on_hand, int count, std::uint64_t seed, FlangeTurns turns = FlangeTurns::any,
               double position = 1e-3, double angle = 5e-3) {
    Chance chance(seed);
    mount = chance.pose(on_hand ? 0.2 : 1.5);
    const Pose<double> marker = chance.pose(on_hand ? 1.5 : 0.2);
    const Matrix3<double> first = chance.rotation();
    for (int n = 0; n < count; ++n) {
      Vector3<double> turn = chance.box(0.8);
      if (turns == FlangeTurns::one_axis) turn = {0.0, 0.0, chance(-1.5, 1.5)};
      if (turns == FlangeTurns::none) turn.setZero();
      flange.push_back({Matrix3<double>(first * exp(turn)), chance.box(0.4)});
      const Pose<double> sees = on_hand ? Pose<double>(flange.back() * mount) : mount;
      const Pose<double> at = on_hand ? marker : Pose<double>(flange.back() * marker);
      Pose<double> seen = sees.inverse() * at;
      const auto normal = [&] {
        const double x = chance.normal(), y = chance.normal(), z = chance.normal();
        return Vector3<double>(x, y, z);
      };
      seen.translation += position * normal();
      seen.rotation = Matrix3<double>(seen.rotation * exp(Vector3<double>(angle * normal())));
      object.push_back(seen);
    }
  }

  /// The file that MoveIt Calibration saves.
  [[nodiscard]] std::string moveit_text() const {
    std::string text;
    for (std::size_t i = 0; i < flange.size(); ++i) {
      text += "- effector_wrt_world:\n" + rows(flange[i]);
      text += "  object_wrt_sensor:\n" + rows(object[i]);
    }
    return text;
  }

 private:
  [[nodiscard]] static std::string rows(const Pose<double>& pose) {
    std::string text;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) text += fmt::format("    - {}\n", pose.rotation(i, j));
      text += fmt::format("    - {}\n", pose.translation(i));
    }
    return text + "    - 0\n    - 0\n    - 0\n    - 1\n";
  }
};

}  // namespace kinecal::test
