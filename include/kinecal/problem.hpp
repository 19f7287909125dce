// Umbrella header of problem/: what a calibration is: sensors on a robot, batches of samples, terms.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/batches.hpp"
#include "kinecal/problem/mounted_sensor.hpp"
#include "kinecal/problem/sample_layout.hpp"
#include "kinecal/problem/sample_reading.hpp"
#include "kinecal/problem/sampled_chain.hpp"
#include "kinecal/problem/term.hpp"
