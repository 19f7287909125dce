// Several arms and cameras in one configuration: answers for each camera with each arm that it can see.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// Answers for each arm with each camera that does not move with it.  Of several cameras, each has the name of its link; of
/// several arms, each holds a target of its own, and the sensor that holds it has the name of the arm's link.
/// @param given    what all of them share; with the target
/// @param arms     links; empty if the target needs none
/// @param cameras  links; empty if the target needs none
/// @throws InputError  if a link occurs twice, or an arm or a camera has no other to go with
[[nodiscard]] std::vector<InitAnswers> answers_of_all(const Robot& robot, const InitAnswers& given,
                                                      const std::vector<std::string>& arms,
                                                      const std::vector<std::string>& cameras);

/// Answers from samples, as answers_from_samples(): for each camera with each sensor whose points it sees.
/// @param given  of one camera: arm, camera and names that are not empty are kept; of several: only the base
/// @throws InputError  as answers_from_samples(); also if two targets have one frame, or one of several arms is not in the URDF
[[nodiscard]] std::vector<InitAnswers> all_answers_from_samples(const Robot& robot,
                                                                std::span<const Sample> samples,
                                                                const InitAnswers& given);

/// Lets the answers find where robots stand: all but the first, which stands where the URDF has it.
/// @param stands  their joints, as stand_joint() names them
/// @throws InputError  if no answer relates a robot to the first, by others or itself
void relate_stands(const Robot& robot, const std::vector<std::string>& stands,
                   std::vector<InitAnswers>& all);

/// "left_eye sees right_hand; right_eye sees left_hand"; without a camera, the arms.
[[nodiscard]] std::string pairs_text(const std::vector<InitAnswers>& all);

}  // namespace kinecal
