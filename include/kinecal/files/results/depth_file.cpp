// Definitions of depth_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/depth_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A number of the file: its name, unit and place.
struct DepthNumber {
  std::string_view name;
  std::string_view unit;
  double DepthErrors::*member;
};
constexpr std::size_t kSettingsOfDepth = 6;  ///< numbers that are settings; then parameters
constexpr std::array kDepthNumbers = {
    DepthNumber{"fx", "pixels", &DepthErrors::fx},
    DepthNumber{"fy", "pixels", &DepthErrors::fy},
    DepthNumber{"cx", "pixels", &DepthErrors::cx},
    DepthNumber{"cy", "pixels", &DepthErrors::cy},
    DepthNumber{"recorded_z_offset", "m", &DepthErrors::recorded_z_offset},
    DepthNumber{"recorded_z_scaling", "a factor", &DepthErrors::recorded_z_scaling},
    DepthNumber{"z_offset", "m", &DepthErrors::z_offset},
    DepthNumber{"z_scaling", "1", &DepthErrors::z_scaling},
    DepthNumber{"z_quadratic", "1/m", &DepthErrors::z_quadratic},
    DepthNumber{"z_x", "1", &DepthErrors::z_x},
    DepthNumber{"z_y", "1", &DepthErrors::z_y},
    DepthNumber{"z_xx", "1", &DepthErrors::z_xx},
    DepthNumber{"z_xy", "1", &DepthErrors::z_xy},
    DepthNumber{"z_yy", "1", &DepthErrors::z_yy}};

/// Calls f with each recorded point of a camera, and its sample.
void for_each_point(const std::string& camera, std::span<const Sample> samples,
                    const std::function<void(const Vector3<double>&, const Sample&)>& f) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen == nullptr) continue;
    for (const Feature& feature : seen->features) {
      if (feature.point.allFinite() && feature.point.z() > 0.0) f(feature.point, sample);
    }
  }
}

/// The true depth of a recorded point.
[[nodiscard]] double depth_of(const DepthErrors& errors, const Vector3<double>& p, double z) {
  const double u = errors.fx * p.x() / p.z() + errors.cx, v = errors.fy * p.y() / p.z() + errors.cy;
  return true_depth(errors, u, v, z);
}

/// "x -0.31 to 0.28, y -0.22 to 0.24, depth 0.62 to 1.8 m": where features are.
[[nodiscard]] std::string seen_where(const std::string& camera, std::span<const Sample> samples) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vector3<double> least = Vector3<double>::Constant(kInfinity), most = -least;
  for_each_point(camera, samples, [&](const Vector3<double>& p, const Sample&) {
    const Vector3<double> at(p.x() / p.z(), p.y() / p.z(), p.z());
    least = least.cwiseMin(at).eval();
    most = most.cwiseMax(at).eval();
  });
  return fmt::format("x {:.2g} to {:.2g}, y {:.2g} to {:.2g}, depth {:.3g} to {:.3g} m", least.x(),
                     most.x(), least.y(), most.y(), least.z(), most.z());
}

constexpr const char* kDepthFormula = R"(#
#   x = (u - cx) / fx      y = (v - cy) / fy
#   z1 = (measured / recorded_z_scaling - recorded_z_offset + z_offset) (1 + z_scaling)
#   depth = z1 (1 + z_quadratic z1 + z_x x + z_y y + z_xx x^2 + z_xy x y + z_yy y^2)
#
# u, v: pixel; measured: the driver's depth, metres along the optical axis.  fx fy cx cy and recorded_* are
# the settings while recording: the point is depth times the ray of the calibrated intrinsics.  A driver that has z_offset and
# z_scaling already gives z1.  kinecal/sensors/depth/true_depth.hpp applies this and needs the standard library only.
)";

}  // namespace
}  // namespace detail

bool CalibratedDepth::bends() const {
  return std::any_of(kDepthPolynomial.begin(), kDepthPolynomial.end(),
                     [&](const auto& bend) { return values.at(std::string(bend.name)) != 0.0; });
}

CalibratedDepth calibrated_depth(const MountedSensor& sensor, const Observation& seen,
                                 ParameterValues values) {
  CalibratedDepth depth;
  const std::vector<double> own = sensor.own_values(values);
  const std::array<double, 6> settings = DepthCamera::settings(seen);
  for (std::size_t i = 0; i < detail::kDepthNumbers.size(); ++i) {
    const detail::DepthNumber& number = detail::kDepthNumbers[i];
    double& value = depth.errors.*number.member;
    if (i < detail::kSettingsOfDepth) {
      value = settings[i];
    } else {  // after fx fy cx cy
      const std::size_t k = i - detail::kSettingsOfDepth + 4;
      value = own[k];
      depth.parameters[std::string(number.name)] = sensor.parameters()[k];
    }
    depth.values[std::string(number.name)] = value;
  }
  depth.width = static_cast<int>(seen.camera->width);
  depth.height = static_cast<int>(seen.camera->height);
  return depth;
}

std::string impossible_depth(const CalibratedDepth& depth, const std::string& camera,
                             std::span<const Sample> samples) {
  if (!depth.bends()) return {};
  std::string why;
  detail::for_each_point(camera, samples, [&](const Vector3<double>& p, const Sample& sample) {
    if (!why.empty()) return;
    constexpr double kStep = 1e-4;  // of the depth
    const double z = detail::depth_of(depth.errors, p, p.z());
    const double beyond = detail::depth_of(depth.errors, p, (1.0 + kStep) * p.z());
    if (z > 0.0 && beyond > z) return;
    why = fmt::format(
        "its depth correction is impossible: {}, a point at {:.3g} m, x {:.2g}, y {:.2g} ",
        sample.source, p.z(), p.x() / p.z(), p.y() / p.z());
    why += z > 0.0 ? "would be nearer if it were farther" : fmt::format("would be at {:.3g} m", z);
    why += "; hold z_quadratic or the terms of the image";
  });
  return why;
}

std::string depth_correction_yaml(const CalibratedDepth& depth, const std::string& camera,
                                  const std::map<int, double>& deviations,
                                  std::span<const Sample> samples) {
  std::string text = fmt::format("# The true depth of pixels of camera '{}'.\n", camera);
  text += detail::kDepthFormula;
  text += fmt::format("# Fitted to features in {}; elsewhere it is a guess.\n",
                      detail::seen_where(camera, samples));
  text += fmt::format("camera_name: {}\nimage_width: {}\nimage_height: {}\n",
                      detail::name_to_yaml(camera), depth.width, depth.height);
  for (const detail::DepthNumber& number : detail::kDepthNumbers) {
    text += fmt::format("{}: {}  # {}", number.name, number_to_yaml(depth.errors.*number.member),
                        number.unit == "1" ? "relative" : number.unit);
    const auto parameter = depth.parameters.find(std::string(number.name));
    if (parameter != depth.parameters.end()) {
      const auto deviation = deviations.find(parameter->second);
      if (deviation != deviations.end()) {
        text += std::isfinite(deviation->second) ? fmt::format(", +- {:.2g}", deviation->second)
                                                 : ", not determined";
      }
    }
    text += "\n";
  }
  return text;
}

}  // namespace kinecal
