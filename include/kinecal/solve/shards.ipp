// Sums over shards, and what is solved with them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "kinecal/solve/determined_spectrum.ipp"
#include "kinecal/solve/settle.hpp"
#include "kinecal/solve/shards.hpp"
#include "kinecal/solve/solve_with.ipp"

namespace kinecal {

namespace detail {

/// Normal equations as numbers, and back.
[[nodiscard]] inline std::vector<double> packed(const NormalEquations& normal) {
  std::vector<double> all = {normal.cost};
  all.insert(all.end(), normal.gradient.begin(), normal.gradient.end());
  all.insert(all.end(), normal.hessian.reshaped().begin(), normal.hessian.reshaped().end());
  return all;
}
[[nodiscard]] inline NormalEquations unpacked(const std::vector<double>& all, int parameters) {
  NormalEquations normal(parameters);
  normal.cost = all[0];
  normal.gradient = Eigen::Map<const Eigen::VectorXd>(all.data() + 1, parameters);
  normal.hessian =
      Eigen::Map<const Eigen::MatrixXd>(all.data() + 1 + parameters, parameters, parameters);
  return normal;
}

/// Evaluates shard after shard.
class ShardEvaluator final : public AnyEvaluator {
 public:
  ShardEvaluator(const Shards& shards, FreeSet free, int threads)
      : shards_(shards), free_(std::move(free)), threads_(threads) {}

  [[nodiscard]] const AnyProblem& problem() const override { return *shards_.problem; }
  [[nodiscard]] const FreeSet& free() const override { return free_; }

  std::optional<UndefinedResidual> evaluate(std::span<const double> values, bool derivatives,
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

  // Reading a shard costs more than its derivatives: they are always taken, and the last sums are kept,
  // as Ceres asks for the cost first and for derivatives at the same point later.
  [[nodiscard]] NormalEquations normal_equations(std::span<const double> values, bool,
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

/// Moves a solution along what nothing determines to the reference, and to the minimum there.
/// @returns  the cost there
inline double hold_shards(const Shards& shards, const FreeSet& free,
                          const Eigen::VectorXd& reference, int threads, Eigen::VectorXd& values) {
  constexpr int kMostRounds = 6;
  constexpr double kNear = 1e-12;  // in units of effect
  const Eigen::VectorXd before = values;
  double first_cost = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    const ShardInformation sums = shard_information(shards, free, numbers(values), threads);
    if (!std::isfinite(sums.measured.cost)) break;
    if (round == 0) first_cost = sums.measured.cost;
    Spectrum spectrum(sums.error_free);
    take_away_null_of(sums.error_free, sums.measured.hessian, spectrum);
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
                                   std::span<const double> values) {
  std::string name = what;
  for (const int p : free.parameters()) name += " " + std::to_string(p);
  name += '\n';
  const std::size_t words = name.size();
  name.resize(words + values.size_bytes());
  std::memcpy(name.data() + words, values.data(), values.size_bytes());
  return name;
}

KINECAL_INLINE ShardInformation shard_information(const Shards& shards, const FreeSet& free,
                                                  std::span<const double> values, int threads) {
  const int n = free.size();
  const auto numbers_of = [&](int shard) {
    const std::shared_ptr<const AnyProblem> problem = shards.read(shard);
    const Eigen::MatrixXd error_free = error_free_information(*problem, free, values) +
                                       prior_equations(*problem, free, values).hessian;
    std::vector<double> all = packed(problem->evaluator(free, threads)->normal_equations(values));
    all.insert(all.end(), error_free.reshaped().begin(), error_free.reshaped().end());
    return all;
  };
  ShardInformation sum{Eigen::MatrixXd::Zero(n, n), NormalEquations(n)};
  for (const auto& one :
       numbers_of_shards(shards, name_at("information", free, values), numbers_of)) {
    sum.measured += unpacked(one, n);
    sum.error_free += Eigen::Map<const Eigen::MatrixXd>(one.data() + 1 + n + n * n, n, n);
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
                                       Eigen::VectorXd& values, const Eigen::VectorXd& reference,
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
  result = detail::solve_with(evaluator_of, free, values, compressed, std::move(result));
  if (!result.converged) return result;
  wrap_angles(*shards.problem, free, values);
  result.final_cost = detail::hold_shards(shards, free, reference, options.threads, values);
  return result;
}

}  // namespace kinecal
