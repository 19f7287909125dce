// One identification: the problem with all parameters, and where the search stands.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/identify.hpp"
#include "kinecal/trust/parameter_search.hpp"
#include "kinecal/trust/plausible_change.ipp"
#include "kinecal/trust/pose_groups.hpp"
#include "kinecal/trust/search_columns.ipp"

namespace kinecal::detail {

/// One identification: the problem, and where the search stands.
class Identification {
 public:
  Identification(Calibration& calibration, std::span<const Sample> samples,
                 const std::vector<int>& base, const std::vector<IdentifyCandidate>& candidates)
      : calibration_(calibration),
        step_(calibration.steps.front()),
        all_(all_columns(*step_.problem, base, candidates)) {
    std::erase_if(step_.unknown_frames, [&](const UnknownFrame& frame) {  // a mount is a candidate
      return std::find_first_of(base.begin(), base.end(), frame.axes.begin(), frame.axes.end()) ==
             base.end();
    });
    unknown_ = step_.unknown_frames;
    constexpr int kFolds = 10;
    const PoseGroups poses = pose_groups(*step_.problem, samples);
    poses_.pose = poses.of_sample;
    poses_.fold = folds_of(samples, poses, std::min(kFolds, poses.count));
    poses_.region = pose_regions(*step_.problem, samples, poses);
    for (const int p : base) {
      if (all_.column(p) >= 0) base_.push_back(all_.column(p));
    }
    for (const IdentifyCandidate& candidate : candidates) {
      SearchCandidate& of = columns_.emplace_back();
      of.rank = candidate.rank;
      for (const int p : candidate.parameters) of.columns.push_back(all_.column(p));
      const auto untouched =  // no residual depends on them
          std::remove_if(of.columns.begin(), of.columns.end(), [](int c) { return c < 0; });
      const bool is_kept = candidate.in_part || untouched == of.columns.end();
      of.columns.erase(is_kept ? untouched : of.columns.begin(), of.columns.end());
    }
    whole_ = columns_;
    // Once: each solve begins where the last one ended.
    for (const auto& [parameter, value] : step_.assignments)
      calibration.table[parameter].value = value;
    step_.assignments.clear();
    calibration.begin = initial_ = numbers_of(calibration.table);
    largest_ = smallest_ = Eigen::VectorXd(all_.size());
    for (int c = 0; c < all_.size(); ++c) {
      const int p = index(c);
      largest_(c) = plausible_change(*step_.problem, p).care;
      const bool positive = is_never_negative(*step_.problem, p);
      smallest_(c) = positive ? -calibration.table[p].value : -largest_(c);
    }
    sigmas_.resize(static_cast<std::size_t>(step_.problem->num_terms()), 0.0);
  }

  [[nodiscard]] const std::vector<SearchCandidate>& candidates() const { return columns_; }
  [[nodiscard]] const std::vector<int>& base() const { return base_; }  ///< columns
  /// Columns of some candidates.
  [[nodiscard]] std::vector<int> columns(const std::vector<int>& chosen) const {
    std::vector<int> all;
    for (const int k : chosen) {
      const std::vector<int>& own = columns_[static_cast<std::size_t>(k)].columns;
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }
  /// The parameter of a column.
  [[nodiscard]] const Parameter& parameter(int column) const {
    return calibration_.table[index(column)];
  }

  /// Leaves out of candidates what the samples do not determine beside the base.
  /// @param linear      at the last solution
  /// @param candidates  those of the search: of what may be freed in part, the parameters that are left
  /// @returns           what the base absorbs, of these and of single parameters
  [[nodiscard]] std::vector<AbsorbedParameters> keep_determined(
      const ParameterSearch& linear, std::vector<IdentifyCandidate>& candidates) {
    const std::vector<int> base = linear.independent(base_);
    std::vector<AbsorbedParameters> all;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const std::vector<int>& own = whole_[k].columns;
      const bool in_part = candidates[k].in_part;
      if (!in_part && own.size() > 1) continue;
      const std::vector<int> kept = in_part ? linear.determined(base, own) : std::vector<int>{};
      AbsorbedParameters absorbed{static_cast<int>(k), {}, {}};
      std::set<std::string> by;
      for (const int c : own) {
        if (std::find(kept.begin(), kept.end(), c) != kept.end()) continue;
        const std::set<std::string> owners = absorbing(linear, base, kept, c);
        if (!owners.empty()) absorbed.parameters.push_back(index(c));
        by.insert(owners.begin(), owners.end());
      }
      absorbed.by.assign(by.begin(), by.end());
      if (!by.empty()) all.push_back(std::move(absorbed));
      if (!in_part) continue;
      columns_[k].columns = kept;
      candidates[k].parameters.clear();
      for (const int c : kept) candidates[k].parameters.push_back(index(c));
    }
    return all;
  }

  /// Noise of the first error block at the last solution, and its unit.
  [[nodiscard]] double noise() const { return sigmas_.front(); }
  [[nodiscard]] std::string noise_unit() const { return step_.problem->term(0).options.unit; }

  /// True if no chosen parameter has moved farther than robots are wrong.
  [[nodiscard]] bool is_plausible(const std::vector<int>& chosen) const {
    const std::vector<int> all = columns(chosen);
    return std::all_of(all.begin(), all.end(), [&](int c) {
      const auto p = static_cast<std::size_t>(index(c));
      const double change = values_[p] - initial_[p];
      return change <= largest_(c) && change >= smallest_(c);
    });
  }

  /// Begins with the initial values again, and searches for unknown poses.
  void begin_again() {
    calibration_.begin = initial_;
    step_.unknown_frames = unknown_;
  }
  /// Begins with the values of an earlier result.
  void begin_at(const ParameterTable& table) { calibration_.begin = numbers_of(table); }
  /// begin_again() with another initial value of a candidate's parameter.
  void begin_with(int column, double change) {
    initial_[static_cast<std::size_t>(index(column))] += change;
    begin_again();
  }

  /// Solves with some candidates, from the last solution, until the noise stays.
  CalibrationResult solve(const std::vector<int>& chosen) {
    std::vector<int> free;
    const auto add = [&](const std::vector<int>& columns) {
      for (const int c : columns) free.push_back(index(c));
    };
    add(base_);
    add(columns(chosen));
    CalibrationResult result;
    result.table = calibration_.table;
    for (int p = 0; p < result.table.size(); ++p) {
      double& now = calibration_.begin[static_cast<std::size_t>(p)];
      if (std::find(free.begin(), free.end(), p) == free.end()) {
        now = initial_[static_cast<std::size_t>(p)];
      }
      result.table[p].initial = result.table[p].value;
      result.table[p].value = now;
    }
    constexpr int kSolves = 5;
    for (int round = 0; round < kSolves; ++round) {
      if (free.empty()) {
        result.converged = true;
      } else {
        step_.free = FreeSet(free, calibration_.table.size());
        result = calibrate(calibration_);
        if (!result.converged) return result;
        calibration_.begin = numbers_of(result.table);
        step_.unknown_frames.clear();  // they are known from here on
      }
      values_ = calibration_.begin;
      if (!update_noise()) break;
    }
    return result;
  }

  /// Linearized at the solution; candidates begin with their initial values, so what they explain is in the residuals.
  [[nodiscard]] ParameterSearch linearized() const {
    const auto evaluator = step_.problem->evaluator(all_, 1);
    const int n = all_.size();
    const Coordinates plain{Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd(n, 0),
                            Eigen::VectorXd::Zero(n), Eigen::VectorXd::Ones(n)};
    LinearFit fit = linear_fit(*evaluator, values_, plain);
    Eigen::VectorXd back = Eigen::VectorXd::Zero(n);
    for (const SearchCandidate& candidate : columns_) {
      for (const int c : candidate.columns) {
        const auto p = static_cast<std::size_t>(index(c));
        back(c) = initial_[p] - values_[p];
      }
    }
    fit.residual += fit.jacobian * back;
    fit.prior_gradient += fit.prior_hessian * back;
    return {fit, poses_, largest_, smallest_};
  }

  /// A weighted residual of 1 as a distance of the error block; of several blocks 1, as errors are in units of noise.
  [[nodiscard]] double distance_of_one() const {
    const Term& only = step_.problem->term(0);
    return sigmas_.size() > 1 ? 1.0 : std::sqrt(only.feature_size) / only.weight;
  }
  /// The unit of such distances.
  [[nodiscard]] std::string unit() const { return sigmas_.size() > 1 ? "1" : noise_unit(); }

 private:
  [[nodiscard]] static std::vector<double> numbers_of(const ParameterTable& table) {
    const Eigen::VectorXd values = table.values();
    return {values.begin(), values.end()};
  }
  [[nodiscard]] int index(int column) const {
    return all_.parameters()[static_cast<std::size_t>(column)];
  }

  /// The owners of those base columns that explain a column beside others; empty: they do not.
  /// @param others  columns of the same candidate
  [[nodiscard]] std::set<std::string> absorbing(const ParameterSearch& linear,
                                                const std::vector<int>& base,
                                                const std::vector<int>& others, int column) const {
    const auto owner = [&](int c) -> const std::string& {
      return step_.problem->owners()[static_cast<std::size_t>(index(c))];
    };
    const auto is_explained = [&](const auto& is_used) {
      std::vector<int> by = others;
      std::copy_if(base.begin(), base.end(), std::back_inserter(by), is_used);
      return linear.explains(by, column);
    };
    const auto all = [](int) { return true; };
    const auto none = [](int) { return false; };
    if (!is_explained(all) || is_explained(none)) return {};
    std::set<std::string> owners, needed, enough;
    for (const int c : base) owners.insert(owner(c));
    for (const std::string& of : owners) {
      if (!is_explained([&](int c) { return owner(c) != of; })) needed.insert(of);
      if (is_explained([&](int c) { return owner(c) == of; })) enough.insert(of);
    }
    return !enough.empty() ? enough : !needed.empty() ? needed : owners;
  }

  /// Sets the noise of each error block to what the median residual shows.
  /// @returns  whether one has changed
  bool update_noise() {
    AnyProblem& problem = *step_.problem;
    std::vector<std::vector<double>> residuals(sigmas_.size());
    (void)evaluate(problem, values_, nullptr, [&](int t, int, const TermResiduals& of) {
      for (Eigen::Index i = 0; i < of.residual.size(); ++i) {
        if (of.residual(i) != 0.0)
          residuals[static_cast<std::size_t>(t)].push_back(std::abs(of.residual(i)));
      }
    });
    constexpr double kOfMedian = 1.4826, kSame = 0.05;
    bool changed = false;
    for (std::size_t t = 0; t < sigmas_.size(); ++t) {
      std::vector<double>& all = residuals[t];
      if (all.empty()) continue;
      const double sigma =
          std::max(kOfMedian * median_of(std::move(all)), std::numeric_limits<double>::min());
      if (std::abs(sigma - sigmas_[t]) <= kSame * sigma) continue;
      sigmas_[t] = sigma;
      step_.set_sigma(static_cast<int>(t), sigma);
      changed = true;
    }
    return changed;
  }

  Calibration& calibration_;
  CalibrationStep& step_;
  FreeSet all_;
  std::vector<UnknownFrame> unknown_;
  std::vector<SearchCandidate> whole_;    ///< with all parameters that residuals depend on
  std::vector<SearchCandidate> columns_;  ///< with those that are freed
  std::vector<int> base_;
  SearchPoses poses_;
  Eigen::VectorXd largest_, smallest_;  ///< plausible changes, by column
  std::vector<double> initial_, sigmas_, values_;
};

}  // namespace kinecal::detail
