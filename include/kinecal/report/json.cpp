// Writing the report as JSON.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/json.hpp"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/json_state.ipp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

namespace detail {
namespace {

// How well cameras are known, in the machine-readable report.

/// A number of each cell, row by row; null where the lens sees nothing or nothing is known.
template <class Number>
[[nodiscard]] Json json_cells(const ProjectionMap& map, const Number& number) {
  Json all = Json::array();
  for (const KnownPixel& cell : map.cells) all.push_back(number(cell));
  return all;
}

[[nodiscard]] Json json(const ProjectionMap& map, const AlikePixels& alike) {
  Json halves;
  if (map.halves) {
    halves = {{"difference", map.halves->difference},
              {"allowed", map.halves->allowed},
              {"chance", map.halves->chance}};
  }
  Json numbers = Json::object();
  for (const CameraNumber& number : map.numbers) {
    numbers[number.name] = {{"value", number.value},
                            {"sigma", number.deviation ? Json(*number.deviation) : Json()}};
  }
  return {{"sensor", map.sensor},
          {"numbers", numbers},
          {"low", map.low},
          {"high", map.high},
          {"columns", map.columns},
          {"rows", map.rows},
          {"distance", map.distance > 0.0 ? Json(map.distance) : Json()},
          {"features", json_cells(map, [](const KnownPixel& cell) { return cell.features; })},
          {"deviation", json_cells(map, [](const KnownPixel& cell) { return cell.deviation(); })},
          {"metres", json_cells(map, [](const KnownPixel& cell) { return cell.metres; })},
          {"difference", json_cells(map, [](const KnownPixel& cell) { return cell.difference; })},
          {"halves", halves},
          {"residuals",
           {{"all", alike.all},
            {"by_place", alike.alike},
            {"chance", alike.chance},
            {"region", alike.region},
            {"pixel", alike.pixel},
            {"there", alike.there}}}};
}

/// The cameras of an assessment.
[[nodiscard]] Json json_cameras(const Assessment& step) {
  Json all = Json::array();
  for (std::size_t i = 0; i < step.maps.size(); ++i)
    all.push_back(json(step.maps[i], step.alike[i]));
  return all;
}

}  // namespace

[[nodiscard]] inline Json json(const Statistics& s) {
  return {{"rms", s.rms}, {"mean", s.mean}, {"median", s.median}, {"max", s.max}};
}

[[nodiscard]] inline Json json(const FoundMinimum& minimum) {
  return {{"cost", minimum.cost}, {"solves", minimum.solves}};
}

[[nodiscard]] inline Json json(const StartSummary& starts) {
  if (!starts.searched()) return nullptr;
  const auto write = [](const FoundMinimum& minimum) { return json(minimum); };
  return {{"frames", starts.frames},
          {"given", starts.given},
          {"starts", starts.starts},
          {"random_starts", starts.random_starts},
          {"failed", starts.failed},
          {"minima", json_list(starts.minima, write)},
          {"taken", starts.taken < 0 ? Json() : Json(starts.taken)}};
}

[[nodiscard]] inline Json json(const StepResult& step) {
  return {{"name", step.name},
          {"iterations", step.iterations},
          {"initial_cost", step.initial_cost},
          {"final_cost", step.final_cost},
          {"seconds", step.seconds},
          {"num_residuals", step.num_residuals},
          {"num_parameters", step.num_parameters},
          {"form", to_string(step.form)},
          {"costs", step.costs},
          {"starts", json(step.starts)}};
}

[[nodiscard]] inline Json json(const BlockStatistics& block) {
  return {{"name", block.name},   {"type", block.type},           {"unit", block.unit},
          {"count", block.count}, {"before", json(block.before)}, {"after", json(block.after)}};
}

[[nodiscard]] inline Json json(const Observability& observability, const ParameterTable& table) {
  const auto combination = [&](const Combination& of) { return json(of, table); };
  const auto name = [&](int parameter) { return table[parameter].name; };
  return {{"rank", observability.rank},
          {"condition", observability.condition},
          {"unobservable", json_list(observability.unobservable, combination)},
          {"hold", json_list(observability.hold, name)}};
}

[[nodiscard]] inline Json json(const BlockNoise& noise, const HeldOutError* error) {
  return {
      {"name", noise.block},
      {"unit", noise.unit},
      {"sigma", noise.sigma},
      {"robust_sigma", noise.robust},
      {"sigma_given", noise.given > 0.0 ? Json(noise.given) : Json()},
      {"features", noise.features},
      {"components", noise.components},
      {"freedom", noise.freedom},
      {"own_sigma", noise.own > 0.0 ? Json(noise.own) : Json()},
      {"own_freedom", noise.own > 0.0 ? Json(noise.own_freedom) : Json()},
      {"repeats_sigma", noise.repeats > 0.0 ? Json(noise.repeats) : Json()},
      {"fitted", error == nullptr ? Json() : Json(error->fitted)},
      {"held_out", error == nullptr ? Json() : Json(error->held_out)},
      {"held_out_region", error == nullptr || error->region == 0.0 ? Json() : Json(error->region)}};
}

[[nodiscard]] inline Json json(const CommonNoise& common) {
  return {{"separable", common.separable}, {"repeats", common.repeats}, {"shifts", common.shifts},
          {"turns", common.turns},         {"freedom", common.freedom}, {"effect", common.effect}};
}

[[nodiscard]] inline Json json(const ReadBack& read_back) {
  const auto error = [](const BlockError& of) {
    return Json{{"name", of.block}, {"unit", of.unit}, {"rms", of.rms}};
  };
  const auto fit = [&](const ReaderFit& of) {
    return Json{{"reader", to_string(of.reader)},
                {"judged", of.reader == read_back.judged},
                {"error_blocks", json_list(of.errors, error)}};
  };
  return {{"readers", json_list(read_back.fits, fit)},
          {"lost", read_back.lost},
          {"geometry_only", json_list(read_back.geometry_only, error)}};
}

[[nodiscard]] inline Json json(const LeftOutSample& sample) {
  return {{"sample", sample.number}, {"source", sample.source}, {"why", sample.why}};
}

[[nodiscard]] inline Json json(const PoseUncertainty& pose) {
  return {{"frame", pose.frame},
          {"link", pose.link},
          {"in", pose.in},
          {"in_link", pose.in_link},
          {"position", pose.position},
          {"rotation", pose.rotation},
          {"worst_position", pose.worst_position},
          {"worst_rotation", pose.worst_rotation},
          {"position_elsewhere", pose.elsewhere > 0.0 ? Json(pose.elsewhere) : Json()},
          {"determined", pose.determined}};
}

[[nodiscard]] inline Json json_parameter(const Findings& findings, int i) {
  const Parameter& parameter = findings.result.table[i];
  const auto deviation = findings.deviation(i);
  const bool known = deviation && std::isfinite(*deviation);
  return {{"name", parameter.name},
          {"value", parameter.value},
          {"initial", parameter.initial},
          {"unit", parameter.unit},
          {"sigma", known ? Json(*deviation) : Json()},
          {"significant", known && note_on(parameter, *deviation).empty()}};
}

[[nodiscard]] inline Json json(const ReportedSearchStep& step, const std::string& unit) {
  return {{"freed", step.freed},
          {"chosen", step.is_chosen},
          {"parameters", step.parameters},
          {"unit", unit},
          {"fitted", step.fitted},
          {"held_out", step.held_out},
          {"held_out_error", std::isfinite(step.held_out) ? Json(step.deviation) : Json()},
          {"regions_held_out", step.region > 0.0 ? Json(step.region) : Json()},
          {"certainty", step.freed.empty() ? Json() : Json(step.certainty)},
          {"alike", step.alike},
          {"inseparable", step.inseparable}};
}

[[nodiscard]] inline Json json_captures(const Findings& findings, const Assessment& step) {
  Json bad = Json::array();
  for (const CaptureError& error : step.captures) {
    if (!error.bad) continue;
    const auto sample = static_cast<std::size_t>(error.sample);
    bad.push_back(
        json(LeftOutSample{findings.numbers[sample], findings.sources[sample],
                           capture_text(error, step) + cause_text(findings, error.sample)}));
  }
  return bad;
}

}  // namespace detail

std::string json_report(const Findings& findings, std::span<const OutputFile> files) {
  using detail::json_list;
  const auto write = [](const auto& item) { return detail::json(item); };
  const CalibrationResult& result = findings.result;
  const Assessment none, &last = findings.assessments.empty() ? none : findings.assessments.back();
  const auto noise = [&](const BlockNoise& of) {
    return detail::json(of,
                        detail::of_block(findings.assessments, &Assessment::held_out, of.block));
  };
  const auto observability = [&](const Assessment& step) {
    return detail::json(step.observability, result.table);
  };
  const auto parameter = [&](int i) { return detail::json_parameter(findings, i); };
  const auto searched = [&](const ReportedSearchStep& step) {
    return detail::json(step, findings.search.unit);
  };
  detail::Json images = detail::Json::object();
  for (const auto& [sensor, image] : findings.images) images[sensor] = image;
  detail::Json lenses = detail::Json::object();
  for (const auto& [sensor, lens] : findings.lenses) lenses[sensor] = lens;
  const auto file = [](const auto& of) {
    return detail::Json{{"role", of.first}, {"name", of.second}};
  };
  const auto checksum = [](const OutputFile& of) {
    return detail::Json{{"name", of.name}, {"sha256", sha256_text(of.content)}};
  };
  const detail::Json report = {
      {"format", kReportFormat},
      {"version", findings.call.version},
      {"robot", findings.robot},
      {"inputs", json_list(findings.call.files, file)},
      {"files", json_list(files, checksum)},
      {"verdict", to_string(findings.judgement.verdict)},
      {"reasons", findings.judgement.reasons},
      {"samples", findings.used_count()},
      {"drawn", findings.drawn},
      {"unused", findings.unused},
      {"would_help", findings.helps},
      {"how_fast", findings.speeds},
      {"read_back", detail::json(findings.read_back)},
      {"search", json_list(findings.search.steps, searched)},
      {"next", next_step(findings)},
      {"converged", result.converged},
      {"termination", result.termination},
      {"steps", json_list(result.steps, write)},
      {"error_blocks", json_list(result.blocks, write)},
      {"noise", json_list(last.noise, noise)},
      {"design_effect", last.uncertainty.design_effect},
      {"common_noise", detail::json(last.common)},
      {"parameters", json_list(result.calibrated, parameter)},
      {"pose", last.compared.empty() ? detail::Json() : detail::json(last.compared[0])},
      {"compared", json_list(last.compared, [](const auto& of) { return detail::json(of); })},
      {"between", json_list(last.between, [](const auto& of) { return detail::json(of); })},
      {"cameras", detail::json_cameras(last)},
      {"observability", json_list(findings.assessments, observability)},
      {"bad_samples", detail::json_captures(findings, last)},
      {"left_out", json_list(findings.left_out, write)},
      {"images", images},
      {"lenses", lenses},
      {"covariance", detail::json_covariance(findings)},
      {"poses", detail::json(findings.poses)}};
  return detail::json_lines(report);
}

}  // namespace kinecal
