// Definitions of magnetometer_start.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/magnetometer_start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "kinecal/config/doubts/field_unit.hpp"
#include "kinecal/errors/magnetic_field.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr std::array<const char*, 3> kReading = {"mag_x", "mag_y", "mag_z"};

/// The reading of a sample; nullopt if it has none.
[[nodiscard]] std::optional<Vector3<double>> reading_of(const Sample& sample) {
  Vector3<double> reading;
  for (std::size_t axis = 0; axis < kReading.size(); ++axis) {
    const auto found = sample.conditions.find(kReading[axis]);
    if (found == sample.conditions.end() || !std::isfinite(found->second)) return std::nullopt;
    reading(static_cast<Eigen::Index>(axis)) = found->second;
  }
  return reading;
}

/// Mean and scatter of readings.
struct Scatter {
  std::vector<Vector3<double>> readings;
  Vector3<double> mean = Vector3<double>::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();  ///< mean of (m - mean)(m - mean)^T

  explicit Scatter(std::span<const Sample> samples) {
    for (const Sample& sample : samples) {
      if (const auto reading = reading_of(sample)) readings.push_back(*reading);
    }
    leave_out_jumps();
    const double share = readings.empty() ? 0.0 : 1.0 / static_cast<double>(readings.size());
    for (const auto& one : readings) mean += share * one;
    for (const auto& one : readings) square += share * (one - mean) * (one - mean).transpose();
  }

 private:
  /// Takes off single readings far outside of all others, which would turn the plane and move the start.
  void leave_out_jumps() {
    constexpr double kTimes = 2.5;  // of how far nine of ten are from their middle
    constexpr std::size_t kFewest = 12, kOneOf = 50;
    if (readings.size() < kFewest) return;
    Vector3<double> middle;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      std::vector<double> along;
      for (const auto& one : readings) along.push_back(one(axis));
      const auto half = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
      std::nth_element(along.begin(), half, along.end());
      middle(axis) = *half;
    }
    std::vector<double> far;
    for (const auto& one : readings) far.push_back((one - middle).norm());
    std::sort(far.begin(), far.end());
    const double most = kTimes * far[far.size() * 9 / 10];
    const auto is_jump = [&](const Vector3<double>& one) { return (one - middle).norm() > most; };
    const auto jumps = std::count_if(readings.begin(), readings.end(), is_jump);
    if (static_cast<std::size_t>(jumps) > std::max<std::size_t>(1, readings.size() / kOneOf))
      return;
    std::erase_if(readings, is_jump);
  }
};

/// Bias and field by the linear fit, without what the readings do not show: the mean counts there.
[[nodiscard]] std::pair<Vector3<double>, double> linear_start(const Scatter& of) {
  const double share = 1.0 / static_cast<double>(of.readings.size());
  double squares = of.square.trace();  // mean of |m - mean|^2
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& one : of.readings) {
    right += 0.5 * share * ((one - of.mean).squaredNorm() - squares) * (one - of.mean);
  }
  constexpr double kShown = 1e-6;  // of the largest
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pairs(of.square);
  Vector3<double> bias = Vector3<double>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!(pairs.eigenvalues()(i) > kShown * pairs.eigenvalues()(2))) continue;
    const Eigen::Vector3d axis = pairs.eigenvectors().col(i);
    bias += axis.dot(right) / pairs.eigenvalues()(i) * axis;
  }
  return {of.mean + bias, std::sqrt(squares + bias.squaredNorm())};
}

/// Reports a field that is free beside gains that go with it: both may shrink to nothing.
/// @param most  gains that may be free beside it
void check_gains(const StepConfig& step, const BlockConfig& block, std::size_t most,
                 Diagnostics& diagnostics) {
  std::vector<std::string> gains;
  bool field_is_free = false;
  for (const FreeParamConfig& free : free_parameters(step)) {
    for (const char* gain : {"xx", "yy", "zz"}) {
      if (free.name == block.name + "_" + gain) gains.push_back(free.name);
    }
    field_is_free = field_is_free || free.name == block.name + "_field";
  }
  if (!field_is_free || gains.size() <= most) return;
  diagnostics.error(
      block.place,
      fmt::format("{} and all of {} are free, but shrinking them together lowers every residual; "
                  "hold '{}', "
                  "or hold '{}' at the local strength of the field (World Magnetic Model)",
                  block.name + "_field", fmt::join(gains, ", "), gains.back(),
                  block.name + "_field"));
}

}  // namespace
}  // namespace detail

std::optional<ReadingsPlane> plane_of_readings(std::span<const Sample> samples) {
  constexpr std::size_t kFewest = 4;
  constexpr double kThin = 0.1;          // of how far they scatter in the plane
  constexpr double kStraight = 0.99985;  // cosine of a degree
  const detail::Scatter of(samples);
  if (of.readings.size() < kFewest) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pairs(of.square);
  if (!(pairs.eigenvalues()(0) < kThin * kThin * pairs.eigenvalues()(2))) return std::nullopt;
  Vector3<double> normal = pairs.eigenvectors().col(0);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(normal(axis)) > kStraight) normal = Vector3<double>::Unit(axis);
  }
  return ReadingsPlane{of.mean, normal, std::sqrt(std::max(0.0, pairs.eigenvalues()(0)))};
}

void begin_magnetometer(Config& config, std::vector<Sample>& samples, Diagnostics& diagnostics) {
  std::vector<BlockConfig*> blocks;
  for (StepConfig& step : config.steps) {
    for (BlockConfig& block : step.error_blocks) {
      if (block.type == MagneticField::kType) blocks.push_back(&block);
    }
  }
  if (blocks.empty()) return;
  const auto plane = plane_of_readings(samples);
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (block.type != MagneticField::kType) continue;
      detail::check_gains(step, block, plane ? 1 : 2, diagnostics);
    }
  }
  if (plane) {
    for (Sample& sample : samples) {
      const auto reading = detail::reading_of(sample);
      if (!reading) continue;
      const Vector3<double> in_plane =
          *reading - plane->normal.dot(*reading - plane->mean) * plane->normal;
      for (std::size_t axis = 0; axis < detail::kReading.size(); ++axis) {
        sample.conditions[detail::kReading[axis]] = in_plane(static_cast<Eigen::Index>(axis));
      }
    }
    Vector3<double> normal = plane->normal;
    Eigen::Index largest = 0;
    normal.cwiseAbs().maxCoeff(&largest);
    if (normal(largest) < 0.0) normal = -normal;
    diagnostics.note(
        blocks.front()->place,
        fmt::format("the readings of the magnetometer are in a plane, within {:.2g} uT: it turned "
                    "about one axis, ({:.2f}, {:.2f}, {:.2f}).  They determine the bias across "
                    "this axis; for the bias along it and the strength of the field, turn it about "
                    "another axis, too",
                    plane->beside, normal.x(), normal.y(), normal.z()));
  }
  const detail::Scatter of(samples);
  if (of.readings.size() < 2) return;
  const auto [bias, field] = detail::linear_start(of);
  constexpr double kLeast = 1e-4;  // of the readings, whatever their unit
  if (!(field > kLeast * of.mean.norm())) {
    diagnostics.error(
        blocks.front()->place,
        "the readings of the magnetometer are all the same; record while it turns through "
        "a full circle at least");
    return;
  }
  detail::check_field_unit(field, plane.has_value(), blocks.front()->place, diagnostics);
  constexpr std::array<const char*, 3> kBias = {"bias_x", "bias_y", "bias_z"};
  for (BlockConfig* block : blocks) {
    auto& numbers = block->numbers;
    const auto is_default = [&](const ParameterInfo& own) {
      const std::string name(own.name);
      return !block->given.contains(name) && numbers.at(name) == own.initial;
    };
    const auto& own = MagneticField::kParameters;
    if (!std::all_of(own.begin(), own.begin() + 3, is_default) || !is_default(own.back())) continue;
    for (std::size_t axis = 0; axis < kBias.size(); ++axis) {
      numbers[kBias[axis]] = bias(static_cast<Eigen::Index>(axis));
    }
    numbers["field"] = field;
  }
}

}  // namespace kinecal
