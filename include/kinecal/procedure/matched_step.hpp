// A step of a calibration whose samples are matched with the robot anew in each round: its problem, the sums of what is
// matched, and the way downhill.  surface_rounds.hpp and outline_rounds.hpp match clouds and masks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/surface_blocks.hpp"

namespace kinecal {

/// What is matched for some values.
struct MatchedSums {
  Eigen::VectorXd values;                                 ///< of all parameters of the table
  std::vector<int> free = {};                             ///< table indices of the columns
  Eigen::VectorXd gradient = {};                          ///< (free) of the cost
  Eigen::MatrixXd hessian = {};                           ///< (free x free)
  double cost = std::numeric_limits<double>::infinity();  ///< with what is beyond the gate
};

/// Features of a block that have nothing within the gate: each costs as if it were there.
struct BeyondGate {
  std::string block;      ///< its name
  std::size_t count = 0;  ///< number of them
  double gate = 0.0;      ///< in the unit of the block's residual
};

/// Where a step away from some values leads.
struct DampedStep {
  Eigen::VectorXd values;  ///< inside of bounds
  double promised = 0.0;   ///< how far the cost should fall
};

/// A step of a calibration, without samples.
class MatchedStep {
 public:
  /// @param config  must outlive this, as `input`
  /// @param step    its number
  MatchedStep(const SurfaceInput& input, const Config& config, std::size_t step)
      : input_(input), config_(config), step_(step) {}

  /// The input.
  [[nodiscard]] const SurfaceInput& input() const { return input_; }
  /// Its problem.
  /// @param huber  scale of a Huber loss in place of those of the blocks, in the unit of their residuals
  [[nodiscard]] std::unique_ptr<AnyProblem> problem(std::span<const SurfaceBlock> blocks = {},
                                                    const std::optional<double>& huber = {}) const;
  /// The sums of samples.
  /// @param empty   problem()
  /// @param values  of all parameters
  /// @param held    table indices of parameters that keep their values
  [[nodiscard]] MatchedSums sums(const AnyProblem& empty, std::span<const Sample> matched,
                                 Eigen::VectorXd values, std::span<const BeyondGate> beyond,
                                 const std::set<int>& held = {}) const;
  /// The gate that goes with the losses of blocks: 20 times the widest scale, in the unit of their residuals; nullopt if
  /// none has a loss.
  [[nodiscard]] std::optional<double> gate_of_losses(std::span<const SurfaceBlock> blocks) const;

 private:
  const SurfaceInput& input_;
  const Config& config_;
  std::size_t step_;
};

/// A damped Gauss-Newton step.
[[nodiscard]] DampedStep damped_step(const ParameterTable& table, const MatchedSums& at,
                                     double damping);
/// Values inside of the bounds of a table.
[[nodiscard]] Eigen::VectorXd inside_bounds(const ParameterTable& table, Eigen::VectorXd values);

/// Gives a block that has a loss and no sigma the noise of what counts as its sigma, and the same loss in sigmas.
/// @param distances  in the unit of its residual; those beyond the gate do not count
/// @param least      sigma, at least
void keep_loss(BlockConfig& block, std::vector<double> distances, double gate, double least);

/// Goes downhill, by Levenberg-Marquardt on the costs of what is matched anew for each values.
/// @tparam State     a MatchedSums, with what belongs to it
/// @param rounds     at most
/// @param tolerance  relative fall of the cost at which rounds end
/// @param match      State(values, state before)
template <class State, class Match>
[[nodiscard]] State go_downhill(const ParameterTable& table, State state, int rounds,
                                double tolerance, const Match& match) {
  constexpr int kKinks = 3;  // the cost has some, where what is nearest changes
  double damping = 1e-3;
  int rejected = 0;
  Eigen::VectorXd last;  // step
  for (int round = 0; round < rounds; ++round) {
    auto [values, promised] = damped_step(table, state, damping);
    if (!(promised > tolerance * state.cost)) break;
    Eigen::VectorXd step = values - state.values;
    if (last.size() > 0 && rejected == 0) {
      // Steps of robust losses are too short by a constant factor: Aitken's extrapolation.
      constexpr double kMost = 0.7;
      const double rate = std::clamp(step.dot(last) / last.squaredNorm(), 0.0, kMost);
      values = inside_bounds(table, state.values + step / (1.0 - rate));
    }
    last = std::move(step);
    State next = match(std::move(values), state);
    const double fall = state.cost - next.cost;
    const bool is_better = fall > 0.0;
    damping = is_better ? std::max(1e-9, 0.1 * damping) : 30.0 * damping;
    rejected = is_better ? 0 : rejected + 1;
    if (is_better) state = std::move(next);
    if (rejected == kKinks || (is_better && fall <= tolerance * state.cost)) break;
  }
  return state;
}

/// Rounds with each gate, at most, while it narrows.
inline constexpr int kGateRounds = 3;

/// Rounds whose gate narrows to four robust standard deviations of what is within it.
/// @param gate       in: beyond it, nothing counts at all; out: the last one
/// @param narrowest  at least
/// @param rounds     with each gate, at most; zero: values stay
/// @param state      in: values
/// @param run        State(gate, values, rounds): so many rounds from there
/// @param distances  of all features of a state
template <class State, class Run, class Distances>
void narrow(double& gate, double narrowest, int rounds, State& state, const Run& run,
            const Distances& distances) {
  constexpr int kMost = 40;
  constexpr double kRobust = 4.0 * 1.4826;
  for (int n = 0; n < kMost; ++n) {
    // First only the distances: with a gate that is too wide, strangers would pull.
    state = run(gate, state.values, n == 0 ? 0 : rounds);
    std::vector<double> near = distances(state);
    std::erase_if(near, [&](double distance) { return !(distance <= gate); });
    if (near.empty()) return;
    const double next = std::clamp(kRobust * median_of(std::move(near)), narrowest, gate);
    const bool is_settled = n > 0 && next > 0.99 * gate;
    gate = next;
    if (is_settled) return;
  }
}

}  // namespace kinecal
