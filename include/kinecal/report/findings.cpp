// Writes the report as text.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/errors/magnetic_field.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/report/parameters_text.ipp"
#include "kinecal/report/text.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/image_region.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/noise/repeat_noise.hpp"

namespace kinecal {

namespace detail {
namespace {

// How good cameras are, in the text report.

/// The median over the cells with features of what a point at their distance is known to, metres.
[[nodiscard]] double known_metres(const ProjectionMap& map) {
  std::vector<double> metres;
  for (const KnownPixel& cell : map.cells) {
    if (cell.features > 0 && std::isfinite(cell.metres)) metres.push_back(cell.metres);
  }
  return metres.empty() ? 0.0 : median_of(std::move(metres));
}

/// The lens of a camera: the one whose coefficients are among its numbers; empty for rectified images.
[[nodiscard]] std::string_view lens_of(const ProjectionMap& map) {
  for (const std::string_view lens : lens_names()) {
    const auto sensor = any_built_in(lens_camera(lens, ImageKind::raw));
    const auto coefficients = sensor->parameters().subspan(kIntrinsics);
    std::size_t others = map.numbers.size();
    for (const ParameterInfo& info : sensor->parameters()) others -= map.number(info.name) ? 1 : 0;
    others -= map.number(ProjectionMap::kAxisFocal) != nullptr ? 1 : 0;
    const bool has_all =
        std::all_of(coefficients.begin(), coefficients.end(),
                    [&](const ParameterInfo& info) { return map.number(info.name) != nullptr; });
    if (has_all && others == 0) return lens;
  }
  return "";
}

}  // namespace
}  // namespace detail

std::string camera_numbers(const ProjectionMap& map) {
  std::string pixels, lens, at_axis;
  bool is_bent = false;
  for (const CameraNumber& number : map.numbers) {
    const bool is_at_axis = number.name == ProjectionMap::kAxisFocal;
    const bool is_pixels = is_at_axis || number.name[0] == 'f' || number.name[0] == 'c';
    is_bent = is_bent || (!is_pixels && number.value != 0.0);
    if (!is_pixels && !number.deviation) continue;
    std::string text = number.name;
    text += is_pixels ? fmt::format(" {:.2f}", number.value) : fmt::format(" {:.5g}", number.value);
    if (number.deviation) {
      const double known = *number.deviation;
      text += !std::isfinite(known) ? " not determined"
              : is_pixels           ? fmt::format(" +- {:.2f}", known)
                                    : fmt::format(" +- {:.2g}", known);
    }
    std::string& list = is_at_axis ? at_axis : is_pixels ? pixels : lens;
    list += (list.empty() ? "" : ", ") + text;
  }
  if (pixels.empty()) return "";
  std::string text = pixels + " px";
  if (const std::string_view name = detail::lens_of(map); !name.empty()) {
    text += fmt::format("; {}{}", name,
                        !lens.empty() ? " " + lens
                        : is_bent     ? ""
                                      : " without distortion");
  }
  return text + (at_axis.empty() ? "" : "; " + at_axis + " px");
}

namespace detail {
namespace {

/// "Camera 'eye': a pixel is known to 0.03 px where features are (0.05 mm at 0.8 m), 0.4 px at the worst place of its image".
[[nodiscard]] std::string camera_text(const ProjectionMap& map) {
  const auto [least, median, most] = map.deviations();
  std::string text =
      std::isfinite(median)
          ? fmt::format("Camera '{}': a pixel is known to {} where features are", map.sensor,
                        reading(median, "px"))
          : fmt::format("Camera '{}': its pixels are not determined, also where features are",
                        map.sensor);
  if (map.distance > 0.0 && std::isfinite(median)) {
    text += fmt::format(" ({} at {:.2g} m)", reading(known_metres(map), "m"), map.distance);
  }
  if (std::isfinite(most)) {
    text += fmt::format(", to {} at the worst place of its image", reading(most, "px"));
  }
  text += "\n";
  if (const std::string numbers = camera_numbers(map); !numbers.empty())
    text += "  " + numbers + "\n";
  if (map.halves) {
    text += fmt::format("  two halves of the samples differ by {}; the +- allow {}\n",
                        reading(map.halves->difference, "px"), reading(map.halves->allowed, "px"));
  }
  return text;
}

/// "residuals depend on the place in the image by 0.2 px, most at the upper left (+0.3, -0.1 px)"; empty if that is chance.
[[nodiscard]] std::string place_text(const AlikePixels& pixels) {
  constexpr double kChance = 0.01;
  if (!(pixels.alike > 0.0) || pixels.chance > kChance) return "";
  return fmt::format(
      "  of the residuals, {} depend on the place in the image, most at the {} ({:+.2f}, {:+.2f} "
      "px)\n",
      reading(pixels.alike, "px"), pixels.region, pixels.there[0], pixels.there[1]);
}

/// "no feature at the top of its image: hold the target there"; empty if features are everywhere.
[[nodiscard]] std::string empty_regions_text(const ProjectionMap& map) {
  std::array<bool, kImageRegions> empty;
  empty.fill(true);
  for (const KnownPixel& cell : map.cells) {
    if (cell.features > 0) empty[map.region_of(cell)] = false;
  }
  const std::string regions = image_regions_text(empty);
  return regions.empty() ? ""
                         : "  no feature at " + regions + " of its image: hold the target there\n";
}

[[nodiscard]] std::string cameras_text(const Findings& findings) {
  std::string text;
  if (findings.assessments.empty()) return text;
  const Assessment& last = findings.assessments.back();
  for (std::size_t i = 0; i < last.maps.size(); ++i) {
    text +=
        camera_text(last.maps[i]) + place_text(last.alike[i]) + empty_regions_text(last.maps[i]);
  }
  return text;
}

}  // namespace

/// Causes, and the gravest of the other reasons; all of them with raw figures.
[[nodiscard]] inline std::string verdict_text(const Findings& findings, Figures figures) {
  constexpr std::size_t kOthers = 4;
  const Judgement& judgement = findings.judgement;
  const std::size_t all = judgement.reasons.size();
  std::size_t shown = static_cast<std::size_t>(judgement.causes) + kOthers;
  if (figures == Figures::raw || all <= shown + 1) shown = all;
  std::string text = fmt::format("verdict: {}\n", to_string(judgement.verdict));
  for (std::size_t i = 0; i < shown; ++i) text += fmt::format("  - {}\n", judgement.reasons[i]);
  if (shown < all) text += fmt::format("  - and {} more, see --verbose\n", all - shown);
  if (!findings.helps.empty()) {
    text += fmt::format("would help: {}; kinecal identify searches for more\n",
                        fmt::join(findings.helps, ", "));
  }
  for (const std::string& speed : findings.speeds) text += "how fast: " + speed + "\n";
  return text;
}

/// Where readings of a pose repeat far better than the model fits.
[[nodiscard]] inline std::string lack_of_fit_note(const Assessment& step) {
  std::string note;
  for (const BlockNoise& noise : step.noise) {
    if (!lacks_fit(noise)) continue;
    note += fmt::format(
        "  Readings of a pose of '{}' repeat to {} and miss the model by {}: the model errs, not "
        "the\n  sensors; free what may be wrong, too\n",
        noise.block, reading(noise.repeats, noise.unit), reading(noise.sigma, noise.unit));
  }
  return note;
}

/// Priors that disagree with the samples, but are no reason of the verdict.
[[nodiscard]] inline std::string prior_note(const Assessment& step, const ParameterTable& table) {
  std::string note;
  for (const PriorPull& pull : step.pulls) {
    if (pull.contradicts()) continue;
    const Parameter& p = table[pull.parameter];
    note += fmt::format(
        "  Prior '{}' shifts '{}' by {}, {:.1f} times what it and the samples allow; +- include "
        "that "
        "they\n  disagree\n",
        pull.prior, p.name, reading(pull.shift, p.unit), pull.times);
  }
  return note;
}

[[nodiscard]] inline std::string fit_table(const Findings& findings) {
  TextTable table({"error block", "features", "unit", "before", "fitted", "held out", "worst",
                   "noise", "sigma given"});
  for (const BlockStatistics& block : findings.result.blocks) {
    const auto* noise = of_block(findings.assessments, &Assessment::noise, block.name);
    if (noise == nullptr) continue;  // a prior
    const auto* error = of_block(findings.assessments, &Assessment::held_out, block.name);
    const auto text = [&](double value) { return in_reading_unit(value, block.unit); };
    table.add({block.name, fmt::format("{}", block.count), reading_unit(block.unit),
               text(block.before.rms), text(block.after.rms),
               error == nullptr || error->features == 0 ? "-" : text(error->held_out),
               text(block.after.max), noise->freedom > 0.0 ? text(noise->sigma) : "-",
               noise->given > 0.0 ? text(noise->given) : "-"});
  }
  std::string note;
  if (!findings.assessments.empty()) {
    note = design_effect_note(findings.assessments.back());
  }
  for (const Assessment& step : findings.assessments) {
    if (&step != &findings.assessments.back()) continue;
    note += lack_of_fit_note(step) + prior_note(step, findings.result.table);
  }
  return "Fit: distances of features, root of the mean square; noise of a coordinate\n" +
         table.str() + note;
}

std::string cause_text(const Findings& findings, int sample) {
  const auto cause = findings.causes.find(sample);
  return cause == findings.causes.end() ? "" : "; likely cause: " + cause->second;
}

std::string note_on(const Parameter& parameter, double deviation) {
  if (!std::isfinite(deviation)) return "not determined";
  if (deviation > useful_deviation(parameter)) return "hardly determined";
  if (std::abs(parameter.value - parameter.initial) < 2.0 * deviation) return "not significant";
  return "";
}

bool has_before(const Findings& findings, const AnyProblem& problem, const Term& term) {
  const auto was_unknown = [&](const ChainJoint& joint) {
    return std::any_of(findings.result.steps.begin(), findings.result.steps.end(),
                       [&](const StepResult& step) {
                         const auto& frames = step.starts.frames;
                         return std::find(frames.begin(), frames.end(), joint.name) != frames.end();
                       });
  };
  for (const int s : term.sensors) {
    for (const SampledChain& chain : problem.sensors()[static_cast<std::size_t>(s)].chains()) {
      const auto& joints = chain.chain().joints;
      if (std::any_of(joints.begin(), joints.end(), was_unknown)) return false;
    }
  }
  return true;
}

[[nodiscard]] inline std::string correlations_text(const Findings& findings) {
  std::string text;
  if (findings.assessments.empty()) return text;
  const Assessment& step = findings.assessments.back();
  constexpr std::size_t kListed = 5;
  const std::vector<Correlation> pairs = high_correlations(step.uncertainty);
  for (std::size_t i = 0; i < std::min(kListed, pairs.size()); ++i) {
    const auto name = [&](int column) {
      return findings.result.table[step.parameters[static_cast<std::size_t>(column)]].name;
    };
    text += fmt::format("  {:+.3f}  {}, {}\n", pairs[i].coefficient, name(pairs[i].a),
                        name(pairs[i].b));
  }
  if (pairs.size() > kListed) text += fmt::format("  and {} more\n", pairs.size() - kListed);
  return text.empty() ? text : "Correlated above 0.9: hard to tell apart\n" + text;
}

[[nodiscard]] inline std::string captures_text(const Findings& findings) {
  std::string text;
  constexpr std::size_t kListed = 50;  // of a log there may be thousands
  for (const LeftOutSample& sample : findings.left_out) {
    if (&sample == findings.left_out.data() + kListed) {
      text += fmt::format("  and {} more left out, see report.json\n",
                          findings.left_out.size() - kListed);
      break;
    }
    text +=
        fmt::format("  {} (sample {}): {}; left out\n", sample.source, sample.number, sample.why);
  }
  if (findings.assessments.empty()) return text;
  const Assessment& step = findings.assessments.back();
  std::vector<CaptureError> worst = step.captures;
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto& a, const auto& b) { return a.times > b.times; });
  constexpr std::size_t kWorst = 3;
  for (std::size_t i = 0; i < worst.size() && (worst[i].bad || i < kWorst); ++i) {
    if (!(worst[i].times > 0.0)) break;
    const auto sample = static_cast<std::size_t>(worst[i].sample);
    text += fmt::format("  {} (sample {}): {}{}{}\n", findings.sources[sample],
                        findings.numbers[sample], capture_text(worst[i], step),
                        worst[i].bad ? "; does not fit the others" : "",
                        cause_text(findings, worst[i].sample));
  }
  return text.empty() ? text : "Worst samples\n" + text;
}

/// Parameters of joints and sensors that no step frees, and whose value is not zero.
[[nodiscard]] inline std::vector<int> held_values(const Robot& robot,
                                                  const Calibration& calibration,
                                                  const CalibrationResult& result) {
  std::vector<int> held;
  if (calibration.steps.empty()) return held;
  const AnyProblem& problem = *calibration.steps.back().problem;
  for (int p = 0; p < std::min(result.table.size(), problem.table().size()); ++p) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const bool is_virtual = problem.frames().contains(owner) && !robot.has_joint(owner);
    const bool is_free =
        std::find(result.calibrated.begin(), result.calibrated.end(), p) != result.calibrated.end();
    if (result.table[p].value != 0.0 && !is_virtual && !is_free) held.push_back(p);
  }
  return held;
}

/// " · by the URDF alone measured 0.283 mm", if that is more.
[[nodiscard]] inline std::string read_by(const ReadBack& read_back) {
  if (!read_back.is_worse) return "";
  return " · by the URDF alone " + errors_text(read_back.of(read_back.judged)->errors);
}

namespace {

/// See Findings::driver_file.
[[nodiscard]] std::string driver_file(const Calibration& calibration) {
  const auto are_all = [&](const auto& is_type) {
    return std::all_of(calibration.steps.begin(), calibration.steps.end(),
                       [&](const CalibrationStep& step) {
                         for (int t = 0; t < step.problem->num_terms(); ++t) {
                           const std::string& type = step.problem->term(t).options.type;
                           if (!is_type(type)) return false;
                         }
                         return true;
                       });
  };
  if (calibration.steps.empty()) return "calibrated.urdf";
  if (are_all(is_base_type)) return "base_calibration.yaml";
  if (are_all([](const std::string& type) { return type == MagneticField::kType; })) {
    return "magnetometer_calibration.yaml";
  }
  return "calibrated.urdf";
}

}  // namespace
}  // namespace detail

Findings findings_of(const Robot& robot, const Calibration& calibration, JudgedResult judged,
                     std::span<const Sample> samples) {
  Findings findings{std::move(judged)};
  findings.robot = robot.name();
  findings.held = detail::held_values(robot, calibration, findings.result);
  findings.poses = recorded_poses(calibration, samples);
  findings.driver_file = detail::driver_file(calibration);
  return findings;
}

std::string findings_text(const Findings& findings, Figures figures) {
  std::string text = detail::verdict_text(findings, figures);
  text += fmt::format("\nRobot '{}', {}", findings.robot,
                      counted(static_cast<std::size_t>(findings.used_count()), "sample"));
  if (!findings.left_out.empty()) text += fmt::format(", {} left out", findings.left_out.size());
  if (findings.drawn > 0) {
    text += fmt::format(
        "\nResult, +- and noise are of all samples; held-out errors, causes, patterns, changes and "
        "the\nsamples below are of {} drawn evenly from all files",
        findings.drawn);
  }
  const std::string cameras = detail::cameras_text(findings);
  std::vector<std::string> parts = {detail::fit_table(findings),
                                    detail::parameters_text(findings, figures),
                                    read_back_text(findings.read_back)};
  parts.insert(detail::are_cameras_alone(findings) ? parts.begin() + 1 : parts.end(), cameras);
  text += "\n";
  for (const std::string& part : parts) {
    if (!part.empty()) text += "\n" + part;
  }
  for (const Assessment& step : findings.assessments) {
    const std::string open =
        observability_text(step.step, step.observability, findings.result.table);
    if (!open.empty()) text += "\n" + open;
  }
  for (const std::string& part :
       {detail::correlations_text(findings), detail::captures_text(findings)}) {
    if (!part.empty()) text += "\n" + part;
  }
  return text + "\nNext: " + next_step(findings) + "\n";
}

std::string findings_line(const Findings& findings) {
  std::string text(to_string(findings.judgement.verdict));
  std::string fits;
  for (const BlockStatistics& block : findings.result.blocks) {
    const auto* noise = detail::of_block(findings.assessments, &Assessment::noise, block.name);
    if (noise == nullptr || noise->features == 0) continue;
    const auto* error = detail::of_block(findings.assessments, &Assessment::held_out, block.name);
    fits += (fits.empty() ? " · " : ", ") + block.name + " " + reading(block.after.rms, block.unit);
    if (error != nullptr && error->features > 0) {
      fits += " (held out " + reading(error->held_out, block.unit) + ")";
    }
  }
  text += fits + detail::read_by(findings.read_back);
  const std::size_t out = findings.left_out.size();
  if (out == 0) return text;
  return text + fmt::format(" · {} of {} samples left out", out,
                            findings.used_count() + static_cast<std::int64_t>(out));
}

}  // namespace kinecal
