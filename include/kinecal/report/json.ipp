// Writing the report as JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "kinecal/report/json.hpp"
#include "kinecal/report/json_state.ipp"

namespace kinecal {

namespace detail {

KINECAL_INLINE std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      json += c;
    }
  }
  return json + "\"";
}

KINECAL_INLINE std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

[[nodiscard]] inline std::string json(const Statistics& s) {
  return fmt::format(R"({{"rms": {}, "mean": {}, "median": {}, "max": {}}})", json_number(s.rms),
                     json_number(s.mean), json_number(s.median), json_number(s.max));
}

[[nodiscard]] inline std::string json(const StartSummary& starts) {
  if (!starts.searched()) return "null";
  std::string frames, minima;
  for (const std::string& frame : starts.frames) {
    frames += (frames.empty() ? "" : ", ") + json_string(frame);
  }
  for (const FoundMinimum& minimum : starts.minima) {
    minima += fmt::format(R"({}{{"cost": {}, "solves": {}}})", minima.empty() ? "" : ", ",
                          json_number(minimum.cost), minimum.solves);
  }
  return fmt::format(
      R"({{"frames": [{}], "starts": {}, "random_starts": {}, "failed": {}, "minima": [{}], )"
      R"("taken": {}}})",
      frames, starts.starts, starts.random_starts, starts.failed, minima,
      starts.taken < 0 ? "null" : std::to_string(starts.taken));
}

[[nodiscard]] inline std::string json(const StepResult& step) {
  return fmt::format(
      R"({{"name": {}, "iterations": {}, "initial_cost": {}, "final_cost": {}, "seconds": {}, )"
      R"("num_residuals": {}, "num_parameters": {}, "form": {}, "costs": {}, "starts": {}}})",
      json_string(step.name), step.iterations, json_number(step.initial_cost),
      json_number(step.final_cost), json_number(step.seconds), step.num_residuals,
      step.num_parameters, json_string(to_string(step.form)), json_row(step.costs, json_number),
      json(step.starts));
}

[[nodiscard]] inline std::string json(const BlockStatistics& block) {
  return fmt::format(
      R"({{"name": {}, "type": {}, "unit": {}, "count": {}, "before": {}, "after": {}}})",
      json_string(block.name), json_string(block.type), json_string(block.unit), block.count,
      json(block.before), json(block.after));
}

[[nodiscard]] inline std::string json(const Observability& observability,
                                      const ParameterTable& table) {
  const auto combination = [&](const Combination& of) { return json(of, table); };
  const auto name = [&](int parameter) { return json_string(table[parameter].name); };
  return fmt::format(R"({{"rank": {}, "condition": {}, "unobservable": {}, "hold": {}}})",
                     observability.rank, json_number(observability.condition),
                     json_row(observability.unobservable, combination),
                     json_row(observability.hold, name));
}

[[nodiscard]] inline std::string json(const BlockNoise& noise, const HeldOutError* error) {
  return fmt::format(
      R"({{"name": {}, "unit": {}, "sigma": {}, "robust_sigma": {}, "sigma_given": {}, )"
      R"("features": {}, "components": {}, "freedom": {}, "fitted": {}, "held_out": {}}})",
      json_string(noise.block), json_string(noise.unit), json_number(noise.sigma),
      json_number(noise.robust), noise.given > 0.0 ? json_number(noise.given) : "null",
      noise.features, noise.components, json_number(noise.freedom),
      error == nullptr ? "null" : json_number(error->fitted),
      error == nullptr ? "null" : json_number(error->held_out));
}

[[nodiscard]] inline std::string json(const LeftOutSample& sample) {
  return fmt::format(R"({{"sample": {}, "source": {}, "why": {}}})", sample.number,
                     json_string(sample.source), json_string(sample.why));
}

[[nodiscard]] inline std::string json(const PoseUncertainty& pose) {
  return fmt::format(
      R"({{"frame": {}, "link": {}, "in": {}, "in_link": {}, "position": {}, "rotation": {}, "worst_position": {}, )"
      R"("worst_rotation": {}, "determined": {}}})",
      json_string(pose.frame), json_string(pose.link), json_string(pose.in),
      json_string(pose.in_link), json_number(pose.position), json_number(pose.rotation),
      json_number(pose.worst_position), json_number(pose.worst_rotation), pose.determined);
}

[[nodiscard]] inline std::string json_parameter(const Findings& findings, int i) {
  const Parameter& parameter = findings.result.table[i];
  const auto deviation = findings.deviation(i);
  const bool known = deviation && std::isfinite(*deviation);
  return fmt::format(
      R"({{"name": {}, "value": {}, "initial": {}, "unit": {}, "sigma": {}, "significant": {}}})",
      json_string(parameter.name), json_number(parameter.value), json_number(parameter.initial),
      json_string(parameter.unit), known ? json_number(*deviation) : "null",
      known && note_on(parameter, *deviation).empty());
}

[[nodiscard]] inline std::string json_capture(const Findings& findings, const Assessment& step,
                                              const CaptureError& error) {
  const auto sample = static_cast<std::size_t>(error.sample);
  return json({findings.numbers[sample], findings.sources[sample],
               capture_text(error, step) + cause_text(findings, error.sample)});
}

}  // namespace detail

KINECAL_INLINE std::string json_report(const Findings& findings) {
  const auto write = [](const auto& item) { return detail::json(item); };
  const CalibrationResult& result = findings.result;
  const Assessment none, &last = findings.assessments.empty() ? none : findings.assessments.back();
  std::vector<CaptureError> bad;
  for (const CaptureError& error : last.captures) {
    if (error.bad) bad.push_back(error);
  }
  const auto noise = [&](const BlockNoise& of) {
    return detail::json(of,
                        detail::of_block(findings.assessments, &Assessment::held_out, of.block));
  };
  const auto observability = [&](const Assessment& step) {
    return detail::json(step.observability, result.table);
  };
  std::string images;
  for (const auto& [sensor, image] : findings.images) {
    images += (images.empty() ? "" : ", ") + detail::json_string(sensor) + ": " +
              detail::json_string(image);
  }
  return fmt::format(
      "{{\n  \"verdict\": {},\n  \"reasons\": {},\n  \"converged\": {},\n  \"termination\": {},\n"
      "  \"steps\": {},\n  \"error_blocks\": {},\n  \"noise\": {},\n  \"design_effect\": {},\n"
      "  \"parameters\": {},\n"
      "  \"pose\": {},\n  \"observability\": {},\n  \"bad_samples\": {},\n"
      "  \"left_out\": {},\n  \"images\": {{{}}},\n  \"covariance\": {},\n  \"poses\": {}\n}}\n",
      detail::json_string(to_string(findings.judgement.verdict)),
      detail::json_list(findings.judgement.reasons, detail::json_string), result.converged,
      detail::json_string(result.termination), detail::json_list(result.steps, write),
      detail::json_list(result.blocks, write), detail::json_list(last.noise, noise),
      detail::json_number(last.uncertainty.design_effect),
      detail::json_list(result.calibrated,
                        [&](int i) { return detail::json_parameter(findings, i); }),
      last.pose ? detail::json(*last.pose) : "null",
      detail::json_list(findings.assessments, observability),
      detail::json_list(
          bad,
          [&](const CaptureError& error) { return detail::json_capture(findings, last, error); }),
      detail::json_list(findings.left_out, write), images, detail::json_covariance(findings),
      detail::json(findings.poses));
}

}  // namespace kinecal
