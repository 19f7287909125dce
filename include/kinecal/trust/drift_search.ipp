// Tests hypotheses of what has moved, and leaves out bad captures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/trust/drift_fit.ipp"
#include "kinecal/trust/f_distribution.hpp"

namespace kinecal::detail {

/// A minimum of X, without the samples that make it too large for chance.
struct CleanFit {
  DriftMinimum at;
  std::vector<MissedSample> missed;
  double freedom = 0.0;      ///< of X
  double probability = 0.0;  ///< of a larger X by chance

  /// X + 2 rank; a sample left out counts with the X of one sample in a thousand.
  [[nodiscard]] double score() const {
    constexpr double kMissed = 14.0;
    double sum = at.statistic + 2.0 * static_cast<double>(at.rank);
    for (const MissedSample& sample : missed) sum += kMissed + sample.rows;
    return sum;
  }
};

/// Possible movers: a joint's offset, a frame, or a sensor, each with its parameters.
[[nodiscard]] inline std::vector<Mover> hypotheses(const AnyProblem& problem) {
  std::map<std::pair<std::string, bool>, std::vector<int>> groups;
  for (const int p : problem.touched_parameters()) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    const std::string& name = problem.table()[p].name;
    const bool is_frame = problem.frames().contains(owner) && is_frame_parameter(name, owner);
    if (!owner.empty()) groups[{owner, is_frame}].push_back(p);
  }
  std::vector<Mover> all;
  for (const auto& [key, parameters] : groups) {
    all.push_back({.owner = key.first, .is_frame = key.second, .parameters = parameters});
  }
  return all;
}

/// Tests possible movers.
class DriftSearch {
 public:
  DriftSearch(const AnyProblem& problem, std::span<const Sample> samples,
              const CalibratedState& state, double level)
      : problem_(problem),
        state_(state),
        fit_(problem, samples, state),
        movers_(hypotheses(problem)),
        level_(level) {
    for (Mover& mover : movers_) {
      std::erase_if(mover.parameters, [&](int p) { return !fit_.matters(p); });
    }
    std::erase_if(movers_, [](const Mover& mover) { return mover.parameters.empty(); });
    std::stable_sort(movers_.begin(), movers_.end(), [](const Mover& a, const Mover& b) {
      return a.parameters.size() < b.parameters.size();
    });
    std::vector<Mover> distinct;
    for (Mover& mover : movers_) {
      const auto known = std::find_if(distinct.begin(), distinct.end(), [&](const Mover& other) {
        return fit_.same_effect(other.parameters, mover.parameters);
      });
      if (known == distinct.end()) {
        distinct.push_back(std::move(mover));
      } else {
        known->same.push_back(mover.owner);
      }
    }
    movers_ = std::move(distinct);
  }

  [[nodiscard]] const std::vector<Mover>& movers() const { return movers_; }

  /// The minimum if these parameters have moved; with none, also tests against each mover.
  [[nodiscard]] CleanFit clean_fit(const std::vector<int>& moved) const {
    const Eigen::MatrixXd directions = fit_.directions(moved);
    std::vector<bool> used(static_cast<std::size_t>(problem_.num_samples()), true);
    const auto fit = [&] {
      CleanFit found = fit_directions(directions, used);
      if (moved.empty()) found.probability = against_movers(found);
      return found;
    };
    CleanFit all = fit();
    CleanFit now = all;
    constexpr int kShare = 5;  // one sample in five
    for (int n = 0; n < problem_.num_samples() / kShare; ++n) {
      if (!moved.empty() && now.probability >= level_) break;  // bad captures are named anyway
      const auto worst = worst_sample(now, directions, used);
      if (!worst) break;
      used[static_cast<std::size_t>(worst->sample)] = false;
      std::vector<MissedSample> missed = now.missed;
      missed.push_back(*worst);
      now = fit();
      now.missed = std::move(missed);
    }
    return now.probability < level_ ? all : now;
  }

 private:
  [[nodiscard]] CleanFit fit_directions(const Eigen::MatrixXd& directions,
                                        const std::vector<bool>& used) const {
    CleanFit found{fit_.minimize(directions, used), {}};
    found.freedom = found.at.size - static_cast<double>(found.at.rank);
    if (found.freedom >= 1.0)
      found.probability = chance(found.at.statistic, found.freedom, found.at);
    return found;
  }
  /// Probability of the result if nothing has moved: half of the level is for X itself, half for
  /// the fall of X under the best hypothesis (Bonferroni).  A held parameter may have been off when the
  /// others were calibrated, so that X falls although nothing has moved: it is left to X itself.
  [[nodiscard]] double against_movers(const CleanFit& still) const {
    double least = 1.0, hypotheses = 0.0;
    for (const Mover& mover : movers_) {
      std::vector<int> calibrated = mover.parameters;
      std::erase_if(calibrated, [&](int p) {
        return std::find(state_.parameters.begin(), state_.parameters.end(), p) ==
               state_.parameters.end();
      });
      if (calibrated.empty()) continue;
      hypotheses += 1.0;
      const DriftFall moved = fit_.fall(calibrated, still.at);
      if (moved.rank < 1) continue;
      const auto rank = static_cast<double>(moved.rank);
      const double fall = moved.fall / state_.common.effect;
      least = std::min(least, f_tail(fall / rank, rank, still.at.freedom / state_.common.scatter));
    }
    if (hypotheses == 0.0) return still.probability;
    return std::min(1.0, 2.0 * std::min(still.probability, hypotheses * least));
  }
  /// Probability that some rows' sum of squares is larger by chance.
  [[nodiscard]] double chance(double squares, double size, const DriftMinimum& at) const {
    return f_tail(squares / size, size / state_.common.scatter, at.freedom / state_.common.scatter);
  }
  /// The sample whose removal lowers X most, if it is further off than chance at the level.
  [[nodiscard]] std::optional<MissedSample> worst_sample(const CleanFit& now,
                                                         const Eigen::MatrixXd& directions,
                                                         const std::vector<bool>& used) const {
    const LinearFit& rows = now.at.rows;
    std::optional<MissedSample> worst;
    double least = level_ / problem_.num_samples();
    for (std::size_t b = 0; b < rows.blocks.size();) {
      std::size_t end = b;
      Eigen::Index size = 0;
      const int sample = rows.blocks[b].sample;
      for (; end < rows.blocks.size() && rows.blocks[end].sample == sample; ++end) {
        size += rows.blocks[end].size;
      }
      const Eigen::Index first = rows.blocks[b].first;
      b = end;
      if (!used[static_cast<std::size_t>(sample)]) continue;
      const Eigen::MatrixXd j = rows.jacobian.middleRows(first, size) * directions;
      const Eigen::VectorXd r = rows.residual.segment(first, size);
      const Eigen::MatrixXd variance =
          Eigen::MatrixXd::Identity(size, size) - j * now.at.inverse * j.transpose();
      const double off = r.dot(Ldlt(variance).solve(r));
      const double mean = off / static_cast<double>(size);
      const double p = chance(off, static_cast<double>(size), now.at);
      if (!(p < least || (worst && p == least && std::sqrt(mean) > worst->times))) {
        continue;
      }
      least = p;
      worst = MissedSample{sample, static_cast<int>(size), std::sqrt(mean)};
    }
    return worst;
  }

  const AnyProblem& problem_;
  const CalibratedState& state_;
  DriftFit fit_;
  std::vector<Mover> movers_;
  double level_;
};

}  // namespace kinecal::detail
