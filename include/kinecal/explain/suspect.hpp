// A suspect: something that may be wrong with samples, a configuration or a robot, and how it is undone.
//
//   Suspect{.undone = "with the positions of 'elbow' negated",
//           .correct = [](Sample& sample) { *position_in(sample, "elbow") *= -1.0; }}
//
// explain_fit() weighs all suspects together; a program's own are given to it, or to calibrate_robot() in
// CalibrationOptions::suspects.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// What a suspect is.  Of suspects that explain the same, the first kind is named first: an engineer looks for simple
/// mistakes before wrong parameters, and for these before properties that the model lacks.
enum class SuspectKind {
  mistake,   ///< in samples or the configuration: names, signs, order, units, axes, rows
  zero,      ///< of a joint, a quarter or half turn off
  property,  ///< of the robot or a sensor: joints that are coupled, a scale
};

/// Something that may be wrong.  One of the functions undoes it.
struct Suspect {
  std::string undone;  ///< "with the positions of 'a' and 'b' exchanged"
  SuspectKind kind = SuspectKind::mistake;
  std::function<void(Sample&)> correct = {};  ///< in one sample
  /// In all samples, as they were recorded; leaves their number.  The first and the last one may become wrong.
  std::function<void(std::vector<Sample>&)> correct_all = {};
  std::function<void(Config&)> correct_config = {};
  /// In one sample, multiplies lengths by a factor that the fit chooses.
  std::function<void(Sample&, double factor)> scale = {};
  double shrinks =
      1.0;  ///< factor on lengths, and so on residuals, which would pass for a better fit
  std::string sign_of = {};  ///< joint whose sign it is: signs are tried together, too
  std::string zero_of = {};  ///< joint whose zero it moves
};

/// The position of a joint in a sample; nullptr if it has none.
[[nodiscard]] double* position_in(Sample& sample, const std::string& joint);

/// All that kinecal suspects: signs, order and names of joints, quarter turns of zeros, couplings, order of features, units,
/// axes and scale of points, forms of poses, signs, order and units of what a base reads, frames and observations of models, rows that belong to neighbours.
/// @param samples  that fit badly
[[nodiscard]] std::vector<Suspect> suspects_of(const Config& config, const Robot& robot,
                                               std::span<const Sample> samples);

}  // namespace kinecal
