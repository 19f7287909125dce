// Residuals of samples with changing measurements, for exact_samples.cpp and sample_design.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"

namespace kinecal::detail {

/// Place of features that share their rows: those of planes.
inline constexpr int kAllPlaces = -1;

/// The point about which all features of an observation turn: the first that is a number; the origin if none is.
[[nodiscard]] inline Vector3<double> pivot_of(const Observation& seen) {
  for (const Feature& feature : seen.features) {
    if (feature.point.allFinite()) return feature.point;
  }
  return Vector3<double>::Zero();
}

/// Rows of one feature in one sample: sample, term, place.
using FeatureKey = std::tuple<int, int, int>;

/// Rows of all features.
struct StudyRows {
  std::map<FeatureKey, Eigen::VectorXd> residual;  ///< weighted
  std::map<FeatureKey, Eigen::MatrixXd>
      jacobian;  ///< weighted, by the free parameters, if asked for
};

/// Samples with changing measurements, and their residuals.
class ChangingSamples {
 public:
  ChangingSamples(const MakeProblem& make, ParameterValues values, std::span<const Sample> samples)
      : make_(make), values_(values), empty_(make()) {
    for (const Sample& sample : samples) {
      samples_.push_back(empty_->paired(sample).value_or(sample));
    }
    measuring_ = measuring_sensors(*empty_, samples_);
  }

  /// The samples in their current state.
  [[nodiscard]] std::vector<Sample>& samples() { return samples_; }
  /// The problem without samples.
  [[nodiscard]] const AnyProblem& problem() const { return *empty_; }
  /// See measuring_sensors().
  [[nodiscard]] const std::set<std::string>& measuring() const { return measuring_; }

  /// True if some block takes all features of a sensor as one plane.
  [[nodiscard]] bool takes_planes(const std::string& sensor) const {
    for (int t = 0; t < empty_->num_terms(); ++t) {
      if (empty_->term(t).pairs_features()) continue;
      for (const int s : empty_->term(t).sensors) {
        if (empty_->sensors()[static_cast<std::size_t>(s)].mount().name == sensor) return true;
      }
    }
    return false;
  }

  /// The rows of these samples.
  /// @param free  columns of the Jacobian; nullptr: residuals only
  [[nodiscard]] StudyRows rows(const std::vector<Sample>& samples,
                               const FreeSet* free = nullptr) const {
    const std::unique_ptr<AnyProblem> problem = make_();
    for (const Sample& sample : samples) problem->add_sample(sample);
    const FreeSet none({}, problem->table().size());
    StudyRows rows;
    const auto visit = [&](int term, int sample, const TermResiduals& of_term) {
      add(*problem, term, sample, of_term, rows);
    };
    const auto undefined = problem->evaluator(free != nullptr ? *free : none, 1)
                               ->evaluate(values_, free != nullptr, visit);
    if (undefined) {
      throw StudyError(undefined->source + ": error block '" + undefined->term +
                       "': its residual is undefined for the true robot, such as that of a point "
                       "behind a camera");
    }
    return rows;
  }

  /// The samples with features of one sensor changed.
  /// @param change  of a sample, an observation and a place: nullopt if absent
  template <class Change>
  [[nodiscard]] std::vector<Sample> with(const std::string& sensor, const Change& change,
                                         double factor) const {
    std::vector<Sample> result = samples_;
    for (std::size_t s = 0; s < result.size(); ++s) {
      for (Observation& seen : result[s].observations) {
        if (seen.sensor != sensor) continue;
        for (std::size_t i = 0; i < seen.features.size(); ++i) {
          const std::optional<FeatureChange> of = change(s, seen, i);
          if (of) seen.features[i] = changed(seen.features[i], *of, factor);
        }
      }
    }
    return result;
  }

 private:
  static void add(const AnyProblem& problem, int term, int sample, const TermResiduals& of_term,
                  StudyRows& rows) {
    const Term& is = problem.term(term);
    const double weight = is.weight;
    const Eigen::Index size = is.pairs_features() ? is.feature_size : of_term.residual.size();
    for (Eigen::Index row = 0; size > 0 && row < of_term.residual.size(); row += size) {
      const int place =
          is.pairs_features() ? problem.feature(term, sample, row / size).place : kAllPlaces;
      const Eigen::VectorXd factor = weight * of_term.factor.segment(row, size);
      const FeatureKey key(sample, term, place);
      rows.residual[key] = factor.cwiseProduct(of_term.residual.segment(row, size));
      if (of_term.jacobian.size() == 0) continue;
      rows.jacobian[key] = factor.asDiagonal() * of_term.jacobian.middleRows(row, size);
    }
  }

  const MakeProblem& make_;
  std::span<const double> values_;
  std::unique_ptr<AnyProblem> empty_;
  std::vector<Sample> samples_;
  std::set<std::string> measuring_;
};

}  // namespace kinecal::detail
