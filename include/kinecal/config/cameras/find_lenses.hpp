// Chooses the lens of a camera by evidence (`lens: auto`): the simplest one that images views that were held out as well as
// any other.
//
// The simplest ones are plumb_bob without distortion, with k1, with k1 k2, with k1 k2 p1 p2, and with k3: ordinary cameras have
// these, and all programs read them.  Then equidistant with k1 k2, double_sphere, equidistant with four coefficients,
// rational_polynomial and thin_prism.
//
// For each of five folds a lens is fitted to the other samples, and the pose of each sample that was held out to the sample.
// The first lens is taken that no other one beats: by more than 2 % in pixels, or by more than 1 % and beyond chance, by
// Student's t at 1 % of the mean squares of samples, or of their logarithms.  Pixels decide, not coefficients: these are correlated, and what a
// coefficient is does not matter where others make up for it.  A lens is out if it folds over where features are, does not fit
// at all, or if its pixels where features are, or its focal length at the axis, are not determined.  One whose coefficients make up
// for fx, or whose pixels are known worse than to a pixel and than corners fit, comes in only if there is no other.
// Each camera is tried alone.  Corners beyond three pixels count less.
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
