// A calibration problem: sensors on a robot, its samples packed for evaluation, terms of the cost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/block_rows.hpp"
#include "kinecal/crate/block_term.hpp"
#include "kinecal/crate/difference_gram.hpp"
#include "kinecal/crate/evaluate.hpp"
#include "kinecal/crate/feature_gram.hpp"
#include "kinecal/crate/feature_rows.hpp"
#include "kinecal/crate/jacobian_rows.hpp"
#include "kinecal/crate/local_sums.hpp"
#include "kinecal/crate/normal_equations.hpp"
#include "kinecal/crate/packed_sample.hpp"
#include "kinecal/crate/parallel.hpp"
#include "kinecal/crate/plane_rows.hpp"
#include "kinecal/crate/prior_term.hpp"
#include "kinecal/crate/problem.hpp"
#include "kinecal/crate/sensor_model.hpp"
#include "kinecal/crate/sensor_view.hpp"
#include "kinecal/crate/term.hpp"
