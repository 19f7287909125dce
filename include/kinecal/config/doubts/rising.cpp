// Definitions of rising.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/rising.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/urdf/urdf_places.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/trust/plain_equations.hpp"

namespace kinecal {

std::map<std::string, double> rising_of(const std::string& text,
                                        const std::string& name_for_messages) {
  const detail::UrdfPlaces source(text, name_for_messages);
  Diagnostics diagnostics;
  std::map<std::string, double> rising;
  for (const detail::JointElement& joint : source.joints()) {
    const double value =
        source.numbers(joint.name, "calibration", "rising", 1, diagnostics).front();
    if (value != 0.0) rising.emplace(joint.name, value);
  }
  diagnostics.throw_if_errors();
  return rising;
}

void add_rising(const std::map<std::string, double>& rising, std::vector<Sample>& samples,
                double factor) {
  for (Sample& sample : samples) {
    const std::size_t measured = std::min(sample.joint_names.size(), sample.joint_positions.size());
    for (std::size_t i = 0; i < measured; ++i) {
      const auto found = rising.find(sample.joint_names[i]);
      if (found != rising.end()) sample.joint_positions[i] += factor * found->second;
    }
  }
}

namespace detail {

/// The quality of a fit: the cost, and the mean residual of the first error block.
struct FitOfSamples {
  double cost = 0.0, mean = 0.0;
  std::string unit;
};

/// The fit of the first step with the offsets of these joints held: free offsets would absorb the
/// difference between the two assumptions.
[[nodiscard]] inline std::optional<FitOfSamples> fit_with_held_offsets(
    const Config& config, const Robot& robot, std::span<const Sample> samples,
    const std::map<std::string, double>& held) {
  Diagnostics quiet;
  Calibration calibration = assemble(config, robot, samples, quiet);
  if (!quiet.errors.empty() || calibration.steps.empty()) return std::nullopt;
  calibration.steps.erase(calibration.steps.begin() + 1, calibration.steps.end());
  CalibrationStep& step = calibration.steps.front();
  std::vector<int> free = step.free.parameters();
  std::erase_if(free, [&](int p) { return held.contains(calibration.table[p].name); });
  if (free.empty()) {
    const Eigen::VectorXd values = calibration.table.values();
    const auto blocks = block_statistics(*step.problem, values, values);
    if (blocks.empty()) return std::nullopt;
    const FreeSet none({}, calibration.table.size());
    return FitOfSamples{plain_equations(*step.problem, none, values).cost,
                        blocks.front().after.mean, blocks.front().unit};
  }
  step.free = FreeSet(std::move(free), calibration.table.size());
  step.max_num_iterations = 200;
  const CalibrationResult result = calibrate(calibration);
  FitOfSamples fit;
  fit.cost = result.steps.front().final_cost;
  if (!result.blocks.empty()) {
    fit.mean = result.blocks.front().after.mean;
    fit.unit = result.blocks.front().unit;
  }
  return std::isfinite(fit.cost) ? std::optional(fit) : std::nullopt;
}

/// Doubt: the samples fit better under the other assumption.
inline void doubt_assumption(const Config& config, const Robot& robot,
                             const std::map<std::string, double>& rising,
                             const SourceLocation& place, std::span<const Sample> samples,
                             Recorded recorded, Diagnostics& diagnostics) {
  constexpr double kClearly = 4.0;  // in cost: twice in residuals
  const bool after = recorded == Recorded::after;
  std::vector<Sample> others(samples.begin(), samples.end());
  add_rising(rising, others, after ? 1.0 : -1.0);
  const auto assumed = fit_with_held_offsets(config, robot, samples, rising);
  const auto other = fit_with_held_offsets(config, robot, others, rising);
  if (!assumed || !other || kClearly * other->cost > assumed->cost) return;
  diagnostics.doubt(
      place,
      fmt::format(
          "the samples look recorded {} <calibration rising> was written: with these offsets "
          "held, the mean residual is {}, against {} as assumed; use --samples-recorded {}",
          after ? "before" : "after", residual_text(other->mean, other->unit),
          residual_text(assumed->mean, assumed->unit), after ? "before" : "after"));
}

void check_rising(const Config& config, const Robot& robot, const std::string& text,
                  const std::string& name_for_messages, std::span<const Sample> samples,
                  Recorded recorded, Diagnostics& diagnostics) {
  std::map<std::string, double> rising = rising_of(text, name_for_messages), used;
  for (const UsedJoint& joint : used_joints(config, robot, {})) {
    const auto found = rising.find(joint.joint.name);
    if (found != rising.end()) used.insert(*found);
  }
  if (used.empty() || samples.empty()) return;
  const UrdfPlaces source(text, name_for_messages);
  const auto& [name, value] = *used.begin();
  const SourceLocation place = source.place(name, "calibration");
  if (recorded == Recorded::after) {
    diagnostics.warning(
        place,
        fmt::format(
            "joint '{}' has <calibration rising=\"{:.6g}\">{}; it is assumed that the "
            "samples were recorded with it in force, so that new offsets are added to "
            "it; if they were recorded before, use --samples-recorded before",
            name, value,
            used.size() == 1 ? "" : fmt::format(" (and {} more have one)", used.size() - 1)));
  }
  doubt_assumption(config, robot, used, place, samples, recorded, diagnostics);
}

}  // namespace detail
}  // namespace kinecal
