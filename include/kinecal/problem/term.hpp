// The terms of the cost, independent of the scalar: error blocks with their sensors, weights and
// losses; and priors, which depend on parameters only.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/errors/loss.hpp"
#include "kinecal/errors/point_to_mesh.hpp"
#include "kinecal/errors/point_to_outline.hpp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/sensors/quantity.hpp"

namespace kinecal {

/// How a term enters the cost and the reports.
struct TermOptions {
  double scale = 1.0;  ///< factor of the residual: its weight is scale / sigma
  /// Standard deviation of a residual, in its unit; residuals are compared with it.  Empty: it counts as one
  /// until it is estimated (trust/calibrate_and_judge.hpp).  A feature's own sigma replaces it.
  std::optional<double> sigma = {};
  Loss loss = {};          ///< of each feature's weighted residual
  bool exclusive = false;  ///< use only samples in which no other sensor observes anything
  /// Use only samples with an observation of this sensor, too; empty: all samples.  It need not be a
  /// sensor of the problem, and does not count for `exclusive`: "ground" marks samples of the floor.
  std::string beside = {};
  std::string type =
      {};  ///< for reports: "chain3d_to_chain3d"; empty: the block's kType, or its name
  std::string unit = {};  ///< of the unweighted residual, for reports: "m", "px" or "1"; empty: the
                          ///< block's kUnit

  /// Factor of the residual by what was stated.
  [[nodiscard]] double weight() const { return scale / sigma.value_or(1.0); }
  /// The loss, or its convex substitute.
  [[nodiscard]] Loss loss_for(Losses losses) const {
    return losses == Losses::convex ? loss.convex() : loss;
  }
};

/// Residuals of one term in one sample, feature after feature, and their derivatives.
struct TermResiduals {
  Eigen::VectorXd residual;  ///< unweighted
  Eigen::VectorXd factor;    ///< of each residual, times the weight: the block's sigma over the
                             ///< feature's own; one for a feature without its own
  Eigen::MatrixXd jacobian;  ///< (residuals x free parameters); empty if not asked for
  /// Share of each residual's variance that poses of the sample's own use up; empty: it has none.
  Eigen::VectorXd used = {};

  /// Sets the residual (rows) to zero, and the Jacobian (rows x columns); columns < 0: no Jacobian.
  /// Factors are one.
  void resize(Eigen::Index rows, int columns) {
    residual.setZero(rows);
    factor.setOnes(rows);
    jacobian.setZero(columns >= 0 ? rows : 0, columns >= 0 ? columns : 0);
  }
};

/// The points at which derivatives are taken.
enum class Linearization {
  measured,   ///< the points that the sensors measured
  error_free  ///< measurements replaced by the model's prediction.  A nonzero residual rotates
              ///< with the robot and would make an undetermined parameter combination look
  ///< observable.  Residuals are those at the replaced points, so use the Jacobian only.
  ///< Planes are not replaced; pixels need not be, as their derivatives do not contain the
  ///< measurement.
};

/// The largest number of parameters, its own and its sensors', that an error block may depend on.
inline constexpr std::size_t kMostOwn = 32;

/// How a block that compares poses scales its six residuals: three of the translation, three of the rotation.
struct PoseScales {
  double per_metre = 1.0;   ///< residual of a translation by a metre
  double per_radian = 1.0;  ///< residual of a rotation by a radian
};

/// A term of the cost: an error block with the sensors that it compares.
struct Term {
  std::string name;          ///< of the error block
  TermOptions options = {};  ///< sigma, loss, names
  double sigma = 1.0;        ///< the stated one, or an estimate: standard deviation of a residual
  double weight = 1.0;  ///< scale / sigma; that of a feature with a sigma: scale / Feature::sigma
  std::vector<int> sensors =
      {};  ///< indices in the problem of those that are compared; may be empty
  std::vector<int> parameters = {};           ///< table indices of the block's own parameters
  std::span<const Quantity> quantities = {};  ///< the block's input from each of its sensors
  /// Names of the conditions, of a feature or its sample, that the block takes.
  std::span<const std::string_view> conditions = {};
  int feature_size = 1;  ///< number of residuals of one feature
  /// Of a block of poses that has scales: its residuals are distances and angles; empty for others.
  std::optional<PoseScales> pose_scales = {};

  /// True if it compares clouds or masks with the surface of the robot: features of a sample are judged as a whole.
  [[nodiscard]] bool is_of_surface() const {
    return options.type == PointToMesh::kType || options.type == PointToOutline::kType;
  }
  /// True if feature i is the same one for all sensors; false if all features of a sensor form one
  /// plane.
  [[nodiscard]] bool pairs_features() const {
    return quantities.empty() || quantities.front() != Quantity::plane;
  }
};

/// A prior with its weight and loss.
struct PriorTerm {
  std::string name;     ///< of the prior, for reports
  Prior prior;          ///< which parameters should stay small
  TermOptions options;  ///< sigma, loss, names

  /// Its unweighted residuals; they count once for each sample.
  /// @param values  of all parameters of the table
  /// @param free    the columns of the Jacobian; nullptr: residuals only
  void evaluate(const ParameterTable& table, ParameterValues values, const FreeSet* free,
                TermResiduals& out) const;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/problem/term.ipp"
#endif
