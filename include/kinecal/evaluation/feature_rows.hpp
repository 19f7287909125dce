// The residual of one feature and its derivatives, before kinematics: the only format of rows.
//
// For any error block, a residual changes only because rigid bodies move (one per sensor:
// everything at the end of its chain), or because parameters of sensors or of the block change:
//
//   dr = sum over bodies of  by_body (v, w)  +  sum over own parameters of  by_own dk
//
// with the twist (v, w) of the body in the base.  A point p with dr = D dp gives by_body =
// D [I, -[p]x]: a row d of D becomes (d, p x d).  The free parameters of a chain enter later, once
// for all features: see local_sums.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/evaluation/sensor_view.hpp"
#include "kinecal/problem/term.hpp"

namespace kinecal::detail {

/// Residual of one feature and its derivatives.
template <class S, int M, int Bodies>
struct FeatureRows {
  S weight{1.0};                    ///< one, or zero where the feature is missing
  Eigen::Matrix<S, M, 1> residual;  ///< (M) unweighted
  std::array<Eigen::Matrix<S, M, 6>, Bodies> by_body;   ///< by linear, by angular
  std::array<Eigen::Matrix<S, M, 1>, kMostOwn> by_own;  ///< by each free parameter of sensors and
                                                        ///< block
  std::size_t own = 0;                                  ///< number of them

  /// Sets the rows of a body with one point.
  /// @param p         (3) in the base, metres
  /// @param by_point  (M x 3) derivative of the residual with respect to it: D
  void set_point(std::size_t body, const Vector3<S>& p, const Eigen::Matrix<S, M, 3>& by_point) {
    for (int row = 0; row < M; ++row) {
      const Vector3<S> d = by_point.row(row);
      by_body[body].row(row) << d.transpose(), cross(p, d).transpose();
    }
  }
  /// Adds the contribution of a vector that only rotates with the body.
  /// @param x     (3) the vector, in the base
  /// @param by_x  (M x 3) derivative of the residual with respect to it
  void add_vector(std::size_t body, Change change, const Vector3<S>& x,
                  const Eigen::Matrix<S, M, 3>& by_x) {
    if (change == Change::number) return;
    for (int row = 0; row < M; ++row) {
      const Vector3<S> d = by_x.row(row), moment = change == Change::rotation ? d : cross(x, d);
      by_body[body].row(row).template tail<3>() += moment.transpose();
    }
  }
};

/// The largest number of sensors of an error block.
inline constexpr std::size_t kMostBodies = 4;
/// The bodies of a feature, one per sensor of the error block: the chain that ends there.
using BodyChains = std::array<std::size_t, kMostBodies>;

/// Consecutive features of a layout on the same chains.
struct FeatureRun {
  std::size_t first = 0;  ///< index of the first feature
  std::size_t end = 0;    ///< index after the last one
  BodyChains chains{};    ///< of each sensor
  /// Columns of the whole Jacobian that affect them, in this order: parameters of the sensors and
  /// of the block, rotational twists of each body, translational twists of each body.  A parameter
  /// that moves several bodies occurs several times.
  std::vector<int> columns;
};

/// The runs of a term's features in the samples of a layout.
/// @param sensors  of the problem
/// @param own      parameters of the block itself
[[nodiscard]] std::vector<FeatureRun> feature_runs(const Term& term, const SampleLayout& layout,
                                                   std::span<const SensorState> sensors,
                                                   const OwnParameters& own);

/// A term, its sensors as they see a batch, and its own parameters.
template <class S>
struct TermViews {
  const Term* term = nullptr;                               ///< weight and names
  std::array<const SensorView<S>*, kMostBodies> sensors{};  ///< of the term, in its order
  const OwnParameters* own = nullptr;                       ///< of the block itself
  std::span<const FeatureRun> runs;                         ///< of the features, in their order
  BatchTerm<S> numbers = {};                                ///< its further inputs in the batch

  [[nodiscard]] const SensorView<S>& operator[](std::size_t s) const { return *sensors[s]; }

  /// Number of features that are compared.
  [[nodiscard]] std::size_t features() const { return runs.back().end; }
  /// Number of free parameters of sensors and block that affect a feature.
  [[nodiscard]] std::size_t num_own() const {
    std::size_t n = own->free.size();
    for (std::size_t s = 0; s < term->sensors.size(); ++s) n += sensors[s]->own().free.size();
    return n;
  }
};

/// Writes the derivatives of a feature, column after column: by_own, and by_body xi for all twists.
/// @param out  (M x columns), column-major
template <class S, int M, int Bodies, class Twists>
void write_columns(const FeatureRows<S, M, Bodies>& rows, const Twists& twists, S* out) {
  for (std::size_t c = 0; c < rows.own; ++c) {
    for (int m = 0; m < M; ++m) *out++ = rows.by_own[c](m);
  }
  for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
    const Eigen::Matrix<S, M, 6>& l = rows.by_body[s];
    for (const Twist<S>& t : twists[s]->rotational) {
      for (int m = 0; m < M; ++m) {
        *out++ = (l(m, 0) * t.linear.x() + l(m, 1) * t.linear.y() + l(m, 2) * t.linear.z()) +
                 (l(m, 3) * t.angular.x() + l(m, 4) * t.angular.y() + l(m, 5) * t.angular.z());
      }
    }
  }
  for (std::size_t s = 0; s < static_cast<std::size_t>(Bodies); ++s) {
    const Eigen::Matrix<S, M, 6>& l = rows.by_body[s];
    for (const Vector3<S>& v : twists[s]->translational) {
      for (int m = 0; m < M; ++m) {
        *out++ = l(m, 0) * v.x() + l(m, 1) * v.y() + l(m, 2) * v.z();
      }
    }
  }
}

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/feature_rows.ipp"
#endif
