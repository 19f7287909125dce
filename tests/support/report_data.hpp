// What a report shows of a simulated calibration: an arm with a camera, and three error blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "kinecal/report/report_data.hpp"

namespace kinecal::test {

/// Numbers that do not depend on the standard library.
class ReportChance {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * double(engine_()) / 4294967296.0;
  }
  /// Of variance one: the sum of twelve uniform ones.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sum;
  }

 private:
  std::mt19937 engine_{7};
};

/// Adds a feature with errors of all directions.
inline ReportedFeature& add_feature(ReportedBlock& block, ReportChance& chance, int sample,
                                    int place, double before, double after) {
  ReportedFeature feature;
  feature.sample = sample;
  feature.feature.place = place;
  double squares = 0.0;
  for (int i = 0; i < block.components; ++i) {
    feature.residual.push_back(after * chance.normal());
    squares += feature.residual.back() * feature.residual.back();
  }
  feature.after = std::sqrt(squares);
  feature.before = std::hypot(before * (0.6 + 0.3 * std::abs(chance.normal())), feature.after);
  block.features.push_back(feature);
  return block.features.back();
}

inline void add_blocks(ReportData& data, int samples, int features) {
  ReportChance chance;
  ReportedBlock points{"hand_eye", "chain3d_to_chain3d", "m", false, 3, 4.6e-4, 1e-3};
  ReportedBlock pixels{"wrist_camera", "chain3d_to_camera2d", "px", false, 2, 0.34, 0.5};
  pixels.image = {1280.0, 720.0};
  ReportedBlock floor{"ground", "chain3d_to_plane", "m", true, 1, 2.1e-3, 0.0};
  for (int s = 0; s < samples; ++s) {
    const double times = data.samples[s].bad ? 12.0 : 1.0;
    for (int f = 0; f < features; ++f) {
      const double x = chance.uniform(0.4, 1.6), y = chance.uniform(-0.8, 0.8);
      auto& point = add_feature(points, chance, s, f, 0.011, 4.6e-4 * times * (f == 2 ? 1.7 : 1.0));
      point.depth = std::hypot(x, y);
      point.point = {{x, y, 0.7}};
      auto& pixel = add_feature(pixels, chance, s, f, 7.0, 0.34 * times);
      pixel.pixel = {{chance.uniform(40.0, 1240.0), chance.uniform(30.0, 690.0)}};
      const double u = ((*pixel.pixel)[0] - 640.0) / 640.0, v = ((*pixel.pixel)[1] - 360.0) / 640.0;
      pixel.residual[0] += 0.9 * u * (u * u + v * v);  // a lens error that was not modelled
      pixel.residual[1] += 0.9 * v * (u * u + v * v);
      pixel.after = std::hypot(pixel.residual[0], pixel.residual[1]);
      auto& seen = add_feature(floor, chance, s, f, 0.02, 1.6e-3);
      seen.point = {{x, y, 0.0}};
      seen.depth = std::hypot(x, y, 1.1);
      seen.residual[0] += 3e-3 * (x - 1.0) * y + 2e-3 * (*seen.depth - 1.5);
      seen.after = std::abs(seen.residual[0]);
    }
  }
  data.blocks = {points, pixels, floor};
  for (ReportedBlock& block : data.blocks) {
    double before = 0.0, after = 0.0;
    for (const ReportedFeature& feature : block.features) {
      before += feature.before * feature.before / double(block.features.size());
      after += feature.after * feature.after / double(block.features.size());
    }
    block.rms_before = std::sqrt(before);
    block.rms_after = std::sqrt(after);
    block.held_out = 1.12 * block.rms_after;
  }
}

inline void add_parameters(ReportData& data) {
  ReportChance chance;
  const auto add = [&](const std::string& name, const std::string& owner, const std::string& unit,
                       double size, double sigma) {
    ReportedParameter parameter{name, owner, unit, size * chance.normal(), 0.0, sigma, ""};
    if (std::abs(parameter.value) < 1.96 * sigma) parameter.note = "not significant";
    data.parameters.push_back(parameter);
    data.correlated.push_back(name);
  };
  for (const std::string joint :
       {"torso_lift", "shoulder_pan", "shoulder_lift", "upperarm_roll", "elbow_flex",
        "forearm_roll", "wrist_flex", "wrist_roll", "head_pan", "head_tilt"}) {
    add(joint + "_joint", joint + "_joint", joint == "torso_lift" ? "m" : "rad", 0.012, 0.0011);
  }
  for (const std::string frame : {"head_camera_rgb_joint", "checkerboard"}) {
    for (const std::string axis : {"_x", "_y", "_z"}) add(frame + axis, frame, "m", 0.006, 8e-4);
    for (const std::string axis : {"_a", "_b", "_c"}) add(frame + axis, frame, "rad", 0.01, 9e-4);
  }
  for (const std::string name : {"fx", "fy", "cx", "cy", "z_scaling"}) {
    add("camera_" + name, "camera", "1", 0.01, 2e-3);
  }
  data.parameters[1].sigma.reset();
  data.parameters[1].note = "not determined";
  data.parameters[8].note = "hardly determined";
  data.parameters[8].sigma = 0.03;
  data.parameters[16].value = 1.25;  // a board whose place nobody knew
  const std::size_t n = data.correlated.size();
  data.correlation.assign(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double near = i - j < 3 ? 0.8 : 0.25;
      data.correlation[i][j] = data.correlation[j][i] = near * chance.uniform(-1.0, 1.0);
    }
    data.correlation[i][i] = 1.0;
  }
  data.unobservable = {
      {{"shoulder_pan_joint", 0.71}, {"head_camera_rgb_joint_c", -0.70}, {"head_pan_joint", 0.05}},
      {{"head_tilt_joint", 0.62}, {"head_camera_rgb_joint_b", -0.78}}};
  data.hold = {"shoulder_pan_joint", "head_tilt_joint"};
  data.rank = static_cast<int>(n) - 2;
}

inline void add_steps(ReportData& data) {
  StepResult first, second;
  first.name = "arm and head";
  first.converged = second.converged = true;
  first.costs = {4.1e6, 3.2e5, 8200.0, 960.0, 611.0, 598.2, 598.1, 598.1};
  second.name = "camera";
  second.costs = {1200.0, 420.0, 318.0, 640.0, 520.0, 518.8, 518.8};
  second.starts.random_starts = 60;
  second.starts.failed = 3;
  second.starts.minima = {{518.8, 41}, {731.2, 12}, {9120.0, 4}};
  second.starts.taken = 0;
  data.steps = {first, second};
}

inline void add_search(ReportData& data) {
  data.search.unit = "m";
  const auto add = [&](const std::string& freed, int parameters, double held_out,
                       bool is_chosen = true) {
    data.search.steps.push_back({freed,
                                 parameters,
                                 0.94 * held_out,
                                 held_out,
                                 0.07 * held_out,
                                 0.0,
                                 3.1,
                                 is_chosen,
                                 {},
                                 {}});
  };
  add("", 9, 5.2e-3);
  add("elbow_flex_joint", 10, 1.9e-3);
  add("shoulder_lift_joint", 11, 9.5e-4);
  add("wrist_flex_joint_eccentric_sin, wrist_flex_joint_eccentric_cos", 13, 5.1e-4);
  add("wrist_flex_joint_x", 14, 4.6e-4);
  add("wrist_roll_joint_gear_ratio", 15, 4.65e-4, false);
  data.search.steps[2].alike = {"shoulder_lift_joint_b", "upperarm_roll_joint_b"};
}

inline void add_workspace(ReportData& data) {
  for (double x = 0.3; x < 1.2; x += 0.1) {
    for (double y = -0.6; y < 0.65; y += 0.1) {
      for (double z = 0.2; z < 1.5; z += 0.1) {
        const double reach = std::sqrt(x * x + y * y + (z - 0.7) * (z - 0.7));
        if (reach < 1.1) data.workspace.push_back({{{x, y, z}}, 3e-4 + 1.2e-3 * reach * reach});
      }
    }
  }
}

/// A calibration with three error blocks, two samples that do not fit and one that was left out.
/// @param features  of each sample and block
inline ReportData report_data(int samples = 100, int features = 4) {
  ReportData data;
  data.robot = "fetch";
  for (int s = 0; s < samples; ++s) {
    ReportedSample sample;
    sample.number = s + 1 + (s >= 36 ? 1 : 0);
    sample.source = "samples.yaml:" + std::to_string(40 * s + 1);
    sample.bad = samples > 20 && (s == 17 || s == 63);
    data.samples.push_back(sample);
  }
  if (samples > 36) {
    ReportedSample out;
    out.number = 37;
    out.left_out = true;
    data.samples.push_back(out);
  }
  add_blocks(data, samples, features);
  add_parameters(data);
  add_steps(data);
  add_search(data);
  add_workspace(data);
  return data;
}

}  // namespace kinecal::test
