// Definitions of find_doubts.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/find_doubts.hpp"

#include "kinecal/config/doubts/accelerometer_axes.hpp"
#include "kinecal/config/doubts/check_weight.hpp"
#include "kinecal/config/doubts/drive_readings.hpp"
#include "kinecal/config/doubts/enough_samples.hpp"
#include "kinecal/config/doubts/ignored_urdf.hpp"
#include "kinecal/config/doubts/initial_values.hpp"
#include "kinecal/config/doubts/joint_positions.hpp"
#include "kinecal/config/doubts/measured_poses.hpp"
#include "kinecal/config/doubts/repeated_samples.hpp"
#include "kinecal/config/doubts/sensor_points.hpp"
#include "kinecal/config/doubts/urdf_units.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/doubts/xacro_left.hpp"

namespace kinecal {

void find_doubts(const CalibrationInput& input, Diagnostics& diagnostics) {
  const auto& [config, robot, urdf_text, urdf, samples, calibration, recorded, is_part] = input;
  const std::size_t before = diagnostics.errors.size();
  detail::check_initial_values(config, diagnostics);
  const bool has_text = !urdf_text.empty();
  if (has_text) {
    detail::check_xacro(urdf_text, urdf, diagnostics);
    detail::check_ignored_urdf(robot, urdf_text, urdf, diagnostics);
    detail::check_urdf_units(config, robot, urdf_text, urdf, diagnostics);
  }
  detail::check_weight(config, samples, diagnostics);
  detail::check_drive_readings(config, samples, diagnostics);
  if (samples.empty() || before > 0) return;  // the rest needs models that match the robot
  const std::vector<detail::UsedJoint> joints = detail::used_joints(config, robot, samples);
  detail::check_joint_positions(detail::with_initial_zeros(config, joints), samples, diagnostics);
  detail::check_stopped_joints(joints, samples, diagnostics);
  detail::check_dropped_observations(config, samples, diagnostics);
  const std::size_t distinct = detail::check_repeated_samples(config, joints, samples, diagnostics);
  if (!is_part && (distinct > 1 || samples.size() == 1)) {
    detail::check_still_joints(config, joints, diagnostics);
    detail::check_enough_samples(config, calibration, distinct, diagnostics);
    detail::check_measured_poses(config, robot, samples, diagnostics);
  }
  detail::check_accelerometer_axes(config, robot, samples, diagnostics);
  detail::check_sensor_points(config, robot, samples, diagnostics);
  if (diagnostics.errors.size() > before) return;
  detail::check_spreads(config, robot, samples, diagnostics);
  if (diagnostics.errors.size() > before) return;
  if (has_text)
    detail::check_rising(config, robot, urdf_text, urdf, samples, recorded, diagnostics);
}

}  // namespace kinecal
