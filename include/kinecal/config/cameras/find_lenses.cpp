// Definitions of find_lenses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/find_lenses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/cameras/camera_places.ipp"
#include "kinecal/config/cameras/known_cameras.ipp"
#include "kinecal/config/cameras/start_cameras.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/systematic/folded_lens.hpp"
#include "kinecal/trust/uncertainty/projection_map.hpp"

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

/// A lens with as many of its coefficients as are free; the others are zero.
struct LensForm {
  std::string_view name;
  std::string_view free;  ///< "k1 k2", in the order of its coefficients, one a word

  [[nodiscard]] std::set<std::string> coefficients() const {
    std::istringstream words{std::string(free)};
    return {std::istream_iterator<std::string>(words), {}};
  }
  /// "plumb_bob k1 k2 p1 p2", "plumb_bob without distortion"
  [[nodiscard]] std::string text() const {
    return std::string(name) + " " + std::string(free.empty() ? "without distortion" : free);
  }
};

/// The configuration with a lens whose intrinsics are free.
[[nodiscard]] Config with_lens(Config config, const ModelConfig& camera, const LensForm& form) {
  const std::set<std::string> others = names_with_lenses(camera);
  const std::string lens(form.name);
  std::set<std::string> free;
  for (const std::string_view own : {"fx", "fy", "cx", "cy"}) {
    free.insert(parameter_name(camera.param_name, own));
  }
  for (const std::string& own : form.coefficients()) {
    free.insert(parameter_name(camera.param_name, own));
  }
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

constexpr double kFar =
    3.0;  // pixels: corners that are farther off count less, so that no view decides alone

/// The square of a distance; beyond kFar as under its loss.
[[nodiscard]] double bounded_square(double distance) {
  return distance <= kFar ? distance * distance : kFar * (2.0 * distance - kFar);
}

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
    constexpr double kChance = 0.01;  // Student's t on one side: its square is an F on both
    const double mean = sum_ / count_, variance = squared_ / count_ - mean * mean;
    const double freedom = count_ - 1.0;
    return mean > 0.0 && mean * mean * freedom > f_exceeded(1.0, freedom, 2.0 * kChance) * variance;
  }

 private:
  double sum_ = 0.0, squared_ = 0.0, count_ = 0.0;
};

/// A lens that was tried.
struct TriedLens {
  LensForm form;
  Config config;
  std::vector<Sample> samples;
  std::vector<double> squares =
      {};                       ///< mean bounded_square() of each sample, held out; 0: no features
  double error = 0.0;           ///< root of that of all features, pixels
  double fitted = 0.0;          ///< typical distance of all features from the fit, pixels
  double known = HUGE_VAL;      ///< +- of a pixel where features are, pixels
  bool has_focal = true;        ///< false: samples do not determine the focal length at the axis
  bool is_traded = false;       ///< fx is not known; what it and coefficients make together is
  std::string fault = {};       ///< why it is out; empty: it is not
  bool is_wrong_input = false;  ///< the fault is an error with its place, not one of this lens

  /// Sets the error.
  void set(const std::vector<std::vector<double>>& distances) {
    double all = 0.0, features = 0.0;
    for (const std::vector<double>& of_sample : distances) {
      double sum = 0.0;
      for (const double distance : of_sample) sum += bounded_square(distance);
      const auto count = static_cast<double>(of_sample.size());
      squares.push_back(count > 0.0 ? sum / count : 0.0);
      all += sum;
      features += count;
    }
    error = std::sqrt(all / std::max(1.0, features));
  }
  /// True if its pixels are known as well as its corners are, and fx is.
  [[nodiscard]] bool is_known() const {
    return known <= std::max(ProjectionMap::kEnough, error) && !is_traded;
  }
  /// True if its error is smaller than that of another one: by more than 2 %, or by more than 1 % and beyond chance, by the
  /// differences of samples' mean squares, or by their ratios, which one sample that is far off under the other lens
  /// does not blur.
  [[nodiscard]] bool beats(const TriedLens& other) const {
    constexpr double kAlike = 1.01, kClear = 1.02;
    if (kClear * error < other.error) return true;
    if (!(kAlike * error < other.error)) return false;
    SureMean differences, ratios;
    for (std::size_t s = 0; s < squares.size(); ++s) {
      if (!(squares[s] > 0.0 && other.squares[s] > 0.0)) continue;
      differences.add(other.squares[s] - squares[s]);
      ratios.add(std::log(other.squares[s] / squares[s]));
    }
    return differences.is_positive() || ratios.is_positive();
  }
};

/// "plumb_bob k1 22.7 px, equidistant k1 k2 0.84 px, double_sphere xi alpha: folds over"
[[nodiscard]] std::string errors_text(const std::vector<TriedLens>& tried) {
  std::string text;
  for (const TriedLens& lens : tried) {
    text += text.empty() ? "" : ", ";
    text += lens.fault.empty() ? fmt::format("{} {:.4g} px", lens.form.text(), lens.error)
                               : fmt::format("{}: {}", lens.form.text(), lens.fault);
    if (lens.fault.empty() && !lens.is_known()) {
      text += lens.is_traded ? " (its coefficients make up for fx)"
                             : fmt::format(" (its pixels are known to {:.2g} px only)", lens.known);
    }
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
  const auto without_focal = std::count_if(tried.begin(), tried.end(),
                                           [](const TriedLens& lens) { return !lens.has_focal; });
  const bool is_flat = 4 * without_focal >= std::ssize(tried);  // one or two do so by chance
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

/// The lenses in the order in which they are preferred: that of ordinary cameras, which all programs read, with as few
/// coefficients as needed; fisheyes; polynomials with many terms.
constexpr std::array<LensForm, 10> kLenses = {
    {{PlumbBob::kName, ""},
     {PlumbBob::kName, "k1"},
     {PlumbBob::kName, "k1 k2"},
     {PlumbBob::kName, "k1 k2 p1 p2"},
     {PlumbBob::kName, "k1 k2 p1 p2 k3"},
     {Equidistant::kName, "k1 k2"},
     {DoubleSphere::kName, "xi alpha"},
     {Equidistant::kName, "k1 k2 k3 k4"},
     {RationalPolynomial::kName, "k1 k2 p1 p2 k3 k4 k5 k6"},
     {ThinPrism::kName, "k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4"}}};

/// Sets how well pixels are known.
void set_known(const CalibrationStep& step, ParameterValues values, const std::string& camera,
               TriedLens& lens) {
  for (const ProjectionMap& map : projection_maps(*step.problem, step.free, values, lens.samples)) {
    if (map.sensor != camera) continue;
    lens.known = map.deviations()[1];
    lens.is_traded = map.number(ProjectionMap::kAxisFocal) != nullptr;
    lens.has_focal = !(map.focal_deviation() > ProjectionMap::kKnownFocal);
  }
}

/// Bounds corners that are far off.
void bound_outliers(Config& config, const std::vector<Sample>& samples) {
  for (StepConfig& step : config.steps) {
    for (BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      const bool is_of_pixels = entry != nullptr && entry->read_as == PointToPixel::kType;
      if (!is_of_pixels || block.loss.type != "none") continue;
      const double sigma = stated_sigma(block, step, samples).value_or(1.0);
      block.loss = {"huber", kFar / sigma};
    }
  }
}

/// Calibrates a lens and predicts what was held out.
void calibrate_lens(const Robot& robot, const ModelConfig& camera, TriedLens& lens) {
  Diagnostics diagnostics;
  bound_outliers(lens.config, lens.samples);
  start_cameras(lens.config, robot, lens.samples, diagnostics);
  choose_lenses(lens.config, lens.samples, diagnostics);
  choose_images(lens.config, robot, lens.samples, diagnostics);
  ModelConfig with_form = camera;
  with_form.lens = lens.form.name;
  for (Sample& sample : lens.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor == camera.name && seen.camera)
        drop_held(lens.config, with_form, *seen.camera);
    }
  }
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
  for (const BlockStatistics& block : result.blocks) {
    if (block.unit == "px") lens.fitted = std::max(lens.fitted, block.after.median);
  }
  set_known(last, values, camera.name, lens);
  if (!lens.has_focal || !std::isfinite(lens.known)) {
    lens.fault = lens.has_focal ? "samples do not determine its pixels"
                                : "samples do not determine its focal length";
    return;
  }
  try {
    lens.set(held_out_distances(*last.problem, last.free, values, lens.samples, camera.name));
  } catch (const std::domain_error&) {
    lens.fault = "samples without a fifth of them do not determine it";
  }
}

/// The samples of a camera of which a lens is begun once, for all of its forms: with all of its coefficients.
/// @param alone  without_others()
[[nodiscard]] std::vector<Sample> begun(const Config& alone, const Robot& robot,
                                        const ModelConfig& camera, std::string_view lens,
                                        std::vector<Sample> samples) {
  const auto whole = std::find_if(kLenses.rbegin(), kLenses.rend(),
                                  [&](const LensForm& form) { return form.name == lens; });
  Config config = with_lens(alone, camera, *whole);
  Diagnostics again;  // they come again where each form is tried
  start_cameras(config, robot, samples, again);
  return samples;
}

/// calibrate_lens(); a lens under which the samples make no sense is out.
void try_lens(const Robot& robot, const ModelConfig& camera, TriedLens& lens) {
  try {
    calibrate_lens(robot, camera, lens);
  } catch (const SettingsError&) {  // a coefficient that is not a number
    lens.fault = "does not fit";
  } catch (const std::domain_error&) {  // a corner that its camera does not see
    lens.fault = "does not fit";
  }
}

/// Tries each lens with all of its coefficients; then with fewer, unless it does not fit even with more.
/// @param alone  without_others()
/// @returns  in the order of kLenses
[[nodiscard]] std::vector<TriedLens> tried_lenses(const Config& alone, const Robot& robot,
                                                  const ModelConfig& camera,
                                                  const std::vector<Sample>& samples) {
  constexpr double kHopeless = 1.5;
  std::array<std::optional<TriedLens>, kLenses.size()> tried;
  std::map<std::string_view, std::vector<Sample>> begun_with;
  double least = HUGE_VAL;
  const auto attempt = [&](std::size_t i) {
    const LensForm& form = kLenses[i];
    if (!begun_with.contains(form.name)) {
      begun_with.emplace(form.name, begun(alone, robot, camera, form.name, samples));
    }
    tried[i] = TriedLens{form, with_lens(alone, camera, form), begun_with.at(form.name)};
    try_lens(robot, camera, *tried[i]);
    if (tried[i]->fault.empty()) least = std::min(least, tried[i]->error);
  };
  // The form with the next coefficients; the size if this one has all.
  const auto larger = [](std::size_t i) {
    const auto begin = kLenses.begin() + static_cast<std::ptrdiff_t>(i);
    const auto next = std::find_if(begin + 1, kLenses.end(),
                                   [&](const LensForm& form) { return form.name == begin->name; });
    return static_cast<std::size_t>(next - kLenses.begin());
  };
  for (std::size_t i = 0; i < kLenses.size(); ++i) {
    if (larger(i) == kLenses.size()) attempt(i);
  }
  for (std::size_t i = kLenses.size(); i-- > 0;) {
    const std::size_t next = larger(i);
    if (next == kLenses.size() || !tried[next]) continue;
    const bool is_hopeless = tried[next]->fitted > kHopeless * least;
    if (!is_hopeless) attempt(i);
  }
  std::vector<TriedLens> all;
  for (std::optional<TriedLens>& lens : tried) {
    if (lens) all.push_back(*std::move(lens));
  }
  return all;
}

/// The first lens that no other one beats; of those that are known, if there are any; nullptr if none fits.
[[nodiscard]] const TriedLens* best_of(const std::vector<TriedLens>& tried) {
  for (const bool known : {true, false}) {
    const auto fits = [&](const TriedLens& lens) {
      return lens.fault.empty() && lens.is_known() == known;
    };
    const auto first = std::find_if(tried.begin(), tried.end(), [&](const TriedLens& one) {
      return fits(one) && std::none_of(tried.begin(), tried.end(), [&](const TriedLens& other) {
               return fits(other) && other.beats(one);
             });
    });
    if (first != tried.end()) return &*first;
  }
  return nullptr;
}

}  // namespace
}  // namespace detail

void find_lenses(Config& config, const Robot& robot, std::vector<Sample>& samples,
                 Diagnostics& diagnostics) {
  const Config given = config;
  for (const ModelConfig& camera : detail::models_of(given)) {
    if (camera.lens != kAnyLens) continue;
    const Config alone = detail::without_others(given, robot, camera);
    const std::vector<detail::TriedLens> tried =
        detail::tried_lenses(alone, robot, camera, samples);
    const detail::TriedLens* best = detail::best_of(tried);
    if (best == nullptr) {
      detail::report_faults(camera, tried, diagnostics);
      continue;
    }
    diagnostics.note(
        camera.place,
        fmt::format("sensor '{}': lens by the error on views held out: {}: taken as {}",
                    camera.name, detail::errors_text(tried), best->form.text()));
    config = detail::with_lens(config, camera, best->form);
    detail::take_camera(camera.name, best->samples, samples);
  }
}

}  // namespace kinecal
