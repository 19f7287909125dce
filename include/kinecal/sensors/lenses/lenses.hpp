// The lenses that everybody has: configurations, camera files, `lens: auto`'s reports and the evaluation know those of
// this list.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lenses/double_sphere.hpp"
#include "kinecal/sensors/lenses/equidistant.hpp"
#include "kinecal/sensors/lenses/plumb_bob.hpp"
#include "kinecal/sensors/lenses/rational_polynomial.hpp"

namespace kinecal {

/// Some lenses.
template <LensModel... Ls>
struct LensList {};

/// All lenses.  Among those that bend a pinhole's image, each contains the ones before it.
using Lenses = LensList<PlumbBob, RationalPolynomial, ThinPrism, Equidistant, DoubleSphere>;

}  // namespace kinecal
