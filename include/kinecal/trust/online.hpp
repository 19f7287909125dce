// A calibration that follows a capture session.  After each sample it gives the solution, the
// uncertainty of the gripper's pose in the camera's frame, whether the sample fits the others, and
// the next move.
//
// All samples stay in batches.  An update takes a few Gauss-Newton steps from the last solution on
// their normal equations: a fraction of a millisecond for a hundred samples.  It needs a start near
// the solution: see calibrate() for one.
//
// A new sample is tested before it is used.  With residuals r and derivatives A at the current
// solution,
//
//   X = r^T (s^2 I + A C A^T)^-1 r / rows      is F with rows and n - rank degrees of freedom,
//
// C the current covariance and s the noise.  From the ninth sample on, a sample is left out if
// chance makes one as bad once in a million times and it is off by three times the noise.  So are
// earlier samples that turn out not to fit, judged by the median sample's noise: a bad one among
// the first few is indistinguishable from the others.
// Samples may have poses of their own, such as that of a board that a person holds: each new sample brings the one
// with which it begins.  The next move is not known then.
// Source: Bar-Shalom et al., Estimation with Applications to Tracking and Navigation, 5.4
// (innovations).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal {

/// The state after a sample.
struct OnlineState {
  int samples = 0;   ///< in the solution
  bool fits = true;  ///< false: the last sample does not fit the others and was left out
  std::vector<int> dropped = {};  ///< earlier ones that no longer fit, by number of add(), from 1
  double times = 0.0;     ///< root of X of the last sample: 1 is usual; 0 if it was not tested
  bool known = false;     ///< the samples determine the pose, with redundancy, also ahead
  double position = 0.0;  ///< standard deviation of the pose, metres: see PoseUncertainty; the
                          ///< larger of captured poses and poses ahead
  double rotation = 0.0;  ///< the same, radians
  double noise = 0.0;     ///< root of the mean weighted squared residual, by degrees of freedom
};

/// What the next pose should change.
struct NextMove {
  std::string joint;      ///< to move
  double change = 0.0;    ///< from its current position, radians or metres
  double position = 0.0;  ///< expected standard deviation of the pose with that sample, metres
};

/// Follows a session.  Not thread-safe.
class OnlineCalibration {
 public:
  /// Makes the problem without samples.
  using MakeProblem = std::function<std::unique_ptr<AnyProblem>()>;

  /// @param values  of all parameters of the table: near the solution
  /// @param frame   whose pose is wanted: the gripper
  /// @param in      the frame in which it is given: the camera
  /// @throws RobotError             if a link does not exist
  OnlineCalibration(MakeProblem make, const FreeSet& free, ParameterValues values,
                    const FrameOnRobot& frame, const FrameOnRobot& in);
  ~OnlineCalibration();
  OnlineCalibration(OnlineCalibration&&) noexcept;
  OnlineCalibration& operator=(OnlineCalibration&&) noexcept;

  /// Poses ahead, where the pose is wanted as well: uses only their joint positions.
  void expect(std::vector<Sample> poses);

  /// Takes the next sample.
  /// @throws SampleError  if the sample does not match the problem; it is not added
  OnlineState add(const Sample& sample);

  /// Values of all parameters of the table.
  [[nodiscard]] const std::vector<double>& values() const;

  /// The most informative joint to move from the last sample's pose: after it, the pose is known
  /// best.  Skips moves that leave the limits or take the frame's origin out of the camera's image.
  /// nullopt without samples or if no move helps.
  /// @param step  of revolute joints, radians; sliding joints move by a fifth of it, metres
  [[nodiscard]] std::optional<NextMove> next_move(double step = 0.4) const;

 private:
  struct Impl;  // holds matrices: created and destroyed by one library
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinecal
