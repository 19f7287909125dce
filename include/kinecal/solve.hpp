// Umbrella header of solve/: calibrating with Ceres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/core.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/solve/calibrate_crate.hpp"
#include "kinecal/solve/ceres_bridge.hpp"
#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/solve/pose_search.hpp"
#include "kinecal/solve/rotation_grid.hpp"
#include "kinecal/solve/settle.hpp"
#include "kinecal/solve/shards.hpp"
#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/solve/stack.hpp"
#include "kinecal/solve/stacked_cost.hpp"
#include "kinecal/solve/start_summary.hpp"
#include "kinecal/solve/starts.hpp"
#include "kinecal/solve/statistics.hpp"
