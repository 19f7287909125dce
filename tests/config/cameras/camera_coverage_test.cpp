// Monte Carlo: the truth is within the +- of simulated cameras and rigs, from nothing but pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kinecal/sensors/lens_camera.hpp"
#include "support/cameras_alone.hpp"
#include "support/interval_coverage.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::assessment_of, test::of_frame;
using test::Cameras, test::Chance, test::IntervalCoverage;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kPixelNoise = 0.3;  // pixels

/// A fisheye whose image of 1280 x 960 pixels is `view` degrees wide.
CameraInfo fisheye(double view, Chance& chance) {
  CameraInfo info;
  info.width = 1280;
  info.height = 960;
  info.distortion_model = "equidistant";
  const double f = 640.0 / (0.5 * view * kDegree);
  info.k = {f * chance(0.98, 1.02),
            0,
            640.0 + chance(-15, 15),
            0,
            f * chance(0.98, 1.02),
            480.0 + chance(-15, 15),
            0,
            0,
            1};
  info.d = {chance(-0.03, 0.03), chance(-5e-3, 5e-3), chance(-1e-3, 1e-3), chance(-2e-4, 2e-4)};
  return info;
}

/// What a camera sees of a board, 9 x 7 corners 4 cm apart: the corners in its image.
/// @param view  angle across, degrees
Observation seen(const std::string& name, const CameraInfo& info, double view,
                 const Pose<double>& camera_T_board, Chance& chance) {
  static const auto camera = any_built_in(lens_camera("equidistant", ImageKind::raw));
  const auto settings = camera->settings({name, {}, info});
  Observation eye{name, {}, CameraInfo{}};
  eye.camera->width = info.width;
  eye.camera->height = info.height;
  for (int i = 0; i < 63; ++i) {
    const Vector3<double> p = camera_T_board * Vector3<double>(0.04 * (i % 9), 0.04 * (i / 9), 0.0);
    const double angle = std::atan2(std::hypot(p.x(), p.y()), p.z());
    const Eigen::Vector2d pixel = camera->predict(p, settings);
    const double u = pixel.x() + kPixelNoise * chance.normal(),
                 v = pixel.y() + kPixelNoise * chance.normal();
    const bool inside =
        angle < 0.55 * view * kDegree && u > 0.0 && u < 1280.0 && v > 0.0 && v < 960.0;
    if (inside) eye.features.push_back({name, {u, v, 0.0}, {}, {}, i});
  }
  return eye;
}

/// A board 0.15 to 0.45 m away in any direction of the view, tilted against it by up to 40 degrees.
Pose<double> board_in(double view, Chance& chance) {
  const double off = chance(0.0, 0.5 * view) * kDegree, about = chance(-3.1, 3.1);
  const Matrix3<double> towards =
      exp(Vector3<double>(off * std::cos(about), off * std::sin(about), 0.0));
  const Matrix3<double> turn = exp(Vector3<double>(chance(-0.7, 0.7), chance(-0.7, 0.7), 0.0)) *
                               exp(Vector3<double>(0.0, 0.0, chance(-3.1, 3.1)));
  Pose<double> pose{Matrix3<double>(towards * turn),
                    towards * Vector3<double>(0.0, 0.0, chance(0.15, 0.45))};
  pose.translation -= pose.rotation * Vector3<double>(0.16, 0.12, 0.0);
  return pose;
}

Observation whole_board() {
  Observation board{"board", {}, {}};
  for (int i = 0; i < 63; ++i) {
    board.features.push_back({"board", {0.04 * (i % 9), 0.04 * (i / 9), 0.0}, {}, {}, i});
  }
  return board;
}

/// Truth of a camera's parameter, by what the samples begin with.
double of_camera(const std::string& part, const CameraInfo& truth, const CameraInfo& start) {
  const std::map<std::string, std::size_t> intrinsics = {
      {"fx", 0}, {"fy", 4}, {"cx", 2}, {"cy", 5}};
  if (const auto at = intrinsics.find(part); at != intrinsics.end()) {
    return truth.k[at->second] / start.k[at->second] - 1.0;
  }
  const std::size_t k = static_cast<std::size_t>(part.at(1) - '1');
  return truth.d.at(k) - (start.d.size() > k ? start.d[k] : 0.0);
}

/// What one camera's samples begin with.
CameraInfo start_of(const std::string& name, const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    if (const Observation* eye = sample.observation(name)) return *eye->camera;
  }
  return {};
}

/// Cameras that see a board which somebody holds; nothing is known but the size of their images.
/// @param both  a second one beside the first
void cover_cameras(IntervalCoverage& coverage, double view, bool both, std::uint64_t seed) {
  Chance chance(seed);
  const CameraInfo left = fisheye(view, chance), right = fisheye(view, chance);
  const Pose<double> left_T_right{exp(chance.box(0.3)),
                                  Vector3<double>(0.12, 0.0, 0.0) + chance.box(0.03)};
  std::vector<Sample> samples;
  while (samples.size() < 25) {
    const Pose<double> left_T_board = board_in(view, chance);
    Sample sample;
    sample.source = "view " + std::to_string(samples.size());
    sample.observations = {whole_board(), seen("left", left, view, left_T_board, chance)};
    if (both) {
      sample.observations.push_back(
          seen("right", right, view, left_T_right.inverse() * left_T_board, chance));
      if (sample.observations.back().features.size() < 20) sample.observations.pop_back();
    }
    if (sample.observations[1].features.size() >= 20) samples.push_back(sample);
  }
  const std::vector<std::string> names =
      both ? std::vector<std::string>{"left", "right"} : std::vector<std::string>{"left"};
  const Cameras found(test::cameras_config(names, "equidistant", "k1 k2 k3 k4"), samples);
  ASSERT_TRUE(found.diagnostics.errors.empty()) << found.diagnostics.errors.front();
  const auto truth = [&](const std::string& name) {
    if (name.starts_with("right_joint_")) {
      return of_frame(name.back(),
                      found.robot.joint("right_joint").origin.inverse() * left_T_right);
    }
    const bool of_left = name.starts_with("left_");
    return of_camera(name.substr(of_left ? 5 : 6), of_left ? left : right,
                     start_of(of_left ? "left" : "right", found.samples));
  };
  coverage.add(found.result, assessment_of(found.calibration, found.result, found.samples), truth);
}

TEST(CameraCoverage, OfAFisheyeOf120Degrees) {
  IntervalCoverage coverage("fisheye of 120 degrees");
  const int runs = test::repetitions_of_study(200, 12);
  for (int run = 0; run < runs; ++run)
    cover_cameras(coverage, 120.0, false, 1000 + std::uint64_t(run));
  coverage.check();
}

TEST(CameraCoverage, OfAFisheyeOf190Degrees) {
  IntervalCoverage coverage("fisheye of 190 degrees");
  const int runs = test::repetitions_of_study(200, 12);
  for (int run = 0; run < runs; ++run)
    cover_cameras(coverage, 190.0, false, 2000 + std::uint64_t(run));
  coverage.check();
}

TEST(CameraCoverage, OfARigOfTwoCameras) {
  IntervalCoverage coverage("rig of two cameras");
  const int runs = test::repetitions_of_study(200, 8);
  for (int run = 0; run < runs; ++run)
    cover_cameras(coverage, 100.0, true, 3000 + std::uint64_t(run));
  coverage.check();
}

}  // namespace
}  // namespace kinecal
