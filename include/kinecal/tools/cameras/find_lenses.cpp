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
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/lens_names.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/tools/cameras/camera_places.ipp"
#include "kinecal/tools/cameras/start_cameras.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/systematic/folded_lens.hpp"

namespace kinecal {

namespace detail {
namespace {

// Configurations with which find_lenses() tries a lens.

/// Names of the parameters of a camera with a lens.
[[nodiscard]] std::set<std::string> names_with_lens(ModelConfig camera, std::string_view lens) {
  camera.lens = lens;
  std::set<std::string> names;
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  for (const ParameterInfo& info : sensor->parameters()) {
    names.insert(parameter_name(camera.param_name, info.name));
  }
  return names;
}

/// The same with any lens.
[[nodiscard]] std::set<std::string> names_with_lenses(const ModelConfig& camera) {
  std::set<std::string> names;
  for (const std::string_view lens : lens_names()) names.merge(names_with_lens(camera, lens));
  return names;
}

/// The configuration with a lens whose intrinsics are free.
/// @param held  a coefficient that is not; empty: all are
[[nodiscard]] Config with_lens(Config config, const ModelConfig& camera, const std::string& lens,
                               const std::string& held) {
  const std::set<std::string> others = names_with_lenses(camera);
  std::set<std::string> free = names_with_lens(camera, lens);
  if (!held.empty()) free.erase(parameter_name(camera.param_name, held));
  for (StepConfig& step : config.steps) {
    bool has_camera = false;
    for (ModelConfig& model : step.models) {
      if (model.name != camera.name) continue;
      has_camera = true;
      model.lens = lens;
      model.image = ImageKind::raw;
    }
    if (!has_camera) continue;
    std::erase_if(step.free_params, [&](const auto& param) { return others.contains(param.name); });
    for (const std::string& name : free) {
      step.free_params.push_back({name, camera.place});
    }
  }
  return config;
}

/// The configuration without the other cameras whose lens is to be found, so that none waits for another; and
/// without the free frame on which the camera stands, if no other camera is left to say where that is.
[[nodiscard]] Config without_others(Config config, const Robot& robot, const ModelConfig& camera) {
  std::set<std::string> cameras, parameters;
  for (const ModelConfig& model : models_of(config)) {
    if (model.lens != kAnyLens || model.name == camera.name) continue;
    cameras.insert(model.name);
    parameters.merge(names_with_lenses(model));
  }
  if (cameras.empty()) return config;
  const bool is_placed = is_placed_by_us(config, robot, camera);
  for (StepConfig& step : config.steps) {
    std::set<std::string> used;
    std::erase_if(step.error_blocks, [&](const BlockConfig& block) {
      const bool is_theirs =
          std::any_of(block.models.begin(), block.models.end(),
                      [&](const std::string& model) { return cameras.contains(model); });
      if (!is_theirs) used.insert(block.models.begin(), block.models.end());
      return is_theirs;
    });
    std::erase_if(step.models, [&](const auto& model) { return !used.contains(model.name); });
    std::erase_if(step.free_params,
                  [&](const auto& free) { return parameters.contains(free.name); });
  }
  const std::vector<TargetPair> left = target_pairs(config, robot);
  const bool is_only = std::all_of(left.begin(), left.end(), [&](const TargetPair& pair) {
    return pair.camera->name == camera.name;
  });
  std::set<std::string> joints;
  for (const Joint* joint : joints_between(config, robot)) joints.insert(joint->name);
  if (is_placed && is_only) joints.erase(robot.parent_joint(camera.frame)->name);
  for (StepConfig& step : config.steps) {
    const auto is_idle = [&](const auto& frame) {
      return robot.has_joint(frame.name) && !joints.contains(frame.name);
    };
    std::erase_if(step.free_frames, is_idle);
    std::erase_if(step.frame_initial_values, is_idle);
  }
  return config;
}

/// Gives the samples of a camera the camera_info of others.
void take_camera(const std::string& camera, const std::vector<Sample>& from,
                 std::vector<Sample>& samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const Observation* found = from[s].observation(camera);
    for (Observation& seen : samples[s].observations) {
      if (seen.sensor == camera && found != nullptr) seen.camera = found->camera;
    }
  }
}

// A lens that find_lenses() has tried, and whether its error on held-out samples is smaller than that of another.

/// A mean, and whether it is above zero for certain.
class SureMean {
 public:
  void add(double value) {
    sum_ += value;
    squared_ += value * value;
    count_ += 1.0;
  }
  [[nodiscard]] bool is_positive() const {
    if (count_ < 3.0) return false;
    const double mean = sum_ / count_, variance = squared_ / count_ - mean * mean;
    // Chance is below 5 %: Student's t, to 2 % of its value.
    const double freedom = count_ - 1.0;
    const double sure = 1.645 * (1.0 + 1.0 / freedom + 1.1 / (freedom * freedom));
    return mean > sure * std::sqrt(std::max(0.0, variance) / freedom);
  }

 private:
  double sum_ = 0.0, squared_ = 0.0, count_ = 0.0;
};

/// A lens that was tried.
struct TriedLens {
  std::string name;
  std::string held;  ///< a coefficient that is zero and held; empty: none
  Config config;
  std::vector<Sample> samples;
  std::vector<double> squares = {};  ///< held_out_squares()
  std::string fault = {};            ///< why it is out; empty: it is not
  bool is_wrong_input = false;       ///< the fault is an error with its place, not one of this lens
  std::string unknown = {};          ///< a parameter that the samples do not determine; empty: none
  std::string hardly = {};           ///< a parameter that the samples hardly determine; empty: none

  /// "plumb_bob without k3"
  [[nodiscard]] std::string text() const { return held.empty() ? name : name + " without " + held; }
  /// Root of the mean of the squared distances of features, pixels.
  [[nodiscard]] double error() const {
    double sum = 0.0, count = 0.0;
    for (const double square : squares) {
      sum += square;
      count += square > 0.0 ? 1.0 : 0.0;
    }
    return count > 0.0 ? std::sqrt(2.0 * sum / count) : 0.0;  // of both coordinates
  }
  /// True if its error is significantly smaller than that of another one: by the differences of mean squares, or by
  /// their ratios, which one view that is far off under the other lens does not blur.
  [[nodiscard]] bool beats(const TriedLens& other) const {
    if (!(error() < other.error())) return false;
    SureMean differences, ratios;
    for (std::size_t s = 0; s < squares.size(); ++s) {
      if (!(squares[s] > 0.0 && other.squares[s] > 0.0)) continue;
      differences.add(other.squares[s] - squares[s]);
      ratios.add(std::log(other.squares[s] / squares[s]));
    }
    return differences.is_positive() || ratios.is_positive();
  }
};

/// "plumb_bob 22.7 px, equidistant 0.84 px, double_sphere: folds over"
[[nodiscard]] std::string errors_text(const std::vector<TriedLens>& tried) {
  std::string text;
  for (const TriedLens& lens : tried) {
    text += text.empty() ? "" : ", ";
    text += lens.fault.empty() ? fmt::format("{} {:.4g} px", lens.text(), lens.error())
                               : fmt::format("{}: {}", lens.text(), lens.fault);
    if (!lens.hardly.empty()) text += fmt::format(" (hardly determines {})", lens.hardly);
  }
  return text;
}

/// Reports why no lens fits: what is wrong with the views, if some lens says it.
void report_faults(const ModelConfig& camera, const std::vector<TriedLens>& tried,
                   Diagnostics& diagnostics) {
  const auto wrong = std::find_if(tried.begin(), tried.end(),
                                  [](const TriedLens& lens) { return lens.is_wrong_input; });
  if (wrong != tried.end()) {
    diagnostics.errors.push_back(wrong->fault);
    return;
  }
  const bool is_flat = std::any_of(tried.begin(), tried.end(), [&](const TriedLens& lens) {
    return lens.unknown == parameter_name(camera.param_name, "fx") ||
           lens.unknown == parameter_name(camera.param_name, "fy");
  });
  const bool is_same = std::all_of(tried.begin(), tried.end(), [&](const TriedLens& lens) {
    return lens.fault == tried.front().fault;
  });
  const std::string faults = is_same ? tried.front().fault : errors_text(tried);
  diagnostics.error(
      camera.place,
      is_flat ? fmt::format("these views do not tell the focal length of '{}': tilt the target by "
                            "30 degrees to all sides ({})",
                            camera.name, faults)
              : fmt::format("sensor '{}': no lens fits ({}); are the columns, rows and ids of the "
                            "target right?",
                            camera.name, faults));
}

/// The lenses from the simplest on: that of ordinary cameras, fisheyes, polynomials with many terms.  Each with a
/// coefficient that may be superfluous; empty if all are needed.
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
