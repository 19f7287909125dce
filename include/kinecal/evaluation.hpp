// Umbrella header of evaluation/: residuals, Jacobian and normal equations of a problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/basic_problem.hpp"
#include "kinecal/evaluation/block_rows.hpp"
#include "kinecal/evaluation/block_term.hpp"
#include "kinecal/evaluation/compiled_walk.hpp"
#include "kinecal/evaluation/evaluator.hpp"
#include "kinecal/evaluation/feature_rows.hpp"
#include "kinecal/evaluation/feature_wrenches.hpp"
#include "kinecal/evaluation/local_sums.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/evaluation/plane_rows.hpp"
#include "kinecal/evaluation/point_wrenches.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/evaluation/sensor_code.hpp"
#include "kinecal/evaluation/sensor_view.hpp"
#include "kinecal/evaluation/term_code.hpp"
