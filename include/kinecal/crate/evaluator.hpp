// Evaluating a problem in S, a double or a packet: residuals with their Jacobian, or the normal
// equations.
//
// Samples are evaluated pack by pack.  The normal equations are summed in pieces of a fixed size,
// which several threads share, and the pieces are added in the order of the samples.  So the result
// is the same, bit for bit, whatever the number of threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "kinecal/crate/any_evaluator.hpp"
#include "kinecal/crate/parallel.hpp"
#include "kinecal/crate/prior_term.hpp"
#include "kinecal/crate/term.hpp"

namespace kinecal {

template <class S>
class BasicProblem;

namespace detail {

/// The rows of one lane, without the features that are missing in it.
template <class S>
void unpack(const Term<S>& term, typename Term<S>::Views views, const PackedRows<S>& rows,
            int lane_index, int columns, TermResiduals& out) {
  const int feature_size = term.feature_size();
  std::vector<int> of_run;
  Eigen::Index present = 0;
  for (const S& weight : rows.weight) present += lane(weight, lane_index) > 0.0 ? 1 : 0;
  out.resize(present * feature_size, columns);
  Eigen::Index row = 0;
  std::size_t feature = 0, value = 0;
  for (std::size_t r = 0; r < rows.num_runs; ++r) {
    const auto& run = rows.runs[r];
    if (columns >= 0) term.columns(views, run.chains, of_run);
    for (const std::size_t end = feature + run.features; feature < end; ++feature) {
      const bool there = lane(rows.weight[feature], lane_index) > 0.0;
      for (int m = 0; m < feature_size; ++m) {
        const std::size_t i = feature * static_cast<std::size_t>(feature_size) + std::size_t(m);
        if (there) out.residual(row) = lane(rows.residual[i], lane_index);
        if (columns >= 0) {
          for (const int column : of_run) {
            const double derivative = lane(rows.jacobian[value++], lane_index);
            if (there) out.jacobian(row, column) += derivative;
          }
        }
        if (there) ++row;
      }
    }
  }
}

}  // namespace detail

/// Evaluates a problem in S.
template <class S>
class Evaluator final : public AnyEvaluator {
 public:
  /// @param problem  must outlive the evaluator; do not add samples meanwhile
  /// @param free     the columns of the Jacobian
  /// @param threads  number of threads that share the work; zero: one per core
  /// @throws std::invalid_argument  if a free parameter is not one of the problem
  Evaluator(const BasicProblem<S>& problem, const FreeSet& free, int threads = 1)
      : problem_(problem), free_(free), workers_(static_cast<std::size_t>(pieces_of(threads))) {
    problem.check(free);
    for (const SensorModel& sensor : problem.sensors()) states_.emplace_back(sensor, free);
  }

  Evaluator(const BasicProblem<S>&&, const FreeSet&,
            int = 1) = delete;  ///< it would not outlive it

  /// The problem that it evaluates.
  [[nodiscard]] const BasicProblem<S>& problem() const override { return problem_; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }

  /// Calls visit(int term index, const Term<S>&, Term<S>::Views, const PackedSample<S>&) for each
  /// pack and each of its terms.
  /// @param values       of all parameters of the table
  /// @param derivatives  fill the twists of the views, too
  template <class Visit>
  void for_each_term(std::span<const double> values, bool derivatives, Visit&& visit) {
    set(values);
    for_each_term(problem_.packs(), derivatives, workers_[0], visit);
  }

  std::optional<UndefinedResidual> evaluate(std::span<const double> values, bool derivatives,
                                            const RowVisitor& visit,
                                            Linearization at = Linearization::measured) override;

  [[nodiscard]] NormalEquations normal_equations(std::span<const double> values,
                                                 bool derivatives = true,
                                                 Losses losses = Losses::as_given) override;

 private:
  static constexpr std::size_t kSamplesOfPiece = 1024, kMaxPieces = 64;

  /// Memory of one thread.
  struct Worker {
    std::vector<SensorView<S>> views;
    std::vector<TermSums<S>> sums;  ///< of each term
  };

  void set(std::span<const double> values) {
    if (values.size() != static_cast<std::size_t>(problem_.table().size())) {
      throw std::invalid_argument(std::to_string(values.size()) + " values for a table of " +
                                  std::to_string(problem_.table().size()) + " parameters");
    }
    for (std::size_t s = 0; s < states_.size(); ++s) states_[s].set(problem_.sensors()[s], values);
  }

  /// Number of packs in a piece; it does not depend on the number of threads.
  [[nodiscard]] std::size_t piece_size() const {
    return std::max(kSamplesOfPiece / kLanes<S>, (problem_.packs().size() - 1) / kMaxPieces + 1);
  }
  [[nodiscard]] std::size_t num_pieces() const {
    return (problem_.packs().size() + piece_size() - 1) / piece_size();
  }
  [[nodiscard]] int pieces_of(int threads) const {
    return std::clamp(number_of_threads(threads), 1, std::max(1, static_cast<int>(num_pieces())));
  }

  template <class Visit>
  void for_each_term(std::span<const PackedSample<S>> packs, bool derivatives, Worker& worker,
                     Visit&& visit) const {
    worker.views.resize(states_.size());
    for (std::size_t s = 0; s < states_.size(); ++s) {
      worker.views[s].start(problem_.sensors()[s], states_[s], derivatives, problem_.walks(s));
    }
    std::vector<std::vector<const SensorView<S>*>> of_terms;
    for (const auto& term : problem_.terms()) {
      std::vector<const SensorView<S>*>& of_term = of_terms.emplace_back();
      for (const int s : term->sensors()) {
        of_term.push_back(&worker.views[static_cast<std::size_t>(s)]);
      }
    }
    for (const PackedSample<S>& pack : packs) {
      for (std::size_t s = 0; s < states_.size(); ++s) {
        if (!pack.seen[s]) continue;
        worker.views[s].update(*pack.seen[s]);
      }
      for (const int t : pack.shape->terms) {
        const auto i = static_cast<std::size_t>(t);
        visit(t, *problem_.terms()[i], typename Term<S>::Views(of_terms[i]), pack);
      }
    }
  }

  /// The normal equations of some packs.
  void sum(std::span<const PackedSample<S>> packs, bool derivatives, Losses losses, Worker& worker,
           NormalEquations& total) const;

  const BasicProblem<S>& problem_;
  FreeSet free_;
  std::vector<SensorState> states_;  ///< of each sensor
  std::vector<Worker> workers_;
  PackedRows<S> rows_;
  TermResiduals residuals_;
};

template <class S>
std::optional<UndefinedResidual> Evaluator<S>::evaluate(std::span<const double> values,
                                                        bool derivatives, const RowVisitor& visit,
                                                        Linearization at) {
  std::optional<UndefinedResidual> undefined;
  const int columns = derivatives ? free_.size() : -1;
  for_each_term(values, derivatives, [&](int t, const Term<S>& term, auto views, auto& pack) {
    term.evaluate(views, derivatives, at, rows_);
    for (std::size_t i = 0; i < pack.samples.size(); ++i) {
      detail::unpack(term, views, rows_, static_cast<int>(i), columns, residuals_);
      if (residuals_.residual.allFinite()) {
        visit(t, pack.samples[i], residuals_);
      } else if (!undefined) {
        undefined = UndefinedResidual{term.name(), problem_.source(pack.samples[i])};
      }
    }
  });
  return undefined;
}

template <class S>
NormalEquations Evaluator<S>::normal_equations(std::span<const double> values, bool derivatives,
                                               Losses losses) {
  set(values);
  const int columns = derivatives ? free_.size() : 0;
  const std::span<const PackedSample<S>> packs = problem_.packs();
  std::vector<NormalEquations> parts(num_pieces(), NormalEquations(columns));
  for_each_piece(static_cast<int>(parts.size()), static_cast<int>(workers_.size()),
                 [&](int piece, int thread) {
                   const std::size_t first = static_cast<std::size_t>(piece) * piece_size();
                   const std::size_t size = std::min(piece_size(), packs.size() - first);
                   sum(packs.subspan(first, size), derivatives, losses,
                       workers_[static_cast<std::size_t>(thread)],
                       parts[static_cast<std::size_t>(piece)]);
                 });
  NormalEquations total(columns);
  for (const NormalEquations& part : parts) total += part;
  for (const PriorTerm& prior : problem_.priors()) {
    prior.evaluate(problem_.table(), values, derivatives ? &free_ : nullptr, residuals_);
    prior.add_to(total, residuals_, problem_.num_samples(), losses);
  }
  return total;
}

template <class S>
void Evaluator<S>::sum(std::span<const PackedSample<S>> packs, bool derivatives, Losses losses,
                       Worker& worker, NormalEquations& total) const {
  worker.sums.resize(problem_.terms().size());
  for (TermSums<S>& of_term : worker.sums) of_term.set_zero();
  for_each_term(packs, derivatives, worker, [&](int t, auto& term, auto views, auto&) {
    const Loss loss = term.options().loss_for(losses);
    TermSums<S>& of_term = worker.sums[static_cast<std::size_t>(t)];
    if (derivatives) {
      term.add_normal_equations(views, loss, of_term);
    } else {
      term.add_cost(views, loss, of_term);
    }
  });
  for (const TermSums<S>& of_term : worker.sums) {
    total.cost += 0.5 * sum_of_lanes(of_term.twice_cost);
    if (!derivatives) continue;
    for (const auto& [chains, local] : of_term.by_chains) local.add_to(total);
  }
}

}  // namespace kinecal
