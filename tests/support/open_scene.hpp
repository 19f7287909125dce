// The scene with sensors that deliver poses, rays and readings, one of them written by a user.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "support/scene.hpp"

namespace kinecal::test {

/// A wire that is pulled out of a drum at the sensor's frame.
struct DrawWire {
  static constexpr std::string_view kType = "draw_wire";
  static constexpr std::array kParameters = {ParameterInfo{"scale"}, ParameterInfo{"zero", "m"}};

  template <class S, class Q>
  [[nodiscard]] Reading<S> place(const Measurement<DrawWire, Q>& m,
                                 const std::array<S, 2>& v) const {
    return {.value = m.point.x() * (1.0 + v[0]) + v[1]};
  }
};

/// Distance of a point to the drum, less the length of the wire.
struct WireLength {
  static constexpr const char* kUnit = "m";
  using Inputs = Takes<Quantity::point, Quantity::reading>;

  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p,
                                                  const Reading<S>& wire) const {
    using std::sqrt;
    const S x = p.x() - wire.origin.x(), y = p.y() - wire.origin.y(), z = p.z() - wire.origin.z();
    return Eigen::Matrix<S, 1, 1>(sqrt(x * x + y * y + z * z) - wire.value);
  }
};

/// Three points on one line, the middle one at an unknown part of the way.
struct BetweenPoints {
  static constexpr const char* kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"part", "1", 0.5}};

  template <class S>
  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& a, const Vector3<S>& b, const Vector3<S>& c,
                                      const std::array<S, 1>& own) const {
    Vector3<S> r;
    for (int k = 0; k < 3; ++k) r(k) = a(k) + (c(k) - a(k)) * own[0] - b(k);
    return r;
  }
};

/// The pixels of one camera with a constant error: a block of pixels with parameters of its own.
struct ShiftedPixel {
  static constexpr const char* kUnit = "px";
  static constexpr std::array kParameters = {ParameterInfo{"u", "px"}, ParameterInfo{"v", "px"}};

  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const PixelObservation<S>& pixel,
                                                  const std::array<S, 2>& own) const {
    return {pixel.predicted.x() - pixel.observed.x() + own[0],
            pixel.predicted.y() - pixel.observed.y() + own[1]};
  }
};

/// A bar between two points that grows with its temperature and bends under a load.
struct ThermalBar {
  static constexpr const char *kType = "thermal_bar", *kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"length", "m", 0.4},
                                             ParameterInfo{"expansion"}};
  static constexpr std::array<std::string_view, 2> kConditions = {"temperature", "load"};
  double bend = 1e-3;  ///< metres per unit of load

  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& a, const Vector3<S>& b,
                                                  const std::array<S, 2>& own,
                                                  const std::array<Q, 2>& conditions) const {
    using std::sqrt;
    const S x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
    const S length = own[0] * (1.0 + own[1] * (conditions[0] - 20.0)) - bend * conditions[1];
    return Eigen::Matrix<S, 1, 1>(sqrt(x * x + y * y + z * z) - length);
  }
};

/// The pixels of a camera whose lens drifts with the temperature by a known amount.
struct WarmPixel {
  static constexpr const char* kUnit = "px";
  static constexpr std::array<std::string_view, 1> kConditions = {"temperature"};

  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const PixelObservation<S>& pixel,
                                                  const std::array<Q, 1>& conditions) const {
    return {pixel.predicted.x() * (1.0 + 1e-4 * conditions[0]) - pixel.observed.x(),
            pixel.predicted.y() - pixel.observed.y()};
  }
};

/// Two parallel walls whose distance grows with the temperature; the same on either side.
struct WarmGap {
  static constexpr const char* kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"gap", "m", 0.4}};
  static constexpr std::array<std::string_view, 1> kConditions = {"temperature"};

  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Plane<S>& a, const Plane<S>& b,
                                                  const std::array<S, 1>& own,
                                                  const std::array<Q, 1>& conditions) const {
    const Vector3<S> between = a.centroid - b.centroid;
    const S distance = b.normal.dot(between), gap = own[0] * (1.0 + 0.01 * conditions[0]);
    return Eigen::Matrix<S, 1, 1>(distance * distance - gap * gap);
  }
};

/// The parameters of the scene, of its further sensors and of a block named "block".
template <ErrorBlock B>
ParameterTable open_table(const B& block) {
  ParameterTable table = scene_table();
  add_parameters(table, "left", std::span(PinholeCamera::kParameters).first(kIntrinsics));
  add_parameters(table, "wire", DrawWire::kParameters);
  add_parameters(table, "block", parameters_of(block));
  return table;
}

/// The problem of the scene with further sensors and one block named "block".
template <class S, ErrorBlock B>
BasicProblem<S> open_problem(const B& block, const std::vector<std::string>& sensors,
                             const TermOptions& options = {},
                             const std::string& base = "base_link") {
  BasicProblem<S> problem(mobile_manipulator(), base, open_table(block), kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  problem.add_sensor(ChainPoint{}, {"elbow_point", "forearm"});
  problem.add_sensor(PinholeCamera{}, {"left", "forearm"});
  problem.add_sensor(ChainPose{}, {"body", "hand"});
  problem.add_sensor(ChainPose{}, {"tracker", "torso"});
  problem.add_sensor(DrawWire{}, {"wire", "torso"});
  problem.add_block("block", block, sensors, options);
  return problem;
}

/// exact_samples() for arm, camera and eye; what the other sensors saw is random.
template <class S>
std::vector<Sample> open_samples(const BasicProblem<S>& problem, std::span<const double> values,
                                 int count, const std::string& arm_frame = "hand") {
  std::vector<Sample> samples = exact_samples(problem, values, count, arm_frame);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-0.5, 0.5), pixel(50, 400);
  const auto vector = [&] { return Vector3<double>{any(random), any(random), any(random)}; };
  for (Sample& sample : samples) {
    sample.conditions = {{"temperature", 20.0 + 30.0 * any(random)},
                         {"load", any(random)},
                         {"ax", 1.3},
                         {"ay", -0.4},
                         {"az", 9.6}};
    for (const char* name : {"elbow_point", "left", "body", "tracker", "wire"}) {
      Observation& seen = sample.observations.emplace_back(Observation{name, {}, camera_info()});
      const std::string frame = name == std::string("tracker") ? "board" : "";
      for (int i = 0; i < 4; ++i) {
        Feature feature{frame, vector(), exp(vector())};
        if (seen.sensor == "left") feature.point = {pixel(random), pixel(random), 0.0};
        if (seen.sensor == "wire") feature.point.x() += 1.0;
        seen.features.push_back(feature);
      }
    }
  }
  return samples;
}

}  // namespace kinecal::test
