// What a calibration of cameras begins with, where nobody knows it: intrinsics, lenses, where the cameras stand on
// their body, and where the target was in each sample.
//
// Each camera without a K begins by camera_start(), and is then calibrated alone, as a fisheye with the target at a pose of its
// own in each view: that converges from afar, and its image is round whatever lens it has.  The lens of the configuration begins as
// close to it as it can.  Poses of a target come from homographies; where cameras stand, from samples that two of
// them share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Fills in what the samples and the configuration do not say.  Needs `per_sample`; does nothing without it.
/// @param robot    with_own_frames()
/// @param samples  get the camera_info of cameras without one, and Sample::poses of the target
/// @param config   gets initial values of frames of cameras that stand on the base by a fixed joint of their own
void start_cameras(Config& config, const Robot& robot, std::vector<Sample>& samples,
                   Diagnostics& diagnostics);

}  // namespace kinecal
