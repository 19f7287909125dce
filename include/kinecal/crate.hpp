// Door of crate/: a robot's sensors, samples and error blocks as one problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/block_term.hpp"
#include "kinecal/crate/prior_term.hpp"
#include "kinecal/crate/problem.hpp"
#include "kinecal/crate/sensor_model.hpp"
#include "kinecal/crate/sensor_view.hpp"
#include "kinecal/crate/term.hpp"
