// Sums over shards, and solving with them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/settle.hpp"
#include "kinecal/solve/shards.hpp"
#include "kinecal/solve/solve_with.ipp"

namespace kinecal {

namespace detail {

// Packs the sums of shards as numbers, and the evaluator that adds them.

/// Normal equations as numbers, and back.
[[nodiscard]] inline std::vector<double> packed(const NormalEquations& normal) {
  std::vector<double> all = {normal.cost};
  all.insert(all.end(), normal.gradient.begin(), normal.gradient.end());
  all.insert(all.end(), normal.hessian.reshaped().begin(), normal.hessian.reshaped().end());
  return all;
}
[[nodiscard]] inline NormalEquations unpacked(const std::vector<double>& all, int parameters) {
  NormalEquations normal(parameters);
  if (all.size() < packed(normal).size()) throw std::invalid_argument("sums of another problem");
  normal.cost = all[0];
  normal.gradient = Eigen::Map<const Eigen::VectorXd>(all.data() + 1, parameters);
  normal.hessian =
      Eigen::Map<const Eigen::MatrixXd>(all.data() + 1 + parameters, parameters, parameters);
  return normal;
}

/// Evaluates one shard after another.
class ShardEvaluator final : public AnyEvaluator {
 public:
  ShardEvaluator(const Shards& shards, FreeSet free, int threads)
      : shards_(shards), free_(std::move(free)), threads_(threads) {}

  [[nodiscard]] const AnyProblem& problem() const override { return *shards_.problem; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }

  std::optional<UndefinedResidual> evaluate(ParameterValues values, bool derivatives,
                                            const RowVisitor& visit, Linearization at) override {
    std::optional<UndefinedResidual> undefined;
    int before = 0;  // samples
    for (int shard = 0; shard < shards_.count; ++shard) {
      const std::shared_ptr<const AnyProblem> problem = shards_.read(shard);
      const auto visit_shifted = [&](int term, int sample, const TermResiduals& rows) {
        visit(term, before + sample, rows);
      };
      auto here =
          problem->evaluator(free_, threads_)->evaluate(values, derivatives, visit_shifted, at);
      if (!undefined) undefined = std::move(here);
      before += problem->num_samples();
    }
    return undefined;
  }

  // Reading a shard costs more than its derivatives, so they are always computed.  The last sums
  // are kept, because Ceres asks for the cost first and for derivatives at the same point later.
  [[nodiscard]] NormalEquations normal_equations(ParameterValues values, bool,
                                                 Losses losses) override {
    const std::string what =
        name_at(losses == Losses::convex ? "convex" : "as given", free_, values);
    if (last_ && last_->first == what) return last_->second;
    const auto numbers_of = [&](int shard) {
      const std::shared_ptr<const AnyProblem> problem = shards_.read(shard);
      return packed(problem->evaluator(free_, threads_)->normal_equations(values, true, losses));
    };
    NormalEquations sum(free_.size());
    for (const std::vector<double>& one : numbers_of_shards(shards_, what, numbers_of)) {
      sum += unpacked(one, free_.size());
    }
    last_.emplace(what, sum);
    return sum;
  }

 private:
  const Shards& shards_;
  FreeSet free_;
  int threads_;
  std::optional<std::pair<std::string, NormalEquations>> last_;
};

/// Moves a solution along undetermined directions to the reference, then to the minimum there.
/// @returns  the cost there
inline double hold_shards(const Shards& shards, const FreeSet& free,
                          const Eigen::VectorXd& reference, int threads, Eigen::VectorXd& values) {
  constexpr int kMostRounds = 6;
  constexpr double kNear = 1e-12;  // in units of effect
  const Eigen::VectorXd before = values;
  double first_cost = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    const SampleInformation sums = shard_information(shards, free, numbers(values));
    if (!std::isfinite(sums.measured.cost)) break;
    if (round == 0) first_cost = sums.measured.cost;
    const Spectrum spectrum = determined_spectrum(sums, Priors::count);
    if (spectrum.null == 0 && round == 0) return first_cost;
    const auto units = spectrum.scale.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd null = spectrum.vectors.leftCols(spectrum.null);
    const Eigen::MatrixXd basis = units * spectrum.vectors.rightCols(free.size() - spectrum.null);
    const Eigen::VectorXd away = values(free.parameters()) - reference(free.parameters());
    const Eigen::VectorXd back = -null * (null.transpose() * spectrum.scale.cwiseProduct(away));
    const Eigen::MatrixXd reduced = basis.transpose() * sums.measured.hessian * basis;
    const Eigen::VectorXd gradient =
        basis.transpose() * (sums.measured.gradient + sums.measured.hessian * (units * back));
    const Eigen::VectorXd down = -Spectrum(reduced).pseudo_inverse() * gradient;
    values(free.parameters()) += units * back + basis * down;
    if (std::max(back.norm(), down.norm()) < kNear * (1.0 + away.norm())) break;
  }
  const double after = shard_evaluator(shards, free, threads)
                           ->normal_equations(numbers(values), true, Losses::as_given)
                           .cost;
  constexpr double kSame = 1e-9;  // of the cost
  const ParameterTable& table = shards.problem->table();
  const bool within = std::ranges::all_of(free.parameters(), [&](int p) {
    return values(p) >= table[p].lower && values(p) <= table[p].upper;
  });
  if (within && after <= first_cost * (1.0 + kSame)) return after;
  values = before;
  return first_cost;
}

KINECAL_INLINE std::string name_at(const std::string& what, const FreeSet& free,
                                   ParameterValues values) {
  std::string name = what;
  for (const int p : free.parameters()) name += " " + std::to_string(p);
  name += '\n';
  const std::size_t words = name.size();
  name.resize(words + values.size_bytes());
  std::memcpy(name.data() + words, values.data(), values.size_bytes());
  return name;
}

KINECAL_INLINE SampleInformation shard_information(const Shards& shards, const FreeSet& free,
                                                   ParameterValues values) {
  const int n = free.size();
  const auto numbers_of = [&](int shard) {
    const SampleInformation of = sample_information(*shards.read(shard), free, values);
    std::vector<double> all = packed(of.measured);
    for (const Eigen::MatrixXd* matrix : {&of.error_free, &of.priors}) {
      all.insert(all.end(), matrix->reshaped().begin(), matrix->reshaped().end());
    }
    return all;
  };
  SampleInformation sum{NormalEquations(n), Eigen::MatrixXd::Zero(n, n),
                        Eigen::MatrixXd::Zero(n, n)};
  const std::size_t first = packed(sum.measured).size(), square = sum.priors.size();
  for (const auto& one :
       numbers_of_shards(shards, name_at("information", free, values), numbers_of)) {
    sum.measured += unpacked(one, n);
    sum.error_free += Eigen::Map<const Eigen::MatrixXd>(one.data() + first, n, n);
    sum.priors += Eigen::Map<const Eigen::MatrixXd>(one.data() + first + square, n, n);
  }
  return sum;
}

}  // namespace detail

KINECAL_INLINE std::vector<std::vector<double>> numbers_of_shards(
    const Shards& shards, const std::string& what, const NumbersOfShard& numbers_of) {
  if (shards.exchange) return shards.exchange(what, numbers_of);
  std::vector<std::vector<double>> all;
  for (int shard = 0; shard < shards.count; ++shard) all.push_back(numbers_of(shard));
  return all;
}

KINECAL_INLINE std::unique_ptr<AnyEvaluator> shard_evaluator(const Shards& shards,
                                                             const FreeSet& free, int threads) {
  shards.problem->check(free);
  return std::make_unique<detail::ShardEvaluator>(shards, free, threads);
}

KINECAL_INLINE StepResult solve_shards(const Shards& shards, const FreeSet& free,
                                       std::vector<double>& values, ParameterValues reference,
                                       const SolveOptions& options) {
  StepResult result;
  result.num_parameters = free.size();
  result.num_residuals = shards.num_residuals;
  result.samples = shards.samples;
  SolveOptions compressed = options;
  compressed.form = CostForm::compressed;
  const auto evaluator_of = [&](const FreeSet& columns) {
    return shard_evaluator(shards, columns, options.threads);
  };
  const auto vector = [](std::span<const double> of) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(of.data(), std::ssize(of)));
  };
  Eigen::VectorXd x = vector(values);
  result = detail::solve_with(evaluator_of, free, x, compressed, std::move(result));
  if (result.converged) {
    wrap_angles(*shards.problem, free, x);
    result.final_cost = detail::hold_shards(shards, free, vector(reference), options.threads, x);
  }
  values.assign(x.begin(), x.end());
  return result;
}

}  // namespace kinecal
