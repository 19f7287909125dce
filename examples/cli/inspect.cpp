// kinecal inspect: shows what is in recordings.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/reading.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

struct JointRange {
  std::size_t samples = 0;
  double lower = 0.0, upper = 0.0;
};

struct SensorContent {
  std::size_t samples = 0, features = 0, least = 0, most = 0, not_numbers = 0;
  std::set<std::string> frames;
  std::string camera = "no camera_info";
};

std::map<std::string, JointRange> joint_ranges(const std::vector<Sample>& samples) {
  std::map<std::string, JointRange> ranges;
  for (const Sample& sample : samples) {
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      const double q = sample.joint_positions[i];
      JointRange& range = ranges[sample.joint_names[i]];
      range.lower = range.samples == 0 ? q : std::min(range.lower, q);
      range.upper = range.samples == 0 ? q : std::max(range.upper, q);
      ++range.samples;
    }
  }
  return ranges;
}

std::map<std::string, SensorContent> sensor_contents(const std::vector<Sample>& samples) {
  std::map<std::string, SensorContent> sensors;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      SensorContent& sensor = sensors[seen.sensor];
      const std::size_t n = seen.features.size();
      sensor.least = sensor.samples == 0 ? n : std::min(sensor.least, n);
      sensor.most = std::max(sensor.most, n);
      ++sensor.samples;
      sensor.features += n;
      for (const Feature& feature : seen.features) {
        sensor.frames.insert(feature.frame);
        if (!feature.point.allFinite()) ++sensor.not_numbers;
      }
      if (seen.camera) {
        sensor.camera = fmt::format("{}x{}, fx {:.2f}, fy {:.2f}", seen.camera->width,
                                    seen.camera->height, seen.camera->p[0], seen.camera->p[5]);
      }
    }
  }
  return sensors;
}

void print_joints(const std::vector<Sample>& samples) {
  TextTable table({"joint", "samples", "least", "greatest", "range"});
  for (const auto& [name, range] : joint_ranges(samples)) {
    table.add({name, fmt::format("{}", range.samples), fmt::format("{:.4f}", range.lower),
               fmt::format("{:.4f}", range.upper),
               fmt::format("{:.4f}", range.upper - range.lower)});
  }
  say("Joints (radians or metres)\n{}\n", table.str());
}

/// Prints how far the measured poses of floating joints are apart.
void print_measured_poses(const std::vector<Sample>& samples) {
  std::map<std::string, std::vector<const Pose<double>*>> all;
  for (const Sample& sample : samples) {
    for (const auto& [joint, pose] : sample.poses) all[joint].push_back(&pose);
  }
  if (all.empty()) return;
  TextTable table({"floating joint", "samples", "x", "y", "z", "turned by"});
  for (const auto& [joint, poses] : all) {
    Vector3<double> least = poses.front()->translation, most = least;
    double turned = 0.0;
    for (const Pose<double>* pose : poses) {
      least = least.cwiseMin(pose->translation);
      most = most.cwiseMax(pose->translation);
      const Matrix3<double> turn = poses.front()->rotation.transpose() * pose->rotation;
      turned = std::max(turned, log(turn).norm());
    }
    const Vector3<double> range = most - least;
    table.add({joint, fmt::format("{}", poses.size()), fmt::format("{:.4f}", range.x()),
               fmt::format("{:.4f}", range.y()), fmt::format("{:.4f}", range.z()),
               reading(turned, "rad")});
  }
  say("Measured poses: their ranges, metres, and how far they turn from the first\n{}\n",
      table.str());
}

void print_sensors(const std::vector<Sample>& samples) {
  TextTable table({"sensor", "frames", "camera", "samples", "features", "each"}, 3);
  for (const auto& [name, sensor] : sensor_contents(samples)) {
    std::string frames;
    for (const std::string& frame : sensor.frames) frames += (frames.empty() ? "" : ", ") + frame;
    table.add({name, frames, sensor.camera, fmt::format("{}", sensor.samples),
               fmt::format("{}", sensor.features),
               sensor.least == sensor.most ? fmt::format("{}", sensor.most)
                                           : fmt::format("{}-{}", sensor.least, sensor.most)});
  }
  say("Sensors\n{}\n", table.str());
}

/// Prints gaps: joints or sensors that only some samples have, features without numbers.
void print_gaps(const std::vector<Sample>& samples) {
  std::string gaps;
  const auto add = [&](const std::string& what, std::size_t count) {
    if (count < samples.size()) {
      gaps += fmt::format("  {} is missing in {} of {}\n", what, samples.size() - count,
                          counted(samples.size(), "sample"));
    }
  };
  for (const auto& [name, range] : joint_ranges(samples)) {
    add(fmt::format("joint '{}'", name), range.samples);
  }
  for (const auto& [name, sensor] : sensor_contents(samples)) {
    add(fmt::format("sensor '{}'", name), sensor.samples);
    if (sensor.not_numbers > 0) {
      gaps += fmt::format("  sensor '{}': {}\n", name,
                          sensor.not_numbers == 1
                              ? "1 feature is not a number"
                              : fmt::format("{} features are not numbers", sensor.not_numbers));
    }
  }
  say("Gaps\n{}", gaps.empty() ? "  none\n" : gaps);
}

void print_topics(const std::string& file, const std::vector<TopicContent>& topics) {
  say("{}: {}\n", file, to_string(recording_format(file)));
  if (topics.empty()) {
    say("no messages\n\n");
    return;
  }
  TextTable table({"topic", "type", "used as", "messages", "kB"}, 3);
  for (const TopicContent& topic : topics) {
    table.add({topic.name, topic.type, std::string(to_string(topic.use)),
               fmt::format("{}", topic.messages),
               fmt::format("{:.1f}", 1e-3 * double(topic.bytes))});
  }
  say("{}\n", table.str());
}

/// Prints poses to capture: joints, and the features to look for.
void print_poses(const std::vector<CapturePose>& poses) {
  std::vector<Sample> samples(poses.size());
  std::map<std::string, std::size_t> finders;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    samples[i].joint_names = poses[i].joint_names;
    samples[i].joint_positions = poses[i].positions;
    for (const std::string& finder : poses[i].features) ++finders[finder];
    if (poses[i].features.empty()) ++finders["(all)"];
  }
  say("{} to capture\n\n", counted(poses.size(), "pose"));
  print_joints(samples);
  TextTable table({"looked for", "poses"});
  for (const auto& [finder, count] : finders) table.add({finder, fmt::format("{}", count)});
  say("Features\n{}\n", table.str());
}

/// Prints the topics of bags, and poses.
/// @return  the files with samples
std::vector<std::string> with_samples(const std::vector<std::string>& files,
                                      Diagnostics& diagnostics) {
  std::vector<std::string> found;
  for (const std::string& file : files) {
    if (recording_format(file) == RecordingFormat::yaml) {
      if (is_poses_yaml(file)) {
        print_poses(read_poses_yaml(file, diagnostics));
      } else {
        found.push_back(file);
      }
      continue;
    }
    const std::size_t errors = diagnostics.errors.size();
    const std::vector<TopicContent> topics = bag_topics(file, diagnostics);
    if (!topics.empty() || diagnostics.errors.size() == errors) print_topics(file, topics);
    const auto has = [&](TopicUse use) {
      return std::any_of(topics.begin(), topics.end(), [&](const TopicContent& topic) {
        return topic.use == use && topic.messages > 0;
      });
    };
    if (has(TopicUse::samples)) {
      found.push_back(file);
    } else if (has(TopicUse::poses)) {
      Diagnostics of_poses;  // repeats what bag_topics() found
      const std::vector<CapturePose> poses = read_bag_poses(file, of_poses);
      if (diagnostics.errors.empty()) diagnostics.errors = of_poses.errors;
      print_poses(poses);
    }
  }
  return found;
}

}  // namespace

int inspect(const std::vector<std::string>& files) {
  Diagnostics of_bags, of_samples;
  const std::vector<std::string> used = with_samples(files, of_bags);
  const std::vector<Sample> samples = read_recordings(used, of_samples).samples;
  print(of_bags);
  if (of_bags.errors.empty()) print(of_samples);  // else they would be printed twice
  if (!of_bags.errors.empty() || !of_samples.errors.empty()) return kBadInput;
  if (used.empty()) return kDone;
  say("{}\n\n", counted(samples.size(), "sample"));
  print_joints(samples);
  print_measured_poses(samples);
  print_sensors(samples);
  print_gaps(samples);
  return kDone;
}

}  // namespace kinecal::cli
