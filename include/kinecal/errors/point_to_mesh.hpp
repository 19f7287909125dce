// Distance of a point to the surface of the robot (chain3d_to_mesh).  r = n . (p - q)
//
// q is the point of the surface that is nearest to p, found before the solve: a feature of a chain3d sensor on the link
// that it lies on.  n is the unit vector from q to p then, in the base, negative if p is inside: the normal of the
// triangle where the two coincide.  It stays constant until points are associated anew.
//
// The gradient is that of the true distance, on edges and corners, too: there n is parallel to p - q, so neither the way
// that q would slide along the surface nor the way that n would turn changes r.  So the block is linear in p and q.
// Source: Chen, Medioni, Object Modelling by Registration of Multiple Range Images, 1992.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to a surface, along the normal there.
struct PointToMesh {
  static constexpr const char* kType = "chain3d_to_mesh";  ///< name in configurations
  static constexpr const char* kUnit = "m";                ///< of the residual
  /// The normal, a unit vector in the base.
  static constexpr std::array<std::string_view, 3> kConditions = {"nx", "ny", "nz"};

  /// The distance.
  /// @param p  (3) measured point, metres, in the base
  /// @param q  (3) point of the surface, metres, in the base
  /// @param n  nx ny nz
  /// @returns  (1) signed distance, metres
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p, const Vector3<S>& q,
                                                  const std::array<Q, 3>& n) const {
    return Eigen::Matrix<S, 1, 1>(n[0] * (p.x() - q.x()) + n[1] * (p.y() - q.y()) +
                                  n[2] * (p.z() - q.z()));
  }
};

}  // namespace kinecal
