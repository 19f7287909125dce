// A capture session: the robot moves from pose to pose, finders look, samples are recorded.
//
// For each pose: move, wait until joints and image are still, run the pose's finders, check that
// nothing moved meanwhile.  A pose that fails is skipped, with the reason.  The session stores
// nothing: the observer writes each sample at once, so a crash loses at most the one in progress.
// A stream that is silent in two poses is dead, and ends the session; so is a camera that shows the
// same image, pixel for pixel, after a joint has moved.  Before the first motion, one
// look at joints, cameras and clocks finds what would fail in every pose; the same fault in the first
// three poses ends the session, too.
//
// A function supplies the next pose: from a list, from a list without the poses recorded earlier,
// or from a person who moves the robot (a pose without joints).
// Source: Fetch paper, III-A.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/session/session_faults.hpp"

namespace kinecal {

/// Supplies the next pose; nullopt ends the session.
using NextPose = std::function<std::optional<CapturePose>()>;
/// Receives each finished pose; writes its samples.
using PoseObserver = std::function<void(const CapturedPose&)>;

/// Runs a session until there is no next pose.
/// @param finders  a pose that names no finders uses all
/// @param took     may throw, which ends the session
/// @throws std::invalid_argument  if a pose names a finder that does not exist
/// @throws ConnectionError        if the connection is lost, or a stream is silent in two poses;
///                                finished poses are kept
/// @throws HopelessError          if what a first look finds, or the first poses, fail alike
template <RobotArm A>
void run_session(A& arm, const NextPose& next, std::span<const SessionFinder> finders,
                 const PoseObserver& took, const SessionOptions& options = {});

/// The poses of a list, one after the other.
[[nodiscard]] NextPose poses_of(std::vector<CapturePose> poses);

/// The poses not captured yet, to resume a session: each sample counts for the first pose that its
/// joint positions match.
/// @param settling  tolerance of a joint, and joints that turn without end
[[nodiscard]] std::vector<CapturePose> poses_left(std::span<const CapturePose> poses,
                                                  std::span<const Sample> samples,
                                                  const SettleOptions& settling = {});

/// A finder of one view, for a session.
/// @param camera  must outlive the result
template <Finder F, RobotCamera C>
[[nodiscard]] SessionFinder session_finder(std::string name, F finder, C& camera) {
  return {std::move(name), [&camera](Stamp after) { return camera.next_view(after); },
          [finder = std::move(finder)](const View& view) { return finder.find(view); }};
}

namespace detail {

/// The finders that a pose asks for.
/// @throws std::invalid_argument  naming the one that does not exist
[[nodiscard]] std::vector<const SessionFinder*> finders_of(const CapturePose& pose,
                                                           std::span<const SessionFinder> finders);

/// Samples of the finders' observations at these joint positions.
[[nodiscard]] std::vector<Sample> samples_of(const MeasuredJoints& joints,
                                             std::span<const FinderOutcome> outcomes);

/// Why a sample cannot be used: a joint that moved while finders looked; empty if none did.
[[nodiscard]] std::string moved_meanwhile(const MeasuredJoints& before, const MeasuredJoints& after,
                                          const SessionOptions& options);

/// Runs the finders of a pose where the robot stands, and returns their results.
template <RobotArm A>
void look(A& arm, const MeasuredJoints& joints, std::span<const SessionFinder* const> finders,
          const SessionOptions& options, FrozenCameras& frozen, CapturedPose& captured) {
  for (const SessionFinder* finder : finders) {
    FinderOutcome& outcome = captured.outcomes.emplace_back();
    outcome.finder = finder->name;
    outcome.view = settle_image(finder->next_view, joints.stamp, options.settling);
    outcome.view.joints = joints;
    outcome.found = finder->find(outcome.view);
  }
  frozen.add(joints, captured.outcomes, options.settling);
  Stamp latest = joints.stamp;
  for (const FinderOutcome& outcome : captured.outcomes) {
    latest = std::max(latest, outcome.view.stamp);
  }
  // The sample gets the later positions: by then the last motion is over.
  const MeasuredJoints now = settle_joints(arm, {}, latest, options.settling);
  captured.failure = moved_meanwhile(joints, now, options);
  if (captured.failure.empty()) captured.samples = samples_of(now, captured.outcomes);
}

}  // namespace detail

template <RobotArm A>
void run_session(A& arm, const NextPose& next, std::span<const SessionFinder> finders,
                 const PoseObserver& took, const SessionOptions& options) {
  Stamp now = Stamp::min();
  detail::SilentStreams silent;
  detail::AlikeFaults alike;
  detail::FrozenCameras frozen;
  bool has_looked = !options.look_first;
  while (std::optional<CapturePose> pose = next()) {
    CapturedPose captured;
    captured.pose = std::move(*pose);
    const auto wanted = detail::finders_of(captured.pose, finders);
    if (!std::exchange(has_looked, true)) {
      const std::string why = detail::first_look(arm, captured.pose, wanted, options);
      if (!why.empty()) throw HopelessError(why + "; the robot has not moved");
    }
    std::optional<Stamp> start;
    std::string dead;
    try {
      now = arm.next_joints(now).stamp;
      start = now;
      const JointTarget target{captured.pose.joint_names, captured.pose.positions,
                               options.velocity_factor};
      if (!target.names.empty()) arm.move(target);
      const MeasuredJoints joints = settle_joints(arm, target, now, options.settling);
      detail::look(arm, joints, wanted, options, frozen, captured);
      now = arm.next_joints(joints.stamp).stamp;
    } catch (const SilenceError& error) {
      captured.failure = error.what();
      dead = silent.add(error);
    } catch (const PoseError& error) {
      captured.failure = error.what();
    }
    if (start) captured.duration = now - *start;
    took(captured);
    if (!dead.empty()) throw ConnectionError(dead);
    const std::string why = alike.add(captured, options.hopeless);
    if (!why.empty()) throw HopelessError(why);
  }
}

}  // namespace kinecal
