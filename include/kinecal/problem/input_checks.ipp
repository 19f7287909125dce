// What a problem refuses when parameters, frames, terms and samples are added.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/problem/term.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// @throws std::invalid_argument  if a number of a term cannot be used
inline void check_number(const std::string& whose, const char* what, double number, bool is_right,
                         const char* rule) {
  if (is_right) return;
  std::ostringstream message;
  message << whose << ": " << what << " is " << number << "; it must be " << rule;
  throw std::invalid_argument(message.str());
}

/// Checks scale, sigma and loss of an error block or prior.
inline void check_options(const std::string& whose, const TermOptions& options) {
  const double sigma = options.sigma.value_or(1.0), loss = options.loss.scale;
  check_number(whose, "scale", options.scale, std::isfinite(options.scale) && options.scale >= 0.0,
               "finite and not negative");
  check_number(whose, "sigma", sigma, std::isfinite(sigma) && sigma > 0.0, "positive");
  check_number(whose, "the scale of its loss", loss,
               options.loss.type == LossType::none || (std::isfinite(loss) && loss > 0.0),
               "positive");
}

/// Checks scales and means of a prior.
inline void check_prior(const std::string& whose, const Prior& prior) {
  for (const double scale : {prior.joint_scale, prior.position_scale, prior.rotation_scale}) {
    check_number(whose, "a scale", scale, std::isfinite(scale), "finite");
  }
  for (const double mean : prior.mean) {
    check_number(whose, "a mean", mean, std::isfinite(mean), "finite");
  }
}

/// Checks that each free frame is a joint, or has a parameter.
inline void check_frames(const Robot& robot, const ParameterTable& table,
                         const std::set<std::string>& frames) {
  for (const std::string& frame : frames) {
    const bool has_one = std::any_of(kFrameAxes.begin(), kFrameAxes.end(), [&](auto axis) {
      return table.find(parameter_name(frame, axis)) >= 0;
    });
    if (has_one || robot.has_joint(frame)) continue;
    std::vector<std::string> names;
    for (const Joint& joint : robot.joints()) names.push_back(joint.name);
    throw std::invalid_argument("free frame '" + frame +
                                "' is not a joint of the robot, and no parameter of it (" +
                                parameter_name(frame, kFrameAxes.front()) + " ... " +
                                parameter_name(frame, kFrameAxes.back()) + ") is in the table" +
                                did_you_mean(frame, names));
  }
}

/// Checks that a sample has one position of each joint and at most one observation of each sensor.
inline void check_lists(const Sample& sample) {
  const std::size_t names = sample.joint_names.size(), positions = sample.joint_positions.size();
  if (names != positions) {
    throw SampleError("it has " + std::to_string(names) + " joint names, but positions of " +
                      std::to_string(positions));
  }
  for (const Observation& seen : sample.observations) {
    if (sample.observation(seen.sensor) == &seen) continue;
    throw SampleError("it has two observations of sensor '" + seen.sensor + "'");
  }
}

}  // namespace kinecal::detail
