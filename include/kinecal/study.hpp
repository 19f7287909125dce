// Umbrella header of study/: simulated robots and cameras.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/study/joint_motion.hpp"
#include "kinecal/study/render.hpp"
#include "kinecal/study/scene.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/study/simulated_camera.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "kinecal/study/tag_grid.hpp"
#include "kinecal/study/true_robot.hpp"
