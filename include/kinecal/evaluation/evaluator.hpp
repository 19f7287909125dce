// Evaluating a problem in S, a double or a packet: residuals with their Jacobian, or the normal
// equations.
//
// Samples are evaluated batch by batch.  The normal equations are summed in pieces of a fixed size,
// which several threads share, and the pieces are added in the order of the batches.  So the result
// is the same, bit for bit, whatever the number of threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/evaluation/prefetch.hpp"
#include "kinecal/evaluation/term.hpp"

namespace kinecal {

template <class S>
class BasicProblem;

/// Evaluates a problem in S.
template <class S>
class Evaluator final : public AnyEvaluator {
 public:
  /// @param problem  must outlive the evaluator; do not add samples meanwhile
  /// @param free     the columns of the Jacobian
  /// @param threads  number of threads that share the work; zero: one per core
  /// @throws std::invalid_argument  if a free parameter is not one of the problem
  Evaluator(const BasicProblem<S>& problem, const FreeSet& free, int threads = 1);

  Evaluator(const BasicProblem<S>&&, const FreeSet&,
            int = 1) = delete;  ///< it would not outlive it

  /// The problem that it evaluates.
  [[nodiscard]] const BasicProblem<S>& problem() const override { return problem_; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }

  /// Calls visit(int term index, const Term<S>&, const TermViews<S>&, std::span<const int> samples)
  /// for each batch and each of its terms.
  /// @param values       of all parameters of the table
  /// @param derivatives  fill the twists of the views, too
  template <class Visit>
  void for_each_term(std::span<const double> values, bool derivatives, Visit&& visit) {
    set(values);
    for_each_term(0, num_batches_, derivatives, workers_[0], visit);
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
    std::vector<detail::SensorView<S>> views;
    std::vector<std::vector<const detail::SensorView<S>*>> of_terms;  ///< the views of each term
    std::vector<detail::TermSums<S>> sums;                            ///< of each term
  };

  void set(std::span<const double> values);

  /// The runs of a term's features in the samples of a layout.
  [[nodiscard]] std::vector<detail::FeatureRun> runs_of(int t,
                                                        const detail::Batches<S>& batches) const;

  /// Number of batches in a piece; it does not depend on the number of threads.
  [[nodiscard]] std::size_t piece_size() const {
    return std::max<std::size_t>(kSamplesOfPiece / kLanes<S>,
                                 (num_batches_ + kMaxPieces - 1) / kMaxPieces);
  }
  [[nodiscard]] std::size_t num_pieces() const {
    return (num_batches_ + piece_size() - 1) / piece_size();
  }

  void start(bool derivatives, Worker& worker) const;

  /// The same for the batches from `first` to `end`, counted over all layouts.
  template <class Visit>
  void for_each_term(std::size_t first, std::size_t end, bool derivatives, Worker& worker,
                     Visit&& visit) const;

  /// The normal equations of some batches.
  void sum(std::size_t first, std::size_t end, bool derivatives, Losses losses, Worker& worker,
           NormalEquations& total) const;

  const BasicProblem<S>& problem_;
  FreeSet free_;
  std::size_t num_batches_ = 0;
  std::vector<detail::SensorState> states_;  ///< of each sensor
  std::vector<OwnParameters> own_;           ///< of each term
  std::vector<std::vector<std::vector<detail::FeatureRun>>>
      runs_;                  ///< of each layout and each of its terms
  std::vector<bool> places_;  ///< of each sensor: a block takes more of it than predictions
  std::vector<Worker> workers_;
  detail::BatchRows<S> rows_;
  TermResiduals residuals_;
};

template <class S>
Evaluator<S>::Evaluator(const BasicProblem<S>& problem, const FreeSet& free, int threads)
    : problem_(problem), free_(free), places_(problem.sensors().size(), false) {
  problem.check(free);
  for (const MountedSensor& sensor : problem.sensors()) states_.emplace_back(sensor, free);
  for (const auto& term : problem.terms()) {
    own_.emplace_back(term->parameters(), free);
    for (std::size_t i = 0; i < term->sensors().size(); ++i) {
      if (term->quantities()[i] == Quantity::pixel) continue;
      places_[static_cast<std::size_t>(term->sensors()[i])] = true;
    }
  }
  for (const detail::Batches<S>& batches : problem.batches()) {
    num_batches_ += batches.size();
    auto& of_layout = runs_.emplace_back();
    for (const int t : batches.terms()) of_layout.push_back(runs_of(t, batches));
  }
  const int pieces = std::max(1, static_cast<int>(num_pieces()));
  workers_.resize(
      static_cast<std::size_t>(std::clamp(detail::number_of_threads(threads), 1, pieces)));
}

template <class S>
std::vector<detail::FeatureRun> Evaluator<S>::runs_of(int t,
                                                      const detail::Batches<S>& batches) const {
  const auto i = static_cast<std::size_t>(t);
  const detail::Term<S>& term = *problem_.terms()[i];
  std::vector<const std::vector<std::size_t>*> chains;
  std::vector<const detail::SensorState*> states;
  for (const int sensor : term.sensors()) {
    const auto s = static_cast<std::size_t>(sensor);
    chains.push_back(&batches.observation(0, s).layout->chain);
    states.push_back(&states_[s]);
  }
  return detail::feature_runs(chains, states, own_[i], term.pairs_features());
}

template <class S>
void Evaluator<S>::set(std::span<const double> values) {
  if (values.size() != static_cast<std::size_t>(problem_.table().size())) {
    throw std::invalid_argument(std::to_string(values.size()) + " values for a table of " +
                                std::to_string(problem_.table().size()) + " parameters");
  }
  for (std::size_t s = 0; s < states_.size(); ++s) states_[s].set(problem_.sensors()[s], values);
  for (std::size_t t = 0; t < own_.size(); ++t) {
    own_[t].set(problem_.terms()[t]->parameters(), values);
  }
}

template <class S>
void Evaluator<S>::start(bool derivatives, Worker& worker) const {
  worker.views.resize(states_.size());
  for (std::size_t s = 0; s < states_.size(); ++s) {
    worker.views[s].start(problem_.sensors()[s], problem_.evaluation_of(s), states_[s], places_[s],
                          derivatives);
  }
  worker.of_terms.clear();
  for (const auto& term : problem_.terms()) {
    auto& of_term = worker.of_terms.emplace_back();
    for (const int s : term->sensors()) {
      of_term.push_back(&worker.views[static_cast<std::size_t>(s)]);
    }
  }
}

template <class S>
template <class Visit>
void Evaluator<S>::for_each_term(std::size_t first, std::size_t end, bool derivatives,
                                 Worker& worker, Visit&& visit) const {
  start(derivatives, worker);
  std::size_t before = 0;
  for (std::size_t layout = 0; layout < runs_.size(); ++layout) {
    const detail::Batches<S>& batches = problem_.batches()[layout];
    const std::size_t size = batches.size();
    const detail::Prefetch<S> prefetch(batches, std::ssize(states_) + std::ssize(batches.terms()));
    for (std::size_t b = std::max(first, before); b < std::min(end, before + size); ++b) {
      auto next = prefetch.of(b + 1 - before);
      for (std::size_t s = 0; s < states_.size(); ++s) {
        next.load_part();
        if (batches.has(s)) worker.views[s].update(batches.observation(b - before, s));
      }
      for (std::size_t n = 0; n < batches.terms().size(); ++n) {
        next.load_part();
        const auto t = static_cast<std::size_t>(batches.terms()[n]);
        visit(batches.terms()[n], *problem_.terms()[t],
              detail::TermViews<S>{worker.of_terms[t], &own_[t], runs_[layout][n],
                                   batches.of_term(b - before, n)},
              batches.samples(b - before));
      }
    }
    before += size;
  }
}

template <class S>
std::optional<UndefinedResidual> Evaluator<S>::evaluate(std::span<const double> values,
                                                        bool derivatives, const RowVisitor& visit,
                                                        Linearization at) {
  std::optional<UndefinedResidual> undefined;
  const int columns = derivatives ? free_.size() : -1;
  const auto visit_batch = [&](int t, const detail::Term<S>& term,
                               const detail::TermViews<S>& views, std::span<const int> samples) {
    term.evaluate(views, derivatives, at, rows_);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      rows_.unpack(views.runs, term.feature_size(), static_cast<int>(i), columns, residuals_);
      if (residuals_.residual.allFinite()) {
        visit(t, samples[i], residuals_);
      } else if (!undefined) {
        undefined = UndefinedResidual{term.name(), problem_.source(samples[i])};
      }
    }
  };
  for_each_term(values, derivatives, visit_batch);
  return undefined;
}

template <class S>
NormalEquations Evaluator<S>::normal_equations(std::span<const double> values, bool derivatives,
                                               Losses losses) {
  set(values);
  const int columns = derivatives ? free_.size() : 0;
  std::vector<NormalEquations> parts(num_pieces(), NormalEquations(columns));
  detail::for_each_piece(static_cast<int>(parts.size()), static_cast<int>(workers_.size()),
                         [&](int piece, int thread) {
                           const std::size_t first = static_cast<std::size_t>(piece) * piece_size();
                           sum(first, std::min(first + piece_size(), num_batches_), derivatives,
                               losses, workers_[static_cast<std::size_t>(thread)],
                               parts[static_cast<std::size_t>(piece)]);
                         });
  NormalEquations total(columns);
  for (const NormalEquations& part : parts) total += part;
  for (const PriorTerm& prior : problem_.priors()) {
    prior.evaluate(problem_.table(), values, derivatives ? &free_ : nullptr, residuals_);
    add_prior(total, prior.options, residuals_, problem_.num_samples(), losses);
  }
  return total;
}

template <class S>
void Evaluator<S>::sum(std::size_t first, std::size_t end, bool derivatives, Losses losses,
                       Worker& worker, NormalEquations& total) const {
  worker.sums.resize(problem_.terms().size());
  for (detail::TermSums<S>& of_term : worker.sums) of_term.set_zero();
  const auto add = [&](int t, const detail::Term<S>& term, const detail::TermViews<S>& views,
                       std::span<const int>) {
    const Loss loss = term.options().loss_for(losses);
    detail::TermSums<S>& of_term = worker.sums[static_cast<std::size_t>(t)];
    if (derivatives) {
      term.add_normal_equations(views, loss, of_term);
    } else {
      term.add_cost(views, loss, of_term);
    }
  };
  for_each_term(first, end, derivatives, worker, add);
  for (const detail::TermSums<S>& of_term : worker.sums) {
    total.cost += 0.5 * sum_of_lanes(of_term.twice_cost);
    if (!derivatives) continue;
    for (const auto& [chains, local] : of_term.by_chains) local.add_to(total);
  }
}

}  // namespace kinecal
