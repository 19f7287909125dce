// A calibration problem by the oracle: the residuals of error blocks and priors with their
// Jacobians, and the normal equations as a textbook has them, rows stacked and multiplied out.
//
// The formulas of the built-in blocks, of the losses and of the prior stand in oracle_problem.cpp a
// second time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <span>

#include "kinecal/errors.hpp"
#include "support/scene.hpp"

namespace kinecal::test {

using OracleJet = ceres::Jet<double, 54>;  ///< of all parameters of the widest table
using OracleResiduals = std::vector<OracleJet>;

/// What a sensor saw, carried to the base.
struct OracleView {
  const Sensor* sensor = nullptr;
  const Observation* seen = nullptr;
  const OracleValues<OracleJet>* values = nullptr;
  OraclePose<OracleJet> pose;              ///< of the sensor's own frame in the base
  std::vector<Vector3<OracleJet>> points;  ///< of each feature, in the base
  std::vector<bool> there;                 ///< false for a feature that is not a number

  /// The plane through its features.
  [[nodiscard]] OraclePlane<OracleJet> plane() const;
};

// The residuals of error blocks for features a and b.

OracleResiduals oracle_residual(const PointToPoint& block, const Vector3<OracleJet>& a,
                                const Vector3<OracleJet>& b);
/// Its coefficients are found from its value at four points; tests/errors holds them against those
/// that it was made of.
OracleResiduals oracle_residual(const PointToPlane& block, const Vector3<OracleJet>& p);
OracleResiduals oracle_residual(const PlaneToPlane& block, const OraclePlane<OracleJet>& a,
                                const OraclePlane<OracleJet>& b);
/// Feature i of a view in the image of a camera.
OracleResiduals oracle_residual(const PointToPixel& block, const OracleView& view,
                                const OracleView& camera, std::size_t i);
/// A block of the tests themselves.
template <class B, class... Points>
OracleResiduals oracle_residual(const B& block, const Points&... points) {
  const auto r = block(points...);
  return {r.data(), r.data() + r.size()};
}

/// All residuals of a block in one sample, features one after the other.
template <ErrorBlock B>
OracleResiduals oracle_residuals(const B& block, const std::vector<const OracleView*>& views) {
  if constexpr (PlanePairBlock<B>) {
    return oracle_residual(block, views[0]->plane(), views[1]->plane());
  } else {
    OracleResiduals all;
    for (std::size_t i = 0; i < views[0]->there.size(); ++i) {
      if (!views[0]->there[i] || !views.back()->there[i]) continue;
      OracleResiduals r;
      if constexpr (SightBlock<B>) {
        r = oracle_residual(block, *views[0], *views[1], i);
      } else if constexpr (PointPairBlock<B>) {
        r = oracle_residual(block, views[0]->points[i], views[1]->points[i]);
      } else {
        r = oracle_residual(block, views[0]->points[i]);
      }
      all.insert(all.end(), r.begin(), r.end());
    }
    return all;
  }
}

/// Residuals and Jacobian, a column for each parameter of the table, by term and sample.
using OracleRows = std::map<std::pair<int, int>, TermResiduals>;

/// Filled as a BasicProblem is.
class OracleProblem {
 public:
  OracleProblem(Robot robot, std::string base, ParameterTable table, std::vector<Sensor> sensors)
      : robot_(std::move(robot)),
        base_(std::move(base)),
        table_(std::move(table)),
        sensors_(std::move(sensors)) {}

  template <ErrorBlock B>
  void add_block(const std::string&, const B& block, const std::vector<std::string>& sensors,
                 const TermOptions& options = {}) {
    terms_.push_back({sensors, options, kResiduals<B>,
                      [block](const Views& views) { return oracle_residuals(block, views); }});
  }
  void add_prior(const std::string&, const Prior& prior, const TermOptions& options = {}) {
    priors_.emplace_back(prior, options);
  }
  void add_sample(const Sample& sample) { samples_.push_back(sample); }

  /// Of all terms and samples; none for a sample that a term does not take.
  [[nodiscard]] OracleRows rows(std::span<const double> x) const;

  /// rho' w^2 J^T J and so on, feature by feature.
  /// @param rows  those at x
  [[nodiscard]] NormalEquations multiplied_out(const OracleRows& rows, std::span<const double> x,
                                               const FreeSet& free,
                                               Losses losses = Losses::as_given) const;
  [[nodiscard]] NormalEquations multiplied_out(std::span<const double> x, const FreeSet& free,
                                               Losses losses = Losses::as_given) const {
    return multiplied_out(rows(x), x, free, losses);
  }

 private:
  using Views = std::vector<const OracleView*>;

  struct Term {
    std::vector<std::string> sensors;
    TermOptions options;
    int size;  ///< residuals of a feature
    std::function<OracleResiduals(const Views&)> residuals;
  };

  [[nodiscard]] OracleView view(const std::string& name, const Sample& sample,
                                const OracleValues<OracleJet>& values) const;
  /// A row for the joint and for each axis of the frame, zero where there is no such parameter.
  [[nodiscard]] TermResiduals prior_rows(const Prior& prior, std::span<const double> x) const;

  Robot robot_;
  std::string base_;
  ParameterTable table_;
  std::vector<Sensor> sensors_;
  std::vector<Term> terms_;
  std::vector<std::pair<Prior, TermOptions>> priors_;
  std::vector<Sample> samples_;
};

/// The robot, sensors and parameters of a problem of the scene, without error blocks and samples.
template <class S>
OracleProblem oracle_of(const BasicProblem<S>& problem) {
  std::vector<Sensor> sensors;
  for (const SensorModel& model : problem.sensors()) sensors.push_back(model.sensor());
  const std::string base = problem.sensors().front().chains().front().base;
  return {mobile_manipulator(), base, problem.table(), sensors};
}

/// Rows of the code under test are those of the oracle.
/// @param residual  an error that rounding may make in a residual; of a Jacobian: relative
/// @param either_sign  a plane's normal has no sign
inline void expect_rows_of_oracle(const TermResiduals& found, const TermResiduals& expected,
                                  double residual, double jacobian, bool either_sign = false) {
  ASSERT_EQ(found.residual.size(), expected.residual.size());
  ASSERT_EQ(found.jacobian.rows(), expected.jacobian.rows());
  ASSERT_EQ(found.jacobian.cols(), expected.jacobian.cols());
  const double sign = either_sign && found.residual.dot(expected.residual) < 0.0 ? -1.0 : 1.0;
  EXPECT_LE((found.residual - sign * expected.residual).norm(), residual)
      << "kinecal\n"
      << found.residual.transpose() << "\noracle\n"
      << sign * expected.residual.transpose();
  EXPECT_LE((found.jacobian - sign * expected.jacobian).norm(),
            jacobian * (1.0 + expected.jacobian.norm()))
      << "kinecal\n"
      << found.jacobian << "\noracle\n"
      << sign * expected.jacobian;
}

}  // namespace kinecal::test
