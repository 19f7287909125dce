// Definitions of find_lenses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/cameras/find_lenses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/tools/cameras/start_cameras.hpp"
#include "kinecal/tools/cameras/trial_config.ipp"
#include "kinecal/tools/cameras/tried_lens.ipp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/folded_lens.hpp"
#include "kinecal/trust/held_out.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The lenses from the simplest on: that of ordinary cameras, fisheyes, polynomials with many terms.  Each with a
/// coefficient that may be superfluous, or none.
constexpr std::array<std::array<std::string_view, 2>, 6> kLenses = {
    {{PlumbBob::kName, "k3"},
     {PlumbBob::kName, ""},
     {DoubleSphere::kName, ""},
     {Equidistant::kName, ""},
     {RationalPolynomial::kName, ""},
     {ThinPrism::kName, ""}}};

/// The parameters of a camera that samples do not determine, or hardly.
struct Undetermined {
  std::string not_at_all, hardly;  ///< the first of each; empty: absent
};

[[nodiscard]] Undetermined undetermined(const CalibrationStep& step, ParameterValues values,
                                        const ParameterTable& table,
                                        const std::vector<Sample>& samples,
                                        const std::set<std::string>& of) {
  constexpr double kTakesPart = 0.01;
  const Assessment found = assess(*step.problem, step.free, values, samples, {.folds = 0});
  Undetermined all;
  for (const Combination& changes : found.observability.unobservable) {
    for (const auto& [parameter, factor] : changes) {
      const bool takes_part = std::abs(factor) > kTakesPart && of.contains(table[parameter].name);
      if (takes_part && all.not_at_all.empty()) all.not_at_all = table[parameter].name;
    }
  }
  for (const int parameter : found.weak.parameters) {
    if (of.contains(table[parameter].name) && all.hardly.empty()) {
      all.hardly = table[parameter].name;
    }
  }
  return all;
}

/// A view with corners that are far off must not decide: each counts less beyond a few pixels.
void bound_outliers(Config& config) {
  constexpr double kFar = 3.0;  // pixels, or sigma
  for (StepConfig& step : config.steps) {
    for (BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      const bool is_of_pixels = entry != nullptr && entry->read_as == PointToPixel::kType;
      if (is_of_pixels && block.loss.type == "none") block.loss = {"huber", kFar};
    }
  }
}

/// Calibrates a lens and predicts what was held out.
void calibrate_lens(const Robot& robot, const ModelConfig& camera, TriedLens& lens) {
  Diagnostics diagnostics;
  bound_outliers(lens.config);
  start_cameras(lens.config, robot, lens.samples, diagnostics);
  choose_lenses(lens.config, lens.samples, diagnostics);
  choose_images(lens.config, robot, lens.samples, diagnostics);
  constexpr int kEnough = 100;  // iterations: a lens that does not fit is not worth more
  for (StepConfig& step : lens.config.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
  }
  const Calibration calibration = assemble(lens.config, robot, lens.samples, diagnostics);
  if (!diagnostics.errors.empty()) {
    lens.fault = diagnostics.errors.front();
    lens.is_wrong_input = true;
    return;
  }
  const CalibrationResult result = calibrate(calibration);
  if (!result.converged) {
    lens.fault = "does not fit";
    return;
  }
  const Eigen::VectorXd solution = result.table.values();
  const CalibrationStep& last = calibration.steps.back();
  const ParameterValues values{solution.data(), static_cast<std::size_t>(solution.size())};
  const std::vector<FoldedLens> folds =
      folded_lenses(*last.problem, last.free, values, lens.samples);
  if (!folds.empty() && folds.front().is_among_features()) {
    lens.fault = fmt::format("folds over {:.0f} px from the center", folds.front().radius);
    return;
  }
  const Undetermined unknown =
      undetermined(last, values, result.table, lens.samples, names_with_lens(camera, lens.name));
  if (!unknown.not_at_all.empty()) {
    lens.unknown = unknown.not_at_all;
    lens.fault = "samples do not determine " + lens.unknown;
    return;
  }
  lens.hardly = unknown.hardly;
  try {
    lens.squares = held_out_squares(*last.problem, last.free, values, lens.samples);
  } catch (const std::domain_error&) {
    lens.fault = "samples without a fifth of them do not determine it";
  }
}

/// The same; a lens under which the samples make no sense is out.
void try_lens(const Robot& robot, const ModelConfig& camera, TriedLens& lens) {
  try {
    calibrate_lens(robot, camera, lens);
  } catch (const SettingsError&) {  // a coefficient that is not a number
    lens.fault = "does not fit";
  } catch (const std::domain_error&) {  // a corner that its camera does not see
    lens.fault = "does not fit";
  }
}

/// The first lens that no other one beats; nullptr if none fits.
/// @param weak  also those with a parameter that samples hardly determine
[[nodiscard]] const TriedLens* best_of(const std::vector<TriedLens>& tried, bool weak) {
  const auto fits = [&](const TriedLens& lens) {
    return lens.fault.empty() && (weak || lens.hardly.empty());
  };
  const auto best = std::find_if(tried.begin(), tried.end(), [&](const TriedLens& one) {
    return fits(one) && std::none_of(tried.begin(), tried.end(), [&](const TriedLens& other) {
             return fits(other) && other.beats(one);
           });
  });
  return best == tried.end() ? nullptr : &*best;
}

}  // namespace
}  // namespace detail

void find_lenses(Config& config, const Robot& robot, std::vector<Sample>& samples,
                 Diagnostics& diagnostics) {
  const Config given = config;
  for (const ModelConfig& camera : detail::models_of(given)) {
    if (camera.lens != kAnyLens) continue;
    std::vector<detail::TriedLens> tried;
    const Config alone = detail::without_others(given, robot, camera);
    for (const auto& [lens, superfluous] : detail::kLenses) {
      const std::string name(lens), held(superfluous);
      tried.push_back({name, held, detail::with_lens(alone, camera, name, held), samples});
      detail::try_lens(robot, camera, tried.back());
    }
    const detail::TriedLens* best = detail::best_of(tried, false);
    if (best == nullptr) best = detail::best_of(tried, true);
    if (best == nullptr) {
      detail::report_faults(camera, tried, diagnostics);
      continue;
    }
    diagnostics.note(
        camera.place,
        fmt::format("sensor '{}': lens by the error on views held out: {}: taken as {}",
                    camera.name, detail::errors_text(tried), best->text()));
    config = detail::with_lens(config, camera, best->name, best->held);
    detail::take_camera(camera.name, best->samples, samples);
  }
}

}  // namespace kinecal
