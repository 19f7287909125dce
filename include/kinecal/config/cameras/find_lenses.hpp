// Chooses the lens of a camera by evidence (`lens: auto`): the simplest one whose error on views that were held out
// no other lens beats significantly.
//
// The simplest one is plumb_bob without k3, then plumb_bob: ordinary cameras have it, and all programs read it.  Then
// double_sphere, equidistant, rational_polynomial and thin_prism, by the number of their coefficients.
//
// Each lens is calibrated with all of its coefficients.  For each of five folds it is fitted to the other samples;
// each sample that was held out gets the mean square of its residuals, its own pose fitted to it.  One lens beats
// another one if its mean squares, or their logarithms, are smaller on average over samples, beyond chance by Student's
// t at 5 %.  A lens that folds over where features are, does not fit at all, or has a parameter that the samples do not
// determine, is out; so is one with a parameter that they hardly determine, unless all have one.  Each camera is tried
// alone.  Corners beyond three pixels count less.
// Source: Vuong, Likelihood Ratio Tests for Model Selection and Non-Nested Hypotheses, 1989.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Replaces `lens: auto` of each camera by a lens, whose intrinsics and coefficients it frees in each step that has the
/// camera, and its D in the samples by that with which the search begins.  Notes the choice, with the errors.
/// @param robot    with_own_frames()
/// @param samples  as start_cameras() takes them
void find_lenses(Config& config, const Robot& robot, std::vector<Sample>& samples,
                 Diagnostics& diagnostics);

}  // namespace kinecal
