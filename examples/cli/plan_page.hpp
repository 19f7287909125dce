// What a plan found, as a page with a chart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/report/charts/pose_curve.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// What a plan found.
struct PlanFindings {
  bool reached = false;  ///< the accuracy that is asked for
  std::string title;     ///< "14 poses give 0.497 mm"
  std::string about;     ///< whose position, and the sentences of what was found
  std::string lost;      ///< what no number of poses determines
  PoseCurve curve;
};

/// The page as HTML.
[[nodiscard]] std::string plan_page(const StudyInput& input, const PlanFindings& findings);

}  // namespace kinecal::cli
