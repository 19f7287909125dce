// Definitions of matched_step.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/matched_step.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "kinecal/config/assemble.hpp"
#include "kinecal/trust/plain_equations.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Factor of a block's residual: its loss is of the product.
[[nodiscard]] double factor_of(const BlockConfig& block) {
  const double scale = block.numbers.contains("scale") ? block.numbers.at("scale") : 1.0;
  return scale / block.sigma.value_or(1.0);
}

}  // namespace
}  // namespace detail

std::unique_ptr<AnyProblem> MatchedStep::problem(std::span<const SurfaceBlock> blocks,
                                                 const std::optional<double>& huber) const {
  Config config = config_;
  for (BlockConfig& block : config.steps[step_].error_blocks) {
    const auto is_its = [&](const SurfaceBlock& of) { return of.name == block.name; };
    if (!huber || std::none_of(blocks.begin(), blocks.end(), is_its)) continue;
    block.loss = {"huber", *huber * detail::factor_of(block)};
  }
  Diagnostics quiet;
  Calibration calibration = assemble(config, input_.robot, {}, quiet);
  quiet.throw_if_errors();
  return std::move(calibration.steps.at(step_).problem);
}

MatchedSums MatchedStep::sums(const AnyProblem& empty, std::span<const Sample> matched,
                              Eigen::VectorXd values, std::span<const BeyondGate> beyond,
                              const std::set<int>& held) const {
  MatchedSums state{.values = std::move(values)};
  const std::unique_ptr<AnyProblem> problem = empty.without_samples();
  for (const Sample& sample : matched) problem->add_sample(sample);
  const std::vector<int> touched = problem->touched_parameters();
  std::vector<int> chosen;
  for (const FreeParamConfig& parameter : free_parameters(config_.steps[step_])) {
    const int index = problem->table().find(parameter.name);
    const bool is_touched = std::binary_search(touched.begin(), touched.end(), index);
    if (is_touched && !held.contains(index)) chosen.push_back(index);
  }
  if (chosen.empty()) return state;
  const FreeSet free(std::move(chosen), problem->table().size());
  const PlainEquations sums = plain_equations(*problem, free, state.values, input_.threads);
  state.free = free.parameters();
  state.gradient = sums.gradient.matrix();
  state.hessian = sums.hessian.matrix();
  state.cost = sums.cost;
  for (const BeyondGate& of_block : beyond) {
    for (int t = 0; t < problem->num_terms(); ++t) {
      const Term& term = problem->term(t);
      if (term.name != of_block.block) continue;
      const double each = term.options.loss(std::pow(term.weight * of_block.gate, 2)).rho;
      state.cost += 0.5 * static_cast<double>(of_block.count) * each;
    }
  }
  if (!std::isfinite(state.cost)) state.cost = std::numeric_limits<double>::infinity();
  return state;
}

std::optional<double> MatchedStep::gate_of_losses(std::span<const SurfaceBlock> blocks) const {
  constexpr double kScales = 20.0;
  std::optional<double> widest;
  for (const SurfaceBlock& of : blocks) {
    const BlockConfig& block = block_of(config_.steps[step_], of.name);
    if (block.loss.type == "none") continue;
    widest = std::max(widest.value_or(0.0), kScales * block.loss.scale / detail::factor_of(block));
  }
  return widest;
}

DampedStep damped_step(const ParameterTable& table, const MatchedSums& at, double damping) {
  DampedStep to{at.values};
  const Eigen::Index n = at.gradient.size();
  if (n == 0) return to;
  Eigen::MatrixXd hessian = at.hessian;
  const double mean = hessian.trace() / static_cast<double>(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    hessian(i, i) += damping * hessian(i, i) + 1e-9 * mean + 1e-30;
  }
  const Eigen::VectorXd step = hessian.ldlt().solve(-at.gradient);
  for (Eigen::Index i = 0; i < n; ++i) to.values[at.free[static_cast<std::size_t>(i)]] += step[i];
  return {inside_bounds(table, std::move(to.values)), -0.5 * step.dot(at.gradient)};
}

Eigen::VectorXd inside_bounds(const ParameterTable& table, Eigen::VectorXd values) {
  for (int p = 0; p < table.size(); ++p) {
    values[p] = std::clamp(values[p], table[p].lower, table[p].upper);
  }
  return values;
}

void keep_loss(BlockConfig& block, std::vector<double> distances, double gate, double least) {
  constexpr double kOfMedian = 1.4826;
  if (block.loss.type == "none" || block.sigma) return;
  std::erase_if(distances, [&](double distance) { return !(distance <= gate); });
  if (distances.empty()) return;
  block.sigma = std::max(least, kOfMedian * median_of(std::move(distances)));
  block.loss.scale /= *block.sigma;
}

}  // namespace kinecal
