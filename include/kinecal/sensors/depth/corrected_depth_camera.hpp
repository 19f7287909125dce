// A depth camera with corrected settings, at a pose: points with derivatives.
//
// The polynomial is evaluated only if a coefficient is free or not zero.  With g its value at z1:
//
//   z' = z1 g      dz'/dz1 = g + z_quadratic z1      dz'/dc = z1 (term of the coefficient c)
//
// Source: depth_camera.hpp has the formula of the point.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/sensors/depth/depth_polynomial.hpp"

namespace kinecal {

/// A depth camera with corrected settings at a pose; computes once what all points of a sample
/// share.  Focal lengths and principal point move a point in x or y only; offset and scaling move it
/// along its ray.
template <class Q>
class CorrectedDepthCamera {
 public:
  /// @param pose      of the camera in the base; must outlive this
  /// @param recorded  fx fy cx cy z_offset z_scaling: DepthCamera::settings()
  /// @param v         (12) parameters: corrections of the recorded settings, polynomial; or the first (6); must
  ///                  outlive this
  CorrectedDepthCamera(const Pose<Q>& pose, const std::array<Q, 6>& recorded,
                       std::span<const double> v)
      : pose_(pose),
        per_fx_(Q(1.0) / (recorded[0] * Q(1.0 + v[0]))),
        per_fy_(Q(1.0) / (recorded[1] * Q(1.0 + v[1]))),
        cx_(recorded[2] * Q(1.0 + v[2])),
        cy_(recorded[3] * Q(1.0 + v[3])),
        s_by_cx_(-(recorded[2] * per_fx_)),
        t_by_cy_(-(recorded[3] * per_fy_)),
        by_fx_(-(recorded[0] * per_fx_)),
        by_fy_(-(recorded[1] * per_fy_)),
        offset_(v[4]),
        factor_(1.0 + v[5]),
        polynomial_(v.subspan(kPlain)) {
    for (const double c : polynomial_) bends_ |= c != 0.0;
  }

  /// The point of a measurement and its derivatives.
  /// @param m        (3) pixel and raw depth: DepthCamera::measurement()
  /// @param chosen   which parameters to differentiate by, ascending
  /// @param changes  out, for each of them: (3) metres per unit, in the base
  /// @returns        (3) metres, in the base
  Vector3<Q> place(const Vector3<Q>& m, std::span<const int> chosen, Vector3<Q>* changes) const {
    const Matrix3<Q>& r = pose_.rotation;
    const Q s = (m.x() - cx_) * per_fx_, t = (m.y() - cy_) * per_fy_;
    const Q raw = m.z() + offset_, depth = raw * factor_;
    const Vector3<Q> ray(r(0, 0) * s + r(0, 1) * t + r(0, 2), r(1, 0) * s + r(1, 1) * t + r(1, 2),
                         r(2, 0) * s + r(2, 1) * t + r(2, 2));
    if (bends_ || (!chosen.empty() && chosen.back() >= static_cast<int>(kPlain))) [[unlikely]] {
      // with the recorded settings: (u - cx0) / fx0
      const Q x = -(m.x() * per_fx_ + s_by_cx_) / by_fx_,
              y = -(m.y() * per_fy_ + t_by_cy_) / by_fy_;
      return bent(pose_, ray, polynomial_, {x, y, depth},
                  {s * by_fx_, t * by_fy_, s_by_cx_, t_by_cy_, factor_, raw}, chosen, changes);
    }
    Vector3<Q> p;
    for (int i = 0; i < 3; ++i) p(i) = pose_.translation(i) + ray(i) * depth;
    if (chosen.size() == kPlain) {  // the usual case: all of them, in order
      changes[0] = times(r.col(0), s * depth * by_fx_);
      changes[1] = times(r.col(1), t * depth * by_fy_);
      changes[2] = times(r.col(0), s_by_cx_ * depth);
      changes[3] = times(r.col(1), t_by_cy_ * depth);
      changes[4] = times(ray, factor_);
      changes[5] = times(ray, raw);
      return p;
    }
    for (const int k : chosen) {
      switch (k) {
        case 0:
          *changes++ = times(r.col(0), s * depth * by_fx_);
          break;
        case 1:
          *changes++ = times(r.col(1), t * depth * by_fy_);
          break;
        case 2:
          *changes++ = times(r.col(0), s_by_cx_ * depth);
          break;
        case 3:
          *changes++ = times(r.col(1), t_by_cy_ * depth);
          break;
        case 4:
          *changes++ = times(ray, factor_);
          break;
        default:
          *changes++ = times(ray, raw);
      }
    }
    return p;
  }

 private:
  static constexpr std::size_t kPlain = 6;  ///< fx fy cx cy z_offset z_scaling

  [[nodiscard]] static Vector3<Q> times(const auto& v, const Q& x) {
    return Vector3<Q>(v(0) * x, v(1) * x, v(2) * x);
  }
  /// place() with the polynomial.  Not inlined, and all by value: the loop of the usual case stays as it is.
  /// @param seen  x, y and z1
  /// @param by    derivatives by the first six parameters: the four of (s, t), the two of z1
  [[gnu::noinline]] static Vector3<Q> bent(const Pose<Q>& pose, const Vector3<Q>& ray,
                                           std::span<const double> polynomial,
                                           const Vector3<Q>& seen, const std::array<Q, kPlain>& by,
                                           std::span<const int> chosen, Vector3<Q>* changes) {
    const Q& z = seen.z();
    const std::array<Q, kDepthTerms> terms = depth_terms(z, seen.x(), seen.y());
    Q factor(1.0);
    for (std::size_t i = 0; i < kDepthTerms; ++i) factor = factor + Q(polynomial[i]) * terms[i];
    const Q depth = z * factor, slope = factor + Q(polynomial[0]) * z;
    for (const int parameter : chosen) {
      const auto k = static_cast<std::size_t>(parameter);
      if (k < 4) {
        *changes++ = times(pose.rotation.col(parameter % 2), by[k] * depth);
      } else {
        *changes++ = times(ray, k < kPlain ? by[k] * slope : z * terms[k - kPlain]);
      }
    }
    Vector3<Q> p;
    for (int i = 0; i < 3; ++i) p(i) = pose.translation(i) + ray(i) * depth;
    return p;
  }

  const Pose<Q>& pose_;
  Q per_fx_, per_fy_, cx_, cy_, s_by_cx_, t_by_cy_, by_fx_, by_fy_, offset_, factor_;
  std::span<const double> polynomial_;  ///< its coefficients, or none
  bool bends_ = false;                  ///< one of them is not zero
};

}  // namespace kinecal
