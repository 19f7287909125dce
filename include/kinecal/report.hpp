// Umbrella header of report/: results for people and programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/report/chart_style.hpp"
#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/charts/charts.hpp"
#include "kinecal/report/charts/density.hpp"
#include "kinecal/report/charts/distance_axis.hpp"
#include "kinecal/report/charts/errors.hpp"
#include "kinecal/report/charts/features.hpp"
#include "kinecal/report/charts/held_out.hpp"
#include "kinecal/report/charts/parameters.hpp"
#include "kinecal/report/charts/samples.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/report/recorded_poses.hpp"
#include "kinecal/report/report_data.hpp"
#include "kinecal/report/residuals_csv.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_axis.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/report/text.hpp"
