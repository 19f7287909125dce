// Assesses a step of a calibration: noise, uncertainty, observability, held-out error, bad
// captures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/captures/captures.hpp"
#include "kinecal/trust/held_out.hpp"
#include "kinecal/trust/noise/common_noise.hpp"
#include "kinecal/trust/noise/neighbours.hpp"
#include "kinecal/trust/prior_pulls.hpp"
#include "kinecal/trust/systematic/alike_pixels.hpp"
#include "kinecal/trust/systematic/folded_lens.hpp"
#include "kinecal/trust/systematic/systematic_error.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"
#include "kinecal/trust/uncertainty/projection_map.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

/// A joint, frame, sensor or error block whose parameters might as well be held.
struct IdleGroup {
  std::string owner;            ///< "elbow_flex_joint"
  std::vector<int> parameters;  ///< table indices
  double statistic = 0.0;       ///< d^T C^-1 d of their changes; about `rank` by chance
  int rank = 0;                 ///< number of determined combinations among them
};

/// The quality of a step.
struct Assessment {
  std::string step;                    ///< its name
  Observability observability;         ///< of all free parameters
  std::vector<BlockNoise> noise;       ///< of each error block
  CommonNoise common;                  ///< that features of a pose share
  std::vector<int> parameters;         ///< table indices: columns of the uncertainty
  std::vector<int> at_bound;           ///< table indices of free parameters that ended at a bound
  Uncertainty uncertainty;             ///< of `parameters`
  WeakParameters weak;                 ///< poorly determined ones of `parameters`
  std::vector<HeldOutError> held_out;  ///< of each error block; empty if there are too few samples
  std::vector<CaptureError> captures;  ///< of each sample
  double noise_without_bad = 1.0;      ///< ratio to that of all samples
  std::optional<SystematicError> systematic;  ///< what explains the residuals best
  std::vector<FoldedLens> folded;             ///< lenses that fold over inside the image
  std::vector<ProjectionMap> maps;            ///< of cameras of which something is free
  std::vector<AlikePixels> alike;             ///< of the same cameras
  std::vector<IdleGroup> idle;                ///< whose parameters improve nothing
  std::vector<PriorPull> pulls;               ///< priors that the samples contradict
  /// Of each pair of frames that error blocks compare: a camera's come once, the first block's first.
  std::vector<PoseUncertainty> compared;
  std::vector<PoseUncertainty> between;  ///< of each pair of AssessOptions::between
  std::int64_t rows = 0;                 ///< residuals, without priors
  double used = 0.0;                     ///< of these, by poses that samples have of their own
  std::int64_t samples = 0;              ///< their number
  double readings = 1.0;                 ///< samples per pose: see pose_groups()
  std::int64_t views = 0;                ///< different poses: see distinct_poses()
  bool one_pose = false;                 ///< all samples are of one pose of the robot
  Neighbours neighbours;                 ///< whether consecutive poses err alike
  double size = 0.0;                     ///< of the robot: longest chain, sum of its links, metres

  /// Standard deviation of a parameter of the table; nullopt if the step does not free it.
  [[nodiscard]] std::optional<double> deviation(int parameter) const;
};

/// What to compute.
struct AssessOptions {
  int folds = 5;  ///< for held-out errors; as many as samples: leave-one-out; below 2: none
  ProgressMeter meter = {};  ///< called after each fold
  /// Sensors, links or frames: the pose of each one in each one before it gets a +-.
  std::vector<std::string> between = {};
};

/// Assesses each step of a finished calibration, at its result.
/// @param samples  those of the problems, in their order
[[nodiscard]] std::vector<Assessment> assess(const Calibration& calibration,
                                             const CalibrationResult& result,
                                             std::span<const Sample> samples,
                                             const AssessOptions& options = {});

/// Assesses one step.
/// @param values  of all parameters of the table: its solution
/// @throws std::domain_error      if a residual is undefined there
/// @throws std::invalid_argument  if a name of AssessOptions::between is unknown: see frame_named()
[[nodiscard]] Assessment assess(const AnyProblem& problem, const FreeSet& free,
                                ParameterValues values, std::span<const Sample> samples,
                                const AssessOptions& options = {});

namespace detail {

/// The last assessment's entry for an error block; nullptr if absent.
template <class T>
[[nodiscard]] const T* of_block(const std::vector<Assessment>& assessments,
                                std::vector<T> Assessment::*list, const std::string& name) {
  for (auto a = assessments.rbegin(); a != assessments.rend(); ++a) {
    for (const T& item : (*a).*list) {
      if (item.block == name) return &item;
    }
  }
  return nullptr;
}

}  // namespace detail

}  // namespace kinecal
