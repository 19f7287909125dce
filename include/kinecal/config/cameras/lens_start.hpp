// Where the search for a lens begins: coefficients by linear least squares, from a lens of which little is known.
//
// A rough lens images the angle t from the axis at the radius f s(t): s = tan t of a pinhole, s = t of a fisheye.  Each
// lens can come close to it, by equations that are linear in its coefficients, with r = tan t:
//
//   plumb_bob                        r (1 + k1 r^2 + k2 r^4 + k3 r^6) = s
//   rational_polynomial, thin_prism  r (1 + k1 r^2 + k2 r^4 + k3 r^6) = s (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   equidistant                      t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) = s
//
// over the angles that the photographs show.  double_sphere is the best of a grid.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string_view>
#include <vector>

namespace kinecal {

/// A lens that is round about its axis, with the radius of the image of an angle.
struct RoundLens {
  double focal = 0.0;                     ///< pixels
  std::function<double(double)> profile;  ///< s(t): radius in focal lengths by the angle, radians
  std::function<double(double)> inverse;  ///< t(s)
};

/// The lenses that a search begins with: a pinhole, and a fisheye.
/// @param focal  pixels
/// @{
[[nodiscard]] RoundLens rough_pinhole(double focal);
[[nodiscard]] RoundLens rough_fisheye(double focal);
/// @}

/// Coefficients with which a lens comes close to another one.
/// @param lens         of lens_names()
/// @param like         the other one
/// @param most_degrees  the largest angle from the axis that matters
/// @returns            in the order of the lens' D
/// @throws std::invalid_argument  if there is no such lens
[[nodiscard]] std::vector<double> lens_start(std::string_view lens, const RoundLens& like,
                                             double most_degrees);

}  // namespace kinecal
