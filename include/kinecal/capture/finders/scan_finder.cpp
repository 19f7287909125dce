// Definitions of scan_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/scan_finder.hpp"

namespace kinecal {

Found ScanFinder::find(const View& view) const {
  if (z_repeats < 1) {
    return refused("z_repeats must be at least 1, is " + std::to_string(z_repeats));
  }
  const RegionPoints scan = points_in({"", nullptr, least, most}, view);
  if (!scan.problem.empty()) return refused(scan.problem);
  if (view.points.height != 1) {
    return refused("a scan has one row of points, the cloud of '" + view.frame + "' has " +
                   std::to_string(view.points.height));
  }
  if (!frame.empty() && !frame_T_scanner) {
    return refused("the pose of '" + view.frame + "' in '" + frame + "' is not known");
  }
  std::string problem;
  const auto frame_T_points = frame.empty()
                                  ? Pose<double>{}
                                  : pose_in({frame, frame_T_scanner, least, most}, view, problem);
  if (!frame_T_points) return refused(problem);
  if (scan.points.empty()) return refused("the scan has no point in the box");
  Observation observation{sensor, {}, {}};
  for (const Vector3<double>& p : scan.points) {
    for (int i = 0; i < z_repeats; ++i) {
      Feature feature;
      feature.frame = frame.empty() ? view.frame : frame;
      feature.point =
          *frame_T_points * Vector3<double>(p + i * z_offset * Vector3<double>::UnitZ());
      observation.features.push_back(feature);
    }
  }
  return {{observation}, "", {}};
}

}  // namespace kinecal
