// A magnetometer that turns in the field of the earth, simulated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::test {

/// Its errors, microtesla, and how it turns.
struct SimulatedMagnetometer {
  Vector3<double> bias{12.0, -7.0, 20.0};
  Eigen::Matrix3d soft = Eigen::Matrix3d::Identity();  ///< A: what undoes its soft iron
  Vector3<double> earth{20.0, 1.0, -44.0};             ///< in the world
  double noise = 0.3;                                  ///< of a component
  bool all_ways = false;  ///< turned by hand, else by a base: two turns about its z axis
  Vector3<double> mount = Vector3<double>::Zero();  ///< rotation vector of the sensor on the base

  /// Readings as samples.
  [[nodiscard]] std::vector<Sample> samples(int count, unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Sample> all;
    for (int i = 0; i < count; ++i) {
      const double turned = 4.0 * 3.141592653589793 * i / count;
      Vector3<double> rotation(0.0, 0.0, turned);
      if (all_ways) {
        const double up = 1.0 - 2.0 * (i + 0.5) / count, angle = 2.399963229728653 * i;
        const double beside = std::sqrt(1.0 - up * up);
        rotation = 2.5 * Vector3<double>(beside * std::cos(angle), beside * std::sin(angle), up);
      }
      const Vector3<double> seen = exp(mount).transpose() * (exp(rotation).transpose() * earth);
      Vector3<double> reading = Vector3<double>(soft.inverse() * seen) + bias;
      for (int axis = 0; axis < 3; ++axis) reading(axis) += noise * normal(random);
      Sample& sample = all.emplace_back();
      sample.source = "mag.bag:" + std::to_string(i + 1);
      sample.conditions = {{"mag_x", reading.x()}, {"mag_y", reading.y()}, {"mag_z", reading.z()}};
    }
    return all;
  }
};

/// Turned all ways, with soft iron: gains that differ by 13 %, and axes that are not at right angles.
inline SimulatedMagnetometer with_soft_iron(double noise = 0.3) {
  SimulatedMagnetometer of{.noise = noise, .all_ways = true};
  of.soft << 1.08, 0.03, -0.02, 0.03, 0.95, 0.01, -0.02, 0.01, 1.0;
  return of;
}

}  // namespace kinecal::test
