// The keys of a recorded sample as a tree.
//
//   joint_states: {header: {stamp: {secs: ..., nsecs: ...}},                (if it is known)
//                  name: [...], position: [...], velocity: [...]}         (velocity may be absent)
//   poses: {flange_joint: {xyz: [...], quaternion_xyzw: [...]}, ...}      (of floating joints)
//   conditions: {temperature: ..., ...}                                   (if there are any)
//   observations:
//   - sensor_name: camera
//     features: [{header: {frame_id: ...}, point: {x: ..., y: ..., z: ...},
//                 orientation: {x: ..., y: ..., z: ..., w: ...},          (of poses only)
//                 sigma: ..., id: ..., conditions: {nx: ..., ...}}, ...]  (if it has them)
//     ext_camera_info:
//       camera_info: {height, width, distortion_model, D, K, R, P, binning_x, binning_y, roi}
//       parameters: [{name: ..., value: ...}, ...]
//
// Source: robot_calibration_msgs/CalibrationData; D K R P are ROS 1, d k r p are ROS 2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace kinecal::detail {

/// A place in the tree.  `document` is the root, `unknown` is skipped.
enum class SampleNode : std::uint8_t {
  document,
  sample,
  joint_states,
  joint_header,
  joint_stamp,
  seconds,
  nanoseconds,
  joint_names,
  joint_name,
  joint_positions,
  joint_position,
  joint_velocities,
  joint_velocity,
  poses,
  pose,
  pose_xyz,
  pose_xyz_item,
  pose_quaternion,
  pose_quaternion_item,
  conditions,
  condition,
  observations,
  observation,
  sensor,
  features,
  feature,
  header,
  frame,
  point,
  x,
  y,
  z,
  orientation,
  qx,
  qy,
  qz,
  qw,
  sigma,
  id,
  feature_conditions,
  ext_camera_info,
  camera_info,
  height,
  width,
  distortion_model,
  d,
  d_item,
  k,
  k_item,
  r,
  r_item,
  p,
  p_item,
  binning_x,
  binning_y,
  roi,
  roi_x,
  roi_y,
  roi_height,
  roi_width,
  parameters,
  parameter,
  parameter_name,
  parameter_value,
  unknown
};

/// `parameter_value` is a word: its meaning depends on the parameter's name.
enum class SampleNodeKind : std::uint8_t { map, list, word, number };

/// One row: the node, its parent, its key (empty for list items and user-defined keys), its other
/// key.
struct SampleNodeRule {
  SampleNode node, parent;
  SampleNodeKind kind;
  std::string_view key, other_key = {};
  bool required = false;
};

[[nodiscard]] constexpr auto sample_node_rules() {
  using enum SampleNode;
  using enum SampleNodeKind;
  return std::to_array<SampleNodeRule>({
      {document, unknown, list, "document"},
      {sample, document, map, ""},
      {joint_states, sample, map, "joint_states", "", true},
      {joint_header, joint_states, map, "header"},
      {joint_stamp, joint_header, map, "stamp"},
      {seconds, joint_stamp, number, "secs", "sec"},
      {nanoseconds, joint_stamp, number, "nsecs", "nanosec"},
      {joint_names, joint_states, list, "name", "", true},
      {joint_name, joint_names, word, ""},
      {joint_positions, joint_states, list, "position", "", true},
      {joint_position, joint_positions, number, ""},
      {joint_velocities, joint_states, list, "velocity"},
      {joint_velocity, joint_velocities, number, ""},
      {poses, sample, map, "poses"},
      {pose, poses, map, ""},
      {pose_xyz, pose, list, "xyz"},
      {pose_xyz_item, pose_xyz, number, ""},
      {pose_quaternion, pose, list, "quaternion_xyzw"},
      {pose_quaternion_item, pose_quaternion, number, ""},
      {conditions, sample, map, "conditions"},
      {condition, conditions, number, ""},
      {observations, sample, list, "observations", "", true},
      {observation, observations, map, ""},
      {sensor, observation, word, "sensor_name", "", true},
      {features, observation, list, "features"},
      {feature, features, map, ""},
      {header, feature, map, "header"},
      {frame, header, word, "frame_id"},
      {point, feature, map, "point", "", true},
      {x, point, number, "x", "", true},
      {y, point, number, "y", "", true},
      {z, point, number, "z", "", true},
      {orientation, feature, map, "orientation"},
      {qx, orientation, number, "x", "", true},
      {qy, orientation, number, "y", "", true},
      {qz, orientation, number, "z", "", true},
      {qw, orientation, number, "w", "", true},
      {sigma, feature, number, "sigma"},
      {id, feature, number, "id"},
      {feature_conditions, feature, map, "conditions"},
      {ext_camera_info, observation, map, "ext_camera_info"},
      {camera_info, ext_camera_info, map, "camera_info"},
      {height, camera_info, number, "height"},
      {width, camera_info, number, "width"},
      {distortion_model, camera_info, word, "distortion_model"},
      {d, camera_info, list, "D", "d"},
      {d_item, d, number, ""},
      {k, camera_info, list, "K", "k"},
      {k_item, k, number, ""},
      {r, camera_info, list, "R", "r"},
      {r_item, r, number, ""},
      {p, camera_info, list, "P", "p"},
      {p_item, p, number, ""},
      {binning_x, camera_info, number, "binning_x"},
      {binning_y, camera_info, number, "binning_y"},
      {roi, camera_info, map, "roi"},
      {roi_x, roi, number, "x_offset"},
      {roi_y, roi, number, "y_offset"},
      {roi_height, roi, number, "height"},
      {roi_width, roi, number, "width"},
      {parameters, ext_camera_info, list, "parameters"},
      {parameter, parameters, map, ""},
      {parameter_name, parameter, word, "name"},
      {parameter_value, parameter, word, "value"},
  });
}

inline constexpr auto kSampleNodeRules = sample_node_rules();

[[nodiscard]] constexpr const SampleNodeRule& sample_rule(SampleNode node) {
  return kSampleNodeRules[static_cast<std::size_t>(node)];
}

[[nodiscard]] constexpr bool sample_is_scalar(SampleNode node) {
  const SampleNodeKind kind = sample_rule(node).kind;
  return kind == SampleNodeKind::word || kind == SampleNodeKind::number;
}

/// One bit per node, to remember which keys of a map have been read.
[[nodiscard]] constexpr std::uint64_t sample_bit(SampleNode node) {
  return std::uint64_t{1} << static_cast<int>(node);
}

/// The possible children of a node.
struct SampleChildren {
  std::array<SampleNode, 10> nodes{};
  std::size_t size = 0;
  std::uint64_t bits = 0, required = 0;  ///< see sample_bit()
};

/// Computed once, because each key of a file is looked up in it.
inline constexpr auto kSampleChildren = [] {
  std::array<SampleChildren, kSampleNodeRules.size() + 1> children{};
  for (const SampleNodeRule& r : kSampleNodeRules) {
    SampleChildren& c = children[static_cast<std::size_t>(r.parent)];
    c.nodes[c.size++] = r.node;
    c.bits |= sample_bit(r.node);
    if (r.required) c.required |= sample_bit(r.node);
  }
  return children;
}();

[[nodiscard]] constexpr const SampleChildren& sample_children(SampleNode parent) {
  return kSampleChildren[static_cast<std::size_t>(parent)];
}

/// True for a map whose keys are names that the user gives.
[[nodiscard]] constexpr bool sample_has_free_keys(SampleNode node) {
  return node == SampleNode::conditions || node == SampleNode::feature_conditions ||
         node == SampleNode::poses;
}

/// The node under `parent` with this key; `unknown` if absent.  List items have the key "".
[[nodiscard]] constexpr SampleNode sample_child(SampleNode parent, std::string_view key) {
  if (parent == SampleNode::conditions || parent == SampleNode::feature_conditions) {
    return SampleNode::condition;  // its parent by the table is the sample's map
  }
  if (parent == SampleNode::poses) return SampleNode::pose;
  const SampleChildren& children = sample_children(parent);
  for (std::size_t i = 0; i < children.size; ++i) {
    const SampleNodeRule& r = sample_rule(children.nodes[i]);
    if (r.key == key || (r.other_key == key && !key.empty())) return r.node;
  }
  return SampleNode::unknown;
}

/// The name of a node in messages: its key; for an item, the key of its list.
[[nodiscard]] constexpr std::string_view sample_name(SampleNode node) {
  if (node == SampleNode::sample) return "sample";
  const SampleNodeRule& r = sample_rule(node);
  return r.key.empty() ? sample_rule(r.parent).key : r.key;
}

static_assert(
    [] {
      for (std::size_t i = 0; i < kSampleNodeRules.size(); ++i)
        if (static_cast<std::size_t>(kSampleNodeRules[i].node) != i) return false;
      return kSampleNodeRules.size() == static_cast<std::size_t>(SampleNode::unknown);
    }(),
    "sample_node_rules() must have one row for each SampleNode, in the order of the enum");

}  // namespace kinecal::detail
