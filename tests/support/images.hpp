// A board seen by a camera, with raw or rectified pixels that carry the same camera_info.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "support/unknown_poses.hpp"

namespace kinecal::test {

/// A lens with distortion, and a rectified image of another size.
inline CameraInfo lens() {
  CameraInfo info = camera_info();
  info.d = {-0.2, 0.05, 1e-3, -1e-3, 0.0};
  info.p = {520, 0, 325, 0, 0, 515, 236, 0, 0, 0, 1, 0};
  return info;
}

/// The board of unknown_poses.hpp, whose pixels are of a raw or a rectified image of this camera.
inline Scenario board(const CameraInfo& info, ImageKind truth, int count = 15) {
  Scenario scenario = board_scenario(true, 5, count);
  const PinholeCamera camera{truth};
  for (Sample& sample : scenario.samples) {
    Observation& eye = sample.observations[1];
    eye.camera = info;
    const auto settings = camera.settings(eye);
    for (Feature& feature : eye.features) {
      const Vector3<double> ray((feature.point.x() - 320) / (550 * 1.01),
                                (feature.point.y() - 240) / (545 * 1.01), 1.0);
      feature.point.head<2>() = camera.predict(ray, settings, std::array<double, 4>{});
    }
  }
  return scenario;
}

/// The gantry of unknown_poses.hpp as a file.
inline std::string gantry_urdf() {
  const auto axis = [](const Joint& joint) {
    return joint.axis.x() > 0.5 ? "1 0 0" : joint.axis.y() > 0.5 ? "0 1 0" : "0 0 1";
  };
  std::string text = "<robot name=\"gantry\"><link name=\"base_link\"/>";
  const Robot robot = gantry("hand");
  for (const Joint& joint : robot.joints()) {
    const bool slides = joint.type == JointType::prismatic;
    text += "<link name=\"" + joint.child + "\"/><joint name=\"" + joint.name + "\" type=\"" +
            (joint.type == JointType::fixed ? "fixed"
             : slides                       ? "prismatic"
                                            : "continuous") +
            "\"><parent link=\"" + joint.parent + "\"/><child link=\"" + joint.child +
            "\"/><limit lower=\"-9\" upper=\"9\" effort=\"1\" velocity=\"1\"/><axis xyz=\"" +
            axis(joint) + "\"/></joint>";
  }
  return text + "</robot>";
}

}  // namespace kinecal::test
