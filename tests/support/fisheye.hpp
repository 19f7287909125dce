// Fisheye cameras that see more than a half space, one right, the others wrong.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kinecal/sensors/sensor.hpp"

namespace kinecal::test {

/// The pixel is proportional to the angle from the axis, f = 400 px, up to k2: theta (1 + k2 theta^2).
struct Fisheye {
  static constexpr std::string_view kType = "fisheye";
  static constexpr bool kOwnFrame = true;
  static constexpr std::array kParameters = {ParameterInfo{"fx"}, ParameterInfo{"k2"}};

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 2>& v) const {
    const S r2 = p.x() * p.x() + p.y() * p.y();
    const auto on_axis = r2 < S(1e-18);
    const S r = sqrt(select(on_axis, S(1.0), r2)), angle = atan2(r, p.z());
    const S scale = select(on_axis, S(1.0) / p.z(), angle * (1.0 + v[1] * angle * angle) / r);
    const S f = 400.0 * (1.0 + v[0]);
    return {f * scale * p.x() + 640.0, f * scale * p.y() + 480.0};
  }
};
static_assert(Sensor<Fisheye>);

/// As everybody writes it first: 0 / 0 on the axis.
struct HollowFisheye {
  static constexpr std::string_view kType = "hollow_fisheye";
  static constexpr bool kOwnFrame = true;

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 0>&) const {
    const S r = sqrt(p.x() * p.x() + p.y() * p.y()), angle = atan2(r, p.z());
    return {400.0 * angle * p.x() / r + 640.0, 400.0 * angle * p.y() / r + 480.0};
  }
};

/// A value on the axis, but the derivative of sqrt(0).
struct KinkedFisheye {
  static constexpr std::string_view kType = "kinked_fisheye";
  static constexpr bool kOwnFrame = true;

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 0>&) const {
    const S r = sqrt(p.x() * p.x() + p.y() * p.y()), angle = atan2(r, p.z());
    const S scale = 400.0 * (angle + 1e-12) / (r + 1e-12);
    return {scale * p.x() + 640.0, scale * p.y() + 480.0};
  }
};

/// Drops a derivative beyond 60 degrees.
struct StraightFisheye {
  static constexpr std::string_view kType = "straight_fisheye";

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>& none,
                                 const std::array<S, 0>&) const {
    const auto pixel = Fisheye{}.predict(p, none, std::array<S, 2>{});
    const auto is_wide = p.z() < S(0.5) * sqrt(p.squaredNorm());
    return {select(is_wide, S(value_of(pixel.x())), pixel.x()), pixel.y()};
  }
};

}  // namespace kinecal::test
