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
#include "kinecal/trust/folded_lens.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/observability.hpp"

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

/// Makes a held coefficient zero.
void drop_held(const TriedLens& lens, const std::string& camera, std::vector<Sample>& samples) {
  if (lens.held.empty()) return;
  const std::shared_ptr<const AnySensor> sensor = any_built_in(lens_camera(lens.name));
  const auto coefficients = sensor->parameters().subspan(kIntrinsics);
  const auto held = std::find_if(coefficients.begin(), coefficients.end(),
                                 [&](const ParameterInfo& info) { return info.name == lens.held; });
  const auto place = static_cast<std::size_t>(held - coefficients.begin());
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != camera || !seen.camera || seen.camera->d.size() <= place) continue;
      seen.camera->d[place] = 0.0;
    }
  }
}

/// A parameter of a camera that samples do not determine; empty if they determine all.
[[nodiscard]] std::string undetermined(const CalibrationStep& step, ParameterValues values,
                                       const ParameterTable& table,
                                       const std::set<std::string>& of) {
  constexpr double kTakesPart = 0.01;
  for (const Combination& changes : observability(*step.problem, step.free, values).unobservable) {
    for (const auto& [parameter, factor] : changes) {
      if (std::abs(factor) > kTakesPart && of.contains(table[parameter].name)) {
        return table[parameter].name;
      }
    }
  }
  return "";
}

/// Calibrates a lens and predicts what was held out.
void try_lens(const Robot& robot, const ModelConfig& camera, TriedLens& lens) {
  Diagnostics diagnostics;
  start_cameras(lens.config, robot, lens.samples, diagnostics);
  drop_held(lens, camera.name, lens.samples);
  choose_lenses(lens.config, lens.samples, diagnostics);
  choose_images(lens.config, robot, lens.samples, diagnostics);
  constexpr int kEnough = 100;  // iterations: a lens that does not fit is not worth more
  for (StepConfig& step : lens.config.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
  }
  const Calibration calibration = assemble(lens.config, robot, lens.samples, diagnostics);
  if (!diagnostics.errors.empty()) {
    lens.fault = diagnostics.errors.front();
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
  const std::string free =
      undetermined(last, values, result.table, names_with_lens(camera, lens.name));
  if (!free.empty()) {
    lens.fault = "samples do not determine " + free;
    return;
  }
  try {
    lens.squares = held_out_squares(*last.problem, last.free, values, lens.samples);
  } catch (const std::domain_error&) {
    lens.fault = "samples without a fifth of them do not determine it";
  }
}

/// "plumb_bob 22.7 px, equidistant 0.84 px, double_sphere: folds over"
[[nodiscard]] std::string errors_text(const std::vector<TriedLens>& tried) {
  std::string text;
  for (const TriedLens& lens : tried) {
    text += text.empty() ? "" : ", ";
    text += lens.fault.empty() ? fmt::format("{} {:.4g} px", lens.text(), lens.error())
                               : fmt::format("{}: {}", lens.text(), lens.fault);
  }
  return text;
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
      tried.push_back({name, held, detail::with_lens(alone, camera, name, held), samples, {}, {}});
      detail::try_lens(robot, camera, tried.back());
    }
    const auto fits = [](const detail::TriedLens& lens) { return lens.fault.empty(); };
    const auto best = std::find_if(tried.begin(), tried.end(), [&](const detail::TriedLens& one) {
      return fits(one) &&
             std::none_of(tried.begin(), tried.end(), [&](const detail::TriedLens& other) {
               return fits(other) && other.beats(one);
             });
    });
    if (best == tried.end()) {
      const std::string& fault = tried.front().fault;
      const bool same = std::all_of(tried.begin(), tried.end(),
                                    [&](const auto& lens) { return lens.fault == fault; });
      if (same) {
        diagnostics.errors.push_back(fault);
      } else {
        diagnostics.error(camera.place, fmt::format("sensor '{}': no lens fits: {}", camera.name,
                                                    detail::errors_text(tried)));
      }
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
