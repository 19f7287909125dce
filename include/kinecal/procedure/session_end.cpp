// Definitions of session_end.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/session_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

#include "kinecal/study/sample_design.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/measured_numbers.hpp"
#include "kinecal/trust/uncertainty/pose_elsewhere.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Samples without errors: those of a session, then those of its remaining poses, with the features
/// of the last sample.  Poses in which these cannot be seen are missing.
[[nodiscard]] std::vector<Sample> with_samples_ahead(const SessionResult& result,
                                                     std::span<const Sample> ahead) {
  const MakeProblem make = [&] { return result.problem.without_samples(); };
  std::vector<Sample> all = exact_samples(make, result.values, result.samples);
  for (const Sample& pose : ahead) {
    Sample there = result.samples.back();
    there.joint_names = pose.joint_names;
    there.joint_positions = pose.joint_positions;
    try {
      all.push_back(exact_samples(make, result.values, std::span(&there, 1)).front());
    } catch (const std::exception&) {
      continue;  // behind the camera, say
    }
  }
  return all;
}

/// Table indices of the parameters that are not determined to useful_deviation(), but would be with
/// samples of the remaining poses.  Others stay open in any case: no reason to go on.
[[nodiscard]] std::vector<int> open_parameters(const SessionResult& result,
                                               std::span<const Sample> ahead) {
  const Assessment& step = result.step;
  for (int t = 0; t < result.problem.num_terms(); ++t) {
    if (result.problem.term(t).is_of_surface()) return {};  // what poses would show is not known
  }
  const auto useful = [&](std::size_t c) {
    return useful_deviation(result.problem.table()[step.parameters[c]]);
  };
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < step.parameters.size(); ++c) {
    const double now = step.uncertainty.deviation(static_cast<Eigen::Index>(c));
    if (!(now <= useful(c))) open.push_back(c);
  }
  if (open.empty() || ahead.empty() || result.samples.empty()) return {};
  try {
    const std::vector<Sample> all = with_samples_ahead(result, ahead);
    const FreeSet free(step.parameters, result.problem.table().size());
    const StudyDesign design = study_design([&] { return result.problem.without_samples(); }, free,
                                            result.values, all, {});
    std::vector<int> chosen(result.samples.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    const ExpectedUncertainty before = expected_uncertainty(design, chosen);
    chosen.resize(all.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    const ExpectedUncertainty after = expected_uncertainty(design, chosen);
    std::vector<int> parameters;
    for (const std::size_t c : open) {
      const auto row = static_cast<Eigen::Index>(c);
      const double now = step.uncertainty.deviation(row), least = before.deviation(row);
      // Noise of this session, not of the study: only the ratio counts.
      const double ratio =
          least > 0.0 && std::isfinite(least) && std::isfinite(now) ? now / least : 1.0;
      if (after.deviation(row) * ratio <= useful(c)) parameters.push_back(step.parameters[c]);
    }
    return parameters;
  } catch (const std::exception&) {
    return {};  // a block that cannot be simulated
  }
}

/// Factor by which held-out samples are further off than their noise and than fitted ones: few
/// samples fit better than they predict.  The design effect is in the uncertainty already and is
/// not counted twice.  At least 1.
[[nodiscard]] double times_held_out(const Assessment& step) {
  double most = 0.0;
  for (std::size_t t = 0; t < step.held_out.size(); ++t) {
    const HeldOutError& error = step.held_out[t];
    const double noise = step.noise[t].sigma * std::sqrt(step.noise[t].components);
    const double expected = std::max(noise, error.fitted);
    if (expected > 0.0) most = std::max(most, error.held_out / expected);
  }
  return std::max(1.0, most / std::sqrt(std::max(1.0, step.uncertainty.design_effect)));
}

/// Why a pose is not accurate enough; empty if it is.
/// @param times  factor of its uncertainty
/// @param where  "at the poses that are left"
[[nodiscard]] std::string not_known(const Accuracy& wanted, PoseUncertainty pose, double times,
                                    const std::string& where) {
  pose.position *= times;
  pose.rotation *= times;
  OnlineState state;
  state.known = pose.determined;
  state.position = pose.position;
  state.rotation = pose.rotation;
  if (wanted.reached(state)) return {};
  const std::string what = fmt::format("'{}' in '{}'", pose.frame, pose.in);
  if (!pose.determined) return fmt::format("{} is not determined {}", what, where);
  return fmt::format("{} is known to {} {}", what,
                     wanted.position ? reading(pose.position, "m") : reading(pose.rotation, "rad"),
                     where);
}

/// Why a result is not usable; empty if it is.
[[nodiscard]] std::string not_usable(const Judgement& judgement) {
  if (judgement.verdict != Grade::do_not_use) return {};
  return "the verdict is 'do not use': " + judgement.reasons.front();
}

/// A reason of the verdict that more poses cure; empty if absent.
[[nodiscard]] std::string cured_by_poses(const Judgement& judgement) {
  for (std::size_t i = 0; i < judgement.reasons.size(); ++i) {
    if (judgement.remedies[i].kind != Remedy::Kind::record) continue;
    return fmt::format("the verdict is '{}': {}", to_string(judgement.verdict),
                       judgement.reasons[i]);
  }
  return {};
}

/// Why samples are too few; empty if they are not.
[[nodiscard]] std::string too_few(const SessionResult& result) {
  constexpr double kToSpare = 0.5;  // of the parameters: what shows the errors of joints
  const auto free = static_cast<int>(result.step.parameters.size());
  const auto needed = static_cast<int>(std::ceil((1.0 + kToSpare) * free));
  const int numbers = measured_numbers(result.problem, result.values);
  if (numbers >= needed) return {};
  return fmt::format(
      "{} free parameters need {} measured numbers; these samples have {}, at most 6 "
      "for each pose and error block",
      free, needed, numbers);
}

/// Why a pose is not known as well as it should be; empty if it is.
/// @param pose  of an error block
[[nodiscard]] std::string pose_not_known(const Accuracy& wanted, const SessionResult& result,
                                         const PoseUncertainty& pose,
                                         std::span<const Sample> ahead) {
  const auto on_robot = [](const std::string& name, const std::string& link) {
    return FrameOnRobot{link, name == link ? "" : name};
  };
  const FrameOnRobot in = on_robot(pose.in, pose.in_link);
  const FrameOnRobot frame =
      wanted.frame.empty() ? on_robot(pose.frame, pose.link) : FrameOnRobot{wanted.frame};
  const auto known_at = [&](std::span<const Sample> poses) {
    return pose_at(result.problem, result.step, result.values, poses, frame, in);
  };
  const double times = times_held_out(result.step);
  std::string why = not_known(wanted, known_at(result.samples), times, "at the captured poses");
  if (why.empty()) {  // only then: held-out samples are included
    why = not_known(
        wanted,
        pose_held_out(result.problem, result.step, result.values, result.samples, frame, in), 1.0,
        "at each pose by the samples of the others");
  }
  if (why.empty() && !ahead.empty()) {
    why = not_known(wanted, known_at(ahead), times, "at the poses that are left");
  }
  return why;
}

/// Which parameters the remaining poses would determine; empty if none.  Without such poses, a
/// person moves the robot: which are hardly determined.
[[nodiscard]] std::string still_open(const SessionResult& result, std::span<const Sample> ahead) {
  const std::vector<int> open =
      ahead.empty() ? result.step.weak.parameters : open_parameters(result, ahead);
  if (open.empty()) return {};
  const Parameter& first = result.problem.table()[open.front()];
  const double now = result.step.deviation(open.front()).value_or(0.0);
  return fmt::format("'{}' {}{}{}", first.name,
                     std::isfinite(now) ? "is known to +- " + reading(now, first.unit) + " only"
                                        : "is not determined",
                     open.size() > 1 ? fmt::format(", and {} more like it", open.size() - 1) : "",
                     ahead.empty() ? "; move the joints that differ least so far"
                                   : "; the poses that are left determine more");
}

}  // namespace
}  // namespace detail

std::string why_go_on(const Accuracy& wanted, const SessionResult& result,
                      std::span<const Sample> ahead) {
  const Assessment& step = result.step;
  if (std::string few = detail::too_few(result); !few.empty()) return few;
  if (std::string why = detail::not_usable(result.judgement); !why.empty()) return why;
  if (step.compared.empty()) return "no error block compares two frames";
  std::string why;
  for (const PoseUncertainty& pose : step.compared) {
    if (why.empty()) why = detail::pose_not_known(wanted, result, pose, ahead);
  }
  return why.empty() ? detail::still_open(result, ahead) : why;
}

std::string why_go_on(const Accuracy& wanted, const SessionFollower& session,
                      std::span<const Sample> ahead) {
  return detail::as_input_error([&]() -> std::string {
    const CalibrationOptions& options = session.options();
    CalibratedRobot all = detail::solve_and_judge(prepare(session.setup(), options), options);
    if (all.assessments.empty()) return all.result.termination;
    const Eigen::VectorXd values = all.result.table.values();
    std::string why = why_go_on(wanted,
                                {*all.setup.calibration.steps.back().problem,
                                 {values.data(), static_cast<std::size_t>(values.size())},
                                 all.assessments.back(),
                                 all.judgement,
                                 all.samples},
                                ahead);
    if (!why.empty()) return why;
    detail::explain(all, options);
    why = detail::not_usable(all.judgement);
    return why.empty() ? detail::cured_by_poses(all.judgement) : why;
  });
}

}  // namespace kinecal
