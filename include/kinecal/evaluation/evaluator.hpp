// Evaluates a problem in S, a double or a packet: residuals and Jacobian, or the normal equations.
//
// Samples are evaluated batch by batch.  The normal equations are summed in pieces of fixed size
// that threads share; the pieces are added in the order of the batches.  So the result is the same,
// bit for bit, for any number of threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/evaluation/prefetch.hpp"
#include "kinecal/evaluation/term_code.hpp"

namespace kinecal {

template <class S>
class BasicProblem;

/// Evaluates a problem in S.
template <class S>
class Evaluator final : public AnyEvaluator {
 public:
  /// @param problem  must outlive the evaluator; do not add samples meanwhile
  /// @param free     the columns of the Jacobian
  /// @param threads  number of threads that share normal_equations(); zero: one per core
  /// @param terms    indices of the error blocks that count; empty: all
  /// @throws std::invalid_argument  if a free parameter does not belong to the problem
  Evaluator(const BasicProblem<S>& problem, const FreeSet& free, int threads = 0,
            std::span<const int> terms = {});
  /// The same for other numbers of the same samples.
  /// @param batches  must outlive the evaluator
  Evaluator(const BasicProblem<S>& problem, const std::vector<detail::Batches<S>>& batches,
            const FreeSet& free, int threads, std::span<const int> terms = {});

  Evaluator(const BasicProblem<S>&&, const FreeSet&, int = 0,
            std::span<const int> = {}) = delete;  ///< the evaluator would outlive it

  /// The problem that it evaluates.
  [[nodiscard]] const BasicProblem<S>& problem() const override { return problem_; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }

  /// Calls visit(int term index, const TermCode<S>&, const TermViews<S>&, std::span<const int>
  /// samples) for each batch and each of its terms.
  /// @param values       of all parameters of the table
  /// @param derivatives  fill the twists of the views, too
  template <class Visit>
  void for_each_term(ParameterValues values, bool derivatives, Visit&& visit) {
    set(values);
    for_each_term(0, num_batches_, derivatives, workers_[0], visit);
  }

  std::optional<UndefinedResidual> evaluate(ParameterValues values, bool derivatives,
                                            const RowVisitor& visit,
                                            Linearization at = Linearization::measured) override;

  [[nodiscard]] NormalEquations normal_equations(ParameterValues values, bool derivatives = true,
                                                 Losses losses = Losses::as_given) override;

 private:
  static constexpr std::size_t kSamplesOfPiece = 1024, kMaxPieces = 64;

  /// Memory of one thread.
  struct Worker {
    std::vector<detail::SensorView<S>> views;
    std::vector<detail::TermSums<S>> sums;  ///< of each term
  };

  /// State of a term that all batches share.
  struct TermState {
    OwnParameters own;                                  ///< of the block
    bool counts = true;                                 ///< else it is left out
    std::vector<std::vector<detail::FeatureRun>> runs;  ///< of the features of each layout
  };

  void set(ParameterValues values);

  /// Number of batches in a piece; it does not depend on the number of threads.
  [[nodiscard]] std::size_t piece_size() const {
    return std::max<std::size_t>(kSamplesOfPiece / kLanes<S>,
                                 (num_batches_ + kMaxPieces - 1) / kMaxPieces);
  }
  [[nodiscard]] std::size_t num_pieces() const {
    return (num_batches_ + piece_size() - 1) / piece_size();
  }

  /// The same for the batches from `first` to `end`, counted over all layouts.
  template <class Visit>
  void for_each_term(std::size_t first, std::size_t end, bool derivatives, Worker& worker,
                     Visit&& visit) const;

  /// The normal equations of some batches.
  void sum(std::size_t first, std::size_t end, bool derivatives, Losses losses, Worker& worker,
           NormalEquations& total) const;

  const BasicProblem<S>& problem_;
  const std::vector<detail::Batches<S>>& batches_;
  FreeSet free_;
  std::size_t num_batches_ = 0;
  std::vector<detail::SensorState> sensors_;
  std::vector<TermState> terms_;
  std::vector<Worker> workers_;
  detail::BatchRows<S> rows_;
  TermResiduals residuals_;
};

template <class S>
template <class Visit>
void Evaluator<S>::for_each_term(std::size_t first, std::size_t end, bool derivatives,
                                 Worker& worker, Visit&& visit) const {
  worker.views.resize(sensors_.size());
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    worker.views[s].start(problem_.sensors()[s], problem_.evaluation_of(s), sensors_[s],
                          derivatives);
  }
  std::size_t before = 0;
  for (std::size_t l = 0; l < batches_.size(); ++l) {
    const detail::Batches<S>& batches = batches_[l];
    const detail::SampleLayout& layout = batches.layout();
    const std::size_t size = batches.size();
    const auto counts = [&](const detail::TermLayout& place) {
      return terms_[static_cast<std::size_t>(place.term)].counts;
    };
    if (std::none_of(layout.terms.begin(), layout.terms.end(), counts)) {
      before += size;
      continue;
    }
    const auto part = detail::prefetched_at_once(size, batches.numbers(0).size_bytes(),
                                                 layout.sensors.size() + layout.terms.size());
    for (std::size_t n = std::max(first, before); n < std::min(end, before + size); ++n) {
      const std::size_t b = n - before;
      std::span<const std::byte> next = std::as_bytes(batches.numbers(b + 1));
      for (std::size_t s = 0; s < sensors_.size(); ++s) {
        detail::prefetch(next, part);
        if (layout.sensors[s]) worker.views[s].update(batches.observation(b, s));
      }
      for (const detail::TermLayout& place : layout.terms) {
        detail::prefetch(next, part);
        const Term& term = problem_.term(place.term);
        const TermState& state = terms_[static_cast<std::size_t>(place.term)];
        if (!state.counts) continue;
        detail::TermViews<S> views{&term, {}, &state.own, state.runs[l]};
        views.inverse_sigmas = batches.of_term(b, place.inverse_sigmas);
        views.conditions = batches.of_term(b, place.conditions);
        views.conditions_step = place.conditions_step;
        for (std::size_t i = 0; i < term.sensors.size(); ++i) {
          views.sensors[i] = &worker.views[static_cast<std::size_t>(term.sensors[i])];
        }
        visit(place.term, problem_.code(place.term), views, batches.samples(b));
      }
    }
    before += size;
  }
}

}  // namespace kinecal
