// Variants of one sample, evaluated at the values of a fit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/trust/capture_causes.hpp"

namespace kinecal::detail {

/// A compared feature of a sample.
struct TrialFeature {
  int number = 0;     ///< from 0, in its observation; -1 if the error block does not pair features
  int size = 1;       ///< residuals
  double chi2 = 0.0;  ///< squared distance in standard deviations
};

/// A sample's residuals.
struct TrialRows {
  Eigen::VectorXd rows;                ///< in standard deviations of the noise
  std::vector<TrialFeature> features;  ///< of all error blocks
  bool defined = true;                 ///< all of them could be evaluated

  /// Beyond this a feature is bad: the limit of captures.hpp for the features of one sample.
  [[nodiscard]] double limit(const TrialFeature& feature) const {
    constexpr double kFalse = 1e-3;
    const double k = feature.size, t = std::log(static_cast<double>(features.size()) / kFalse);
    return k + 2.0 * std::sqrt(k * t) + 2.0 * t;
  }
  [[nodiscard]] int bad() const {
    return static_cast<int>(
        std::count_if(features.begin(), features.end(),
                      [&](const TrialFeature& feature) { return feature.chi2 > limit(feature); }));
  }
  /// True if all features are within the noise and the uncertainty of the values.
  [[nodiscard]] bool fits() const {
    constexpr double kSlack = 1.5 * 1.5, kSlackOfAll = 1.5;
    const double n = static_cast<double>(rows.size());
    return defined && rows.squaredNorm() <= kSlackOfAll * (n + 4.0 * std::sqrt(2.0 * n)) &&
           std::all_of(features.begin(), features.end(), [&](const TrialFeature& feature) {
             return feature.chi2 <= kSlack * limit(feature);
           });
  }
  [[nodiscard]] const TrialFeature& worst() const {
    return *std::max_element(
        features.begin(), features.end(),
        [](const TrialFeature& a, const TrialFeature& b) { return a.chi2 < b.chi2; });
  }
};

/// Evaluates variants of a sample.
class CaptureTrials {
 public:
  CaptureTrials(const AnyProblem& problem, ParameterValues values,
                const std::vector<BlockNoise>& noise)
      : problem_(problem), values_(values), noise_(noise) {}

  /// @returns  rows of each variant, in their order
  [[nodiscard]] std::vector<TrialRows> operator()(const std::vector<Sample>& variants) const {
    std::vector<TrialRows> all(variants.size());
    std::vector<std::size_t> numbers;  // of the samples that the problem takes
    const std::unique_ptr<AnyProblem> problem = problem_.without_samples();
    for (std::size_t i = 0; i < variants.size(); ++i) {
      try {
        problem->add_sample(variants[i]);
        numbers.push_back(i);
      } catch (const SampleError&) {
        all[i].defined = false;
      }
    }
    std::vector<std::vector<double>> rows(variants.size());
    (void)evaluate(
        *problem, values_, nullptr, [&](int term, int sample, const TermResiduals& residuals) {
          const std::size_t of = numbers[static_cast<std::size_t>(sample)];
          const auto label = [&](Eigen::Index i) { return problem->feature(term, sample, i); };
          add(problem->term(term), noise_[static_cast<std::size_t>(term)], residuals, label,
              all[of], rows[of]);
        });
    for (std::size_t i = 0; i < variants.size(); ++i) {
      all[i].rows = Eigen::Map<const Eigen::VectorXd>(rows[i].data(), std::ssize(rows[i]));
      const bool complete = !rows[i].empty() && rows[i].size() >= rows[0].size();
      all[i].defined = all[i].defined && complete && all[i].rows.allFinite();
    }
    return all;
  }

 private:
  template <class LabelOf>
  static void add(const Term& term, const BlockNoise& noise, const TermResiduals& residuals,
                  const LabelOf& label, TrialRows& to, std::vector<double>& rows) {
    constexpr double kRounding = 1e-9;  // of exact data, as in captures.cpp
    const double sigma = std::max(noise.robust > 0.0 ? noise.robust : noise.sigma,
                                  kRounding * std::max(noise.unit_sigma, 1e-3));
    const int size = term.feature_size;
    for (Eigen::Index row = 0; row + size <= residuals.residual.size(); row += size) {
      TrialFeature feature{term.pairs_features() ? label(row / size).place : -1, size, 0.0};
      for (Eigen::Index k = row; k < row + size; ++k) {
        rows.push_back(residuals.residual(k) * residuals.factor(k) / sigma);
        feature.chi2 += rows.back() * rows.back();
      }
      to.features.push_back(feature);
    }
  }

  const AnyProblem& problem_;
  std::span<const double> values_;
  const std::vector<BlockNoise>& noise_;
};

}  // namespace kinecal::detail
