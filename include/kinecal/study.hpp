// Umbrella header of study/: simulated robots and cameras, and what calibrations of them are worth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/study/error_sizes.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/joint_motion.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/study/motion_order.hpp"
#include "kinecal/study/render.hpp"
#include "kinecal/study/repeatability.hpp"
#include "kinecal/study/sample_design.hpp"
#include "kinecal/study/scene.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/study/select_poses.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "kinecal/study/simulated_camera.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "kinecal/study/study_summary.hpp"
#include "kinecal/study/tag_grid.hpp"
#include "kinecal/study/true_robot.hpp"
