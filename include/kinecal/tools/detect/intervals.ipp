// Intervals of a recording that give a view each while the robot moves.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "kinecal/text/counted.hpp"
#include "kinecal/tools/detect/raw_view.ipp"
#include "kinecal/tools/detect/recorded_survey.ipp"
#include "kinecal/tools/detect/recorded_views.hpp"

namespace kinecal::detail {

/// The view of a camera nearest to the middle of an interval; none if it has none there.
/// @param views  sorted
[[nodiscard]] inline std::vector<ViewStamp> middle_view(const std::vector<ViewStamp>& views,
                                                        const Standstill& time) {
  const ViewStamp* nearest = nearest_view(views, time.begin + (time.end - time.begin) / 2);
  if (nearest == nullptr || nearest->stamp < time.begin || nearest->stamp >= time.end) return {};
  return {*nearest};
}

/// Intervals [begin, begin + every) from the first reading of a joint to the last, those in which a
/// camera has a view.  The last one ends with the joints.
[[nodiscard]] inline std::vector<Standstill> intervals_with_views(
    const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras, Stamp every) {
  const auto joints = survey.joints.span();
  if (!joints) return {};
  std::set<std::int64_t> numbers;
  for (const ViewTopics& camera : cameras) {
    for (const ViewStamp& view : survey.topics.at(parts_of(camera).front()).views) {
      if (view.stamp < joints->begin || view.stamp > joints->end) continue;
      numbers.insert((view.stamp - joints->begin) / every);
    }
  }
  std::vector<Standstill> intervals;
  for (const std::int64_t number : numbers) {
    const Stamp begin = joints->begin + number * every;
    intervals.push_back({begin, std::min(begin + every, joints->end + Stamp(1))});
  }
  return intervals;
}

/// Whether joints stand where they stood in another view.  A robot that swings comes by the same
/// place at speed.
[[nodiscard]] inline bool stand_there(const MeasuredJoints& joints, const MeasuredJoints& before) {
  constexpr double kMoved = 1e-3;  // radians or metres
  constexpr double kMoves = 1e-2;  // rad/s or m/s
  for (std::size_t i = 0; i < joints.names.size(); ++i) {
    const auto stood = before.position(joints.names[i]);
    if (!stood || std::abs(unwrapped_step(*stood, joints.positions[i])) >= kMoved) return false;
    if (std::abs(joints.velocities[i]) >= kMoves) return false;
  }
  return true;
}

/// Leaves out intervals in which the robot rests where it was in the last view.
/// @returns  how many
inline std::size_t leave_out_rests(const RecordedSurvey& survey,
                                   const std::vector<ViewTopics>& cameras,
                                   std::vector<Standstill>& intervals) {
  MeasuredJoints last;
  return std::erase_if(intervals, [&](const Standstill& time) {
    for (const ViewTopics& camera : cameras) {
      for (const ViewStamp& view :
           middle_view(survey.topics.at(parts_of(camera).front()).views, time)) {
        JointsInMotion now = survey.joints.motion(view.stamp);
        if (!now.refusal.empty()) return false;  // the view says why it is refused
        if (!last.names.empty() && stand_there(now.joints, last)) return true;
        last = std::move(now.joints);
        return false;
      }
    }
    return false;
  });
}

/// The intervals that give views; an error without any, a note about those left out.
[[nodiscard]] inline std::vector<Standstill> find_intervals(const RecordedSurvey& survey,
                                                            const std::vector<ViewTopics>& cameras,
                                                            const RecordingOptions& options,
                                                            Diagnostics& diagnostics) {
  std::vector<Standstill> times = intervals_with_views(survey, cameras, options.every);
  if (times.empty()) {
    diagnostics.error({options.path, 0}, "has no image while joints are measured");
    return times;
  }
  const std::size_t rests = leave_out_rests(survey, cameras, times);
  if (rests > 0) {
    diagnostics.notes.push_back(options.path + ": left out " + counted(rests, "view") +
                                " in which the robot rests where it was in the view before");
  }
  return times;
}

}  // namespace kinecal::detail
