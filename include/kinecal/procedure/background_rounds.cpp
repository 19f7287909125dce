// Definitions of background_rounds.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/background_rounds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/errors/point_on_line.hpp"
#include "kinecal/errors/point_on_plane.hpp"
#include "kinecal/errors/point_to_line.hpp"
#include "kinecal/errors/point_to_plane.hpp"
#include "kinecal/errors/point_to_sphere.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/matched_step.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr std::size_t kCloud = 10;                           ///< points of a sample, more than that
constexpr double kGate = 5.0;                                ///< scales of the loss, at most
constexpr std::array kWidths = {81.0, 27.0, 9.0, 3.0, 1.0};  ///< times the scale of the loss

[[nodiscard]] bool is_cloud(const BlockConfig& block, std::span<const Sample> samples) {
  constexpr std::array<std::string_view, 5> kTypes = {PointToSphere::kType, PointToPlane::kType,
                                                      PointOnPlane::kType, PointToLine::kType,
                                                      PointOnLine::kType};
  const bool is_one = std::find(kTypes.begin(), kTypes.end(), block.type) != kTypes.end();
  if (!is_one || block.models.empty()) return false;
  if (block.loss.type != "cauchy" && block.loss.type != "tukey") return false;
  return std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
    const Observation* seen = sample.observation(block.models[0]);
    return seen != nullptr && seen->features.size() > kCloud && !seen->features.front().id;
  });
}

/// Metres beyond which points of a block are of something else, whatever the others do.
[[nodiscard]] double widest_gate(const BlockConfig& block) {
  return kGate * block.loss.scale * block.sigma.value_or(1.0);
}

/// The distances of the points of a block.
struct CloudDistances {
  std::vector<double> all;                  ///< metres
  double gate = 0.0;                        ///< metres
  std::map<int, std::set<int>> background;  ///< places of points beyond the gate, by sample
  std::map<int, std::size_t> within;        ///< numbers of the others, by sample

  /// The share of points within a distance.
  [[nodiscard]] double share(double distance) const {
    const auto count =
        std::count_if(all.begin(), all.end(), [&](double d) { return d <= distance; });
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, all.size()));
  }
};

/// Four robust standard deviations of what is within the gate, narrowed until that settles.
[[nodiscard]] double settled_gate(const std::vector<double>& distances, double widest) {
  constexpr int kMost = 40;
  constexpr double kRobust = 4.0 * 1.4826, kLeast = 1e-6;  // metres
  double gate = widest;
  for (int n = 0; n < kMost; ++n) {
    std::vector<double> near = distances;
    std::erase_if(near, [&](double distance) { return !(distance <= gate); });
    if (near.empty()) return gate;
    const double next = std::min(gate, std::max(kLeast, kRobust * median_of(std::move(near))));
    if (next > 0.99 * gate) return gate;
    gate = next;
  }
  return gate;
}

/// @param problem  of the block's step
[[nodiscard]] CloudDistances distances_of(const BlockConfig& block, const AnyProblem& problem,
                                          const Eigen::VectorXd& values) {
  struct Point {
    int sample, place;
    double distance;
  };
  std::vector<Point> points;
  CloudDistances found;
  (void)evaluate(problem, values, nullptr, [&](int t, int sample, const TermResiduals& rows) {
    const Term& term = problem.term(t);
    if (term.name != block.name) return;
    for (Eigen::Index i = 0; i < rows.residual.size() / term.feature_size; ++i) {
      const double distance =
          rows.residual.segment(i * term.feature_size, term.feature_size).norm();
      points.push_back({sample, problem.feature(t, sample, i).place, distance});
      found.all.push_back(distance);
    }
  });
  found.gate = settled_gate(found.all, widest_gate(block));
  for (const Point& point : points) {
    if (point.distance > found.gate) {
      found.background[point.sample].insert(point.place);
    } else {
      ++found.within[point.sample];
    }
  }
  return found;
}

/// Takes the background away from the points of a block, and from what is paired with them.
void take_away(const BlockConfig& block, const CloudDistances& found,
               std::vector<Sample>& samples) {
  for (const auto& of_sample : found.background) {
    const std::set<int>& places = of_sample.second;
    Sample& sample = samples[static_cast<std::size_t>(of_sample.first)];
    const Observation* points = sample.observation(block.models[0]);
    const std::size_t count = points == nullptr ? 0 : points->features.size();
    for (Observation& seen : sample.observations) {
      const bool is_of_block =
          std::find(block.models.begin(), block.models.end(), seen.sensor) != block.models.end();
      if (!is_of_block || seen.features.size() != count) continue;
      int place = 0;
      std::erase_if(seen.features, [&](const Feature&) { return places.contains(place++); });
    }
  }
}

/// Says how many points of a block count.
/// @param samples  as they were
void report(const BlockConfig& block, const CloudDistances& found, std::span<const Sample> samples,
            bool is_held, Diagnostics& diagnostics) {
  constexpr double kFewest = 0.03, kQuarter = 0.45;  // of normal errors 68 % are within a quarter
  constexpr std::size_t kNamed = 5;
  if (found.all.empty()) return;  // assemble() says so
  const double within = found.share(found.gate), near = found.share(0.25 * found.gate);
  const std::string text = fmt::format(
      "error block '{}': of {}, {:.1f} % lie within {:.4g} mm of what they are compared with, and ",
      block.name, counted(found.all.size(), "point"), 100.0 * within, 1e3 * found.gate);
  if (within < kFewest || near < kQuarter * within) {
    const std::string why =
        text + fmt::format(
                   "{:.1f} % within a quarter of that: hardly more than by chance.  Do the clouds "
                   "show it, in metres, with the joints of their time, is it what the "
                   "configuration says, and is the scale of the loss above the noise?",
                   100.0 * near);
    return is_held ? diagnostics.doubt(block.place, why) : diagnostics.error(block.place, why);
  }
  diagnostics.note(block.place, text + "those count");
  std::vector<std::string> without;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const int number = static_cast<int>(s);
    if (found.background.contains(number) && !found.within.contains(number))
      without.push_back(samples[s].source);
  }
  if (without.empty()) return;
  const std::size_t more = without.size() - std::min(without.size(), kNamed);
  without.resize(std::min(without.size(), kNamed));
  diagnostics.warning(
      block.place,
      fmt::format("error block '{}': no point of {} lies on it{}", block.name,
                  fmt::join(without, ", "), more > 0 ? fmt::format(", nor of {} more", more) : ""));
}

/// Calibrates in rounds, with narrower and narrower losses.
/// @returns  of all parameters; empty if that is not possible: the caller's calibration says why
[[nodiscard]] std::vector<double> fitted(const Robot& robot, const Config& config,
                                         std::span<const Sample> samples,
                                         const SolveOptions& solving) {
  std::vector<double> values;
  for (const double width : kWidths) {
    Config wide = config;
    for (StepConfig& step : wide.steps) {
      for (BlockConfig& block : step.error_blocks) {
        if (width == 1.0 || !is_cloud(block, samples)) continue;
        block.loss = {"cauchy", width * block.loss.scale};  // tukey has no slope far away
      }
    }
    Diagnostics quiet;
    Calibration calibration = assemble(wide, robot, samples, quiet);
    if (!quiet.errors.empty()) return {};
    if (!values.empty()) begin_at(values, calibration);
    const CalibrationResult result = calibrate(calibration, {}, solving);
    values.clear();
    for (const Parameter& parameter : result.table) values.push_back(parameter.value);
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      return {};
  }
  return values;
}

}  // namespace
}  // namespace detail

bool has_background(const Config& config, std::span<const Sample> samples) {
  return std::any_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
    return std::any_of(step.error_blocks.begin(), step.error_blocks.end(),
                       [&](const BlockConfig& block) { return detail::is_cloud(block, samples); });
  });
}

std::vector<double> leave_out_background(const Robot& robot,
                                         const std::optional<std::map<std::string, double>>& held,
                                         Config& config, std::vector<Sample>& samples,
                                         const SolveOptions& solving, Diagnostics& diagnostics) {
  constexpr double kLeast = 1e-7;  // metres
  const std::size_t before = diagnostics.errors.size();
  std::map<std::string, std::string> clouds;  // the block of each sensor, in one step or several
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (!detail::is_cloud(block, samples)) continue;
      if (clouds.emplace(block.models[0], block.name).first->second == block.name) continue;
      diagnostics.error(
          block.place,
          fmt::format("error block '{}': sensor '{}' has a loss in another block, too, and nothing "
                      "says which points belong to which.  Give what it sees as a link of the URDF "
                      "(chain3d_to_mesh), or give the points two names of sensors",
                      block.name, block.models[0]));
    }
  }
  if (diagnostics.errors.size() != before) return {};
  std::vector<double> values;
  if (!held) {
    values = detail::fitted(robot, config, samples, solving);
    if (values.empty()) return {};
  }
  Diagnostics quiet;
  const Calibration calibration = assemble(config, robot, samples, quiet);
  if (!quiet.errors.empty()) return {};  // the caller's assemble() says them
  Eigen::VectorXd at(calibration.table.size());
  for (int p = 0; p < calibration.table.size(); ++p) {
    const Parameter& parameter = calibration.table[p];
    at[p] = values.empty() ? parameter.value : values[static_cast<std::size_t>(p)];
    if (held && held->contains(parameter.name)) at[p] = held->at(parameter.name);
  }
  const std::vector<Sample> given = samples;
  std::set<std::string> done;  // sensors
  for (std::size_t s = 0; s < config.steps.size(); ++s) {
    for (BlockConfig& block : config.steps[s].error_blocks) {
      if (!detail::is_cloud(block, given)) continue;
      detail::CloudDistances found =
          detail::distances_of(block, *calibration.steps.at(s).problem, at);
      if (done.insert(block.models[0]).second) {  // not again in a later step
        detail::report(block, found, given, held.has_value(), diagnostics);
        detail::take_away(block, found, samples);
      }
      keep_loss(block, std::move(found.all), found.gate, kLeast);
    }
  }
  return diagnostics.errors.size() == before ? values : std::vector<double>();
}

void begin_at(std::vector<double> values, Calibration& calibration) {
  if (calibration.steps.empty()) return;
  calibration.begin = std::move(values);
  calibration.steps.front().assignments.clear();
  for (CalibrationStep& step : calibration.steps) {
    std::erase_if(step.unknown_frames, [](const UnknownFrame& frame) { return frame.has_guess; });
    for (UnknownFrame& frame : step.unknown_frames) frame.axes.fill(-1);  // nothing is left to find
  }
}

}  // namespace kinecal
