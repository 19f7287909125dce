// A capture session: the robot moves from pose to pose, finders look, samples are recorded.
//
// For each pose: move, wait until joints and image stand still, run the finders that the pose asks
// for, check that nothing moved meanwhile.  A pose that fails is skipped, with the reason.  Nothing
// is kept here: the observer writes each sample as soon as it is there, so a crash loses at most the
// one in progress.  A stream that is silent in two poses is dead, and ends the session.
//
// Where the next pose comes from is a function: a list, a list without what an earlier session has
// recorded, or a person who puts the robot somewhere (a pose without joints).
// Source: Fetch paper, III-A.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/capture/capture_pose.hpp"
#include "kinecal/capture/settling.hpp"

namespace kinecal {

/// A finder of a session: what it looks at, and what it does with it.
struct SessionFinder {
  std::string name;                              ///< as poses name it
  std::function<View(Stamp after)> next_view;    ///< of its camera: see Camera
  std::function<Found(const View& still)> find;  ///< receives a view in which nothing moves
};

/// How a session runs.
struct SessionOptions {
  double velocity_factor = 1.0;  ///< of the robot's usual speed, (0, 1]
  SettleOptions settling = {};   ///< when the robot counts as still
  double moved = 0.003;          ///< joints may move by this while finders look, radians or metres
};

/// What one finder did in one pose.
struct FinderOutcome {
  std::string finder;  ///< its name
  View view;           ///< in which it looked; its image is empty if it was never still
  Found found;         ///< what it found, or why nothing
};

/// What became of one pose.
struct CapturedPose {
  CapturePose pose;                     ///< as asked for
  std::vector<Sample> samples;          ///< none if nothing was found; one, or more where finders
                                        ///< observe with the same sensors
  std::vector<FinderOutcome> outcomes;  ///< of each finder that looked
  std::string failure;                  ///< why the pose was skipped; empty if it was not
  Stamp duration{};                     ///< of the robot's clock, for move and finders
};

/// Says which pose is next; nothing ends the session.
using NextPose = std::function<std::optional<CapturePose>()>;
/// Takes each pose when it is done; writes its samples.
using PoseObserver = std::function<void(const CapturedPose&)>;

/// Runs a session until there is no next pose.
/// @param finders  a pose without names of finders asks for all
/// @param took     may throw; what it throws ends the session
/// @throws std::invalid_argument  if a pose names a finder that does not exist
/// @throws ConnectionError        if the robot cannot be reached any more, or a stream of it delivers
///                                nothing in two poses; what was taken is taken
template <Arm A>
void run_session(A& arm, const NextPose& next, std::span<const SessionFinder> finders,
                 const PoseObserver& took, const SessionOptions& options = {});

/// The poses of a list, one after the other.
[[nodiscard]] NextPose poses_of(std::vector<CapturePose> poses);

/// The poses that were not captured yet, to resume a session: each sample is taken for the first pose
/// that its joint positions match.
/// @param arrival  by which a joint may differ from its pose, radians or metres
[[nodiscard]] std::vector<CapturePose> poses_left(std::span<const CapturePose> poses,
                                                  std::span<const Sample> samples,
                                                  double arrival = SettleOptions{}.arrival);

/// A finder of one view, for a session.
/// @param camera  must outlive the result
template <Finder F, Camera C>
[[nodiscard]] SessionFinder session_finder(std::string name, F finder, C& camera) {
  return {std::move(name), [&camera](Stamp after) { return camera.next_view(after); },
          [finder = std::move(finder)](const View& view) { return finder.find(view); }};
}

namespace detail {

/// Streams that were waited for in vain.
class SilentStreams {
 public:
  /// Why the session must end; empty if this is the stream's first silence, or it has delivered
  /// something since the last one.
  [[nodiscard]] std::string add(const SilenceError& error);

 private:
  std::map<std::string, std::optional<Stamp>> newest_;  ///< stamps, by stream
};

/// The finders that a pose asks for.
/// @throws std::invalid_argument  naming the one that does not exist
[[nodiscard]] std::vector<const SessionFinder*> finders_of(const CapturePose& pose,
                                                           std::span<const SessionFinder> finders);

/// Samples of what finders found at these joint positions.
[[nodiscard]] std::vector<Sample> samples_of(const MeasuredJoints& joints,
                                             std::span<const FinderOutcome> outcomes);

/// Why a sample cannot be used: a joint that moved while finders looked; empty if none did.
[[nodiscard]] std::string moved_meanwhile(const MeasuredJoints& before, const MeasuredJoints& after,
                                          double limit);

/// Runs the finders of a pose where the robot stands, and takes what they found.
template <Arm A>
void look(A& arm, const MeasuredJoints& joints, std::span<const SessionFinder* const> finders,
          const SessionOptions& options, CapturedPose& captured) {
  for (const SessionFinder* finder : finders) {
    FinderOutcome& outcome = captured.outcomes.emplace_back();
    outcome.finder = finder->name;
    outcome.view = settle_image(finder->next_view, joints.stamp, options.settling);
    outcome.view.joints = joints;
    outcome.found = finder->find(outcome.view);
  }
  Stamp latest = joints.stamp;
  for (const FinderOutcome& outcome : captured.outcomes) {
    latest = std::max(latest, outcome.view.stamp);
  }
  // The later positions are those of the sample: what was left of the motion is over by then.
  const MeasuredJoints now = settle_joints(arm, {}, latest, options.settling);
  captured.failure = moved_meanwhile(joints, now, options.moved);
  if (captured.failure.empty()) captured.samples = samples_of(now, captured.outcomes);
}

}  // namespace detail

template <Arm A>
void run_session(A& arm, const NextPose& next, std::span<const SessionFinder> finders,
                 const PoseObserver& took, const SessionOptions& options) {
  Stamp now = Stamp::min();
  detail::SilentStreams silent;
  while (std::optional<CapturePose> pose = next()) {
    CapturedPose captured;
    captured.pose = std::move(*pose);
    const auto wanted = detail::finders_of(captured.pose, finders);
    std::optional<Stamp> start;
    std::string dead;
    try {
      now = arm.next_joints(now).stamp;
      start = now;
      const JointTarget target{captured.pose.joint_names, captured.pose.positions,
                               options.velocity_factor};
      if (!target.names.empty()) arm.move(target);
      const MeasuredJoints joints = settle_joints(arm, target, now, options.settling);
      detail::look(arm, joints, wanted, options, captured);
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
  }
}

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/session.ipp"
#endif
