// The result of a plan as a page with a chart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/report/charts/pose_curve.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// The result of a plan.
struct PlanFindings {
  bool reached = false;  ///< true if the requested accuracy is reached
  std::string title;     ///< "14 poses give 0.497 mm"
  std::string about;     ///< whose position, and the findings as sentences
  std::string lost;      ///< parameter combinations that no number of poses determines
  PoseCurve curve;
};

/// The page as HTML.
[[nodiscard]] std::string plan_page(const StudyInput& input, const PlanFindings& findings);

}  // namespace kinecal::cli
