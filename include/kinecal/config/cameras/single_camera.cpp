// Definitions of single_camera.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/single_camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

namespace detail {
namespace {

using Fisheye = LensCamera<Equidistant>;

/// The camera alone: it looks at a board that floats before it.
[[nodiscard]] std::unique_ptr<AnyProblem> fisheye_problem() {
  ParameterTable table;
  add_parameters(table, "camera", Fisheye::kParameters);
  add_parameters(table, "board", kFrameParameters);
  auto problem = make_problem(
      Robot("camera", {{"board", JointType::floating, "camera", "board", {}, {}, {}, {}}}),
      "camera", table, {"board"});
  problem->give_sample_poses({"board"});
  problem->add_built_in(ChainPoint{}, {"board", "board"});
  problem->add_built_in(Fisheye{ImageKind::raw}, {"camera", "camera"});
  constexpr double kScale = 3.0;  // pixels, beyond which a corner counts less
  problem->add_built_in("corners", PointToPixel{}, {"board", "camera"},
                        {.loss = {LossType::huber, kScale}});
  return problem;
}

[[nodiscard]] Sample board_sample(const TargetView& view, const CameraInfo& info,
                                  const Pose<double>& pose) {
  Sample sample;
  Observation board{"board", {}, {}}, camera{"camera", {}, info};
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    board.features.push_back({"board", {view.plane[i].x(), view.plane[i].y(), 0.0}});
    camera.features.push_back({"camera", {view.pixels[i].x(), view.pixels[i].y(), 0.0}});
  }
  sample.observations = {board, camera};
  sample.poses["board"] = pose;
  return sample;
}

/// A fisheye, and where it saw the target.
struct SeenByFisheye {
  CameraInfo info;
  std::vector<std::optional<Pose<double>>> poses;  ///< camera_T_target of each view
};

/// Fits a fisheye and the poses of its views, from where they are.
void fit_fisheye(std::span<const TargetView> views, SeenByFisheye& camera) {
  std::unique_ptr<AnyProblem> problem = fisheye_problem();
  std::vector<std::size_t> of_sample;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!camera.poses[v]) continue;
    problem->add_sample(board_sample(views[v], camera.info, *camera.poses[v]));
    of_sample.push_back(v);
  }
  std::vector<int> columns(Fisheye::kParameters.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<int>(i);
  const FreeSet free(columns, problem->table().size());
  Calibration calibration{problem->table(), {}};
  constexpr int kMostIterations = 100;
  calibration.steps.push_back({"camera", kMostIterations, std::move(problem), free, {}, {}});
  constexpr double kEnough = 1e-6;  // of the cost: it is a start
  const CalibrationResult result = calibrate(calibration, {}, {.function_tolerance = kEnough});
  const auto& poses = calibration.steps.front().problem->poses_of_samples();
  for (std::size_t i = 0; i < of_sample.size(); ++i) camera.poses[of_sample[i]] = poses[i][0];
  Fisheye::Settings own{};
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = result.table[static_cast<int>(i)].value;
  camera.info = Fisheye{ImageKind::raw}.calibrated(camera.info, own);
}

/// Mean distance of the corners of a view from where a pose puts them, pixels; infinite behind the lens.
[[nodiscard]] double miss_of(const TargetView& view, const Lens& lens, const Pose<double>& pose) {
  double sum = 0.0;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Vector3<double> p = pose * Vector3<double>(view.plane[i].x(), view.plane[i].y(), 0.0);
    const double off = (lens.project(p) - view.pixels[i]).norm();
    if (!std::isfinite(off)) return std::numeric_limits<double>::infinity();
    sum += off;
  }
  return sum / static_cast<double>(view.pixels.size());
}

/// Replaces the poses that are in a wrong minimum: a few corners at the border look nearly the same from two sides,
/// and the start of the lens was rough there.
/// @returns  true if there were any
[[nodiscard]] bool mend_poses(std::span<const TargetView> views, SeenByFisheye& camera) {
  constexpr double kClearly = 0.7, kMatters = 0.5;  // of the distance; pixels
  const Lens lens(camera.info, ImageKind::raw);
  bool is_mended = false;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto fresh = pose_of_view(
        views[v], [&](const Eigen::Vector2d& pixel) { return lens.ray(pixel.x(), pixel.y()); });
    if (!fresh) continue;
    const double was = camera.poses[v] ? miss_of(views[v], lens, *camera.poses[v])
                                       : std::numeric_limits<double>::infinity();
    if (!(was > kMatters && miss_of(views[v], lens, *fresh) < kClearly * was)) continue;
    camera.poses[v] = fresh;
    is_mended = true;
  }
  return is_mended;
}

}  // namespace
}  // namespace detail

std::optional<SingleCamera> single_camera(std::span<const TargetView> views, double width,
                                          double height, const std::string& lens) {
  const std::optional<CameraStart> start = camera_start(views, width, height);
  if (!start) return std::nullopt;
  CameraInfo info;
  info.distortion_model = Equidistant::kName;
  info.d = lens_start(Equidistant::kName, start->lens, start->most_degrees);
  const double f = start->lens.focal;
  info.k = {f, 0, start->center.x(), 0, f, start->center.y(), 0, 0, 1};
  constexpr std::size_t kEnough = 32;  // views for a start
  const std::vector<TargetView> some = telling_views(views, kEnough);
  detail::SeenByFisheye camera{info, {}};
  for (const TargetView& view : some) camera.poses.push_back(start->pose(view));
  constexpr int kMostRounds = 5;
  for (int round = 0; round < kMostRounds; ++round) {
    detail::fit_fisheye(some, camera);
    if (!detail::mend_poses(some, camera)) break;
  }
  info = camera.info;
  const Lens fisheye(info, ImageKind::raw);
  const PixelDirection ray = [&](const Eigen::Vector2d& pixel) {
    return fisheye.ray(pixel.x(), pixel.y());
  };
  SingleCamera single;
  for (const TargetView& view : views) single.poses.push_back(pose_of_view(view, ray));
  const double angle = farthest_degrees(views, ray);
  constexpr double kNarrow = 50.0;  // degrees from the axis
  const std::string wanted(!lens.empty()     ? lens
                           : angle < kNarrow ? PlumbBob::kName
                                             : RationalPolynomial::kName);
  if (wanted != Equidistant::kName) {
    std::array<double, Equidistant::kCoefficients.size()> d{};
    std::copy_n(info.d.begin(), d.size(), d.begin());
    const auto profile = [d](double t) {
      return Equidistant::image(Vector3<double>(std::sin(t), 0.0, std::cos(t)), d).x();
    };
    const RoundLens like{info.k[0], profile, {}};
    info.d = lens_start(wanted, like, angle);
  }
  info.distortion_model = distortion_model_of(wanted);
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {info.k[0], 0, info.k[2], 0, 0, info.k[4], info.k[5], 0, 0, 0, 1, 0};
  single.info = info;
  return single;
}

}  // namespace kinecal
