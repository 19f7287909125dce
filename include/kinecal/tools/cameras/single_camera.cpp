// Definitions of single_camera.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/cameras/single_camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/sensors/lens_camera.hpp"
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
  problem->give_own_poses({"board"});
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

/// The angle from the axis at which a fisheye shows the farthest corner, degrees.
[[nodiscard]] double farthest_angle(const CameraInfo& info, std::span<const TargetView> views) {
  const Fisheye camera{ImageKind::raw};
  const auto settings = camera.settings({"camera", {}, info});
  double most = 0.0;
  for (const TargetView& view : views) {
    for (const Eigen::Vector2d& pixel : view.pixels) {
      Measurement<Fisheye, double> m;
      m.point = {pixel.x(), pixel.y(), 0.0};
      m.settings = settings;
      const Vector3<double> to = camera.place(m, std::array<double, 4>{}).direction;
      if (to.allFinite()) most = std::max(most, std::atan2(to.head<2>().norm(), to.z()));
    }
  }
  return most * 180.0 / std::numbers::pi;
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
  std::unique_ptr<AnyProblem> problem = detail::fisheye_problem();
  std::vector<std::size_t> of_sample;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto pose = start->pose(views[v]);
    if (!pose) continue;
    problem->add_sample(detail::board_sample(views[v], info, *pose));
    of_sample.push_back(v);
  }
  std::vector<int> columns(detail::Fisheye::kParameters.size());
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<int>(i);
  const FreeSet free(columns, problem->table().size());
  Calibration calibration{problem->table(), {}};
  constexpr int kMostIterations = 100;
  calibration.steps.push_back({"camera", kMostIterations, std::move(problem), free, {}, {}});
  constexpr double kEnough = 1e-6;  // of the cost: it is a start
  const CalibrationResult result = calibrate(calibration, {}, {.function_tolerance = kEnough});
  SingleCamera single;
  single.poses.resize(views.size());
  const auto& poses = calibration.steps.front().problem->poses_of_samples();
  for (std::size_t i = 0; i < of_sample.size(); ++i) single.poses[of_sample[i]] = poses[i][0];
  detail::Fisheye::Settings own{};
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = result.table[static_cast<int>(i)].value;
  info = detail::Fisheye{ImageKind::raw}.calibrated(info, own);
  const double angle = detail::farthest_angle(info, views);
  constexpr double kNarrow = 50.0;  // degrees from the axis
  const std::string wanted(!lens.empty()     ? lens
                           : angle < kNarrow ? PlumbBob::kName
                                             : RationalPolynomial::kName);
  if (wanted != Equidistant::kName) {
    const std::vector<double> k = info.d;
    const RoundLens like{info.k[0],
                         [k](double t) {
                           const double w = t * t;
                           return t * (1.0 + w * (k[0] + w * (k[1] + w * (k[2] + w * k[3]))));
                         },
                         {}};
    info.d = lens_start(wanted, like, angle);
  }
  info.distortion_model =
      wanted == ThinPrism::kName ? std::string(RationalPolynomial::kName) : wanted;
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {info.k[0], 0, info.k[2], 0, 0, info.k[4], info.k[5], 0, 0, 0, 1, 0};
  single.info = info;
  return single;
}

}  // namespace kinecal
