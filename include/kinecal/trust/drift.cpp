// Decides what has moved.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/drift.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/trust/drift_search.ipp"

namespace kinecal {

namespace detail {
namespace {

/// True unless a joint would have slipped by more than 30 degrees or 10 cm.
[[nodiscard]] bool is_plausible(const AnyProblem& problem, const Mover& mover) {
  if (mover.is_frame || !problem.robot().has_joint(mover.owner)) return true;
  for (std::size_t i = 0; i < mover.parameters.size(); ++i) {
    const Parameter& parameter = problem.table()[mover.parameters[i]];
    const double limit = parameter.unit == "rad" ? 0.5236 : 0.1;
    if (parameter.name == mover.owner && std::abs(mover.change[i]) > limit) return false;
  }
  return true;
}

/// Fits one hypothesis.
void try_mover(const AnyProblem& problem, const DriftSearch& search, double level, Mover& mover) {
  const CleanFit found = search.clean_fit(mover.parameters);
  const Eigen::Index size = std::ssize(mover.parameters);
  const Eigen::VectorXd change = found.at.z.tail(size);
  const Eigen::VectorXd variance = found.at.inverse.diagonal().tail(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    mover.change.push_back(change(i));
    mover.deviation.push_back(std::sqrt(std::max(0.0, variance(i))));
  }
  mover.statistic = found.at.statistic;
  mover.freedom = found.freedom;
  mover.probability = found.probability;
  mover.score = found.score();
  mover.explains = found.probability >= level && is_plausible(problem, mover);
  mover.missed = found.missed;
}

}  // namespace
}  // namespace detail

CalibratedState calibrated_state(const Assessment& assessment, ParameterValues values) {
  CalibratedState state{{values.begin(), values.end()},
                        assessment.parameters,
                        assessment.uncertainty.covariance,
                        {},
                        assessment.noise,
                        assessment.common};
  const Observability& observability = assessment.observability;
  if (assessment.uncertainty.determined < std::ssize(assessment.parameters)) {
    state.undetermined = observability.unobservable;
  }
  return state;
}

Drift check_drift(const AnyProblem& problem, std::span<const Sample> samples,
                  const CalibratedState& state, const DriftOptions& options) {
  const detail::DriftSearch search(problem, samples, state, options.level);
  const detail::CleanFit still = search.clean_fit({});
  Drift drift{.statistic = still.at.statistic,
              .freedom = still.freedom,
              .noise_freedom = still.at.freedom,
              .probability = still.probability,
              .score = still.score(),
              .missed = still.missed,
              .movers = {},
              .visible = {}};
  drift.holds = drift.probability >= options.level;
  if (drift.holds) {
    drift.visible = search.smallest_changes(still);
    return drift;
  }
  for (Mover mover : search.movers()) {
    detail::try_mover(problem, search, options.level, mover);
    if (mover.freedom >= 1.0) drift.movers.push_back(mover);
  }
  std::stable_sort(drift.movers.begin(), drift.movers.end(), [](const Mover& a, const Mover& b) {
    return a.explains != b.explains ? a.explains : a.score < b.score;
  });
  if (drift.movers.empty()) return drift;
  constexpr double kTold = 6.0;  // likelihood ratio of 20
  const auto best = drift.movers.begin();
  drift.score = best->explains ? best->score : std::min(drift.score, best->score);
  for (const Mover& mover : drift.movers) {
    if (mover.explains == best->explains && mover.score < best->score + kTold) ++drift.alike;
  }
  std::stable_sort(
      drift.movers.begin(), drift.movers.begin() + drift.alike,
      [](const Mover& a, const Mover& b) { return a.parameters.size() < b.parameters.size(); });
  return drift;
}

}  // namespace kinecal
