// Definitions of sensor_points.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/sensor_points.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/same_feature.ipp"
#include "kinecal/config/doubts/unseen_corners.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal::detail {
namespace {

// Checks specific to cameras: features that are not pixels, intrinsics of another image, a driver
// that has stopped.

/// The camera_info of the first sample with a size; nullptr if absent.
[[nodiscard]] const CameraInfo* sized_camera(const RecordedPoints& recorded,
                                             std::span<const Sample> samples) {
  const Observation* seen = samples[recorded.samples.front()].observation(recorded.model.name);
  const bool sized = seen->camera && seen->camera->width > 0 && seen->camera->height > 0;
  return sized ? &*seen->camera : nullptr;
}

/// Doubt: pixels outside of the image.
/// @param pixels  (u, v, any) of each of the recorded points
/// @param few     fraction of them that may be outside
void check_inside(const RecordedPoints& recorded, std::span<const Vector3<double>> pixels,
                  const CameraInfo& camera, double few, std::span<const Sample> samples,
                  Diagnostics& diagnostics) {
  const double width = camera.width, height = camera.height;
  std::size_t last = 0;  // sample already counted
  double all = 0.0;
  Occurrences outside;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double u = pixels[i].x(), v = pixels[i].y();
    const bool is_outside =
        u < -0.1 * width || u > 1.1 * width || v < -0.1 * height || v > 1.1 * height;
    all += is_outside ? 1.0 : 0.0;
    if (!is_outside || (outside.count > 0 && last == recorded.samples[i])) continue;
    last = recorded.samples[i];
    outside.add(last);
  }
  if (all <= few * static_cast<double>(pixels.size())) return;
  diagnostics.doubt(place_of(samples, outside.first),
                    fmt::format("a feature of sensor '{}' is outside its image of {}x{} pixels{}; "
                                "is it the camera_info of another camera or size?",
                                recorded.model.name, width, height, outside.others()));
}

/// Error or doubt: features that are not pixels.
void check_pixels(const RecordedPoints& recorded, std::span<const Sample> samples,
                  Diagnostics& diagnostics) {
  check_unseen(recorded.model.name, samples, diagnostics);
  const CameraInfo* camera = sized_camera(recorded, samples);
  if (camera == nullptr) return;
  double most = 0.0;
  for (const auto& pixel : recorded.points)
    most = std::max(most, pixel.head<2>().cwiseAbs().maxCoeff());
  if (most < 4.0 && recorded.points.size() > 3) {
    diagnostics.error(
        place_of(samples, recorded.samples.front()),
        fmt::format("no feature of sensor '{}' is beyond {:.3g} pixels of an image of "
                    "{}x{}; they look like metres or normalized coordinates",
                    recorded.model.name, most, camera->width, camera->height));
  } else {
    check_inside(recorded, recorded.points, *camera, 0.0, samples, diagnostics);
  }
}

/// Error or doubt: points of a depth camera that contradict its camera_info.
void check_depth_points(const RecordedPoints& recorded, std::span<const Sample> samples,
                        Diagnostics& diagnostics) {
  std::vector<Vector3<double>> pixels;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const std::size_t s = recorded.samples[i];
    const Observation& seen = *samples[s].observation(recorded.model.name);
    const std::shared_ptr<const AnySensor> sensor = sensor_of(recorded.model);
    pixels.push_back(sensor->measurement(recorded.points[i], sensor->settings(seen)));
    if (pixels.back().z() > 0.0) continue;
    diagnostics.error(
        place_of(samples, s),
        fmt::format(
            "sensor '{}' has a point {:.4g} m away, which its driver made of a depth of "
            "{:.4g} m by z_offset_mm {:.6g} and z_scaling {:.6g} of ext_camera_info; one of "
            "them is wrong",
            recorded.model.name, recorded.points[i].z(), pixels.back().z(),
            1e3 * seen.camera->z_offset, seen.camera->z_scaling));
    return;
  }
  const CameraInfo* camera = sized_camera(recorded, samples);
  constexpr double kFew = 0.05;  // a driver may give points beyond its image
  if (camera != nullptr) check_inside(recorded, pixels, *camera, kFew, samples, diagnostics);
}

/// Doubt: a principal point far from the middle of the image, as if from another resolution.
void check_principal_points(std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::set<std::string> checked;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    for (const Observation& seen : samples[s].observations) {
      if (!seen.camera || !checked.insert(seen.sensor).second) continue;
      const CameraInfo& camera = *seen.camera;
      const auto is_far = [](double point, int size) {
        constexpr double kFar = 0.3;  // of the size of the image
        return size > 0 && std::abs(point / size - 0.5) > kFar;
      };
      const auto doubt = [&](const char* matrix, double cx, double cy) {
        if (!is_far(cx, camera.width) && !is_far(cy, camera.height)) return false;
        diagnostics.doubt(
            place_of(samples, s),
            fmt::format(
                "the principal point of sensor '{}' is ({:.4g}, {:.4g}) by {}, far from the "
                "middle of its image of {}x{} pixels; is it the camera_info of another "
                "resolution?",
                seen.sensor, cx, cy, matrix, camera.width, camera.height));
        return true;
      };
      if (camera.k[0] > 0.0 && doubt("K", camera.k[2], camera.k[5])) continue;
      if (camera.p[0] > 0.0) doubt("P", camera.p[2], camera.p[6]);
    }
  }
}

/// Error: a camera that records the same in every sample although the robot moves.
void check_frozen(const RecordedPoints& recorded, std::span<const Sample> samples,
                  Diagnostics& diagnostics) {
  const auto last = recorded.samples.back();
  if (!recorded.is_measured || !recorded.is_constant || recorded.samples.front() == last) return;
  if (samples[last].joint_positions == samples[recorded.samples.front()].joint_positions) return;
  diagnostics.error(
      place_of(samples, recorded.samples.front()),
      fmt::format("sensor '{}' records the same features, to the last digit, in every "
                  "sample though the robot moves; its driver or topic has stopped",
                  recorded.model.name));
}

}  // namespace

// Compares how points spread about their center: those of a fixed sensor, and those of the arm.
// Uses the median and drops the farthest tenth, so that a few distant points do not decide.

double spread_of(std::span<const Vector3<double>> points) {
  if (points.empty()) return 0.0;
  Vector3<double> center;
  std::vector<double> numbers(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), numbers.begin(),
                   [axis](const auto& point) { return point(axis); });
    center(axis) = median_of(numbers);
  }
  std::transform(points.begin(), points.end(), numbers.begin(),
                 [&](const auto& point) { return (point - center).squaredNorm(); });
  std::sort(numbers.begin(), numbers.end());
  const std::size_t near = numbers.size() - (numbers.size() + 9) / 10;
  const double sum =
      std::accumulate(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(near), 0.0);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, near)));
}

/// Keeps the points of samples in which the other model has points, too.
[[nodiscard]] inline RecordedPoints together_with(const RecordedPoints& other,
                                                  const RecordedPoints& all) {
  RecordedPoints kept = all;
  kept.points.clear();
  kept.samples.clear();
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (!std::binary_search(other.samples.begin(), other.samples.end(), all.samples[i])) continue;
    kept.points.push_back(all.points[i]);
    kept.samples.push_back(all.samples[i]);
  }
  return kept;
}

/// The points of a moving model in the base, for the robot of the URDF.
[[nodiscard]] inline std::vector<Vector3<double>> points_in_base(const RecordedPoints& recorded,
                                                                 std::span<const Sample> samples) {
  std::vector<Vector3<double>> points;
  Pose<double> base_T_sensor;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    if (i == 0 || recorded.samples[i] != recorded.samples[i - 1]) {
      base_T_sensor = forward_kinematics(recorded.chain, [&](const std::string& joint) {
        return samples[recorded.samples[i]].position(joint).value_or(0.0);
      });
    }
    points.push_back(base_T_sensor * recorded.points[i]);
  }
  return points;
}

/// The unit mistake that explains a factor between lengths; empty if none does.
[[nodiscard]] inline std::string unit_of_factor(double factor) {
  struct Unit {
    double factor;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1000.0, "millimetres"},
                             {100.0, "centimetres"},
                             {39.37, "inches"},
                             {3.281, "feet"},
                             {0.001, "kilometres"}};
  for (const Unit& unit : kUnits) {
    if (std::abs(std::log(factor / unit.factor)) < std::log(1.3)) return unit.name;
  }
  return {};
}

/// Error or doubt: the two spreads differ.
/// @param fixed  of a sensor that does not move; @param arm  of one that moves
inline void compare_spreads(const RecordedPoints& fixed, const RecordedPoints& arm,
                            std::span<const Sample> samples, double reach,
                            Diagnostics& diagnostics) {
  const double of_fixed = spread_of(fixed.points), of_arm = spread_of(points_in_base(arm, samples));
  const double least = std::max(0.15, 0.1 * reach);  // metres: errors of zeros move less
  const double factor = of_fixed / std::max(of_arm, 1e-9);
  if (std::abs(of_fixed - of_arm) <= least || (factor > 1.0 / 3.0 && factor < 3.0)) return;
  const SourceLocation place = place_of(samples, fixed.samples.front());
  const std::string text = fmt::format(
      "points of '{}' move over {:.3g} m (rms about their center), those of sensor '{}' "
      "over {:.3g} m",
      arm.model.name, of_arm, fixed.model.name, of_fixed);
  const std::string unit = unit_of_factor(factor);
  if (fixed.is_constant) {
    diagnostics.error(
        place,
        text + fmt::format("; it records the same features in every sample though the robot "
                           "moves: its driver or topic has stopped, or the frames of '{}' and "
                           "'{}' are exchanged in the configuration",
                           arm.model.name, fixed.model.name));
  } else if (!unit.empty()) {
    diagnostics.error(place,
                      text + fmt::format("; they look like {}; points must be in metres", unit));
  } else {
    diagnostics.doubt(place, text + "; is it the right sensor, frame and unit?");
  }
}

/// Points of a fixed sensor, explained by the arm of the URDF.
struct ComputedFit {
  Pose<double> sensor_T_base;
  double rms = 0.0;       ///< of a coordinate of what is left, metres
  double rounding = 0.0;  ///< the same, of the digits of joints and points alone
};

/// The step of which all numbers are multiples: 1e-3, 1e-4 ...; 0 if they have all digits of a double.
/// @param unit  in which they were written: pi / 180 for degrees
[[nodiscard]] inline double step_of(std::span<const double> numbers, double unit) {
  for (double step = 1e-2; step > 1e-8; step /= 10.0) {
    const auto is_multiple = [&](double number) {
      const double steps = number / (unit * step);
      return std::abs(steps - std::round(steps)) < 1e-4;
    };
    if (std::all_of(numbers.begin(), numbers.end(), is_multiple)) return unit * step;
  }
  return 0.0;
}

/// The fit of  p = sensor_T_base (base_T_arm (a + t))  for all points, with one offset t in the arm's frame.
/// @param fixed, arm  their points in the same order
[[nodiscard]] inline ComputedFit fit_computed(const RecordedPoints& fixed,
                                              const RecordedPoints& arm,
                                              std::span<const Sample> samples) {
  constexpr std::size_t kMostPoints = 500;
  const auto n = static_cast<Eigen::Index>(std::min(kMostPoints, fixed.points.size()));
  const std::vector<Vector3<double>> in_base = points_in_base(arm, samples);
  std::vector<Matrix3<double>> turns;
  std::vector<double> joints, coordinates;
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Sample& sample = samples[fixed.samples[at]];
    turns.push_back(forward_kinematics(arm.chain, [&](const std::string& joint) {
                      return sample.position(joint).value_or(0.0);
                    }).rotation);
    joints.insert(joints.end(), sample.joint_positions.begin(), sample.joint_positions.end());
    coordinates.insert(coordinates.end(), fixed.points[at].begin(), fixed.points[at].end());
    from.col(i) = in_base[at];
    to.col(i) = fixed.points[at];
  }
  const Eigen::Matrix4d start = Eigen::umeyama(from, to, false);
  ComputedFit fit{{start.topLeftCorner<3, 3>(), start.topRightCorner<3, 1>()}};
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  constexpr int kSteps = 20;
  for (int step = 0; step <= kSteps; ++step) {
    Eigen::Matrix<double, 9, 9> information = Eigen::Matrix<double, 9, 9>::Identity() * 1e-12;
    Eigen::Matrix<double, 9, 1> gradient = Eigen::Matrix<double, 9, 1>::Zero();
    double squares = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Matrix3<double> turn = fit.sensor_T_base.rotation * turns[static_cast<std::size_t>(i)];
      const Eigen::Vector3d turned = fit.sensor_T_base.rotation * from.col(i) + turn * offset;
      const Eigen::Vector3d left = turned + fit.sensor_T_base.translation - to.col(i);
      Eigen::Matrix<double, 3, 9> jacobian;
      jacobian << -cross_matrix<double>(turned), Eigen::Matrix3d::Identity(), turn;
      information += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * left;
      squares += left.squaredNorm();
    }
    fit.rms = std::sqrt(squares / (3.0 * static_cast<double>(n)));
    if (step == kSteps) break;
    const Eigen::Matrix<double, 9, 1> change = -information.ldlt().solve(gradient);
    fit.sensor_T_base.rotation =
        exp(Vector3<double>(change.head<3>())) * fit.sensor_T_base.rotation;
    fit.sensor_T_base.translation += change.segment<3>(3);
    offset += change.tail<3>();
  }
  const double lever = spread_of(in_base),
               turn = std::max(step_of(joints, 1.0), step_of(joints, std::numbers::pi / 180.0));
  fit.rounding = std::hypot(step_of(coordinates, 1.0), lever * turn) / std::sqrt(12.0);
  return fit;
}

/// Doubt: points that agree with the URDF to a rounding error, which the controller computed from the joints.
/// Points with all digits of a double are doubted only if the sensor stands in the robot's base: simulated ones are exact, too.
inline void check_computed(const RecordedPoints& fixed, const RecordedPoints& arm,
                           std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kMost = 5e-5, kDigits = 1e-8, kBase = 1e-4;  // metres
  constexpr std::size_t kLeast = 6;                             // points, of 9 unknowns
  if (fixed.samples != arm.samples || fixed.points.size() < kLeast || fixed.is_constant) return;
  const ComputedFit fit = fit_computed(fixed, arm, samples);
  const Matrix3<double>& turn = fit.sensor_T_base.rotation;
  const bool in_base = fit.sensor_T_base.translation.norm() < kBase &&
                       (turn - Matrix3<double>(turn.array().round().matrix())).norm() < kBase;
  const double most = std::max(2.0 * fit.rounding, in_base ? kDigits : 0.0);
  if (!(fit.rms < std::min(kMost, most))) return;
  diagnostics.doubt(
      place_of(samples, fixed.samples.front()),
      fmt::format("points of sensor '{}' agree with the URDF to {:.2g} mm{}: they were computed "
                  "from the joints, not "
                  "measured; give points of an instrument",
                  fixed.model.name, 1e3 * fit.rms, in_base ? ", in the robot's base" : ""));
}

void check_spreads(const Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics) {
  const std::vector<RecordedPoints> all = recorded_points(config, robot, samples);
  std::set<std::pair<const RecordedPoints*, const RecordedPoints*>> compared;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      if (entry == nullptr || entry->read_as != PointToPoint::kType) continue;
      std::vector<const RecordedPoints*> of_block;
      for (const std::string& model : block.models) {
        for (const RecordedPoints& recorded : all) {
          if (recorded.model.name == model && recorded.in_metres) of_block.push_back(&recorded);
        }
      }
      if (of_block.size() != 2 || of_block[0]->moves == of_block[1]->moves) continue;
      const RecordedPoints* fixed = of_block[of_block[0]->moves ? 1 : 0];
      const RecordedPoints* arm = of_block[of_block[0]->moves ? 0 : 1];
      // The view of a moving camera depends on its mount, which may be unknown.
      if (!arm->model.type.starts_with("chain")) continue;
      if (!compared.insert({fixed, arm}).second || fixed->points.size() < 3) continue;
      const RecordedPoints of_fixed = together_with(*arm, *fixed),
                           of_arm = together_with(*fixed, *arm);
      compare_spreads(of_fixed, of_arm, samples, reach_of(robot, arm->chain), diagnostics);
      check_computed(of_fixed, of_arm, samples, diagnostics);
    }
  }
}

/// Adds the model's points in one sample.
/// @param first  the observation of the first sample with one
inline void add_points(RecordedPoints& all, const Observation& seen, std::size_t sample,
                       const Observation& first) {
  for (std::size_t i = 0; i < seen.features.size(); ++i) {
    const Feature& feature = seen.features[i];
    if (!feature.id && seen.features.size() != first.features.size()) all.is_constant = false;
    const Feature* before = all.is_constant ? same_feature(first, feature, i) : nullptr;
    if (before != nullptr) {
      all.is_constant = feature.point == before->point && feature.frame == before->frame;
    }
    if (!feature.point.allFinite()) continue;
    all.points.push_back(feature.point);
    all.samples.push_back(sample);
  }
}

std::vector<RecordedPoints> recorded_points(const Config& config, const Robot& robot,
                                            std::span<const Sample> samples) {
  std::vector<RecordedPoints> all;
  const std::set<std::string> pixels = pixel_models(config);
  for (const ModelConfig& model : models_of(config)) {
    const SensorEntry* entry = entry_of(model);
    if (entry == nullptr || !robot.has_link(model.frame)) continue;
    RecordedPoints recorded{model,
                            make_chain(robot, config.base_link, model.frame),
                            false,
                            false,
                            !pixels.contains(model.name),
                            true,
                            {},
                            {}};
    for (const ChainJoint& joint : recorded.chain.joints) {
      recorded.moves = recorded.moves || kinecal::moves(joint.type);
    }
    recorded.is_measured = !entry->sensor->parameters().empty();
    const Observation* first = nullptr;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Observation* seen = samples[s].observation(model.name);
      if (seen == nullptr) continue;
      if (first == nullptr) first = seen;
      add_points(recorded, *seen, s, *first);
    }
    if (!recorded.points.empty()) all.push_back(std::move(recorded));
  }
  return all;
}

double reach_of(const Robot& robot, const RuntimeChain& chain) {
  double reach = chain.tail.translation.norm();
  for (const ChainJoint& joint : chain.joints) {
    reach += joint.fixed.translation.norm();
    if (joint.type != JointType::prismatic || !robot.has_joint(joint.name)) continue;
    const auto& limits = robot.joint(joint.name).limits;
    if (!limits) continue;
    const double travel = std::max(std::abs(limits->lower), std::abs(limits->upper));
    if (travel < 100.0) reach += travel;  // larger values stand for no limit
  }
  return reach;
}

/// Error: absurd coordinates.
/// @returns  true if there are any
inline bool report_absurd_points(const RecordedPoints& recorded, std::span<const Sample> samples,
                                 Diagnostics& diagnostics) {
  const double most = recorded.in_metres ? 1e5 : 1e6;  // metres, or pixels and readings
  Occurrences absurd;
  double first = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const double size = recorded.points[i].cwiseAbs().maxCoeff();
    if (size <= most) continue;
    if (absurd.count > 0 && last == recorded.samples[i]) continue;  // the sample is counted
    last = recorded.samples[i];
    if (absurd.add(last)) first = size;
  }
  if (absurd.count == 0) return false;
  diagnostics.error(place_of(samples, absurd.first),
                    fmt::format("sensor '{}' has a feature with the number {:.6g}{}; correct or "
                                "remove the sample",
                                recorded.model.name, first, absurd.others()));
  return true;
}

/// Size of the recorded points: their distance from a moving sensor, their extent for a fixed one,
/// because a tracker may stand far away.
[[nodiscard]] inline double size_of(const RecordedPoints& recorded) {
  std::vector<double> sizes;
  Vector3<double> center = Vector3<double>::Zero();
  if (!recorded.moves) {
    for (const auto& point : recorded.points) center += point;
    center /= static_cast<double>(recorded.points.size());
  }
  for (const auto& point : recorded.points) sizes.push_back((point - center).norm());
  return median_of(std::move(sizes));  // half of the points are as large
}

/// Error or doubt: points further away than the robot's size.
inline void check_distances(const RecordedPoints& recorded, double reach,
                            std::span<const Sample> samples, Diagnostics& diagnostics) {
  const double size = size_of(recorded), scale = reach + 0.5;  // metres: the smallest robots, too
  const double most = recorded.is_measured && recorded.moves ? 10.0 : 6.0;
  const SourceLocation place = place_of(samples, recorded.samples.front());
  const std::string text = fmt::format(
      "points of sensor '{}' are {:.4g} m {}; the robot's links between base and sensors are "
      "{:.3g} "
      "m long",
      recorded.model.name, size, recorded.moves ? "away" : "apart", reach);
  const bool is_mounted = recorded.moves && recorded.is_constant;  // LEDs in the gripper
  const double surely = is_mounted ? std::max(10.0 * scale, 10.0) : std::max(40.0 * scale, 30.0);
  if (size > surely) {
    diagnostics.error(place, text + "; they look like millimetres; points must be in metres");
  } else if (size > most * scale) {
    diagnostics.doubt(place, text + "; are they in metres?");
  } else if (recorded.is_measured && recorded.moves && size < 0.01) {
    diagnostics.error(place, text + "; no camera sees so close; points must be in metres");
  }
}

void check_sensor_points(const Config& config, const Robot& robot, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  check_principal_points(samples, diagnostics);
  const std::vector<RecordedPoints> all = recorded_points(config, robot, samples);
  double reach = 0.0;
  for (const RecordedPoints& recorded : all) {
    reach = std::max(reach, reach_of(robot, recorded.chain));
  }
  for (const Sample& sample : samples) {
    for (const auto& [joint, pose] : sample.poses) {
      reach = std::max(reach, pose.translation.norm());
    }
  }
  for (const RecordedPoints& recorded : all) {
    if (report_absurd_points(recorded, samples, diagnostics)) continue;
    check_frozen(recorded, samples, diagnostics);
    const SensorEntry* entry = entry_of(recorded.model);
    if (recorded.in_metres) {
      check_distances(recorded, reach, samples, diagnostics);
      if (measures_depth(*entry->sensor)) {
        check_depth_points(recorded, samples, diagnostics);
      }
    } else if (entry->sensor->delivers(Quantity::pixel)) {
      check_pixels(recorded, samples, diagnostics);
    }
  }
}

}  // namespace kinecal::detail
