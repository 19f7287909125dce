// Evaluates a problem whose samples have poses of their own: a board that a person holds, seen by cameras.
//
// The pose of such a frame in a sample is an unknown of that sample only.  It is eliminated here: for given
// values of the other parameters, each sample's poses are fitted, and what remains is a problem in the others
// alone, of the same kind as any other.  With the rows of a sample, J by the others and L by its poses,
//
//   r(others) = r at the best poses      J' = J - L (L^T W L)^+ L^T W J
//
// W holds the weights.  So gradient, Gauss-Newton Hessian (the Schur complement), covariance (that of
// the others beside unknown poses) and the effect of leaving a sample out follow without a special case, the solver's
// problem has a constant size, and the time is linear in the samples.
//
// A pose is fitted by Levenberg-Marquardt steps, from where it was in the best evaluation so far, or from where
// (L^T W L)^+ L^T W J of the last one says that it goes.  Directions that the
// features of a sample do not determine stay as they are.
// Source: Golub and Pereyra, Separable nonlinear least squares: the variable projection method and its
// applications, 2003; Kaufman, A variable projection method for solving separable nonlinear least squares problems,
// 1975.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "kinecal/evaluation/evaluator.hpp"

namespace kinecal {

namespace detail {

/// Where the numbers of a pose stand in a layout: of each chain that leads over it.
struct PosePlace {
  std::size_t frame = 0;  ///< index in AnyProblem::sample_poses()
  /// Offsets of its six coordinates in a row.
  std::array<std::size_t, 6> offsets{};
};

/// The normal equations of a sample by its own poses.
struct SamplePoseSums {
  Eigen::MatrixXd hessian;   ///< (poses x poses) L^T W L
  Eigen::VectorXd gradient;  ///< (poses) L^T W r
  double cost = 0.0;         ///< of its error blocks, losses included
  Eigen::Index rows = 0;     ///< number of residuals

  /// All zero.
  explicit SamplePoseSums(int poses)
      : hessian(Eigen::MatrixXd::Zero(poses, poses)), gradient(Eigen::VectorXd::Zero(poses)) {}
  /// The step to the minimum, shortened by the damping of Levenberg and Marquardt.
  /// @returns  (poses)
  [[nodiscard]] Eigen::VectorXd step(double damping) const;
  /// The decrease of the cost that a step promises.
  [[nodiscard]] double decrease(const Eigen::VectorXd& change) const;
};

}  // namespace detail

/// Evaluates a problem whose samples have poses of their own, in S.
template <class S>
class SamplePosesEvaluator final : public AnyEvaluator {
 public:
  /// @param problem  must outlive the evaluator; do not add samples meanwhile
  /// @param free     the columns of the Jacobian, none of them of such a pose
  /// @throws std::invalid_argument  if a free parameter does not belong to the problem
  SamplePosesEvaluator(const BasicProblem<S>& problem, const FreeSet& free);

  [[nodiscard]] const BasicProblem<S>& problem() const override { return problem_; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }
  std::optional<UndefinedResidual> evaluate(ParameterValues values, bool derivatives,
                                            const RowVisitor& visit,
                                            Linearization at = Linearization::measured) override;
  [[nodiscard]] NormalEquations normal_equations(ParameterValues values, bool derivatives = true,
                                                 Losses losses = Losses::as_given) override;

  [[nodiscard]] std::vector<std::vector<Pose<double>>> sample_poses(
      ParameterValues values) override;

 private:
  using Poses = std::vector<std::vector<Pose<double>>>;  ///< of each sample and frame

  /// A sample in the batches.
  struct Place {
    std::size_t layout = 0, row = 0;
  };
  /// The rows of a term in a sample.
  struct Rows {
    int term = 0, sample = 0;
    TermResiduals residuals;
    double cost = 0.0;        ///< losses included
    Eigen::VectorXd weights;  ///< squares of each row's weight, losses included
  };

  /// Moves a sample in the batches to its current poses.
  void place(std::size_t sample);
  /// The normal equations of each sample at its current poses.
  [[nodiscard]] std::vector<detail::SamplePoseSums> sums(ParameterValues values, Losses losses);
  /// The same at these poses, which become the current ones.
  [[nodiscard]] std::vector<detail::SamplePoseSums> sums_at(Poses poses, ParameterValues values,
                                                            Losses losses);
  /// Begins at the poses of the best evaluation, or where the last derivatives say that they go, whichever is better in
  /// a sample.
  [[nodiscard]] std::vector<detail::SamplePoseSums> start(ParameterValues values, Losses losses);
  /// Fits all poses at these values.
  void fit(ParameterValues values, Losses losses);
  /// The rows at the fitted poses, with their derivatives by the free parameters: J'.
  [[nodiscard]] std::optional<UndefinedResidual> collect(ParameterValues values, Losses losses,
                                                         Linearization at);

  /// Fitted poses, and how they change with the others.
  struct KnownPoses {
    Poses poses;
    std::vector<Eigen::MatrixXd> by_free;  ///< (poses x free) of each sample, its sign reversed
    std::vector<double> values;            ///< at which they were fitted, of all parameters
  };

  const BasicProblem<S>& problem_;
  FreeSet free_, own_, all_;
  std::vector<detail::Batches<S>> batches_;              ///< with the current poses
  std::vector<std::vector<detail::PosePlace>> offsets_;  ///< of each layout
  std::vector<Place> places_;                            ///< of each sample
  std::unique_ptr<Evaluator<S>> by_own_, by_all_;
  Poses now_, best_;
  KnownPoses known_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  std::vector<Rows> rows_;  ///< of the last evaluation
};

}  // namespace kinecal
