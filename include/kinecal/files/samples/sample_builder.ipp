// Builds one sample from the values of its document or message, and collects errors.
//
// The nodes are those of sample_schema.ipp; sample_handler.ipp finds them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/samples/sample_camera.ipp"
#include "kinecal/files/samples/sample_pose.ipp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

class SampleBuilder {
 public:
  /// @param file  name of the file in Sample::source
  explicit SampleBuilder(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] Sample take() { return std::move(sample_); }
  [[nodiscard]] SampleErrors& errors() { return errors_; }
  [[nodiscard]] int sample_line() const { return line_; }  ///< where the last sample begins

  /// A map or list begins.  @param line  of its first character, from 1
  void begin(SampleNode node, int line) {
    if (node == SampleNode::sample) {
      line_ = line;
      sample_ = {};
      sample_.joint_names.reserve(joints_);
      sample_.joint_positions.reserve(joints_);
      sample_.source = SourceLocation{file_, line}.str();
    } else if (node == SampleNode::observation) {
      sample_.observations.emplace_back();
      camera_ = {};
    } else if (node == SampleNode::feature) {
      observation().features.emplace_back();
    } else if (node == SampleNode::pose) {
      pose_ = {};
    } else {
      camera_.begin(node, line);
    }
  }

  /// A map or list ends.  @param line  where it began
  void end(SampleNode node, int line) {
    if (node == SampleNode::joint_states) check_joints(line);
    if (node == SampleNode::orientation) end_orientation(line);
    if (node == SampleNode::pose) end_pose(line);
    if (node == SampleNode::observation) end_observation(line);
    if (node == SampleNode::parameter) camera_.end_parameter(errors_);
  }

  /// The name of the condition, or of the joint of a pose, whose value comes next.
  void key(SampleNode node, int line, std::string_view name) {
    key_ = name;
    const bool is_pose = node == SampleNode::pose;
    if (!(is_pose ? sample_.poses.contains(key_) : sample_.conditions.contains(key_))) return;
    errors_.add(line, fmt::format("{}: {} occurs twice", sample_name(node), shown(name)));
  }

  /// A word, or a number as text.
  void scalar(SampleNode node, int line, std::string_view text) {
    if (sample_rule(node).kind == SampleNodeKind::word) return word(node, line, text);
    const std::optional<double> value = number_from_yaml(text);
    if (!value) {
      errors_.add(line, fmt::format("{}: {} is not a number", sample_name(node), shown(text)));
    }
    number(node, line, value.value_or(0.0));
  }

  /// @param node  of kind SampleNodeKind::number
  void number(SampleNode node, int line, double value) {
    if (node == SampleNode::joint_position) {
      sample_.joint_positions.push_back(value);
    } else if (node == SampleNode::joint_velocity) {
      sample_.joint_velocities.push_back(value);
    } else if (node == SampleNode::x) {
      feature().point.x() = value;
    } else if (node == SampleNode::y) {
      feature().point.y() = value;
    } else if (node == SampleNode::z) {
      feature().point.z() = value;
    } else if (node >= SampleNode::qx && node <= SampleNode::qw) {
      quaternion_(static_cast<int>(node) - static_cast<int>(SampleNode::qx)) = value;
    } else if (node == SampleNode::seconds || node == SampleNode::nanoseconds) {
      add_to_stamp(node == SampleNode::seconds ? 1e9 : 1.0, value);
    } else if (node == SampleNode::pose_xyz_item || node == SampleNode::pose_quaternion_item) {
      pose_.number(node, value);
    } else if (node == SampleNode::condition) {
      sample_.conditions[key_] = value;
    } else if (node == SampleNode::sigma) {
      feature().sigma = value;
    } else if (node == SampleNode::id) {
      feature().id = feature_id(value);
      if (!feature().id)
        errors_.add(line, fmt::format("id: {} is not a whole number from 0", value));
    } else {
      camera_.number(node, line, value, errors_);
    }
  }

 private:
  [[nodiscard]] Observation& observation() { return sample_.observations.back(); }
  [[nodiscard]] Feature& feature() { return observation().features.back(); }

  void word(SampleNode node, int line, std::string_view text) {
    if (node == SampleNode::joint_name) {
      sample_.joint_names.emplace_back(text);
    } else if (node == SampleNode::sensor) {
      observation().sensor = text;
    } else if (node == SampleNode::frame) {
      feature().frame = plain_frame(text);  // tf of old ROS 1: /tool
    } else {
      camera_.word(node, line, text);
    }
  }

  /// Ignores zero, which stands for an unknown time.
  void add_to_stamp(double unit, double value) {
    constexpr double kMost = 9e18;  // nanoseconds
    const double nanoseconds = unit * value;
    if (nanoseconds == 0.0 || !(std::abs(nanoseconds) < kMost)) return;
    sample_.stamp = sample_.stamp.value_or(std::chrono::nanoseconds(0)) +
                    std::chrono::nanoseconds(std::llround(value) * std::llround(unit));
  }

  void check_joints(int line) {
    const std::size_t names = sample_.joint_names.size(), values = sample_.joint_positions.size();
    joints_ = names;
    if (names != values) {
      errors_.add(line, fmt::format("joint_states: {} name{} but {} position{}", names,
                                    names == 1 ? "" : "s", values, values == 1 ? "" : "s"));
    }
    std::vector<double>& velocities = sample_.joint_velocities;
    if (!velocities.empty() && velocities.size() != names) {
      errors_.warn_once(
          line, fmt::format("joint_states: {} names but {} velocit{}, so velocities "
                            "are not used",
                            names, velocities.size(), velocities.size() == 1 ? "y" : "ies"));
      velocities.clear();
    }
  }

  void end_orientation(int line) {
    const auto rotation = rotation_from_rounded_quaternion(quaternion_);
    if (!rotation) errors_.add(line, "orientation: " + not_unit_text(quaternion_.norm()));
    feature().rotation = rotation.value_or(Matrix3<double>::Identity());
  }

  void end_pose(int line) {
    const std::string wrong = pose_.read(sample_.poses[key_]);
    if (!wrong.empty()) errors_.add(line, fmt::format("pose of {}: {}", shown(key_), wrong));
  }

  void end_observation(int line) {
    const std::string& name = observation().sensor;
    const auto where = [&] {
      return fmt::format("sample at line {}, sensor {}", line_, shown(name));
    };
    const auto same = [&](const Observation& o) { return o.sensor == name; };
    if (std::any_of(sample_.observations.begin(), sample_.observations.end() - 1, same)) {
      errors_.add(line, where() + " occurs twice");
    }
    if (const std::string wrong = camera_.ids().apply(observation().features); !wrong.empty()) {
      errors_.add(line, where() + ": " + wrong);
    }
    observation().camera = camera_.take(line, where, errors_);
    if (!observation().camera) return;
    const std::string doubt = doubt_image_part(camera_.part(), *observation().camera);
    if (!doubt.empty()) errors_.warn_once(line, fmt::format("sensor {}: {}", shown(name), doubt));
  }

  std::string file_;
  SampleErrors errors_;
  int line_ = 0;            ///< where the sample begins
  std::size_t joints_ = 0;  ///< of the last sample: the next one probably has as many
  Sample sample_;
  Eigen::Vector4d quaternion_ = Eigen::Vector4d::Zero();  ///< x y z w
  std::string key_;  ///< name of the last condition, or joint of the last pose
  SamplePose pose_;
  SampleCamera camera_;
};

}  // namespace kinecal::detail
