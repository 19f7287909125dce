// Photographs of a board that somebody held before a camera, as corners with noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::test {

/// A camera and its photographs.
struct Photographs {
  CameraInfo truth;             ///< of the camera
  std::string lens;             ///< kinecal's name of its lens
  std::vector<Sample> samples;  ///< with the poses of the board, roughly

  struct Options {
    int views = 25;
    double noise = 0.2;   ///< of each coordinate, pixels
    double aside = 0.25;  ///< how far the board is moved sideways, of its distance
    double bend = 0.0;    ///< of the board: farther by this at its corners, metres
    unsigned seed = 1;
  };
  Photographs(CameraInfo info, std::string lens_of_it, const Options& options)
      : truth(std::move(info)), lens(std::move(lens_of_it)) {
    std::mt19937 random(options.seed);
    std::normal_distribution<double> normal;
    const auto uniform = [&](double reach) {
      return std::uniform_real_distribution<double>(-reach, reach)(random);
    };
    const auto eye = any_built_in(lens_camera(lens));
    constexpr int kColumns = 9, kRows = 7;
    constexpr double kSquare = 0.04;
    while (std::ssize(samples) < options.views) {
      const double distance = 0.5 + uniform(0.15);
      const Pose<double> camera_T_board{
          exp(Vector3<double>(uniform(0.6), uniform(0.6), uniform(3.0))),
          {distance * uniform(options.aside), distance * uniform(options.aside), distance}};
      Sample sample;
      Observation board{"board", {}, {}}, seen{"camera", {}, truth};
      for (int i = 0; i < kColumns * kRows; ++i) {
        const Vector3<double> corner(kSquare * (i % kColumns - 0.5 * (kColumns - 1)),
                                     kSquare * (i / kColumns - 0.5 * (kRows - 1)), 0.0);
        const double far = corner.squaredNorm() / (0.04 * (16.0 + 9.0) * 0.04);
        const Vector3<double> bent = corner + Vector3<double>(0.0, 0.0, options.bend * far);
        const Vector3<double> p = camera_T_board * bent;
        const Eigen::Vector2d pixel = eye->predict(p, eye->settings(seen));
        if (!pixel.allFinite() || pixel.minCoeff() < 0.0 || pixel.x() > truth.width ||
            pixel.y() > truth.height) {
          continue;
        }
        board.features.push_back({"board", corner});
        seen.features.push_back({"camera",
                                 {pixel.x() + options.noise * normal(random),
                                  pixel.y() + options.noise * normal(random), 0.0}});
      }
      constexpr std::size_t kFewest = 20;
      if (seen.features.size() < kFewest) continue;
      sample.observations = {board, seen};
      sample.poses["board"] = camera_T_board;
      sample.source = "view " + std::to_string(samples.size());
      samples.push_back(sample);
    }
  }

  /// A calibration that starts at the recorded camera_info, with a lens.
  /// @param names  of the free parameters, without "camera_"
  [[nodiscard]] Calibration calibration(const std::vector<std::string>& names) const {
    ParameterTable table;
    const auto eye = any_built_in(lens_camera(lens));
    for (const ParameterInfo& info : eye->parameters()) {
      table.add({.name = "camera_" + std::string(info.name), .unit = std::string(info.unit)});
    }
    add_parameters(table, "board", kFrameParameters);
    const Joint board{"board", JointType::floating, "camera", "board", {}, {}, {}, {}};
    auto problem = make_problem(Robot("camera", {board}), "camera", table, {"board"});
    problem->give_sample_poses({"board"});
    problem->add_built_in(ChainPoint{}, {"board", "board"});
    problem->add_built_in(lens_camera(lens), {"camera", "camera"});
    problem->add_built_in("corners", PointToPixel{}, {"board", "camera"}, {.unit = "px"});
    for (const Sample& sample : samples) problem->add_sample(sample);
    std::vector<int> free;
    for (const std::string& name : names) free.push_back(table.find("camera_" + name));
    Calibration all{table, {}};
    all.steps.push_back({"camera", 100, std::move(problem), FreeSet(free, table.size()), {}, {}});
    return all;
  }
};

/// A camera with some distortion.
inline CameraInfo distorted_camera() {
  CameraInfo info;
  info.width = 1280;
  info.height = 960;
  info.distortion_model = "plumb_bob";
  info.d = {-0.25, 0.08, 0.0, 0.0, 0.0};
  info.k = {800, 0, 640, 0, 800, 480, 0, 0, 1};
  return info;
}

/// A camera that sees 120 degrees in its diagonal, or more.
/// @param focal  pixels
inline CameraInfo fisheye_camera(double focal) {
  CameraInfo info = distorted_camera();
  info.distortion_model = "equidistant";
  info.d = {-0.02, 0.005, 0.0, 0.0};
  info.k = {focal, 0, 640, 0, focal, 480, 0, 0, 1};
  return info;
}

}  // namespace kinecal::test
