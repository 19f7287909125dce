// Umbrella header of samples/: recorded samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/samples/sample.hpp"
