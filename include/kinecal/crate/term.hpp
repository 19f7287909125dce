// A term of the cost: an error block with the sensors it compares, its weight and its loss.
//
// The block is known at compile time, the term hides it: a problem holds terms of different blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kinecal/crate/sensor_view.hpp"
#include "kinecal/errors/error_block.hpp"
#include "kinecal/errors/loss.hpp"
#include "kinecal/errors/plane_fit.hpp"

namespace kinecal {

struct TermOptions {
  double weight = 1.0;     ///< the residual is multiplied by it: scale / sigma
  Loss loss = {};          ///< of each feature's weighted residual
  bool alone = false;      ///< only samples in which no other sensor observes
  std::string type = {};   ///< for reports: "chain3d_to_chain3d"
  std::string unit = "m";  ///< of the unweighted residual, for reports: "m", "px" or "1"
};

/// Residuals of one term in one sample, features one after the other, and their derivatives.
struct TermResiduals {
  Eigen::VectorXd residual;  ///< unweighted
  Eigen::MatrixXd jacobian;  ///< rows as the residual, a column for each free parameter

  void resize(Eigen::Index rows, int columns) {
    residual.setZero(rows);
    jacobian.setZero(columns >= 0 ? rows : 0, columns >= 0 ? columns : 0);
  }
};

/// At which points derivatives are taken.
enum class Linearization {
  measured,   ///< those that the sensors saw
  error_free  ///< measurements replaced by the model's prediction.  With residuals, a change that
              ///< no measurement shows still turns them and looks as if it could be seen.  Planes
              ///< are taken as they are.
};

class Term {
 public:
  Term(std::string name, std::vector<int> sensors, TermOptions options)
      : name_(std::move(name)), sensors_(std::move(sensors)), options_(std::move(options)) {}
  virtual ~Term() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<int>& sensors() const { return sensors_; }
  [[nodiscard]] const TermOptions& options() const { return options_; }

  /// Number of residuals of one feature.
  [[nodiscard]] virtual int feature_size() const = 0;
  /// True if feature i of one sensor is compared with feature i of the other.
  [[nodiscard]] virtual bool pairs_features() const = 0;
  /// Features that can be compared, given what the sensors observed.
  [[nodiscard]] virtual int count(std::span<const PackedObservation* const> seen) const = 0;
  /// Why the block cannot take these observations of one sample; empty if it can.
  [[nodiscard]] virtual std::string why_not(
      std::span<const PackedObservation* const> seen) const = 0;
  /// @param columns  number of free parameters; -1: no derivatives
  /// @returns  false where the residual is not defined (a point behind a camera)
  [[nodiscard]] virtual bool evaluate(std::span<const SensorView* const> views, int columns,
                                      Linearization at, TermResiduals& out) const = 0;

 protected:
  /// Indices of the features that all sensors have.
  [[nodiscard]] static std::vector<std::size_t> usable(
      std::span<const PackedObservation* const> seen) {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < seen[0]->usable.size(); ++i) {
      bool all = true;
      for (const PackedObservation* o : seen) all = all && o->usable[i];
      if (all) indices.push_back(i);
    }
    return indices;
  }

  [[nodiscard]] static std::vector<std::size_t> usable(std::span<const SensorView* const> views) {
    std::vector<const PackedObservation*> seen;
    for (const SensorView* view : views) seen.push_back(&view->observation());
    return usable(seen);
  }

 private:
  std::string name_;
  std::vector<int> sensors_;
  TermOptions options_;
};

namespace detail {

/// Three jets for a point, whose variables start at `first`.
template <class J>
[[nodiscard]] Vector3<J> point_jets(const Vector3<double>& p, int first) {
  return {J(p.x(), first), J(p.y(), first + 1), J(p.z(), first + 2)};
}

/// Values of a residual, and derivatives of its rows with respect to `Width` variables from
/// `first`.
template <int M, class S>
[[nodiscard]] Eigen::Matrix<double, M, 1> values(const Eigen::Matrix<S, M, 1>& r) {
  Eigen::Matrix<double, M, 1> result;
  for (int i = 0; i < M; ++i) result(i) = value_of(r(i));
  return result;
}

template <int Width, int M, class J>
[[nodiscard]] Eigen::Matrix<double, M, Width> derivatives(const Eigen::Matrix<J, M, 1>& r,
                                                          int first) {
  Eigen::Matrix<double, M, Width> result;
  for (int i = 0; i < M; ++i) {
    result.row(i) = r(i).v.template segment<Width>(first).transpose();
  }
  return result;
}

}  // namespace detail
}  // namespace kinecal
