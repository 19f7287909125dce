// Definitions of session_faults.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/session_faults.hpp"

#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

std::string SilentStreams::add(const SilenceError& error) {
  const auto [known, is_first] = newest_.try_emplace(error.stream, error.newest);
  const bool is_dead = !is_first && known->second == error.newest;
  known->second = error.newest;
  return is_dead ? std::string(error.what()) + "; nothing came in two poses" : std::string();
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

}  // namespace kinecal::detail
