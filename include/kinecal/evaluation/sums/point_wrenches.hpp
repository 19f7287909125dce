// Normal-equation sums for p_a − p_b, and its Jacobian.
//
// With derivatives I and -I, the sums over the features are moments of the points.  About the
// center of each side's points, translation and rotation decouple:
//
//   force   sum w v = W v,  the same on both sides
//   moment  sum w q x (u x p) = (tr C - C) u      C = sum w p q^T
//
// for a twist (v, u) whose linear part v is the velocity of the center.  The second side moves the
// other way: its twists are (-v, u), and its moments are negated.  Features are scaled by the
// square root of their weights and velocities by that of W, so a velocity equals its force.
// Source: Euler's equations of a rigid body.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "kinecal/evaluation/sums/local_sums.hpp"
#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal::detail {

/// One side of a difference r = p_a - p_b: points in the base, and their motion by each parameter.
template <class S>
struct DifferenceSide {
  const Vector3<S>* points;  ///< of each feature, metres
  /// Derivatives of each point by the sensor's own parameters, feature by feature: metres per unit.
  const Vector3<S>* changes;
  std::size_t own = 0;                     ///< number of those parameters
  const ChainTwists<S>* twists = nullptr;  ///< of the body of the points
};

/// Writes the derivatives of a difference, column by column: velocities of the points.  Loads each
/// twist once for all features.
/// @param first  index of the first feature
/// @param out    (3 x columns) of each of kFeatures features, column-major
template <std::size_t kFeatures, class S>
void write_differences(const std::array<DifferenceSide<S>, 2>& sides, std::size_t first,
                       std::size_t columns, S* out) {
  // Copies vectors number by number, into registers: copying a whole one goes through memory.
  const auto write = [&out, stride = 3 * columns](std::size_t count, const auto& column) {
    for (std::size_t k = 0; k < count; ++k, out += 3) {
      const auto of_feature = column(k);
      for (std::size_t f = 0; f < kFeatures; ++f) {
        const Vector3<S> v = of_feature(f);
        S* at = out + f * stride;
        for (int n = 0; n < 3; ++n) at[n] = v(n);
      }
    }
  };
  const auto of_side = [](auto s, const Vector3<S>& v) {
    if constexpr (s == 0) return Vector3<S>(v.x(), v.y(), v.z());
    if constexpr (s == 1) return Vector3<S>(-v.x(), -v.y(), -v.z());
  };
  unrolled<2>([&](auto s) {
    const std::size_t own = sides[s].own;
    const Vector3<S>* change = sides[s].changes + first * own;
    write(own, [&](std::size_t k) {
      return [&, k](std::size_t f) { return of_side(s, change[f * own + k]); };
    });
  });
  constexpr Constant<0> kAsItIs;
  unrolled<2>([&](auto s) {
    std::array<Vector3<S>, kFeatures> p;
    for (std::size_t f = 0; f < kFeatures; ++f) p[f] = of_side(kAsItIs, sides[s].points[first + f]);
    const std::span<const Twist<S>> twists = sides[s].twists->rotational;
    write(twists.size(), [&](std::size_t k) {
      const Twist<S> twist{of_side(kAsItIs, twists[k].linear), of_side(kAsItIs, twists[k].angular)};
      return [&p, s, twist](std::size_t f) {
        return s == 0 ? twist.velocity(p[f]) : twist.opposite_velocity(p[f]);
      };
    });
  });
  unrolled<2>([&](auto s) {
    const std::span<const Vector3<S>> velocities = sides[s].twists->translational;
    write(velocities.size(), [&](std::size_t k) {
      const Vector3<S> v = of_side(s, velocities[k]);
      return [x = v.x(), y = v.y(), z = v.z()](std::size_t) { return Vector3<S>(x, y, z); };
    });
  });
}

/// Normal-equation sums for p_a − p_b; same interface as FeatureWrenches.
template <class S>
class PointWrenches {
 public:
  using Sides = std::array<DifferenceSide<S>, 2>;

  [[nodiscard]] static constexpr std::size_t bodies() { return 2; }
  /// Number of rotational and of translational twists of a body.
  /// @{
  [[nodiscard]] std::size_t turns(std::size_t body) const { return turns_[body]; }
  [[nodiscard]] std::size_t shifts(std::size_t body) const { return shifts_[body]; }
  /// @}
  /// Number of the sensors' own parameters.
  [[nodiscard]] std::size_t own() const { return own_; }

  /// The twists of columns i, i + 1, ...
  [[nodiscard]] PacketRows<S> twists(std::size_t i) const {
    static_assert(sizeof(Column) == 12 * sizeof(S));
    return {columns_[i].velocity.data(), 12, 3};
  }
  /// Force and moment of each column on a body.  The force is the velocity, so its three numbers are shared; the
  /// moments follow at 6 and 9.
  [[nodiscard]] PacketRows<S> wrenches(std::size_t body) const {
    return {columns_[0].velocity.data(), 12, 6 + 3 * body};
  }
  /// Adds the products of the sensors' own columns with each other and with the residual.
  void add_own(S* sums, std::size_t stride) const {
    if (own_ == 0) return;
    const std::size_t size = 3 * (1 + own_);
    const S* motions = motions_[0].data();
    const auto add = [&]<std::size_t N>(std::integral_constant<std::size_t, N>) {
      add_products<3 * N, S>({motions + 3, 3, size}, own_, {motions, 3, size}, 1, sums, stride);
      motions += N * size;
    };
    std::size_t left = features_;
    for (; left >= 4; left -= 4) add(std::integral_constant<std::size_t, 4>{});
    for (; left > 0; --left) add(std::integral_constant<std::size_t, 1>{});
  }

  /// Sums consecutive features on the same chains.
  /// @param weights    of each feature
  /// @param residuals  (3) of each feature, metres
  void set(const Sides& sides, std::span<const S> weights, std::span<const Vector3<S>> residuals);

 private:
  /// A column: twist, force and moments.
  struct Column {
    Vector3<S> velocity;  ///< of the center, scaled; equals the force
    Vector3<S> angular;
    std::array<Vector3<S>, 2> moment;  ///< about the centers; the second one negated
  };

  void set_points(const Sides& sides, std::span<const S> weights);
  /// sum (p^T q I - p q^T); negated for two sides.
  /// @tparam Same  true if p and q are the same points: only one triangle is summed
  template <bool Same>
  void set_inertia(Matrix3<S>& inertia, const Vector3<S>* p, const Vector3<S>* q) const;
  /// @returns  the column after the last one
  Column* set_own_columns(const Sides& sides);
  /// @param x  (3) of each feature: its motion by a parameter, or its residual
  void set_own(std::size_t c, const Vector3<S>* x, std::size_t stride, bool negated);
  /// @returns  the column after the last one
  template <std::size_t Side>
  Column* set_turns(std::span<const Twist<S>> turns, Column* column) const;

  [[nodiscard]] static Vector3<S> scaled(const Vector3<S>& v, const S& factor) {
    return {v.x() * factor, v.y() * factor, v.z() * factor};
  }
  static void add_scaled(Vector3<S>& sum, const Vector3<S>& v, const S& factor) {
    sum = {sum.x() + v.x() * factor, sum.y() + v.y() * factor, sum.z() + v.z() * factor};
  }
  static void add_cross(Vector3<S>& sum, const Vector3<S>& p, const Vector3<S>& f) {
    sum = {sum.x() + p.y() * f.z() - p.z() * f.y(),  // two fused multiply-adds each
           sum.y() + p.z() * f.x() - p.x() * f.z(), sum.z() + p.x() * f.y() - p.y() * f.x()};
  }

  std::size_t features_ = 0, own_ = 0;
  std::array<std::size_t, 2> turns_{}, shifts_{};
  S root_, share_of_root_;             ///< of the sum of weights, and its inverse
  std::array<Vector3<S>, 2> centers_;  ///< of the points of both sides, in the base
  std::array<Matrix3<S>, 3> inertia_;  ///< first, mixed, second
  std::vector<Column> columns_;        ///< in the order of LocalSums
  std::vector<S> roots_;               ///< of the weights
  std::array<std::vector<Vector3<S>>, 2> from_center_;  ///< each point, scaled
  std::vector<Vector3<S>> motions_;  ///< residual and own motions of each feature, scaled
};

}  // namespace kinecal::detail
