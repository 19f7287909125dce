// Collecting the charts of a report.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/charts.hpp"

#include <initializer_list>
#include <iterator>
#include <utility>

#include "kinecal/report/charts/cameras.hpp"
#include "kinecal/report/charts/convergence.hpp"
#include "kinecal/report/charts/correlation.hpp"
#include "kinecal/report/charts/depth.hpp"
#include "kinecal/report/charts/errors.hpp"
#include "kinecal/report/charts/features.hpp"
#include "kinecal/report/charts/held_out.hpp"
#include "kinecal/report/charts/outlines.hpp"
#include "kinecal/report/charts/parameters.hpp"
#include "kinecal/report/charts/pixels.hpp"
#include "kinecal/report/charts/planes.hpp"
#include "kinecal/report/charts/projection.hpp"
#include "kinecal/report/charts/radial.hpp"
#include "kinecal/report/charts/samples.hpp"
#include "kinecal/report/charts/search.hpp"
#include "kinecal/report/charts/unobservable.hpp"
#include "kinecal/report/charts/workspace.hpp"

namespace kinecal {

std::vector<Chart> charts(const ReportData& data) {
  std::vector<Chart> all;
  using Draw = std::vector<Chart> (*)(const ReportData&);
  const Draw of_parameters = [](const ReportData& of) { return parameter_charts(of); };
  for (const Draw draw : std::initializer_list<Draw>{
           error_charts, held_out_charts, search_charts, sample_charts, camera_charts,
           feature_charts, pixel_charts, outline_charts, radial_charts, projection_charts,
           depth_charts, plane_charts, workspace_charts, of_parameters, correlation_charts,
           unobservable_charts, convergence_charts, start_charts}) {
    std::vector<Chart> some = draw(data);
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace kinecal
