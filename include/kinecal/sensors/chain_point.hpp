// Points and poses at known places in a link (chain3d, chain6d): an arm that holds a target.
//
// A feature may also be given in a virtual frame beyond the link: a checkerboard, a tracker.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// Points at known positions in a link.
struct ChainPoint {
  static constexpr std::string_view kType = "chain3d";  ///< name in configurations

  /// The point as it was recorded.
  /// @returns  (3) metres, in the frame of the feature
  template <class S, class Q>
  [[nodiscard]] Vector3<S> place(const Measurement<ChainPoint, Q>& m,
                                 const std::array<S, 0>&) const {
    return Vector3<S>(S(m.point.x()), S(m.point.y()), S(m.point.z()));
  }
};

/// Poses in a link: of a marker, or of a body tracked by motion capture or tf.
struct ChainPose {
  static constexpr std::string_view kType = "chain6d";  ///< name in configurations
  static constexpr bool kOriented = true;               ///< features have an orientation

  /// The pose as it was recorded.
  /// @returns  metres, in the frame of the feature
  template <class S, class Q>
  [[nodiscard]] Pose<S> place(const Measurement<ChainPose, Q>& m, const std::array<S, 0>&) const {
    Pose<S> pose;
    for (int r = 0; r < 3; ++r) {
      pose.translation(r) = S(m.point(r));
      for (int c = 0; c < 3; ++c) pose.rotation(r, c) = S(m.rotation(r, c));
    }
    return pose;
  }
};

}  // namespace kinecal
