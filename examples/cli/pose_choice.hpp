// Candidate poses, and the expected accuracy of a calibration with some of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/study/motion_order.hpp"
#include "kinecal/study/sample_design.hpp"
#include "kinecal/study/select_poses.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// The poses of a study as candidates.
struct PoseChoice {
  std::vector<Sample> samples;      ///< exact ones
  StudyDesign design;               ///< of these samples
  PoseCandidates candidates;        ///< the same, to select from
  std::vector<std::string> joints;  ///< that move what is observed
  JointPlaces places;               ///< of these joints, radians or metres
  std::vector<double> speeds;       ///< of these joints, radians or metres per second
  std::vector<int> have = {};       ///< samples that exist already, the last ones: no candidates
  int determined = 0;               ///< directions that all samples and priors determine
};

/// Drops the poses to choose from that are like one that exists already.
/// @param least_distance  see SelectOptions
/// @throws InputError  if no pose is left
void drop_poses_of_have(StudyInput& input, double least_distance);

[[nodiscard]] PoseChoice pose_choice(const StudyInput& input);

/// These samples and those that exist already.
[[nodiscard]] std::vector<int> with_existing(const PoseChoice& choice,
                                             const std::vector<int>& chosen);

/// Expected standard deviation of the pose that is judged with these samples and those that exist,
/// metres; infinite if they determine less than all poses do.
[[nodiscard]] double expected_position(const PoseChoice& choice, const std::vector<int>& chosen);

/// What may remain so that a spread becomes no more than a tenth worse than what is asked for,
/// metres.
[[nodiscard]] double tolerated_error(double spread, double wanted);

/// "0.497 mm", "not determined".
[[nodiscard]] std::string millimetres(double metres);

/// What the uncertainty is of, if the robot is its own target: a sentence.
[[nodiscard]] std::string surface_text(const StudyInput& input);

/// Median of expected_position() of random sets, metres.
/// @param meter  called now and then
[[nodiscard]] double random_position(const PoseChoice& choice, int count,
                                     const ProgressMeter& meter = {});

/// The least number of poses with which the median of random sets is as good, and that median; one
/// more than all if no number suffices.
/// @param meter  called now and then
[[nodiscard]] int random_poses_for(const PoseChoice& choice, double position,
                                   const ProgressMeter& meter = {});

/// Seconds of a session with poses in this order: moves, and what each stop takes.
[[nodiscard]] double session_seconds(const PoseChoice& choice, const std::vector<int>& order);

/// "1 min 20 s".
[[nodiscard]] std::string duration_text(double seconds);

/// Poses in an order of short ways.
[[nodiscard]] std::vector<int> short_order(const PoseChoice& choice, std::vector<int> chosen);

/// The poses of a study, by index.
[[nodiscard]] std::vector<CapturePose> poses_of_choice(const StudyInput& input,
                                                       const std::vector<int>& chosen);

}  // namespace kinecal::cli
