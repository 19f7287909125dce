// Checks a recording, and finds when the robot stood still.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/detect/listed.ipp"
#include "kinecal/tools/detect/raw_view.ipp"
#include "kinecal/tools/detect/recorded_views.hpp"

namespace kinecal::detail {

/// Warnings about skipped messages; an error if a camera has no others.
inline void report_messages(const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
                            const std::string& file, Diagnostics& diagnostics) {
  std::set<std::string> used;
  for (const ViewTopics& camera : cameras) {
    for (const std::string& topic : parts_of(camera)) used.insert(topic);
    if (!camera.camera_info.empty()) used.insert(camera.camera_info);
  }
  for (const auto& [name, topic] : survey.topics) {
    if (used.count(name) == 0 && topic.topic.type != "sensor_msgs/JointState") continue;
    const std::string about = "topic '" + printable(name) + "': ";
    if (topic.damaged > 0) {
      const std::string text = about + std::to_string(topic.damaged) + " of " +
                               std::to_string(topic.messages) +
                               " messages cannot be read; the first: " + topic.damage;
      if (topic.damaged == topic.messages && used.count(name) > 0) {
        diagnostics.error({file, 0}, text);
      } else {
        diagnostics.warning({file, 0}, text);
      }
    }
    if (topic.unstamped > topic.damaged) {
      diagnostics.warning({file, 0}, about + std::to_string(topic.unstamped) +
                                         " messages have no stamp; their times of recording are "
                                         "used");
    }
    if (topic.camera_changes) {
      diagnostics.warning({file, 0}, about + "the camera's settings change; the first are used");
    }
    if (!topic.image_part.empty()) diagnostics.warning({file, 0}, about + topic.image_part);
  }
}

/// An error if camera and joints never overlap in time; a doubt if their clocks seem to differ.
inline void check_clocks(const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
                         const std::string& file, Diagnostics& diagnostics) {
  constexpr std::chrono::seconds kSameClock{1};
  const auto joints = survey.joints.span();
  for (const ViewTopics& camera : cameras) {
    const std::string name = parts_of(camera).front();
    const auto& views = survey.topics.at(name).views;
    if (!joints || views.empty()) continue;
    const auto [first, last] = std::minmax_element(
        views.begin(), views.end(),
        [](const ViewStamp& a, const ViewStamp& b) { return a.stamp < b.stamp; });
    if (last->stamp < joints->begin || first->stamp > joints->end) {
      diagnostics.error({file, 0}, "topic '" + printable(name) + "': its stamps are from " +
                                       stamp_text(first->stamp) + " to " + stamp_text(last->stamp) +
                                       ", those of the joint states from " +
                                       stamp_text(joints->begin) + " to " +
                                       stamp_text(joints->end) +
                                       ": they are of another clock, or recorded at another time");
      continue;
    }
    std::vector<std::int64_t> ahead;
    for (const ViewStamp& view : views) ahead.push_back(view.ahead);
    const Stamp apart(median_of(ahead) - median_of(survey.joints_ahead));
    if (std::chrono::abs(apart) <= kSameClock) continue;
    diagnostics.doubt({file, 0}, "topic '" + printable(name) + "': its stamps are " +
                                     stamp_text(std::chrono::abs(apart)) +
                                     (apart > Stamp{} ? " behind" : " ahead of") +
                                     " those of the joint states, by the times of recording; "
                                     "synchronise the clocks (ntp, use_sim_time)");
  }
}

/// The times when the robot stood still; an error if it never did.
[[nodiscard]] inline std::vector<Standstill> find_standstills(const RecordedSurvey& survey,
                                                              const RecordingOptions& options,
                                                              Diagnostics& diagnostics) {
  const std::set<std::string> names = survey.joints.names();
  for (const std::string& joint : options.restless) {
    if (names.count(joint) > 0) continue;
    diagnostics.error({options.path, 0}, "has no joint '" + printable(joint) + "'" +
                                             did_you_mean(joint, std::vector<std::string>(
                                                                     names.begin(), names.end())));
  }
  std::vector<Standstill> times = survey.joints.standstills(options.restless, options.settle);
  if (!times.empty() || !diagnostics.errors.empty()) return times;
  std::string text = "the robot never stands still for " + seconds_text(options.settle.window);
  std::vector<std::string> moving = survey.joints.never_still(options.settle);
  std::erase_if(moving,
                [&](const std::string& joint) { return options.restless.count(joint) > 0; });
  if (moving.empty() || moving.size() + options.restless.size() == names.size()) {
    text += "; let it rest for a second in each pose";
  } else {
    text += ": joints " + listed(moving) +
            " always move; name those that need not stand still with --restless";
  }
  diagnostics.error({options.path, 0}, text);
  return times;
}

}  // namespace kinecal::detail
