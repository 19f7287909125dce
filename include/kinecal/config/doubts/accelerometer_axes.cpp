// Definitions of accelerometer_axes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/accelerometer_axes.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/errors/gravity_seen.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal::detail {
namespace {

/// Upwards in the axes of the sensor, of length one, and what it read, m/s^2; or how it turned, rotation vectors.
struct UpSeen {
  Vector3<double> up, read;
};

/// The axes of the sensor in the base; nullopt if joints are missing.
[[nodiscard]] std::optional<Matrix3<double>> axes_at(const RuntimeChain& chain,
                                                     const Sample& sample) {
  bool is_known = true;
  const Pose<double> base_T_sensor = forward_kinematics(chain, [&](const std::string& joint) {
    const auto position = sample.position(joint);
    is_known = is_known && position.has_value();
    return position.value_or(0.0);
  });
  return is_known ? std::optional(base_T_sensor.rotation) : std::nullopt;
}

/// Three conditions of a sample; nullopt if one is missing.
template <class Names>
[[nodiscard]] std::optional<Vector3<double>> read_of(const Sample& sample, const Names& names) {
  Vector3<double> read;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = sample.conditions.find(std::string(names[axis]));
    if (found == sample.conditions.end() || !std::isfinite(found->second)) return std::nullopt;
    read(static_cast<Eigen::Index>(axis)) = found->second;
  }
  return read;
}

/// Axes that are exchanged and reversed: axis k reads sign[k] times axis of[k].
struct OtherAxes {
  std::array<int, 3> of = {0, 1, 2};
  std::array<int, 3> sign = {1, 1, 1};

  /// Root of the mean square of what is left, m/s^2.
  [[nodiscard]] double left(const std::vector<UpSeen>& all, double strength) const {
    double squares = 0.0;
    for (const UpSeen& seen : all) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double r =
            seen.read(static_cast<Eigen::Index>(k)) - strength * sign[k] * seen.up(of[k]);
        squares += r * r;
      }
    }
    return std::sqrt(squares / static_cast<double>(all.size()));
  }
  [[nodiscard]] std::string text() const {
    const bool in_order = of == std::array<int, 3>{0, 1, 2};
    if (in_order && sign == std::array<int, 3>{-1, -1, -1}) {
      return "with the other sign";
    }
    std::string axes;
    for (std::size_t k = 0; k < 3; ++k) {
      if (of[k] == static_cast<int>(k) && sign[k] > 0) continue;
      axes += fmt::format("{}its {} reads {}{}", axes.empty() ? "with other axes: " : ", ",
                          "xyz"[k], sign[k] < 0 ? "-" : "", "xyz"[static_cast<std::size_t>(of[k])]);
    }
    return axes;
  }
};

/// The best of all 48.
[[nodiscard]] OtherAxes best_axes(const std::vector<UpSeen>& all, double strength) {
  OtherAxes best;
  OtherAxes other;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      for (std::size_t k = 0; k < 3; ++k) other.sign[k] = (signs >> k) % 2 == 0 ? 1 : -1;
      if (other.left(all, strength) < best.left(all, strength)) best = other;
    }
  } while (std::next_permutation(other.of.begin(), other.of.end()));
  return best;
}

/// True if readings are a reflection of what they should be.
[[nodiscard]] bool is_mirrored(const std::vector<UpSeen>& all) {
  constexpr double kSurely = 0.02;  // of -1, where the poses show all directions alike
  Matrix3<double> products = Matrix3<double>::Zero();
  for (const UpSeen& seen : all) products += seen.up * seen.read.transpose();
  const double size = products.norm() / std::sqrt(3.0);
  return products.determinant() < -kSurely * size * size * size;
}

/// How a gyroscope turned from rest to rest.
constexpr std::array<const char*, 3> kTurned = {"turned_a", "turned_b", "turned_c"};

/// Doubts a gyroscope that turns against the joints.
void check_turns(const std::vector<UpSeen>& turns, const BlockConfig& block,
                 const ModelConfig& model, const std::string& frame, Diagnostics& diagnostics) {
  constexpr double kWrong = 0.2, kBetter = 0.3;  // radians; of what is left
  const OtherAxes best = best_axes(turns, 1.0);
  const double as_it_is = OtherAxes().left(turns, 1.0);
  if (as_it_is < kWrong || best.left(turns, 1.0) > kBetter * as_it_is) return;
  diagnostics.doubt(block.place,
                    fmt::format("the gyroscope beside the accelerometer of model '{}' turns {}, "
                                "compared with link '{}' of the URDF",
                                model.name, best.text(), frame));
}

}  // namespace

void check_accelerometer_axes(const Config& config, const Robot& robot,
                              std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr std::size_t kFewest = 4;
  constexpr double kSmall = 1.5;                 // radians: reversed rates add up to the reverse
  constexpr double kWrong = 3.0, kBetter = 0.3;  // m/s^2; of what is left
  const Vector3<double> up = config.gravity && config.gravity->norm() > 0.0
                                 ? Vector3<double>(-config.gravity->normalized())
                                 : Vector3<double>(0.0, 0.0, 1.0);
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (block.type != GravitySeen::kType || block.models.empty()) continue;
      const auto model =
          std::find_if(step.models.begin(), step.models.end(),
                       [&](const ModelConfig& one) { return one.name == block.models.front(); });
      if (model == step.models.end()) continue;
      std::string frame;
      for (const Sample& sample : samples) {
        const Observation* seen = sample.observation(model->name);
        if (seen != nullptr && !seen->features.empty()) frame = seen->features.front().frame;
      }
      const bool is_link = robot.has_link(frame);
      const RuntimeChain chain =
          make_chain(robot, config.base_link, is_link ? frame : model->frame);
      std::vector<UpSeen> all, turns;
      double strength = 0.0;
      std::optional<Matrix3<double>> before;
      for (const Sample& sample : samples) {
        if (sample.observation(model->name) == nullptr) continue;
        const auto axes = axes_at(chain, sample);
        const auto read = read_of(sample, GravitySeen::kConditions),
                   turned = read_of(sample, kTurned);
        if (axes && read) all.push_back({Vector3<double>(axes->transpose() * up), *read});
        if (axes && before && turned) {
          const Vector3<double> turn = log(Matrix3<double>(before->transpose() * *axes));
          if (turn.norm() < kSmall) turns.push_back({turn, *turned});
        }
        before = axes;
      }
      if (is_link && turns.size() >= kFewest) check_turns(turns, block, *model, frame, diagnostics);
      if (all.size() < kFewest) continue;
      for (const UpSeen& seen : all) strength += seen.read.norm() / static_cast<double>(all.size());
      const OtherAxes best = is_link ? best_axes(all, strength) : OtherAxes();
      const double as_it_is = OtherAxes().left(all, strength);
      if (is_link && as_it_is > kWrong && best.left(all, strength) < kBetter * as_it_is) {
        diagnostics.doubt(block.place,
                          fmt::format("the accelerometer of model '{}' reads gravity {}, compared "
                                      "with link '{}' of the URDF",
                                      model->name, best.text(), frame));
      } else if (is_mirrored(all)) {
        diagnostics.doubt(
            block.place, fmt::format("the accelerometer of model '{}' reads gravity with the other "
                                     "sign (at rest, a reading points up), or its axes are "
                                     "left-handed: two are exchanged, or one is reversed",
                                     model->name));
      }
    }
  }
}

}  // namespace kinecal::detail
