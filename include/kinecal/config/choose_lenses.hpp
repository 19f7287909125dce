// Decides which lens each camera2d has, if the configuration does not say: that of its camera_info.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Sets ModelConfig::lens of each camera2d without the key.  Of the lenses plumb_bob, rational_polynomial and
/// thin_prism, each of which contains the one before it, the last one that the samples have.
///
/// A lens that the configuration gives replaces another one in the samples: its coefficients start at zero, with a
/// note.  Error: samples with different lenses; a given lens without any free coefficient that replaces another
/// one.
void choose_lenses(Config& config, std::vector<Sample>& samples, Diagnostics& diagnostics);

}  // namespace kinecal
