// Definitions of session_faults.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/session_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

std::string like_degrees(const MeasuredJoints& joints, const Robot& robot) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kMargin = 0.2;  // radians
  for (std::size_t i = 0; i < joints.names.size(); ++i) {
    const std::string& name = joints.names[i];
    if (!robot.has_joint(name)) continue;
    const Joint& joint = robot.joint(name);
    if (joint.type != JointType::revolute || !joint.limits) continue;
    const auto [lower, upper] = *joint.limits;
    const double q = joints.positions[i], beyond = std::max(lower - q, q - upper);
    const bool is_far = beyond > upper - lower || (beyond > kMargin && std::abs(q) > kTurn);
    if (!(upper > lower) || !is_far) continue;
    std::ostringstream text;
    text << "joint '" << name << "' is at " << q << ", far beyond its limits of " << lower << " to "
         << upper << " rad: are positions in degrees? radians are expected";
    return text.str();
  }
  return {};
}

namespace detail {

std::string SilentStreams::add(const SilenceError& error) {
  const auto [known, is_first] = newest_.try_emplace(error.stream, error.newest);
  const bool is_dead = !is_first && known->second == error.newest;
  known->second = error.newest;
  return is_dead ? std::string(error.what()) + "; the same in two poses" : std::string();
}

std::string AlikeFaults::add(const CapturedPose& pose, int most) {
  found_ = found_ || !pose.samples.empty();
  if (found_ || most <= 0) return {};
  std::string why = pose.failure;
  for (const FinderOutcome& outcome : pose.outcomes) {
    if (!pose.failure.empty() || outcome.found) continue;
    why += (why.empty() ? "" : "; ") + outcome.finder + ": " + outcome.found.refusal;
  }
  std::string plain = why;
  std::erase_if(plain, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; });
  count_ = plain == last_ ? count_ + 1 : 1;
  last_ = plain;
  if (count_ < most) return {};
  return "the same in " + std::to_string(count_) + " poses in a row, and nothing was found: " + why;
}

void FrozenCameras::add(const MeasuredJoints& joints, std::span<const FinderOutcome> outcomes,
                        const SettleOptions& options) {
  const auto same_point = [](const Vector3<float>& a, const Vector3<float>& b) {
    return a == b || (!a.allFinite() && !b.allFinite());
  };
  for (const FinderOutcome& outcome : outcomes) {
    const View& view = outcome.view;
    if (!outcome.found || view.image.empty()) continue;
    const auto [known, is_new] =
        last_.try_emplace(outcome.finder, Seen{joints, view.stamp, view.image, view.points});
    if (is_new) continue;
    Seen& seen = known->second;
    const bool is_same =
        seen.image.width == view.image.width && seen.image.height == view.image.height &&
        seen.image.pixels == view.image.pixels &&
        std::equal(seen.points.pixels.begin(), seen.points.pixels.end(), view.points.pixels.begin(),
                   view.points.pixels.end(), same_point);
    for (std::size_t i = 0; is_same && i < joints.names.size(); ++i) {
      const std::string& name = joints.names[i];
      const double before = seen.joints.position(name).value_or(joints.positions[i]);
      if (joint_distance(name, before, joints.positions[i], options.continuous) <= options.arrival)
        continue;
      std::ostringstream text;
      text << outcome.finder << ": its camera is frozen: joint '" << name << "' has moved from "
           << before << " to " << joints.positions[i]
           << ", but each pixel is as in the pose before; restart the camera's driver";
      throw SilenceError(text.str(), outcome.finder, seen.stamp);
    }
    if (!is_same) seen = {joints, view.stamp, view.image, view.points};
  }
}

std::string not_measured(const CapturePose& pose, const MeasuredJoints& joints) {
  for (const std::string& joint : pose.joint_names) {
    if (joints.position(joint)) continue;
    return "joint '" + joint + "' of the poses is not measured" + did_you_mean(joint, joints.names);
  }
  return {};
}

std::string useless_views(const SessionFinder& finder, Stamp joints, const SettleOptions& options) {
  const View view = finder.next_view(joints);
  std::string why = clock_fault(view.stamp, joints, options);
  if (why.empty() && finder.fault) why = finder.fault(view);
  return why.empty() ? why : finder.name + ": " + why;
}

}  // namespace detail
}  // namespace kinecal
