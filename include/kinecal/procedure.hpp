// Umbrella header of procedure/: the whole of a calibration, whichever way you come in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/procedure/background_rounds.hpp"
#include "kinecal/procedure/calibrate_crate.hpp"
#include "kinecal/procedure/calibrate_log.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/procedure/calibrated_page.hpp"
#include "kinecal/procedure/crate_config.hpp"
#include "kinecal/procedure/judge_read_back.hpp"
#include "kinecal/procedure/matched_step.hpp"
#include "kinecal/procedure/outline_rounds.hpp"
#include "kinecal/procedure/session_end.hpp"
#include "kinecal/procedure/session_follower.hpp"
#include "kinecal/procedure/surface_blocks.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/procedure/surface_views.hpp"
