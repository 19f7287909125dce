// Definitions of evaluator.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template <class S>
Evaluator<S>::Evaluator(const BasicProblem<S>& problem, const FreeSet& free, int threads,
                        std::span<const int> terms)
    : Evaluator(problem, problem.batches(), free, threads, terms) {}

template <class S>
Evaluator<S>::Evaluator(const BasicProblem<S>& problem,
                        const std::vector<detail::Batches<S>>& batches, const FreeSet& free,
                        int threads, std::span<const int> only)
    : problem_(problem), batches_(batches), free_(free) {
  problem.check(free);
  std::vector<bool> placed(problem.sensors().size(), false);
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    for (std::size_t i = 0; i < term.sensors.size(); ++i) {
      if (term.quantities[i] != Quantity::pixel) placed[std::size_t(term.sensors[i])] = true;
    }
  }
  for (std::size_t s = 0; s < placed.size(); ++s) {
    sensors_.emplace_back(problem.sensors()[s], free, placed[s]);
  }
  for (int t = 0; t < problem.num_terms(); ++t) {
    const bool counts = only.empty() || std::find(only.begin(), only.end(), t) != only.end();
    terms_.push_back({OwnParameters(problem.term(t).parameters, free), counts, {}});
    terms_.back().runs.resize(batches.size());
  }
  for (std::size_t l = 0; l < batches.size(); ++l) {
    const detail::SampleLayout& layout = batches[l].layout();
    num_batches_ += batches[l].size();
    for (const detail::TermLayout& place : layout.terms) {
      TermState& term = terms_[static_cast<std::size_t>(place.term)];
      term.runs[l] = detail::feature_runs(problem.term(place.term), layout, sensors_, term.own);
    }
  }
  const int pieces = std::max(1, static_cast<int>(num_pieces()));
  workers_.resize(
      static_cast<std::size_t>(std::clamp(detail::number_of_threads(threads), 1, pieces)));
}

template <class S>
void Evaluator<S>::set(ParameterValues values) {
  if (values.size() != static_cast<std::size_t>(problem_.table().size())) {
    throw std::invalid_argument(std::to_string(values.size()) + " values for a table of " +
                                std::to_string(problem_.table().size()) + " parameters");
  }
  for (std::size_t s = 0; s < sensors_.size(); ++s) sensors_[s].set(problem_.sensors()[s], values);
  for (int t = 0; t < problem_.num_terms(); ++t) {
    terms_[static_cast<std::size_t>(t)].own.set(problem_.term(t).parameters, values);
  }
}

template <class S>
std::optional<UndefinedResidual> Evaluator<S>::evaluate(ParameterValues values, bool derivatives,
                                                        const RowVisitor& visit, Linearization at) {
  std::optional<UndefinedResidual> undefined;
  const int columns = derivatives ? free_.size() : -1;
  const auto visit_batch = [&](int t, const detail::TermCode<S>& code,
                               const detail::TermViews<S>& views, std::span<const int> samples) {
    code.evaluate(views, derivatives, at, rows_);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      rows_.unpack(views.runs, views.term->feature_size, static_cast<int>(i), columns, residuals_);
      const bool has_value = residuals_.residual.allFinite();
      if (has_value && (!derivatives || std::isfinite(residuals_.jacobian.sum()))) {
        visit(t, samples[i], residuals_);
      } else if (!undefined) {
        undefined = UndefinedResidual{views.term->name, problem_.source(samples[i]), has_value};
      }
    }
  };
  for_each_term(values, derivatives, visit_batch);
  return undefined;
}

template <class S>
NormalEquations Evaluator<S>::normal_equations(ParameterValues values, bool derivatives,
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
  // An undefined derivative times any residual is not a number.
  if (!total.gradient.allFinite()) total.cost = std::numeric_limits<double>::quiet_NaN();
  for (const PriorTerm& prior : problem_.priors()) {
    prior.evaluate(problem_.table(), values, derivatives ? &free_ : nullptr, residuals_);
    total.add_prior(prior, residuals_, problem_.num_samples(), losses);
  }
  return total;
}

template <class S>
void Evaluator<S>::sum(std::size_t first, std::size_t end, bool derivatives, Losses losses,
                       Worker& worker, NormalEquations& total) const {
  worker.sums.resize(terms_.size());
  for (detail::TermSums<S>& of_term : worker.sums) of_term.set_zero();
  const auto add = [&](int t, const detail::TermCode<S>& code, const detail::TermViews<S>& views,
                       std::span<const int>) {
    const Loss loss = views.term->options.loss_for(losses);
    detail::TermSums<S>& of_term = worker.sums[static_cast<std::size_t>(t)];
    if (derivatives) {
      code.add_normal_equations(views, loss, of_term);
    } else {
      code.add_cost(views, loss, of_term);
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
