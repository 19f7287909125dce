// Chooses the topics that joint positions are taken from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/joint_tracks.hpp"
#include "kinecal/tools/detect/listed.ipp"

namespace kinecal {

inline void JointTracks::choose_topics(const std::vector<std::string>& topics,
                                       const std::string& file, Diagnostics& diagnostics) {
  std::set<std::string> known;
  for (const detail::JointTrack& track : tracks_) known.insert(track.topic);
  for (const std::string& topic : silent_) {
    if (known.count(topic) > 0) continue;
    diagnostics.warning({file, 0}, "topic '" + topic + "' has joint states without positions");
  }
  for (const auto& [joint, count] : not_finite_) {
    diagnostics.warning({file, 0}, "topic '" + joint.first + "': the position of joint '" +
                                       joint.second + "' is not a number in " +
                                       std::to_string(count) + " messages");
  }
  for (const std::string& topic : topics) {
    if (known.count(topic) > 0) continue;
    diagnostics.error(
        {file, 0}, "has no joint positions on topic '" + topic + "'" +
                       did_you_mean(topic, std::vector<std::string>(known.begin(), known.end())));
  }
  std::erase_if(tracks_, [&](const detail::JointTrack& track) {
    return !topics.empty() && std::find(topics.begin(), topics.end(), track.topic) == topics.end();
  });
  if (tracks_.empty() && diagnostics.errors.empty()) {
    diagnostics.error({file, 0},
                      "has no joint positions (sensor_msgs/JointState); record joint_states, too");
  }
}

inline void JointTracks::settle_conflicts(const std::string& file, Diagnostics& diagnostics) {
  std::map<std::string, std::set<std::string>> topics_of;
  for (const detail::JointTrack& track : tracks_) {
    for (const std::string& name : track.names) topics_of[name].insert(track.topic);
  }
  std::set<std::string> taken;
  std::string conflict;
  for (const auto& [joint, topics] : topics_of) {
    if (topics.size() < 2) continue;
    if (topics.count("joint_states") == 0) {
      if (!conflict.empty()) continue;  // one example is enough
      conflict = joint;
      diagnostics.error({file, 0}, "joint '" + printable(joint) +
                                       "' is on several topics: " + detail::listed(topics) +
                                       "; choose those to use with --joints");
    }
    taken.insert(joint);
  }
  if (taken.empty() || !conflict.empty()) return;
  diagnostics.notes.push_back(file + ": positions of " + detail::listed(taken) +
                              " are taken from topic 'joint_states', although others have them");
  for (detail::JointTrack& track : tracks_) {
    if (track.topic == "joint_states") continue;
    for (std::size_t i = 0; i < track.names.size(); ++i) {
      if (taken.count(track.names[i]) > 0) track.used[i] = false;
    }
  }
}

}  // namespace kinecal
