// The scene of a calibration as JSON, for the viewer in the HTML report.
//
// Lengths are metres, angles radians; a pose is [x, y, z, qx, qy, qz, qw].
//
//   { "base": 0,                  index of the link in which points are given
//     "links":  [{"name", "visuals": [{"kind": "box", "size": [3], "pose": [7], "color": [r, g, b]},
//                                     {"kind": "cylinder", "radius", "length", ...},
//                                     {"kind": "sphere", "radius", ...},
//                                     {"kind": "mesh", "mesh": 0, "scale": [3], ...}]}],
//     "joints": [{"name", "type", "parent": 0, "child": 1, "origin": [7], "axis": [3],
//                 "drive": [index into q or -1, multiplier, offset],
//                 "before": {"t": [3], "r": [3], "offset"}, "after": ..., "virtual": true}],
//     "meshes": [{"vertices": base64 of float32 x y z, "triangles": base64 of uint32 a b c}],
//     "names": [joint of q[0], ...],
//     "samples": [{"number": 1, "source", "bad": false, "note", "q": [...],
//                  "cloud": base64 of float32 x y z, "cloud_link": 3,
//                  "matched": {"before": {"low": [x, y, z], "step": 0.0001, "points": base64 of uint16 x y z d},
//                              "after": ...},  points in the base: low + step * xyz; distance from the robot: step * d
//                  "features": [{"block": 0, "name", "before": [[3], [3]], "after": ..., "error"}]}],
//     "blocks": [names], "thinned": "200 of 10000 samples",
//     "cameras": [{"name", "link", "pose": [7], "width", "height", "fx", "fy", "cx", "cy"}],
//     "workspace": {"unit": "mm", "points": [[x, y, z, error], ...]} }
//
// A joint is at  multiplier * q + offset + correction's offset, without joint models, which are too small to be
// seen.  Missing items are omitted: a correction, a note, a point behind a camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// The scene as JSON in the form above.  It may stand in an HTML <script>: it has no <, > and &, and is
/// ASCII whatever the names are.
[[nodiscard]] std::string scene_json(const RobotScene& scene);

}  // namespace kinecal
