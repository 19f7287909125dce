// Follows the events of a YAML document or a message through a sample, without building a tree.
//
// The handler knows its place in the tree of sample_schema.ipp and skips unknown keys with
// everything below them.  Values go to the SampleBuilder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/samples/sample_camera.ipp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/files/yaml/deciding_keys.hpp"
#include "kinecal/files/yaml/yaml_events.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

// The measured pose of a floating joint in a sample.

/// Collects the numbers of a pose.
class SamplePose {
 public:
  /// @param node  pose_xyz_item or pose_quaternion_item
  void number(SampleNode node, double value) {
    (node == SampleNode::pose_xyz_item ? xyz_ : xyzw_).push_back(value);
  }

  /// The pose of the numbers.
  /// @returns  what is wrong with them; empty: nothing
  [[nodiscard]] std::string read(Pose<double>& pose) const {
    if (xyz_.size() != 3) return "xyz has " + counted(xyz_.size(), "number") + ", not 3";
    if (xyzw_.size() != 4) {
      return "quaternion_xyzw has " + counted(xyzw_.size(), "number") + ", not 4";
    }
    pose.translation = Vector3<double>::Map(xyz_.data());
    const Eigen::Vector4d quaternion = Eigen::Vector4d::Map(xyzw_.data());
    const auto rotation = rotation_from_rounded_quaternion(quaternion);
    if (!rotation) return not_unit_text(quaternion.norm());
    pose.rotation = *rotation;
    const std::string far = far_away_text(pose.translation);
    return far.empty() ? "" : far + "; write metres";
  }

 private:
  std::vector<double> xyz_, xyzw_;
};

// Builds one sample from the values of its document or message, and collects errors.
//
// The nodes are those of sample_schema.ipp; sample_handler.ipp finds them.

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
      sensors_.clear();
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
    } else if (node == SampleNode::conditions || node == SampleNode::feature_conditions) {
      of_feature_ = node == SampleNode::feature_conditions;
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
    if (!(is_pose ? sample_.poses.contains(key_) : conditions().contains(key_))) return;
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
      conditions()[key_] = value;
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
  [[nodiscard]] std::map<std::string, double>& conditions() {
    return of_feature_ ? feature().conditions : sample_.conditions;
  }

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
    if (!sensors_.insert(name).second) errors_.add(line, where() + " occurs twice");
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
  std::unordered_set<std::string> sensors_;               ///< of the sample's observations so far
  Eigen::Vector4d quaternion_ = Eigen::Vector4d::Zero();  ///< x y z w
  std::string key_;          ///< name of the last condition, or joint of the last pose
  bool of_feature_ = false;  ///< the open map of conditions is a feature's
  SamplePose pose_;
  SampleCamera camera_;
};

// Finds probable mistakes in the keys of samples.
//
// Only kinecal has some of the keys: a typo would silently ignore a sigma, an id,
// the conditions or the poses.
// And {x: 0,03} is the number 0 and a key 03.

/// The probably intended key; empty if none is within two letters.
/// @param parent  the map with the key
[[nodiscard]] inline std::string_view meant_sample_key(SampleNode parent, std::string_view key) {
  constexpr std::size_t kMostLetters = 2;
  for (const SampleNode own :
       {SampleNode::poses, SampleNode::conditions, SampleNode::feature_conditions,
        SampleNode::orientation, SampleNode::sigma, SampleNode::id}) {
    const SampleNodeRule& rule = sample_rule(own);
    if (rule.parent != parent) continue;
    const NearestName near = NearestName::none(key).or_nearer(rule.key, key);
    if (!near.name.empty() && near.distance <= kMostLetters) return rule.key;
  }
  return {};
}

/// Warns of an unknown key that resembles one of kinecal's own, once per file.  A key of digits
/// among numbers is an error.
inline void doubt_sample_key(SampleErrors& errors, SampleNode parent, int line,
                             std::string_view key) {
  const bool digits = key.find_first_not_of("0123456789") == std::string_view::npos;
  if (digits && !key.empty() &&
      (parent == SampleNode::point || parent == SampleNode::orientation)) {
    const std::string_view part = key.substr(0, 20);
    return errors.add(line, fmt::format("{}: unknown key '{}'; decimal comma? write a dot: 0.{}",
                                        sample_name(parent), part, part));
  }
  const KeyMeaning meaning = meaning_of_key(key);
  const bool is_lens = parent == SampleNode::camera_info && meaning == KeyMeaning::distortion;
  const bool is_unit = meaning == KeyMeaning::unit &&
                       (parent == SampleNode::feature || parent == SampleNode::point ||
                        parent == SampleNode::observation || parent == SampleNode::joint_states);
  if (is_lens || is_unit) {
    return errors.add(line, fmt::format("{}: unknown key {} looks like {}, which would be lost; {}",
                                        sample_name(parent), shown(key), text_of(meaning),
                                        is_lens ? "the distortion is called D (ROS 2: d)"
                                                : "samples are in metres, radians and pixels"));
  }
  const std::string_view meant = meant_sample_key(parent, key);
  if (meant.empty()) return;
  errors.warn_once(line, fmt::format("{}: unknown key {} is skipped; did you mean '{}'?",
                                     sample_name(parent), shown(key), meant));
}

class SampleHandler {
 public:
  /// @param file  name of the file in Sample::source
  explicit SampleHandler(std::string file) : builder_(std::move(file)) {}

  [[nodiscard]] std::vector<Sample> take() { return std::move(samples_); }
  [[nodiscard]] SampleBuilder& builder() { return builder_; }
  /// True inside something unknown: its content may be omitted.
  [[nodiscard]] bool skips() const { return skipped_ > 0; }
  [[nodiscard]] bool last_document_is_empty() const { return last_document_is_empty_; }

  void document_starts() {
    levels_.clear();
    skipped_ = 0;
    last_document_is_empty_ = false;
    errors_before_ = builder_.errors().errors.size();
  }

  void null(int line) {
    if (levels_.empty() && skipped_ == 0) {
      last_document_is_empty_ = true;
      return;
    }
    // The parser may already be on a later line; users look for the line of the key.
    const bool is_value = !levels_.empty() && levels_.back().is_map && !at_key();
    const SampleNode node = next_node();
    if (node != SampleNode::unknown) null(node, is_value ? key_line_ : line);
  }

  void alias(int line) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    error(node, line, "an alias (*) is not supported here; write the value in its place");
  }

  void scalar(int line, std::string_view text) {
    if (skipped_ > 0) return;
    if (at_key()) return key(line, text);
    const SampleNode node = next_node();
    if (node != SampleNode::unknown) scalar(node, line, text);
  }

  /// A number of a message.  It reaches the sample unchanged; if something else is expected, its
  /// text is used.
  template <class X>
  void number(int line, X x) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown) return;
    if (sample_rule(node).kind == SampleNodeKind::number) {
      builder_.number(node, line, static_cast<double>(x));
    } else {
      scalar(node, line, fmt::format("{}", x));
    }
  }

  void list_starts(int line) { start(line, SampleNodeKind::list); }
  void map_starts(int line) { start(line, SampleNodeKind::map); }

  void ends() {
    if (skipped_ == 0) return finish();
    --skipped_;
  }

 private:
  struct Level {
    SampleNode node;
    bool is_map, at_key;
    int line;  ///< where it began, from 1
  };

  [[nodiscard]] bool at_key() const { return !levels_.empty() && levels_.back().at_key; }

  /// The node of the current value; advances to the next one.
  [[nodiscard]] SampleNode next_node() {
    if (skipped_ > 0) return SampleNode::unknown;
    if (levels_.empty()) return SampleNode::sample;
    Level& level = levels_.back();
    if (!level.is_map) return sample_child(level.node, "");
    if (level.at_key) {  // a key that is not a word: skipped with its value
      level.at_key = false;
      value_node_ = SampleNode::unknown;
      return SampleNode::unknown;
    }
    level.at_key = true;
    return std::exchange(value_node_, SampleNode::unknown);
  }

  void scalar(SampleNode node, int line, std::string_view text) {
    if (sample_is_scalar(node)) return builder_.scalar(node, line, text);
    error(node, line, fmt::format("{} is not a {}", shown(text), kind_name(node)));
  }

  void key(int line, std::string_view text) {
    Level& level = levels_.back();
    level.at_key = false;
    key_line_ = line;
    value_node_ = text.empty() ? SampleNode::unknown : sample_child(level.node, text);
    if (value_node_ == SampleNode::unknown)
      return doubt_sample_key(builder_.errors(), level.node, line, text);
    if (sample_has_free_keys(level.node)) return builder_.key(value_node_, line, text);
    if ((seen_ & sample_bit(value_node_)) != 0) {
      error(level.node, line,
            fmt::format("key '{}' occurs twice; is a '---' missing between samples?", text));
    }
    seen_ |= sample_bit(value_node_);
  }

  void start(int line, SampleNodeKind kind) {
    const SampleNode node = next_node();
    if (node == SampleNode::unknown || sample_rule(node).kind != kind) {
      ++skipped_;
      if (node != SampleNode::unknown) {
        error(node, line,
              fmt::format("expected a {}, found a {}", kind_name(node),
                          kind == SampleNodeKind::map ? "map" : "list"));
      }
      return;
    }
    begin(node, line);
  }

  void begin(SampleNode node, int line) {
    seen_ &= ~sample_children(node).bits;
    const bool is_map = sample_rule(node).kind == SampleNodeKind::map;
    levels_.push_back({node, is_map, is_map, line});
    builder_.begin(node, line);
  }

  void finish() {
    const Level level = levels_.back();
    levels_.pop_back();
    if ((sample_children(level.node).required & ~seen_) != 0) report_missing(level);
    builder_.end(level.node, level.line);
    if (level.node == SampleNode::sample && builder_.errors().errors.size() == errors_before_) {
      samples_.push_back(builder_.take());
    }
  }

  void report_missing(const Level& level) {
    for (const SampleNodeRule& r : kSampleNodeRules) {
      if (r.required && r.parent == level.node && (seen_ & sample_bit(r.node)) == 0) {
        builder_.errors().add(level.line,
                              fmt::format("{} without '{}'", sample_name(level.node), r.key));
      }
    }
  }

  /// An empty value: an empty list, map or text; never a number.
  void null(SampleNode node, int line) {
    if (sample_is_scalar(node)) return builder_.scalar(node, line, "");
    begin(node, line);
    finish();
  }

  void error(SampleNode node, int line, const std::string& message) {
    builder_.errors().add(line, fmt::format("{}: {}", sample_name(node), message));
  }

  [[nodiscard]] static const char* kind_name(SampleNode node) {
    constexpr const char* kNames[] = {"map", "list", "word or number", "word or number"};
    return kNames[static_cast<int>(sample_rule(node).kind)];
  }

  SampleBuilder builder_;
  std::vector<Sample> samples_;
  std::vector<Level> levels_;
  std::uint64_t seen_ = 0;  ///< keys read in the open maps, see sample_bit()
  SampleNode value_node_ = SampleNode::unknown;
  int key_line_ = 0;               ///< of the last key
  int skipped_ = 0;                ///< levels of something unknown
  std::size_t errors_before_ = 0;  ///< errors when this document began
  bool last_document_is_empty_ = false;
};

static_assert(YamlHandler<SampleHandler>);

}  // namespace kinecal::detail
