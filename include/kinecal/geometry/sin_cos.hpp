// Sine and cosine of all lanes of a packet at once, to two units in the last place; the packet's own sin() and cos() call the
// C library for each lane, which takes five times as long.
//
// The angle is reduced by multiples of pi/2 that are subtracted in three parts, the first two short enough that their
// products are exact; then sine and cosine are polynomials of it on [-pi/4, pi/4].
// Source: Cody and Waite, Software Manual for the Elementary Functions, 1980; Moshier, Methods and Programs for Mathematical
// Functions, 1989 (coefficients).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/geometry/packet.hpp"

namespace kinecal {

/// Sine and cosine of an angle.
template <class S>
struct SinCos {
  S sin, cos;
};

/// @param angle  radians; lanes beyond 10^5 are left to the C library
template <int N>
[[nodiscard]] SinCos<PacketOf<N>> sin_cos(const PacketOf<N>& angle) {
  using P = PacketOf<N>;
  using Mask = typename P::Mask;
  constexpr double kFarthest = 1e5, kTwoOverPi = 0.63661977236758134308;
  constexpr double kShift =
      6755399441055744.0;  // 1.5 * 2^52: then the last bits are those of an integer
  const P shifted = angle * kTwoOverPi + kShift, quarters = shifted - kShift;
  const P x = ((angle - quarters * 1.57079625129699707031) - quarters * 7.54978941586159635335e-8) -
              quarters * 5.39030285815811905290e-15;
  const P z = x * x;
  const P sine = x + x * z *
                         (((((z * 1.58962301576546568060e-10 - 2.50507477628578072866e-8) * z +
                             2.75573136213857245213e-6) *
                                z -
                            1.98412698295895385996e-4) *
                               z +
                           8.33333333332211858878e-3) *
                              z -
                          1.66666666666666307295e-1);
  const P cosine = 1.0 - 0.5 * z +
                   z * z *
                       (((((z * -1.13585365213876817300e-11 + 2.08757008419747316778e-9) * z -
                           2.75573141792967388112e-7) *
                              z +
                          2.48015872888517045348e-5) *
                             z -
                         1.38888888888730564116e-3) *
                            z +
                        4.16666666666665929218e-2);
  const Mask turn = Mask(shifted.lanes());
  const Mask odd = (turn & 1) != 0, sine_falls = (turn & 2) != 0,
             cosine_falls = ((turn + 1) & 2) != 0;
  SinCos<P> result{select(odd, cosine, sine), select(odd, sine, cosine)};
  result.sin = select(sine_falls, P(-result.sin), result.sin);
  result.cos = select(cosine_falls, P(-result.cos), result.cos);
  const Mask near = abs(angle) <= P(kFarthest);
  for (std::size_t i = 0; i < P::size(); ++i) {
    if (near[i]) continue;
    result.sin.set(i, std::sin(angle[i]));
    result.cos.set(i, std::cos(angle[i]));
  }
  return result;
}

}  // namespace kinecal
