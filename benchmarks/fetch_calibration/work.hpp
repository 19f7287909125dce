// The workload: the calibration of a Fetch from 100 samples of four LEDs.
//
//   r = p_camera - p_arm     metres, in torso_lift_link
//
// with 12 residuals per sample and 26 free parameters.  The samples are recorded if the data sets are
// present (KINECAL_DATA), else simulated with the same shape.  There are no priors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

#include "kinecal/files/samples/read_samples.hpp"
#include "made_samples.hpp"

#ifndef KINECAL_DATA_DEFAULT
#define KINECAL_DATA_DEFAULT ""
#endif

namespace kinecal::bench {

inline constexpr int kSamples = 100;

/// One sample with names resolved; each method prepares it once.
struct Sighting {
  const Sample* sample;
  std::array<double, 6> camera;                   ///< as recorded
  std::array<Vector3<double>, kLeds> measured{};  ///< pixel and raw depth: pixels, metres
  std::array<Vector3<double>, kLeds> on_arm{};    ///< metres, in wrist_roll_link

  /// Measured position of a joint, radians.
  [[nodiscard]] double operator()(const std::string& joint) const {
    return sample->position(joint).value();
  }
};

/// @throws std::invalid_argument  if it does not have four points of the arm and of the camera
[[nodiscard]] inline Sighting sighting(const Sample& sample) {
  const Observation* camera = sample.observation("camera");
  const Observation* arm = sample.observation("arm");
  if (camera == nullptr || arm == nullptr || !camera->camera || camera->features.size() != kLeds ||
      arm->features.size() != kLeds) {
    throw std::invalid_argument(sample.source + ": not four LEDs seen by camera and arm");
  }
  Sighting seen{&sample, DepthCamera::settings(*camera)};
  for (std::size_t i = 0; i < kLeds; ++i) {
    seen.measured[i] = DepthCamera::measurement(camera->features[i].point, seen.camera);
    seen.on_arm[i] = arm->features[i].point;
  }
  return seen;
}

struct FetchWork {
  Robot robot = fetch_robot();
  ParameterTable table = fetch_parameters(0.0, 1.0);
  Mount arm = arm_mount(), camera = camera_mount();
  std::vector<Sample> samples;
  bool recorded = false;  ///< false if the samples are simulated

  FetchWork() {
    const char* folder = std::getenv("KINECAL_DATA");
    const std::filesystem::path file =
        std::filesystem::path(folder != nullptr ? folder : KINECAL_DATA_DEFAULT) /
        "fetch/synth/samples.yaml";
    recorded = std::filesystem::exists(file);
    if (recorded) {
      Diagnostics diagnostics;
      samples = read_samples(file.string(), diagnostics);
      diagnostics.throw_if_errors();
      const CameraInfo& info = samples.front().observation("camera")->camera.value();
      table = fetch_parameters(info.z_offset, info.z_scaling);
    } else {
      samples = MadeSamples(robot, table, made_values(table))(kSamples);
    }
  }

  /// n samples: the given ones, repeated.
  [[nodiscard]] std::vector<Sample> cycled(int n) const {
    std::vector<Sample> result;
    result.reserve(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      result.push_back(samples[static_cast<std::size_t>(i) % samples.size()]);
    }
    return result;
  }

  [[nodiscard]] std::vector<Sighting> sightings(int n) const {
    std::vector<Sighting> result;
    result.reserve(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      result.push_back(sighting(samples[static_cast<std::size_t>(i) % samples.size()]));
    }
    return result;
  }

  /// The values at which evaluations are timed: not zero, and not at the minimum.
  [[nodiscard]] Eigen::VectorXd timed_values() const { return 0.5 * made_values(table); }

  /// The values at which a calibration starts.
  [[nodiscard]] Eigen::VectorXd initial_values() const { return table.values(); }
};

/// The chains that all methods walk.  Constant transforms are folded into the joints, so all
/// methods visit the same joints.
struct FetchChains {
  RuntimeChain arm, camera;
  std::array<int, 6> camera_parameters{};  ///< in the table, in the order of DepthCamera

  explicit FetchChains(const FetchWork& work)
      : arm(make_chain(work.robot, kBase, work.arm.frame, kFreeFrames)),
        camera(make_chain(work.robot, kBase, work.camera.frame, kFreeFrames)) {
    for (std::size_t i = 0; i < camera_parameters.size(); ++i) {
      camera_parameters[i] = work.table.index(
          parameter_name(work.camera.parameter_prefix(), DepthCamera::kParameters[i].name));
    }
  }
};

}  // namespace kinecal::bench
