// Parameters that the remaining poses of a session would still determine: for session_end.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <exception>
#include <numeric>
#include <span>
#include <vector>

#include "kinecal/procedure/session_end.hpp"
#include "kinecal/study/sample_design.hpp"
#include "kinecal/trust/weak_parameters.hpp"

namespace kinecal::detail {

/// Samples without errors: those of a session, then those of its remaining poses, with the features
/// of the last sample.  Poses in which these cannot be seen are missing.
[[nodiscard]] inline std::vector<Sample> with_samples_ahead(const SessionResult& result,
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
[[nodiscard]] inline std::vector<int> open_parameters(const SessionResult& result,
                                                      std::span<const Sample> ahead) {
  const Assessment& step = result.step;
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

}  // namespace kinecal::detail
