// Which parameters samples support: a search over subsets, at one linearization.
//
// All candidates are columns of one linearized problem, so a fit with any subset of them, and its error on
// poses held out, is linear algebra.  Forward steps free what explains most, if the error on held-out poses falls;
// backward steps hold again what later ones have made superfluous.
// Source: Hastie, Tibshirani, Friedman, The Elements of Statistical Learning, 3.3 and 7.10.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal {

/// Parameters that are freed together.
struct SearchCandidate {
  std::vector<int> columns;  ///< of the linearization
  int rank =
      0;  ///< of candidates that explain the same, the lowest is taken: what an engineer names first
};

/// How well a subset predicts: weighted residuals, root of the mean square of a component.
struct SearchFit {
  double fitted = 0.0;     ///< of all poses
  double held_out = 0.0;   ///< of poses held out; infinite if a fold leaves something undetermined
  double region = 0.0;     ///< of regions held out; 0: too few poses
  double deviation = 0.0;  ///< standard error of held_out, by poses
  int columns = 0;         ///< free ones
};

/// A parameter that was found, in the order of what they explain.
struct SearchStep {
  int candidate = 0;   ///< by number
  SearchFit fit = {};  ///< with it and those before it
  double certainty =
      0.0;  ///< rise of the error on held-out poses without it alone, in its standard errors
  std::vector<int> alike = {};  ///< other candidates that would do as well in place of it
  std::vector<int> inseparable =
      {};  ///< those of them that add nothing beside it: no sample like these separates them
};

/// The samples of a search.
struct SearchPoses {
  std::vector<int> pose;    ///< of each sample: readings of one pose are held out together
  std::vector<int> fold;    ///< of each sample
  std::vector<int> region;  ///< of each sample; empty: none
};

/// A search at one linearization.
class ParameterSearch {
 public:
  using Candidates = std::vector<SearchCandidate>;  ///< all that may be freed

  /// @param fit      linearized by all columns, as plain parameters
  /// @param poses    of the samples of the problem
  /// @param largest   (columns) plausible change of each parameter
  /// @param smallest  (columns) the same downwards; empty: -largest
  ParameterSearch(const LinearFit& fit, const SearchPoses& poses, Eigen::VectorXd largest,
                  Eigen::VectorXd smallest = {});

  /// Columns without those that are combinations of others before them.
  [[nodiscard]] std::vector<int> independent(const std::vector<int>& columns) const;
  /// Those of some columns that the samples determine beside a base and each other, to a fraction of what is plausible.
  /// @param base  independent columns
  [[nodiscard]] std::vector<int> determined(const std::vector<int>& base,
                                            const std::vector<int>& columns) const;
  /// True if a column is a combination of others, or zero.
  /// @param columns  independent
  [[nodiscard]] bool explains(const std::vector<int>& columns, int column) const;

  /// How well a subset predicts.
  /// @param base    columns that are always free, independent
  /// @param chosen  candidates
  [[nodiscard]] SearchFit fit_of(const std::vector<int>& base, const Candidates& candidates,
                                 const std::vector<int>& chosen) const;

  /// Searches until no step helps, or until steps change so much that the problem should be linearized again.
  /// @param base    columns that are always free, independent
  /// @param chosen  candidates; in: to begin with
  void run(const std::vector<int>& base, const Candidates& candidates,
           std::vector<int>& chosen) const;

  /// What a candidate must show.
  struct Evidence {
    double chance = 0.0;  ///< largest that noise does as much, of all candidates together
    double sure = 0.0;    ///< least fall of the error on held-out poses, in its standard errors
  };
  /// Frees the candidate that explains most, of those that help.
  /// @returns  whether there is one
  bool free_one(const std::vector<int>& base, const Candidates& candidates,
                std::vector<int>& chosen, const Evidence& evidence) const;
  /// The candidate of the lowest rank among those that do as well in place of one of the chosen, or that one.
  [[nodiscard]] int simplest(const std::vector<int>& base, const Candidates& candidates,
                             const std::vector<int>& chosen, int k) const;

  /// What each of the chosen candidates buys.
  [[nodiscard]] std::vector<SearchStep> path(const std::vector<int>& base,
                                             const Candidates& candidates,
                                             const std::vector<int>& chosen) const;
  /// What the next candidates would buy after the chosen ones: those that explain most, if the samples determine them.
  /// @param most  steps
  [[nodiscard]] std::vector<SearchStep> beyond(const std::vector<int>& base,
                                               const Candidates& candidates,
                                               const std::vector<int>& chosen, int most) const;

 private:
  /// A fit of a subset to all rows.
  struct Whole {
    std::vector<int> columns;
    Eigen::MatrixXd inverse;    ///< of the information
    Eigen::VectorXd residual;   ///< (rows) left
    double squares = 0.0;       ///< of them
    Eigen::VectorXd change;     ///< (columns)
    Eigen::VectorXd deviation;  ///< (columns) standard deviations
    bool determined = false;    ///< all columns
  };
  /// What a candidate explains beside a subset.
  struct Gain {
    int candidate = 0;
    double squares = 0.0;  ///< fall of the sum of squares
    double chance = 1.0;   ///< that noise does so
  };

  [[nodiscard]] Whole whole_fit(const std::vector<int>& columns) const;
  /// @param whole  determined
  /// @param cross  whole.inverse * J_whole^T J_own
  [[nodiscard]] Gain gain_of(const Whole& whole, const SearchCandidate& candidate, int number,
                             const Eigen::MatrixXd& cross) const;
  [[nodiscard]] Gain gain_of(const Whole& whole, const SearchCandidate& candidate,
                             int number) const;
  [[nodiscard]] std::vector<Gain> gains(const Whole& whole, const Candidates& candidates,
                                        const std::vector<int>& chosen) const;
  /// Chance of the same if the residuals of a pose err together.
  [[nodiscard]] double chance_by_poses(const Whole& whole, const SearchCandidate& candidate) const;
  /// True if every change and deviation is plausible.
  /// @param from  first of the columns to look at
  [[nodiscard]] bool is_plausible(const Whole& whole, std::size_t from) const;
  /// Rows that are held out together, and their sums.
  struct Part {
    std::vector<int> pose;     ///< of each row
    Eigen::MatrixXd jacobian;  ///< (rows x columns) weighted
    Eigen::VectorXd residual;  ///< (rows) weighted
    Eigen::MatrixXd squared;   ///< J^T J
    Eigen::VectorXd gradient;  ///< J^T r
  };
  /// Sets folds and regions.
  void set_parts(const LinearFit& fit, const SearchPoses& poses);
  /// (poses) sum of squared weighted residuals, each pose predicted without its part; empty if undetermined.
  [[nodiscard]] Eigen::VectorXd predicted(const std::vector<int>& columns,
                                          const std::vector<Part>& parts) const;
  /// Fall of held-out errors in standard errors.
  [[nodiscard]] double certainty(const Eigen::VectorXd& before, const Eigen::VectorXd& after) const;
  /// Fall of the error on held-out poses by some columns, in its standard errors; the smaller one of poses and regions,
  /// where regions need not fall.
  [[nodiscard]] double certainty_of(const std::vector<int>& with,
                                    const std::vector<int>& without) const;
  /// True if noise does not explain what a candidate does, and the samples determine it.
  /// @param base  number of columns that are always free
  [[nodiscard]] bool helps(const Whole& whole, const Gain& gain, const Candidates& candidates,
                           std::size_t base, const Evidence& evidence) const;
  /// Holds what does not help beside the others.
  void hold_superfluous(const std::vector<int>& base, const Candidates& candidates,
                        std::vector<int>& chosen) const;
  /// All candidates of some ranks that are determined, beside the chosen ones, rank by rank.
  [[nodiscard]] std::vector<int> saturated(const std::vector<int>& base,
                                           const Candidates& candidates, std::vector<int> chosen,
                                           const std::vector<int>& ranks) const;
  /// Candidates that do as well in place of one.
  [[nodiscard]] std::vector<int> like(const Whole& without, const Candidates& candidates,
                                      const std::vector<int>& chosen, int k) const;

  static constexpr double kSure = 1.0;  // standard errors
  static constexpr double kHardly =
      0.3;  // deviation of what is hardly determined, of its plausible change

  Eigen::MatrixXd jacobian_;            ///< (rows x columns) weighted
  Eigen::VectorXd residual_;            ///< (rows) weighted
  Eigen::MatrixXd squared_;             ///< J^T J, priors included
  Eigen::VectorXd gradient_;            ///< J^T r, priors included
  Eigen::VectorXd scale_;               ///< (columns) lengths
  Eigen::VectorXd largest_, smallest_;  ///< (columns)
  std::vector<int> pose_;               ///< of each row
  std::vector<Part> folds_, regions_;
  double weight_ = 0.0;  ///< of all rows
  int poses_ = 0;
};

}  // namespace kinecal
