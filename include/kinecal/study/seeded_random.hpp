// Random numbers for simulations: the same seed gives the same numbers on every platform.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// Random numbers, equal for equal seeds on every platform.  (The standard defines mt19937_64, but
/// not the algorithms of distributions.)
class SeededRandom {
 public:
  /// Each seed gives another sequence.
  explicit SeededRandom(std::uint64_t seed) : engine_(seed) {}

  /// From `lower` to `upper`, uniformly distributed.
  [[nodiscard]] double uniform(double lower, double upper) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return lower + unit * (upper - lower);
  }

  /// From `first` to `last`, both included.
  [[nodiscard]] int integer(int first, int last) {
    return first + static_cast<int>(uniform(0.0, last - first + 1.0));
  }

  /// A number of random sign whose absolute value is between the two.
  [[nodiscard]] double either_sign(double least, double most) {
    const double size = uniform(least, most);
    return uniform(0.0, 1.0) < 0.5 ? -size : size;
  }

  /// Mean 0, standard deviation 1.  Source: Box, Muller, 1958.
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log1p(-uniform(0.0, 1.0)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
  }

  /// Three of them, independent.
  [[nodiscard]] Vector3<double> normal_vector() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

  /// A unit vector in a uniformly random direction.
  [[nodiscard]] Vector3<double> direction() { return normal_vector().normalized(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace kinecal
