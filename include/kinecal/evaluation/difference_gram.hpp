// The matrix K of local_sums.hpp for points that are only subtracted: r = p_a - p_b.
//
// With derivatives I and -I, the sums over the features are moments of the points.  Taken about the
// center of each side's points, translation and rotation decouple:
//
//   force   sum w v = W v,  the same on both sides
//   moment  sum w q x (u x p) = (tr C - C) u      C = sum w p q^T
//
// for a twist (v, u) whose linear part v is the velocity of the center.  The twists of the second
// side are negated, so that both sides add up.  fetch_calibration_bench prints how much this saves
// compared with multiplying rows.
// Source: Euler's equations of a rigid body.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal {

/// The matrix K of features that are only subtracted; the interface is that of FeatureGram.
template <class S>
class DifferenceGram {
 public:
  static constexpr bool kShiftsFeltAsForces = true;  ///< a translation has no moment
  /// Where effects() puts the force, the same for both bodies.
  [[nodiscard]] static constexpr std::size_t force(std::size_t) { return 0; }
  /// Where effects() puts the moment on a body.
  [[nodiscard]] static constexpr std::size_t moment(std::size_t body) { return 3 + 3 * body; }
  /// Where effects() puts the products with own parameters' columns and with the residual.
  [[nodiscard]] static constexpr std::size_t rest() { return 9; }
  /// Number of rows that effects() writes.
  [[nodiscard]] std::size_t width() const { return rest() + columns_.size(); }
  /// Products of the column of own parameter c with those from it on, and with the residual.
  [[nodiscard]] const S* own_row(std::size_t c) const {
    return &products_[c * columns_.size() + c];
  }

  /// One side of the difference: consecutive features of a sensor.
  struct Side {
    const Vector3<S>* points;   ///< of each feature, metres, in the base
    const Vector3<S>* changes;  ///< of each feature by each own parameter, in the base
    std::size_t own;            ///< number of these parameters
  };

  /// Sums consecutive features on the same chains.
  /// @param weights    of each feature
  /// @param residuals  (3) of each feature, metres
  void set(const Side& a, const Side& b, std::span<const S> weights,
           std::span<const Vector3<S>> residuals) {
    set_points({a.points, b.points}, weights);
    const std::size_t features = weights.size(), own = a.own + b.own;
    columns_.resize(own + 1);
    forces_.resize(columns_.size() * features);
    products_.resize(columns_.size() * columns_.size());
    const auto change = [&](std::size_t c) {
      return c < a.own ? Strided{a.changes + c, a.own, 1.0}
                       : Strided{b.changes + (c - a.own), b.own, -1.0};
    };
    for (std::size_t c = 0; c < own; ++c) set_column(c, change(c), weights);
    set_column(own, {residuals.data(), 1, 1.0}, weights);
    for (std::size_t c = 0; c < own; ++c) set_products(c, change(c), features);
  }

  /// The twists of both sides as K takes them: linear parts at the centers, the second side
  /// negated.
  /// @returns  views into this object
  [[nodiscard]] std::array<BodyTwists<S>, 2> centered(const std::array<BodyTwists<S>, 2>& twists) {
    for (std::size_t s = 0; s < 2; ++s) {
      std::vector<Twist<S>>& turns = centered_[s].rotational;
      turns.resize(twists[s].rotational.size());
      for (std::size_t i = 0; i < turns.size(); ++i) {
        const Twist<S>& t = twists[s].rotational[i];
        const Vector3<S> v = t.velocity(centers_[s]);
        turns[i].linear = s == 0 ? v : Vector3<S>(-v);
        turns[i].angular = s == 0 ? t.angular : Vector3<S>(-t.angular);
      }
    }
    std::vector<Vector3<S>>& shifts = centered_[1].translational;
    shifts.resize(twists[1].translational.size());
    for (std::size_t i = 0; i < shifts.size(); ++i) shifts[i] = -twists[1].translational[i];
    return {BodyTwists<S>{centered_[0].rotational, twists[0].translational}, BodyTwists<S>(centered_[1])};
  }

  /// K xi of R twists of a body: see FeatureGram.  With D = 3 it does not write moments.
  template <int D, int R>
  void effects(std::size_t body, const S* xi, S* __restrict effects) const {
    const S weight = weight_;
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t r = 0; r < R; ++r) effects[d * R + r] = weight * xi[r * D + d];
    }
    if constexpr (D == 6) {
      for (std::size_t b = body; b < 2; ++b) {
        const S* inertia = inertia_[body + b].data();
        S* moments = effects + R * moment(b);
        for (std::size_t k = 0; k < 3; ++k, inertia += 3, moments += R) {
          for (std::size_t r = 0; r < R; ++r) moments[r] = dot(inertia, xi + r * D + 3);
        }
      }
    }
    effects += R * rest();
    const Column *column = columns_.data(), *end = column + columns_.size();
    for (; column != end; ++column, effects += R) {
      for (std::size_t r = 0; r < R; ++r) {
        S felt = dot(column->force.data(), xi + r * D);
        if constexpr (D == 6) felt += dot(column->moment[body].data(), xi + r * D + 3);
        effects[r] = felt;
      }
    }
  }

 private:
  /// A vector of each feature, with a sign.
  struct Strided {
    const Vector3<S>* first;
    std::size_t stride;
    double sign;
  };
  /// Force and moments of an own parameter, or of the residual, on both sides.
  struct Column {
    Vector3<S> force;
    std::array<Vector3<S>, 2> moment;  ///< about the centers
  };

  void set_points(const std::array<const Vector3<S>*, 2>& points, std::span<const S> weights) {
    weight_ = S(0.0);
    for (const S& w : weights) weight_ += w;
    const S share = S(1.0) / select(weight_ > S(0.0), weight_, S(1.0));
    for (std::size_t s = 0; s < 2; ++s) {
      const Vector3<S>* p = points[s];
      Vector3<S> sum = Vector3<S>::Zero();
      for (std::size_t i = 0; i < weights.size(); ++i) add_scaled(sum, p[i], weights[i]);
      const Vector3<S> center(sum(0) * share, sum(1) * share, sum(2) * share);
      from_center_[s].resize(weights.size());
      Vector3<S>* from_center = from_center_[s].data();
      for (std::size_t i = 0; i < weights.size(); ++i) from_center[i] = p[i] - center;
      centers_[s] = center;
    }
    set_inertia<true>(inertia_[0], from_center_[0].data(), from_center_[0].data(), weights);
    set_inertia<false>(inertia_[1], from_center_[1].data(), from_center_[0].data(), weights);
    set_inertia<true>(inertia_[2], from_center_[1].data(), from_center_[1].data(), weights);
  }

  /// sum w (p^T q I - p q^T).
  /// @tparam Same  true if p and q are the same points: only one triangle is summed
  template <bool Same>
  static void set_inertia(Matrix3<S>& inertia, const Vector3<S>* p, const Vector3<S>* q,
                          std::span<const S> weights) {
    Matrix3<S> c = Matrix3<S>::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i, ++p, ++q) {
      for (int col = 0; col < 3; ++col) {
        const S scaled = (*q)(col)*weights[i];
        for (int row = Same ? col : 0; row < 3; ++row) c(row, col) += (*p)(row)*scaled;
      }
    }
    const S trace = c(0, 0) + c(1, 1) + c(2, 2);
    for (int col = 0; col < 3; ++col) {
      inertia(col, col) = trace - c(col, col);
      for (int row = Same ? col + 1 : 0; row < 3; ++row) {
        if (row == col) continue;
        inertia(row, col) = -c(row, col);
        if constexpr (Same) inertia(col, row) = inertia(row, col);
      }
    }
  }

  /// @param x  (3) of each feature: its change by a parameter, or its residual
  void set_column(std::size_t c, const Strided& x, std::span<const S> weights) {
    const Vector3<S>*p_a = from_center_[0].data(), *p_b = from_center_[1].data(), *v = x.first;
    Vector3<S>* forces = &forces_[c * weights.size()];
    Vector3<S> force = Vector3<S>::Zero(), about_a = force, about_b = force;
    for (const S& weight : weights) {
      const S w = x.sign < 0.0 ? S(-weight) : weight;
      const Vector3<S> f((*v)(0) * w, (*v)(1) * w, (*v)(2) * w);
      force += f;
      add_cross(about_a, *p_a++, f);
      add_cross(about_b, *p_b++, f);
      *forces++ = f;
      v += x.stride;
    }
    columns_[c] = {force, {about_a, about_b}};
  }

  /// The products of own parameter c with itself and those after it, and with the residual.
  void set_products(std::size_t c, const Strided& x, std::size_t features) {
    const Vector3<S>* forces = &forces_[c * features];
    const std::size_t columns = columns_.size();
    for (S *product = &products_[c * columns + c], *end = &products_[c * columns] + columns;
         product != end; ++product) {
      S sum(0.0);
      const Vector3<S>* u = x.first;
      for (std::size_t i = 0; i < features; ++i, u += x.stride) {
        sum += dot(u->data(), (forces++)->data());
      }
      *product = x.sign < 0.0 ? S(-sum) : sum;
    }
  }

  [[nodiscard]] static S dot(const S* u, const S* v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  }
  static void add_scaled(Vector3<S>& sum, const Vector3<S>& p, const S& factor) {
    for (int k = 0; k < 3; ++k) sum(k) += p(k) * factor;
  }
  static void add_cross(Vector3<S>& sum, const Vector3<S>& p, const Vector3<S>& f) {
    sum = {sum.x() + p.y() * f.z() - p.z() * f.y(),  // two fused multiply-adds each
           sum.y() + p.z() * f.x() - p.x() * f.z(), sum.z() + p.x() * f.y() - p.y() * f.x()};
  }

  S weight_;                           ///< sum over all features
  std::array<Vector3<S>, 2> centers_;  ///< of the points of both sides, in the base
  std::array<Matrix3<S>, 3> inertia_;  ///< first, mixed, second
  std::vector<Column> columns_;        ///< of each own parameter and the residual
  std::vector<S> products_;            ///< of all pairs of columns: the upper triangle
  std::array<std::vector<Vector3<S>>, 2> from_center_;  ///< each point, relative
  std::vector<Vector3<S>> forces_;   ///< weight times motion, column by column
  std::array<ChainTwists<S>, 2> centered_;
};

}  // namespace kinecal
