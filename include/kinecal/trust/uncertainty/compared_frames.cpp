// Finding the frames that a problem compares.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/uncertainty/compared_frames.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Where the features of a sensor are: its link, or a virtual frame beyond it.
[[nodiscard]] FrameOnRobot frame_of_features(const AnyProblem& problem, int sensor,
                                             std::span<const Sample> samples) {
  const MountedSensor& mounted = problem.sensors()[static_cast<std::size_t>(sensor)];
  FrameOnRobot frame{mounted.mount().frame};
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(mounted.mount().name);
    if (seen == nullptr || seen->features.empty()) continue;
    const std::string* name = frame_among(problem.frames(), seen->features.front().frame);
    const bool is_virtual = name != nullptr && !problem.robot().has_joint(*name);
    if (is_virtual && !mounted.sensor().in_own_frame()) frame.frame = *name;
    break;
  }
  return frame;
}

/// True if a sensor is at a pose that each sample has of its own: where it is says nothing of the robot.
[[nodiscard]] bool has_sample_pose(const AnyProblem& problem, const std::vector<int>& sensors) {
  const std::vector<std::string>& own = problem.sample_poses();
  return std::any_of(sensors.begin(), sensors.end(), [&](int s) {
    const auto& joints =
        problem.sensors()[static_cast<std::size_t>(s)].chains().front().chain().joints;
    return std::any_of(joints.begin(), joints.end(), [&](const ChainJoint& joint) {
      return std::find(own.begin(), own.end(), joint.floating) != own.end();
    });
  });
}

}  // namespace
}  // namespace detail

std::vector<ComparedFrames> compared_frames(const AnyProblem& problem,
                                            std::span<const Sample> samples) {
  std::vector<ComparedFrames> all;
  const auto is_known = [&](const FrameOnRobot& in) {
    return std::any_of(all.begin(), all.end(),
                       [&](const ComparedFrames& of) { return of.in.name() == in.name(); });
  };
  for (int t = 0; t < problem.num_terms(); ++t) {
    const std::vector<int>& sensors = problem.term(t).sensors;
    if (sensors.empty() || problem.samples_of(t) == 0) continue;
    const auto is_camera = [&](std::size_t i) {
      return problem.sensors()[static_cast<std::size_t>(sensors[i])].sensor().in_own_frame();
    };
    ComparedFrames of{detail::frame_of_features(problem, sensors[0], samples), {problem.base()}};
    if (sensors.size() > 1) {
      of.in = detail::frame_of_features(problem, sensors[1], samples);
      if (is_camera(0)) std::swap(of.frame, of.in);
    }
    if (of.frame.name() == of.in.name() || detail::has_sample_pose(problem, sensors)) continue;
    const bool is_of_camera = sensors.size() > 1 && (is_camera(0) || is_camera(1));
    if (all.empty() || (is_of_camera && !is_known(of.in))) all.push_back(std::move(of));
  }
  return all;
}

FrameOnRobot frame_named(const AnyProblem& problem, std::span<const Sample> samples,
                         const std::string& name) {
  std::vector<std::string> names = problem.robot().link_names();
  for (int s = 0; s < static_cast<int>(problem.sensors().size()); ++s) {
    const FrameOnRobot frame = detail::frame_of_features(problem, s, samples);
    const std::string& sensor = problem.sensors()[static_cast<std::size_t>(s)].mount().name;
    if (name == sensor || (!frame.frame.empty() && name == frame.frame)) return frame;
    names.push_back(sensor);
    if (!frame.frame.empty()) names.push_back(frame.frame);
  }
  if (problem.robot().has_link(name)) return {name};
  throw std::invalid_argument("'" + name + "' is no sensor, link or frame of the samples" +
                              did_you_mean(name, names));
}

}  // namespace kinecal
