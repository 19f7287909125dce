// Definitions of calibrated_page.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/calibrated_page.hpp"

#include "kinecal/files/urdf/visuals.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/scene_clouds.hpp"
#include "kinecal/report/scene_json.hpp"
#include "kinecal/report/scene_meshes.hpp"
#include "kinecal/trust/uncertainty/workspace_map.hpp"

namespace kinecal {

namespace detail {
namespace {

/// How well a camera knows points where the robot works; empty if nothing is compared.
[[nodiscard]] std::vector<KnownPoint> workspace_of(const CalibratedRobot& calibrated) {
  constexpr int kPoses = 400;
  const Findings& findings = calibrated;
  if (findings.assessments.empty() || findings.assessments.back().compared.empty()) return {};
  std::vector<double> values;
  for (const Parameter& parameter : findings.result.table) values.push_back(parameter.value);
  const std::size_t step = findings.assessments.size() - 1;
  return workspace_map(*calibrated.setup.calibration.steps[step].problem,
                       findings.assessments.back(), findings.assessments.back().compared[0], values,
                       kPoses);
}

}  // namespace
}  // namespace detail

RobotScene calibrated_scene(const CalibratedRobot& calibrated,
                            const std::vector<std::string>& mesh_paths, Diagnostics& diagnostics,
                            const SceneLimits& limits) {
  const PreparedCalibration& setup = calibrated.setup;
  RobotScene scene = robot_scene(setup.calibration, calibrated, calibrated.samples, limits,
                                 calibrated.left_out_samples);
  add_visuals(visuals(setup.urdf_text, setup.urdf, diagnostics),
              mesh_places(setup.urdf, mesh_paths), setup.urdf, scene, diagnostics);
  return scene;
}

ReportData calibrated_data(const CalibratedRobot& calibrated) {
  return report_data(calibrated.setup.calibration, calibrated, calibrated.samples,
                     calibrated.left_out_samples);
}

std::string calibrated_page(const CalibratedRobot& calibrated, const PageOptions& options,
                            Diagnostics& diagnostics) {
  ReportData data = calibrated_data(calibrated);
  data.version = options.version;
  data.command = options.command;
  data.date = options.date;
  data.inputs = options.inputs;
  data.workspace = detail::workspace_of(calibrated);
  RobotScene scene = calibrated_scene(calibrated, options.mesh_paths, diagnostics);
  for (const KnownPoint& point : data.workspace) {
    const auto& [x, y, z] = point.p_base;
    scene.workspace.push_back({x, y, z, point.deviation});
  }
  add_clouds(options.recordings, scene);
  add_points(scene, data);
  return html_report(data, scene_json(scene));
}

}  // namespace kinecal
