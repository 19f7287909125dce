// A term of the cost, independent of the scalar: an error block's name, sensors, weight and loss.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/normal_equations.hpp"
#include "kinecal/crate/packed_sample.hpp"
#include "kinecal/errors/loss.hpp"

namespace kinecal {

/// How a term enters the cost and reports.
struct TermOptions {
  double weight = 1.0;  ///< factor of the residual: scale / sigma
  Loss loss = {};       ///< of each feature's weighted residual
  bool alone = false;   ///< use only samples in which no other sensor observes anything
  /// Use only samples with an observation of this sensor, too; empty: all samples.  It need not be a
  /// sensor of the problem, and does not count for `alone`: "ground" marks samples of the floor.
  std::string beside = {};
  std::string type = {};   ///< for reports: "chain3d_to_chain3d"
  std::string unit = "m";  ///< of the unweighted residual, for reports: "m", "px" or "1"

  /// The loss, or its convex substitute.
  [[nodiscard]] Loss loss_for(Losses losses) const {
    return losses == Losses::convex ? loss.convex() : loss;
  }
};

/// Residuals of one term in one sample, feature after feature, and their derivatives.
struct TermResiduals {
  Eigen::VectorXd residual;  ///< unweighted
  Eigen::MatrixXd jacobian;  ///< (residuals x free parameters); empty if not asked for

  /// Sets the residual (rows) to zero, and the Jacobian (rows x columns); columns < 0: no Jacobian.
  void resize(Eigen::Index rows, int columns) {
    residual.setZero(rows);
    jacobian.setZero(columns >= 0 ? rows : 0, columns >= 0 ? columns : 0);
  }
};

/// At which points derivatives are taken.
enum class Linearization {
  measured,   ///< the points that the sensors measured
  error_free  ///< measurements replaced by the model's prediction.  A residual that is not zero
              ///< turns with the robot, so a parameter combination that no measurement determines
              ///< would still look observable.  Planes are taken as they are.
};

/// A term, independent of the scalar: its name, its sensors, and which samples it takes.
class AnyTerm {
 public:
  /// What the sensors of the term observed in one sample, in their order.
  using Observations = std::span<const PackedObservation<double>* const>;

  /// @param sensors  indices of the sensors in the problem
  AnyTerm(std::string name, std::vector<int> sensors, TermOptions options)
      : name_(std::move(name)), sensors_(std::move(sensors)), options_(std::move(options)) {}
  virtual ~AnyTerm() = default;

  [[nodiscard]] const std::string& name() const { return name_; }  ///< of the error block
  /// Indices in the problem of the sensors that are compared.
  [[nodiscard]] const std::vector<int>& sensors() const { return sensors_; }
  [[nodiscard]] const TermOptions& options() const { return options_; }  ///< weight, loss, names

  /// Number of residuals of one feature.
  [[nodiscard]] virtual int feature_size() const = 0;
  /// True if feature i of one sensor is compared with feature i of the other.
  [[nodiscard]] virtual bool pairs_features() const = 0;
  /// Number of features that can be compared, given what the sensors observed.
  [[nodiscard]] virtual int count(Observations seen) const = 0;
  /// Why the block cannot take these observations of one sample; empty if it can.
  [[nodiscard]] virtual std::string why_not(Observations seen) const = 0;

 private:
  std::string name_;
  std::vector<int> sensors_;
  TermOptions options_;
};

}  // namespace kinecal
