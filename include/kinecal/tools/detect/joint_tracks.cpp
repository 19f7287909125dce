// Definitions of joint_tracks.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_tracks.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/joint_motion.hpp"
#include "kinecal/tools/detect/joint_track.hpp"
#include "kinecal/tools/detect/listed.ipp"

namespace kinecal {

namespace detail {
namespace {

// Checks that the stamps of a joint track are usable.

/// An error if stamps go back; a warning if joints were not measured throughout.
/// @param all        from the first to the last reading of any joint
/// @param in_motion  whether views are taken while the robot moves
void check_stamps(const JointTrack& track, const Standstill& all, bool in_motion,
                  const std::string& file, Diagnostics& diagnostics) {
  const std::string about = "topic '" + printable(track.topic) + "': ";
  if (track.back) {
    diagnostics.error({file, 0},
                      about + "stamps go back from " + seconds_text(track.back->end) + " to " +
                          seconds_text(track.back->begin) +
                          ": the clock was set, or a simulation began anew; cut the recording "
                          "there");
  }
  constexpr double kMost = 0.9;
  const auto [first, last] = std::minmax_element(track.stamps.begin(), track.stamps.end());
  const std::chrono::duration<double> own = *last - *first, whole = all.end - all.begin;
  if (own >= kMost * whole) return;
  diagnostics.warning(
      {file, 0}, about + "joints " + listed(track.names) + " were measured for " +
                     seconds_text(*last - *first) + " of " + seconds_text(all.end - all.begin) +
                     (in_motion ? ", and only then are views used; choose topics with --joints"
                                : ", and only then is it known that they stand still; name those "
                                  "that need not with --restless"));
}

constexpr const char* kTwoNodes =
    ": two nodes publish it; record that of the robot's driver alone, or on a topic of its own";

/// Messages that joints cannot have been in: an error if there are many, else a warning.
void check_jumps(const JointTrack& track, const std::string& file, Diagnostics& diagnostics) {
  const std::string about = "topic '" + printable(track.topic) + "': ";
  if (track.zeros > 0) {
    diagnostics.warning({file, 0}, about + "joints " + listed(track.names) +
                                       " are zero in the first " + counted(track.zeros, "message") +
                                       ", and jump from there: left out");
  }
  if (!track.jump) return;
  constexpr double kNoise = 8.0;  // standard deviations: what is less are readings that scatter
  const auto [joint, from, to] = *track.jump;
  if (std::abs(to - from) < kNoise * track.noise[joint]) return;
  std::ostringstream text;
  text << about << "joint '" << printable(track.names[joint]) << "' jumps from " << from << " to "
       << to << " and back; so in " << track.jumps << " of " << counted(track.messages, "message");
  constexpr double kRare = 0.02;  // share of the messages
  if (static_cast<double>(track.jumps) <= kRare * static_cast<double>(track.messages)) {
    diagnostics.warning({file, 0}, text.str() + ", which are left out");
  } else {
    diagnostics.error({file, 0}, text.str() + kTwoNodes);
  }
}

/// Where two lists of joints have a joint at different places at the same time; nullopt if they
/// agree.
/// @param joint_a, joint_b  its index in each
[[nodiscard]] std::optional<std::pair<double, double>> apart(const JointTrack& a,
                                                             std::size_t joint_a,
                                                             const JointTrack& b,
                                                             std::size_t joint_b) {
  constexpr std::chrono::milliseconds kNear{50};
  constexpr std::size_t kFewest = 4;
  std::optional<std::pair<double, double>> first;
  std::size_t compared = 0, differ = 0;
  for (std::size_t i = 0; i < a.stamps.size(); ++i) {
    const auto [at, end] = b.near(a.stamps[i], {a.stamps[i], a.stamps[i]});
    const Stamp time = std::chrono::abs(b.stamps[at] - a.stamps[i]);
    if (time > kNear) continue;
    ++compared;
    if (!is_impossible(unwrapped_step(a.rows[i][joint_a], b.rows[at][joint_b]), time)) continue;
    ++differ;
    if (!first) first = {a.rows[i][joint_a], b.rows[at][joint_b]};
  }
  constexpr std::size_t kRare = 10;  // one of them
  return differ >= kFewest && kRare * differ > compared ? first : std::nullopt;
}

}  // namespace
}  // namespace detail

// Chooses the topics that joint positions are taken from.

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

inline void JointTracks::find_second_nodes(const std::string& file,
                                           Diagnostics& diagnostics) const {
  std::map<std::pair<std::string, std::string>, std::pair<const detail::JointTrack*, std::size_t>>
      known;
  for (const detail::JointTrack& track : tracks_) {
    detail::check_jumps(track, file, diagnostics);
    for (std::size_t j = 0; j < track.names.size(); ++j) {
      const auto [other, is_new] = known.try_emplace({track.topic, track.names[j]}, &track, j);
      if (is_new || !track.used[j] || track.restless[j]) continue;
      const auto places = detail::apart(*other->second.first, other->second.second, track, j);
      if (!places) continue;
      std::ostringstream text;
      text << "topic '" << printable(track.topic) << "': joint '" << printable(track.names[j])
           << "' is in two lists of joints, at " << places->first << " and " << places->second
           << " at the same time" << detail::kTwoNodes;
      diagnostics.error({file, 0}, text.str());
      return;
    }
  }
}

void JointTracks::add(const std::string& topic, const MeasuredJoints& reading) {
  std::map<std::string, double> sorted;
  bool is_whole = true;
  for (std::size_t i = 0; i < reading.names.size() && i < reading.positions.size(); ++i) {
    if (std::isfinite(reading.positions[i])) {
      sorted[reading.names[i]] = reading.positions[i];
    } else {
      ++not_finite_[{topic, reading.names[i]}];
      is_whole = is_whole && !measures(topic, reading.names[i]);
    }
  }
  if (!is_whole) return;  // a gap of joints that other tracks measure
  if (sorted.empty()) {
    silent_.insert(topic);
    return;
  }
  std::vector<std::string> names;
  std::vector<double> positions;
  for (const auto& [name, position] : sorted) names.push_back(name);
  for (const auto& [name, position] : sorted) positions.push_back(position);
  auto track = std::find_if(tracks_.begin(), tracks_.end(), [&](const detail::JointTrack& t) {
    return t.topic == topic && t.names == names;
  });
  if (track == tracks_.end()) {
    track = tracks_.emplace(tracks_.end());
    track->topic = topic;
    track->names = names;
    track->used.assign(names.size(), true);
    for (const std::string& name : names) track->restless.push_back(restless_.contains(name));
  }
  track->add({reading.stamp, std::move(positions)});
}

bool JointTracks::measures(const std::string& topic, const std::string& joint) const {
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const detail::JointTrack& track) {
    return track.topic == topic &&
           std::find(track.names.begin(), track.names.end(), joint) != track.names.end();
  });
}

void JointTracks::choose(const std::vector<std::string>& topics, const std::string& file,
                         Diagnostics& diagnostics, bool in_motion) {
  choose_topics(topics, file, diagnostics);
  settle_conflicts(file, diagnostics);
  for (detail::JointTrack& track : tracks_) track.finish();
  constexpr std::size_t kFewest = 4;
  std::erase_if(tracks_, [&](const detail::JointTrack& track) {
    if (track.stamps.size() >= kFewest) return false;
    diagnostics.warning({file, 0}, "joints " + detail::listed(track.names) + " of topic '" +
                                       track.topic + "' are left out: they were measured " +
                                       std::to_string(track.stamps.size()) + " times only");
    return true;
  });
  const std::optional<Standstill> all = span();
  for (const detail::JointTrack& track : tracks_) {
    detail::check_stamps(track, *all, in_motion, file, diagnostics);
  }
  find_second_nodes(file, diagnostics);
}

std::vector<Standstill> JointTracks::standstills(const std::set<std::string>& restless,
                                                 const SettleOptions& options) const {
  std::optional<std::vector<Standstill>> all;
  for (const detail::JointTrack& track : tracks_) {
    std::vector<std::size_t> joints;
    for (std::size_t i = 0; i < track.names.size(); ++i) {
      if (track.used[i] && restless.count(track.names[i]) == 0) joints.push_back(i);
    }
    if (joints.empty()) continue;
    const std::vector<Standstill> own = track.rests(joints, options);
    all = all ? detail::common(*all, own) : own;
  }
  if (!all && !tracks_.empty()) all = {*span()};
  if (!all) return {};
  std::erase_if(*all, [&](const Standstill& s) { return s.end - s.begin < options.window; });
  return *all;
}

std::vector<std::string> JointTracks::never_still(const SettleOptions& options) const {
  std::vector<std::string> result;
  for (const detail::JointTrack& track : tracks_) {
    for (std::size_t i = 0; i < track.names.size(); ++i) {
      if (track.used[i] && track.rests({i}, options).empty()) result.push_back(track.names[i]);
    }
  }
  return result;
}

double JointTracks::noise(const std::string& joint) const {
  double most = 0.0;
  for (const detail::JointTrack& track : tracks_) {
    for (std::size_t i = 0; i < track.names.size(); ++i) {
      if (track.used[i] && track.names[i] == joint) most = std::max(most, track.noise[i]);
    }
  }
  return most;
}

std::set<std::string> JointTracks::names() const {
  std::set<std::string> all;
  for (const detail::JointTrack& track : tracks_)
    all.insert(track.names.begin(), track.names.end());
  return all;
}

MeasuredJoints JointTracks::positions(Stamp stamp, const Standstill& during) const {
  constexpr std::chrono::milliseconds kUsual{150}, kNoisy{500};
  const double noisy = SettleOptions{}.still;
  MeasuredJoints joints;
  joints.stamp = stamp;
  for (const detail::JointTrack& track : tracks_) {
    const bool is_noisy = std::any_of(track.noise.begin(), track.noise.end(),
                                      [&](double noise) { return noise > noisy; });
    const Stamp away = is_noisy ? kNoisy : kUsual;
    const auto [first, last] = track.near(
        stamp, {std::max(during.begin, stamp - away), std::min(during.end, stamp + away)});
    for (std::size_t j = 0; j < track.names.size(); ++j) {
      if (!track.used[j] || joints.position(track.names[j])) continue;
      joints.names.push_back(track.names[j]);
      joints.positions.push_back(track.mean(j, first, last));
    }
  }
  return joints;
}

JointsInMotion JointTracks::motion(Stamp stamp) const {
  MeasuredJoints joints;
  joints.stamp = stamp;
  std::vector<std::pair<std::string, std::string>> unknown;  // joint and topic
  for (const detail::JointTrack& track : tracks_) {
    const auto weights = detail::motion_weights(track, stamp);
    for (std::size_t j = 0; j < track.names.size(); ++j) {
      if (!track.used[j] || joints.position(track.names[j])) continue;
      if (!weights) {
        unknown.emplace_back(track.names[j], track.topic);
        continue;
      }
      const detail::JointMotion motion = detail::motion_of(track, j, *weights);
      joints.names.push_back(track.names[j]);
      joints.positions.push_back(motion.position);
      joints.velocities.push_back(motion.velocity);
    }
  }
  for (const auto& [joint, topic] : unknown) {
    if (joints.position(joint)) continue;
    return {{}, detail::unknown_motion(joint, topic)};
  }
  return {std::move(joints), {}};
}

std::optional<Standstill> JointTracks::span() const {
  std::optional<Standstill> all;
  for (const detail::JointTrack& track : tracks_) {
    if (track.stamps.empty()) continue;
    const auto [first, last] = std::minmax_element(track.stamps.begin(), track.stamps.end());
    const Standstill own{*first, *last};
    if (!all) all = own;
    all = Standstill{std::min(all->begin, own.begin), std::max(all->end, own.end)};
  }
  return all;
}

}  // namespace kinecal
