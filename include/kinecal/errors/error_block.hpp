// What an error block is: a small function of points, templated on the scalar.
//
// It takes what its sensors saw, carried to the base by their chains, and returns the residual of
// one feature.  Jets differentiate it; twists carry the derivative to the joints and frames.  So a
// new error block is a struct with one templated call operator and nothing else:
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
// Four signatures are known:
//   (point)              a feature of one sensor, in the base
//   (point, point)       the same feature seen by two sensors, both in the base
//   (sight)              a feature of one sensor as another, a pinhole camera, sees it
//   (plane, plane)       the planes through all features of two sensors, in the base
//
// The scalar holds one sample for each lane of a packet, so a block does not branch on values: it
// writes select(x < y, a, b) for x < y ? a : b.  (Planes are compared sample by sample.)
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
  Vector3<S> p_camera;                    ///< metres, in the camera's optical frame
  std::array<S, 4> parameters;            ///< of the camera: fx fy cx cy, relative
  PinholeCamera<ValueOf<S>> camera;       ///< as recorded
  Eigen::Matrix<ValueOf<S>, 2, 1> pixel;  ///< observed
};

/// A plane through points, in the base.
template <class S>
struct Plane {
  Vector3<S> centroid;  ///< of its points, metres
  Vector3<S> normal;    ///< unit vector
};

namespace detail {
using Probe = Jet<double, 1>;
template <class R>
inline constexpr bool kIsFixedColumn = (R::RowsAtCompileTime > 0) && (R::ColsAtCompileTime == 1);
/// A vector of fixed size in the scalar of the points: a block that is not templated returns
/// another.
template <class R>
concept ResidualVector = std::same_as<typename R::Scalar, Probe> && kIsFixedColumn<R>;
}  // namespace detail

template <class B>
concept PointBlock = requires(const B& block, const Vector3<detail::Probe>& p) {
  { block(p) } -> detail::ResidualVector;
};
template <class B>
concept PointPairBlock = requires(const B& block, const Vector3<detail::Probe>& p) {
  { block(p, p) } -> detail::ResidualVector;
};
template <class B>
concept SightBlock = requires(const B& block, const Sight<detail::Probe>& s) {
  { block(s) } -> detail::ResidualVector;
};
template <class B>
concept PlanePairBlock = requires(const B& block, const Plane<detail::Probe>& p) {
  { block(p, p) } -> detail::ResidualVector;
};

template <class B>
concept ErrorBlock = PointBlock<B> || PointPairBlock<B> || SightBlock<B> || PlanePairBlock<B>;

/// How many sensors a block takes its features from.
template <ErrorBlock B>
inline constexpr int kSensors = PointBlock<B> ? 1 : 2;

namespace detail {
/// From the signature alone: a block is not compiled for a scalar in which nobody calls it.
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

/// Number of residuals for one feature (for one pair of planes).
template <ErrorBlock B>
inline constexpr int kResiduals = detail::residuals<B>();

}  // namespace kinecal
