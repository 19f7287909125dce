// Umbrella header of trust/: how far a result can be believed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/capture_causes.hpp"
#include "kinecal/trust/captures.hpp"
#include "kinecal/trust/compared_frames.hpp"
#include "kinecal/trust/drift.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/noise.hpp"
#include "kinecal/trust/observability.hpp"
#include "kinecal/trust/online.hpp"
#include "kinecal/trust/plain_matrix.hpp"
#include "kinecal/trust/pose_change.hpp"
#include "kinecal/trust/pose_uncertainty.hpp"
#include "kinecal/trust/reading.hpp"
#include "kinecal/trust/recording_change.hpp"
#include "kinecal/trust/reluctance.hpp"
#include "kinecal/trust/ruined.hpp"
#include "kinecal/trust/uncertainty.hpp"
#include "kinecal/trust/weak_parameters.hpp"
