// The answers of `kinecal init` from recorded samples: names of sensors and frames, what holds the
// target, what moves.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// Completes answers by what samples show.
/// @param given  arm, camera, base and names that are not empty are kept
/// @throws InputError  "--from: ..." or "--camera: ...": what samples and URDF leave open, and the
///                     option that says it
[[nodiscard]] InitAnswers answers_from_samples(const Robot& robot, std::span<const Sample> samples,
                                               InitAnswers given);

}  // namespace kinecal
