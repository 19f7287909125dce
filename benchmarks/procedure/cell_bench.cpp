// A cell: 250 poses of a board on a flange before four cameras, from nothing to the verdict, and its control, the solve alone.
//
//   cell_bench [REPETITIONS]     5 by default; the least time of each part is printed
//
// Each camera sees the board in each pose: 1000 views of 24 corners.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "kinecal/tools/init/initial_config.hpp"

namespace kinecal {
namespace {

constexpr int kPoses = 250, kCameras = 4;
constexpr double kFocal = 1000.0, kNoise = 0.1;  // pixels

/// Milliseconds of the fastest of some runs.
double fastest(int repetitions, const std::function<void()>& run) {
  double least = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    least = std::min(least, took.count());
  }
  return least;
}

/// The cell, its configuration and its samples.
struct Cell {
  std::vector<std::string> cameras;
  std::vector<Pose<double>> truth;  ///< base_T_camera
  std::string urdf;
  std::string config;
  std::vector<Sample> samples;

  Cell() {
    std::vector<InitAnswers> all;
    for (int c = 0; c < kCameras; ++c) {
      InitAnswers answers;
      answers.target = InitTarget::checkerboard;
      answers.base = HandEyeNames::kBase;
      answers.arm = HandEyeNames::kFlange;
      answers.camera = answers.camera_name = fmt::format("c{}", c);
      answers.camera_type = "camera2d";
      answers.target_frame = HandEyeNames::kTarget;
      answers.known_lens = true;
      cameras.push_back(answers.camera);
      all.push_back(answers);
      // From four sides, looking at one place.
      const double side = 0.35 * (c % 2 == 0 ? 1.0 : -1.0), up = 0.35 * (c < 2 ? 1.0 : -1.0);
      truth.push_back({rotation_from_rpy({-up, side, 0.2 * c}), {-1.1 * side, -1.1 * up, 0.0}});
    }
    urdf = hand_eye_urdf(false, cameras);
    config = initial_config(parse_urdf(urdf, "hand_eye.urdf"), all);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> side(-0.1, 0.1), tilt(-0.4, 0.4);
    std::normal_distribution<double> noise(0.0, kNoise);
    const Pose<double> flange_T_board{rotation_from_rpy({0.2, -0.1, 0.5}), {0.02, -0.05, 0.12}};
    CameraInfo info;
    info.width = 1280;
    info.height = 960;
    info.k = {kFocal, 0, 640, 0, kFocal, 480, 0, 0, 1};
    info.p = {kFocal, 0, 640, 0, 0, kFocal, 480, 0, 0, 0, 1, 0};
    for (int n = 0; n < kPoses; ++n) {
      const Pose<double> base_T_board{
          rotation_from_rpy({tilt(random), tilt(random), 3.0 * tilt(random)}),
          {side(random) - 0.07, side(random) - 0.05, 1.1 + side(random)}};
      Sample& sample = samples.emplace_back();
      sample.source = fmt::format("pose {}", n);
      sample.poses[HandEyeNames::kFlangeJoint] = base_T_board * flange_T_board.inverse();
      Observation& held = sample.observations.emplace_back(Observation{"arm", {}});
      std::vector<Observation> seen;
      for (const std::string& camera : cameras) seen.push_back({camera, {}, info});
      for (int i = 0; i < 24; ++i) {
        Feature corner{.frame = HandEyeNames::kTarget,
                       .point = {0.03 * (i % 6), 0.03 * (i / 6), 0}};
        corner.id = i;
        held.features.push_back(corner);
        for (std::size_t c = 0; c < cameras.size(); ++c) {
          const Vector3<double> p = truth[c].inverse() * (base_T_board * corner.point);
          Feature pixel{.frame = cameras[c],
                        .point = {640 + kFocal * p.x() / p.z() + noise(random),
                                  480 + kFocal * p.y() / p.z() + noise(random), 0.0}};
          pixel.id = i;
          seen[c].features.push_back(pixel);
        }
      }
      sample.observations.insert(sample.observations.end(), seen.begin(), seen.end());
    }
  }

  [[nodiscard]] CalibrationSetup setup() const {
    Diagnostics diagnostics;
    CalibrationSetup made{.robot = parse_urdf(urdf, "hand_eye.urdf"),
                          .config = parse_config(config, "calibrate.yaml", diagnostics),
                          .samples = samples,
                          .urdf_text = urdf,
                          .urdf = "hand_eye.urdf"};
    diagnostics.throw_if_errors();
    return made;
  }

  /// The cameras are where they are.
  [[nodiscard]] bool is_found(const CalibratedRobot& calibrated) const {
    const ParameterTable& table = calibrated.result.table;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const auto at = [&](const char* axis) { return table[cameras[c] + "_joint_" + axis].value; };
      const Vector3<double> shift(at("x"), at("y"), at("z"));
      if ((shift - truth[c].translation).norm() > 1e-3) return false;
    }
    return calibrated.judgement.verdict == Grade::good;
  }
};

int run(int repetitions) {
  const Cell cell;
  if (!cell.is_found(calibrate_robot(cell.setup()))) {
    std::fprintf(stderr, "error: the cameras are elsewhere, or the verdict is not 'good'\n");
    return 1;
  }
  const double whole = fastest(repetitions, [&] { (void)calibrate_robot(cell.setup()); });
  const double prepared = fastest(repetitions, [&] { (void)prepare(cell.setup()); });
  const PreparedCalibration ready = prepare(cell.setup());
  const double solved = fastest(repetitions, [&] { (void)calibrate(ready.calibration); });
  std::printf("%d poses, %d cameras, %d corners\n", kPoses, kCameras, kPoses * kCameras * 24);
  std::printf("  from nothing to the verdict %8.1f ms\n", whole);
  std::printf("  of that, checks of the input %7.1f ms\n", prepared);
  std::printf("  control: search and solve   %8.1f ms\n", solved);
  return 0;
}

}  // namespace
}  // namespace kinecal

int main(int argc, char** argv) {
  return kinecal::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5);
}
