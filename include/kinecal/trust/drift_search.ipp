// Tests hypotheses of what has moved, and leaves out bad captures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
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
    for (const Mover& mover : movers_) {
      std::vector<int> calibrated = mover.parameters;
      std::erase_if(calibrated, [&](int p) {
        return std::find(state_.parameters.begin(), state_.parameters.end(), p) ==
               state_.parameters.end();
      });
      if (!calibrated.empty()) tested_.push_back(std::move(calibrated));
    }
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
    if (now.probability < level_) return all;
    const bool slipped = moved.empty() && all.probability < level_ && slip_is_likelier(all, now);
    return slipped ? all : now;
  }
  /// The smallest changes that would have been found, smallest first: of the offset of each joint, and
  /// of each frame along the axis along which a shift shows least.
  [[nodiscard]] std::vector<SmallestChange> smallest_changes(const CleanFit& still) const {
    std::vector<SmallestChange> all;
    if (still.freedom < 1.0) return all;
    const Eigen::MatrixXd information = fit_.information(still.at);
    for (const Mover& mover : movers_) {
      std::vector<int> changed = mover.parameters;
      std::erase_if(changed, [&](int p) {
        const Parameter& parameter = problem_.table()[p];
        return mover.is_frame ? parameter.unit != "m" : parameter.name != mover.owner;
      });
      if (changed.empty()) continue;
      const std::vector<int> columns = fit_.columns(changed);
      const Eigenpairs axes = eigenpairs(Eigen::MatrixXd(information(columns, columns)));
      Eigen::VectorXd change = Eigen::VectorXd::Zero(information.cols());
      change(columns) = axes.vectors.col(0);
      all.push_back({mover.owner, mover.is_frame, problem_.table()[changed.front()].unit,
                     smallest_times(change, information, still)});
    }
    std::stable_sort(all.begin(), all.end(), [](const SmallestChange& a, const SmallestChange& b) {
      return a.size < b.size;
    });
    return all;
  }

 private:
  /// True if the slip of one joint explains all samples, and better than bad captures do.  A frame may
  /// explain a bad capture: it has six parameters.
  [[nodiscard]] bool slip_is_likelier(const CleanFit& all, const CleanFit& without) const {
    return std::any_of(movers_.begin(), movers_.end(), [&](const Mover& mover) {
      const DriftFall found = fit_.fall(mover.parameters, all.at);
      const double left = all.at.statistic - found.fall, freedom = all.freedom - 1.0;
      return found.rank == 1 && all.score() - found.fall + 2.0 < without.score() &&
             freedom >= 1.0 && f_tail(left / freedom, freedom, all.at.freedom) >= level_;
    });
  }
  /// How many times a change of the free parameters is found with 90 % power, by X or by a mover.
  /// @param information  see DriftFit
  [[nodiscard]] double smallest_times(const Eigen::VectorXd& change,
                                      const Eigen::MatrixXd& information,
                                      const CleanFit& still) const {
    constexpr double kPower = 0.9;
    const Eigen::VectorXd slope = information * change;
    const double all = change.dot(slope);
    if (!fit_.shows(all, change)) return std::numeric_limits<double>::infinity();
    const double b = still.at.freedom;
    double squares = noncentrality(still.freedom, b, 0.5 * level_, kPower) / all;
    for (const std::vector<int>& moved : tested_) {
      const std::vector<int> columns = fit_.columns(moved);
      const Spectrum spectrum(information(columns, columns));
      const auto rank = static_cast<double>(std::ssize(moved) - spectrum.null);
      const Eigen::VectorXd of = slope(columns);
      const double fall = std::min(all, of.dot(spectrum.pseudo_inverse() * of));
      if (!(rank >= 1.0 && fall > 0.0)) continue;
      const double level = 0.5 * level_ / static_cast<double>(tested_.size());
      squares =
          std::min(squares, state_.common.effect * noncentrality(rank, b, level, kPower) / fall);
    }
    return std::sqrt(squares);
  }
  [[nodiscard]] CleanFit fit_directions(const Eigen::MatrixXd& directions,
                                        const std::vector<bool>& used) const {
    CleanFit found{fit_.minimize(directions, used), {}};
    found.freedom = found.at.size - static_cast<double>(found.at.rank);
    if (found.freedom >= 1.0) {
      found.probability =
          f_tail(found.at.statistic / found.freedom, found.freedom, found.at.freedom);
    }
    return found;
  }
  /// Probability of the result if nothing has moved: half of the level is for X itself, half for
  /// the fall of X under the best hypothesis (Bonferroni).
  [[nodiscard]] double against_movers(const CleanFit& still) const {
    double least = 1.0;
    for (const std::vector<int>& moved : tested_) {
      const DriftFall found = fit_.fall(moved, still.at);
      if (found.rank < 1) continue;
      const auto rank = static_cast<double>(found.rank);
      const double fall = found.fall / state_.common.effect;
      least = std::min(least, f_tail(fall / rank, rank, still.at.freedom));
    }
    if (tested_.empty()) return still.probability;
    const auto hypotheses = static_cast<double>(tested_.size());
    return std::min(1.0, 2.0 * std::min(still.probability, hypotheses * least));
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
      const double p = f_tail(mean, static_cast<double>(size), now.at.freedom);
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
  /// Calibrated parameters of movers.  A held one may have been off when the others were calibrated, so
  /// that X falls although nothing has moved: it is left to X itself.
  std::vector<std::vector<int>> tested_;
  double level_;
};

}  // namespace kinecal::detail
