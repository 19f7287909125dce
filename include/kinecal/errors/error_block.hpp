// The concept of an error block: a small function of points, templated on the scalar.
//
// A block takes a feature of each of its sensors, transformed to the base, and returns its
// residual.  Jets differentiate the block; twists propagate the derivative to joints and frames.
// So a new error block is a struct with one templated call operator and nothing else:
//
//   struct PointToSphere {
//     Vector3<double> center;
//     double radius;
//     template <class S>
//     Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
//       return Eigen::Matrix<S, 1, 1>((p_base - center.cast<S>()).norm() - S(radius));
//     }
//   };
//
// There are four signatures:
//   (point)              a feature of one sensor, in the base
//   (point, point)       the same feature observed by two sensors, both in the base
//   (sight)              a feature of one sensor, projected into another one, a pinhole camera
//   (plane, plane)       the planes through all features of two sensors, in the base
//
// A scalar may be a packet with one sample per lane.  So a block does not branch on values: write
// select(x < y, a, b) in place of x < y ? a : b.  (Planes are compared sample by sample and may
// branch.)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <type_traits>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/sensors/pinhole_camera.hpp"

namespace kinecal {

/// A point in front of a pinhole camera and the pixel at which it was observed.
template <class S>
struct Sight {
  Vector3<S> p_camera;                    ///< (3) metres, in the camera's optical frame
  std::array<S, 4> parameters;            ///< (4) of the camera: fx fy cx cy, relative
  PinholeCamera<ValueOf<S>> camera;       ///< as recorded
  Eigen::Matrix<ValueOf<S>, 2, 1> pixel;  ///< (2) observed
};

/// The plane through some points, in the base.
template <class S>
struct Plane {
  Vector3<S> centroid;  ///< (3) of the points, metres, in the base
  Vector3<S> normal;    ///< (3) unit vector, in the base
};

namespace detail {
using Probe = Jet<double, 1>;
template <class R>
inline constexpr bool kIsFixedColumn = (R::RowsAtCompileTime > 0) && (R::ColsAtCompileTime == 1);
/// A vector of fixed size in the scalar of the points.  A block that is not templated returns
/// another scalar.
template <class R>
concept ResidualVector = std::same_as<typename R::Scalar, Probe> && kIsFixedColumn<R>;
}  // namespace detail

/// block(p): p is a feature of one sensor, metres, in the base.
template <class B>
concept PointBlock = requires(const B& block, const Vector3<detail::Probe>& p) {
  { block(p) } -> detail::ResidualVector;
};
/// block(p_a, p_b): the same feature observed by two sensors, metres, in the base.
template <class B>
concept PointPairBlock = requires(const B& block, const Vector3<detail::Probe>& p) {
  { block(p, p) } -> detail::ResidualVector;
};
/// block(sight): a feature of one sensor in front of another one, a pinhole camera.
template <class B>
concept SightBlock = requires(const B& block, const Sight<detail::Probe>& s) {
  { block(s) } -> detail::ResidualVector;
};
/// block(a, b): the planes through all features of two sensors, in the base.
template <class B>
concept PlanePairBlock = requires(const B& block, const Plane<detail::Probe>& p) {
  { block(p, p) } -> detail::ResidualVector;
};

/// A residual with one of the four signatures.
template <class B>
concept ErrorBlock = PointBlock<B> || PointPairBlock<B> || SightBlock<B> || PlanePairBlock<B>;

/// Number of sensors that a block compares; one for a point compared with a constant.
template <ErrorBlock B>
inline constexpr int kSensors = PointBlock<B> ? 1 : 2;

namespace detail {
/// From the signature only, so that a block is not compiled for a scalar in which nobody calls it.
template <class B, class... Given>
inline constexpr int kRows = std::invoke_result_t<const B&, const Given&...>::RowsAtCompileTime;

template <ErrorBlock B>
[[nodiscard]] consteval int residuals() {
  if constexpr (PointBlock<B>) {
    return kRows<B, Vector3<Probe>>;
  } else if constexpr (PointPairBlock<B>) {
    return kRows<B, Vector3<Probe>, Vector3<Probe>>;
  } else if constexpr (SightBlock<B>) {
    return kRows<B, Sight<Probe>>;
  } else {
    return kRows<B, Plane<Probe>, Plane<Probe>>;
  }
}
}  // namespace detail

/// Number of residuals of one feature, or of one pair of planes.
template <ErrorBlock B>
inline constexpr int kResiduals = detail::residuals<B>();

}  // namespace kinecal
