// Definitions of judge_values.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge_values.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace kinecal::detail {

double change_of(const Parameter& p) {
  if (p.unit != "1") return p.value - p.initial;
  if (p.lower > 0.0 && p.initial > 0.0) return p.value / p.initial - 1.0;
  if (!(1.0 + p.initial > 0.0)) return p.value - p.initial;
  return (1.0 + p.value) / (1.0 + p.initial) - 1.0;
}

std::string turned_text(const Parameter& p) {
  constexpr double kQuarter = std::numbers::pi / 2.0, kNear = 5.0 * std::numbers::pi / 180.0;
  const double turns = (p.value - p.initial) / kQuarter;
  if (p.unit != "rad" || std::abs(turns) < 0.5) return "";
  if (std::abs(turns - std::round(turns)) * kQuarter > kNear) return "";
  return std::abs(turns) < 1.5 ? "  A quarter turn: is the motor screwed on so?"
                               : "  Half a turn: is the motor screwed on so?";
}

bool ran_off(const Parameter& p, double by, double size) {
  return p.unit == "rad" ? std::abs(by) > std::numbers::pi
                         : p.unit == "m" && size > 0.0 && std::abs(by) > size;
}

void judge_changes(const CalibrationStep& step, const CalibrationResult& result, double size,
                   Judgement& judgement) {
  const Parameter* worst = nullptr;
  double times = 0.0;
  int others = -1;
  Grade grade = Grade::good;
  for (const int p : step.free.parameters()) {
    const double by = std::abs(change_of(result.table[p]));
    const Limits limits = plausible_change(step, p);
    if (!limits.exceeded(by)) continue;
    ++others;
    grade = std::max(grade, limits.grade(by));
    if (worst != nullptr && !(by / limits.care > times)) continue;
    times = by / limits.care;
    worst = &result.table[p];
  }
  if (worst == nullptr) return;
  const double by = change_of(*worst);
  if (ran_off(*worst, by, size)) {
    judgement.add(Grade::do_not_use,
                  "these samples do not determine '" + worst->name + "' (it ran off, by " +
                      reading(by, worst->unit) + ")" +
                      (others > 0 ? " and " + std::to_string(others) + " more" : "") +
                      "; record more poses that differ, or free fewer parameters",
                  {Remedy::Kind::record});
    return;
  }
  judgement.add(
      grade,
      "'" + worst->name + "' changed by " +
          (worst->unit == "1" ? reading(1e2 * by, "1") + " %" : reading(by, worst->unit)) +
          (others > 0 ? ", and " + std::to_string(others) +
                            " more by more than is plausible; are the URDF or initial "
                            "values wrong, or do these samples not determine them?"
                      : "; is the URDF or its initial value wrong, or do these samples not "
                        "determine it?") +
          turned_text(*worst),
      {Remedy::Kind::hold});
}

void judge_given_places(const AnyProblem& problem, const ParameterTable& table, double size,
                        Judgement& judgement) {
  constexpr double kFar = 0.3, kOfDistance = 0.1;  // metres, for a robot of a metre
  for (const std::string& frame : problem.frames()) {
    if (problem.robot().has_joint(frame)) continue;
    Vector3<double> given = Vector3<double>::Zero(), found = Vector3<double>::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int p = table.find(parameter_name(frame, kFrameAxes[axis]));
      if (p < 0) continue;
      given(static_cast<Eigen::Index>(axis)) = table[p].initial;
      found(static_cast<Eigen::Index>(axis)) = table[p].value;
    }
    const double by = (found - given).norm();
    const double of_robot = kFar * (size > 0.0 ? std::min(1.0, size) : 1.0);
    if (given.isZero() || by < std::max(of_robot, kOfDistance * given.norm())) continue;
    judgement.add(Grade::use_with_care,
                  "'" + frame + "' ended " + reading(by, "m") +
                      " from where the configuration says it is; is that initial value wrong, or "
                      "has the frame absorbed another mistake, such as the sign of an axis?",
                  {Remedy::Kind::mend, "mend the initial value of '" + frame +
                                           "', or leave it out if nobody measured it"});
  }
}

void judge_signs(const CalibrationStep& step, const CalibrationResult& result,
                 const Assessment& assessment, Judgement& judgement) {
  constexpr double kSure = 3.0;  // standard deviations
  for (const int p : step.free.parameters()) {
    const Parameter& of = result.table[p];
    const std::optional<double> deviation = assessment.deviation(p);
    const bool is_below = of.value < 0.0 && deviation && of.value < -kSure * *deviation;
    if (!is_below || !is_never_negative(*step.problem, p)) continue;
    judgement.add(Grade::use_with_care,
                  "'" + of.name + "' is " + reading(of.value, of.unit) +
                      ", but a joint yields to its load and never against it: something else is "
                      "wrong and looks like that");
  }
}

void judge_values(const CalibrationStep& step, const CalibrationResult& result,
                  const Assessment& assessment, Judgement& judgement) {
  judge_changes(step, result, assessment.size, judgement);
  judge_signs(step, result, assessment, judgement);
  for (const int p : assessment.at_bound) {
    judgement.add(Grade::use_with_care, "'" + result.table[p].name + "' ended at its bound " +
                                            reading(result.table[p].value, result.table[p].unit));
  }
}

}  // namespace kinecal::detail
