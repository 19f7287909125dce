// Umbrella header of tools/: what the program offers beside calibrations: init, detect, install, simulation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/tools/detect/board_turns.hpp"
#include "kinecal/tools/detect/contact_sheet.hpp"
#include "kinecal/tools/detect/detect.hpp"
#include "kinecal/tools/detect/detect_all.hpp"
#include "kinecal/tools/detect/image_folder.hpp"
#include "kinecal/tools/detect/joint_track.hpp"
#include "kinecal/tools/detect/joint_tracks.hpp"
#include "kinecal/tools/detect/look.hpp"
#include "kinecal/tools/detect/recorded_views.hpp"
#include "kinecal/tools/detect/still_view.hpp"
#include "kinecal/tools/detect/view_topics.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/robot_parts.hpp"
#include "kinecal/tools/install/install.hpp"
#include "kinecal/tools/install/launch_names.hpp"
#include "kinecal/tools/install/result_folder.hpp"
#include "kinecal/tools/simulation/photographs.hpp"
#include "kinecal/tools/simulation/pose_samples.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"
