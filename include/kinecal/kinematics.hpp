// Umbrella header of kinematics/: robots, chains, the walk and its walkers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/chain_checks.hpp"
#include "kinecal/kinematics/chain_fold.hpp"
#include "kinecal/kinematics/corrections.hpp"
#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/kinematics/gravity_load.hpp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/kinematics/known_name.hpp"
#include "kinecal/kinematics/pose_batch.hpp"
#include "kinecal/kinematics/pose_walker.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/kinematics/robot_data.hpp"
#include "kinecal/kinematics/static_chain.hpp"
#include "kinecal/kinematics/static_pose.hpp"
#include "kinecal/kinematics/static_robot.hpp"
#include "kinecal/kinematics/true_position.hpp"
#include "kinecal/kinematics/twist_walker.hpp"
#include "kinecal/kinematics/walk.hpp"
