// Estimates the noise of error blocks without a sigma.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// The sigmas of the error blocks for which an estimate matters: blocks without a sigma that have a
/// loss, whose scale is in sigmas, or that share a step with others, against which they are weighed.
class EstimatedNoise {
 public:
  /// Noise of the error blocks of each step.
  using OfSteps = std::vector<std::vector<BlockNoise>>;

  explicit EstimatedNoise(const Calibration& calibration);  ///< finds the blocks

  /// Fits, and fits again with the noise that residuals show as sigmas, until they stay.
  /// @param fit       takes nothing, gives the calibration's result, of any type
  /// @param noise_of  takes a result, gives OfSteps; empty if it has not converged
  template <class Fit, class NoiseOf>
  [[nodiscard]] auto settle(Calibration& calibration, const Fit& fit,
                            const NoiseOf& noise_of) const {
    constexpr int kRounds = 10;
    auto result = fit();
    for (int round = 0; round < kRounds && !blocks_.empty(); ++round) {
      if (!update(calibration, noise_of(result))) break;
      result = fit();
    }
    return result;
  }
  /// Forgets the estimates: each sigma is one.
  void reset(Calibration& calibration) const;
  /// The current sigmas.
  [[nodiscard]] std::vector<double> sigmas(const Calibration& calibration) const;

 private:
  /// Sets the noise that residuals show as sigmas, unless each stays within 1 % of its sigma.
  /// @param calibration  the one that was given to the constructor
  /// @param noise        of its steps; of a name that several have, the last one counts
  /// @returns  whether sigmas have changed, so that it should be solved again
  [[nodiscard]] bool update(Calibration& calibration, const OfSteps& noise) const;

  /// An error block of a step.
  struct Estimated {
    std::size_t step = 0;
    int term = 0;
  };
  std::vector<Estimated> blocks_;
};

}  // namespace kinecal
