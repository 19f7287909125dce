// kinecal rpy: rotation vectors as roll, pitch, yaw, and back.
//
// A free frame is calibrated as a rotation vector; a URDF has roll, pitch, yaw.  The three numbers
// look alike but are not the same.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/geometry/rpy.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "commands.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

Vector3<double> three_numbers(const std::vector<std::string>& texts) {
  if (texts.size() != 3) throw InputError(fmt::format("{} numbers, not 3", texts.size()));
  Vector3<double> numbers = Vector3<double>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const std::string& text = texts[static_cast<std::size_t>(i)];
    const auto number = number_from_yaml(text);
    if (!number || !std::isfinite(*number)) {
      throw InputError("'" + text + "' is not a finite number");
    }
    constexpr double kMost = 1e6;  // radians; beyond that no digits are left
    if (std::abs(*number) > kMost) throw InputError("'" + text + "' is too large for an angle");
    numbers(i) = *number;
  }
  return numbers;
}

/// Prints a line with every digit, for programs, and one in degrees, for people.
void print(const char* what, const Vector3<double>& v) {
  const Vector3<double> r = v + Vector3<double>::Zero();  // never -0
  const Vector3<double> d = r * (180.0 / std::numbers::pi);
  say("{}, rad  {} {} {}\n", what, r.x(), r.y(), r.z());
  say("{}, deg  {:.6f} {:.6f} {:.6f}\n", what, d.x(), d.y(), d.z());
}

}  // namespace

int rpy(const RpyOptions& options) {
  const Vector3<double> given = three_numbers(options.numbers);
  const Matrix3<double> rotation = options.to_vector ? rotation_from_rpy(given) : exp(given);
  const Vector3<double> vector = options.to_vector ? Vector3<double>(log(rotation)) : given;
  const Vector3<double> angles = options.to_vector ? given : rpy_from_rotation(rotation);
  if (options.comma) {
    const Vector3<double> r = (options.to_vector ? vector : angles) + Vector3<double>::Zero();
    say("{}, {}, {}\n", r.x(), r.y(), r.z());
    return kDone;
  }
  print("rotation vector", vector);
  print("roll, pitch, yaw", angles);
  return kDone;
}

}  // namespace kinecal::cli
