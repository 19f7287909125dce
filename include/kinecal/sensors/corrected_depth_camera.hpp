// A depth camera with corrected settings, at a pose: points with derivatives.
//
// The polynomial is evaluated only if a coefficient is free or not zero.  With g its value at z1:
//
//   z' = z1 g      dz'/dz1 = g + z_quadratic z1      dz'/dc = z1 (term of the coefficient c)
//
// Source: depth_camera.hpp has the formula of the point.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/sensors/depth_polynomial.hpp"

namespace kinecal {

/// A depth camera with corrected settings at a pose; computes once what all points of a sample
/// share.  Focal lengths and principal point move a point in x or y only; offset and scaling move it
/// along its ray.
template <class Q>
class CorrectedDepthCamera {
 public:
  /// @param pose      of the camera in the base; must outlive this
  /// @param recorded  fx fy cx cy z_offset z_scaling: DepthCamera::settings()
  /// @param v         (12) parameters: corrections of the recorded settings, polynomial; or the first (6)
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
        factor_(1.0 + v[5]) {
    if (v.size() <= kPlain) return;
    std::copy_n(v.begin() + kPlain, kDepthTerms, polynomial_.begin());
    bends_ = std::any_of(polynomial_.begin(), polynomial_.end(), [](double c) { return c != 0.0; });
    x_ = {Q(1.0) / recorded[0], recorded[2]};
    y_ = {Q(1.0) / recorded[1], recorded[3]};
  }

  /// The point of a measurement and its derivatives.
  /// @param m        (3) pixel and raw depth: DepthCamera::measurement()
  /// @param chosen   which parameters to differentiate by, ascending
  /// @param changes  out, for each of them: (3) metres per unit, in the base
  /// @returns        (3) metres, in the base
  Vector3<Q> place(const Vector3<Q>& m, std::span<const int> chosen, Vector3<Q>* changes) const {
    const Matrix3<Q>& r = pose_.rotation;
    const Q s = (m.x() - cx_) * per_fx_, t = (m.y() - cy_) * per_fy_;
    const Q raw = m.z() + offset_, plain = raw * factor_;
    const Vector3<Q> ray(r(0, 0) * s + r(0, 1) * t + r(0, 2), r(1, 0) * s + r(1, 1) * t + r(1, 2),
                         r(2, 0) * s + r(2, 1) * t + r(2, 2));
    if (bends_ || (!chosen.empty() && chosen.back() >= kPlain)) {
      return place_bent(m, {s, t, raw, plain, ray}, chosen, changes);
    }
    if (chosen.size() == kPlain) {  // the usual case: all of them, in order
      changes[0] = times(r.col(0), s * plain * by_fx_);
      changes[1] = times(r.col(1), t * plain * by_fy_);
      changes[2] = times(r.col(0), s_by_cx_ * plain);
      changes[3] = times(r.col(1), t_by_cy_ * plain);
      changes[4] = times(ray, factor_);
      changes[5] = times(ray, raw);
    } else {
      const Seen seen{s, t, raw, plain, ray};
      for (const int k : chosen) *changes++ = change(k, seen, plain, Q(1.0));
    }
    return at(ray, plain);
  }

 private:
  static constexpr int kPlain = 6;  ///< fx fy cx cy z_offset z_scaling

  /// What a measurement gives before the polynomial.
  struct Seen {
    Q s, t;          ///< of the corrected ray (s, t, 1)
    Q raw, plain;    ///< z0 + z_offset, and z1; metres
    Vector3<Q> ray;  ///< in the base
  };
  /// The recorded focal length, inverse, and principal point of an axis of the image.
  struct RecordedAxis {
    Q per_f = Q(0.0), c = Q(0.0);
  };

  [[nodiscard]] static Vector3<Q> times(const auto& v, const Q& x) {
    return Vector3<Q>(v(0) * x, v(1) * x, v(2) * x);
  }
  [[nodiscard]] Vector3<Q> at(const Vector3<Q>& ray, const Q& depth) const {
    Vector3<Q> p;
    for (int i = 0; i < 3; ++i) p(i) = pose_.translation(i) + ray(i) * depth;
    return p;
  }
  /// The derivative by one of the first six parameters.
  /// @param slope  dz'/dz1
  [[nodiscard]] Vector3<Q> change(int k, const Seen& seen, const Q& depth, const Q& slope) const {
    const Matrix3<Q>& r = pose_.rotation;
    switch (k) {
      case 0:
        return times(r.col(0), seen.s * depth * by_fx_);
      case 1:
        return times(r.col(1), seen.t * depth * by_fy_);
      case 2:
        return times(r.col(0), s_by_cx_ * depth);
      case 3:
        return times(r.col(1), t_by_cy_ * depth);
      case 4:
        return times(seen.ray, factor_ * slope);
      default:
        return times(seen.ray, seen.raw * slope);
    }
  }
  /// place() with the polynomial.
  Vector3<Q> place_bent(const Vector3<Q>& m, const Seen& seen, std::span<const int> chosen,
                        Vector3<Q>* changes) const {
    const Q x = (m.x() - x_.c) * x_.per_f, y = (m.y() - y_.c) * y_.per_f;
    const std::array<Q, kDepthTerms> terms = depth_terms(seen.plain, x, y);
    Q factor(1.0);
    for (std::size_t i = 0; i < kDepthTerms; ++i) factor = factor + Q(polynomial_[i]) * terms[i];
    const Q depth = seen.plain * factor, slope = factor + Q(polynomial_[0]) * seen.plain;
    for (const int k : chosen) {
      *changes++ = k < kPlain ? change(k, seen, depth, slope)
                              : times(seen.ray, seen.plain * terms[std::size_t(k - kPlain)]);
    }
    return at(seen.ray, depth);
  }

  const Pose<Q>& pose_;
  Q per_fx_, per_fy_, cx_, cy_, s_by_cx_, t_by_cy_, by_fx_, by_fy_, offset_, factor_;
  RecordedAxis x_, y_;
  std::array<double, kDepthTerms> polynomial_{};
  bool bends_ = false;  ///< a coefficient is not zero
};

}  // namespace kinecal
