// Packs the sums of shards as numbers, and the evaluator that adds them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/shards.hpp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
