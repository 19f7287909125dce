// Definitions of fixed_frames.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/fixed_frames.hpp"

#include <Eigen/Core>
#include <cmath>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace {

/// The pose of a geometry_msgs/TransformStamped; nullopt if it is none.
[[nodiscard]] std::optional<Pose<double>> transform_of(const MessageFields& stamped) {
  const auto at = [&](const char* name) { return detail::number_at(stamped, name); };
  const Eigen::Vector4d q(at("transform.rotation.x"), at("transform.rotation.y"),
                          at("transform.rotation.z"), at("transform.rotation.w"));
  const Pose<double> pose{rotation_from_quaternion<double>(q.normalized()),
                          {at("transform.translation.x"), at("transform.translation.y"),
                           at("transform.translation.z")}};
  const bool is_pose = std::abs(q.norm() - 1.0) < 0.01 && pose.translation.allFinite();
  return is_pose ? std::optional(pose) : std::nullopt;
}

}  // namespace

void FixedFrames::add(const std::string& parent, const std::string& child,
                      const Pose<double>& pose) {
  constexpr double kSame = 1e-5;  // metres, and of the elements of a rotation
  const Edge edge{std::string(plain_frame(parent)), pose};
  Edge& known = edges_.try_emplace(std::string(plain_frame(child)), edge).first->second;
  const bool is_same = known.parent == edge.parent &&
                       (known.pose.translation - pose.translation).cwiseAbs().maxCoeff() < kSame &&
                       (known.pose.rotation - pose.rotation).cwiseAbs().maxCoeff() < kSame;
  known.moves = known.moves || !is_same;
}

void FixedFrames::add(const MessageFields& message) {
  for (const MessageValue& item : detail::list_at(message, "transforms")) {
    const auto* stamped = item.as<MessageFields>();
    const auto pose = stamped != nullptr ? transform_of(*stamped) : std::nullopt;
    if (!pose) continue;
    add(std::string(detail::text_at(*stamped, "header.frame_id")),
        std::string(detail::text_at(*stamped, "child_frame_id")), *pose);
  }
}

void FixedFrames::add(const Robot& robot) {
  for (const Joint& joint : robot.joints()) {
    if (joint.type != JointType::fixed) continue;
    edges_.try_emplace(std::string(plain_frame(joint.child)),
                       Edge{std::string(plain_frame(joint.parent)), joint.origin});
  }
}

std::map<std::string, Pose<double>> FixedFrames::above(const std::string& frame) const {
  std::string at(plain_frame(frame));
  std::map<std::string, Pose<double>> all = {{at, {}}};
  for (auto edge = edges_.find(at); edge != edges_.end() && !edge->second.moves;
       edge = edges_.find(at)) {
    const Pose<double> pose = edge->second.pose * all.at(at);
    at = edge->second.parent;
    if (!all.emplace(at, pose).second) break;  // a loop
  }
  return all;
}

std::optional<Pose<double>> FixedFrames::pose(const std::string& a, const std::string& b) const {
  const auto above_a = above(a);
  for (const auto& [frame, frame_T_b] : above(b)) {
    const auto common = above_a.find(frame);
    if (common != above_a.end()) return common->second.inverse() * frame_T_b;
  }
  return std::nullopt;
}

FixedFrames recorded_frames(const std::string& path) {
  FixedFrames frames;
  std::optional<Robot> robot;
  Diagnostics ignored;
  detail::MessageDecoder decoder(path, ignored);
  const auto is_urdf = [](const BagTopic& topic) { return use_of(topic) == TopicUse::urdf; };
  const auto wants = [&](const BagTopic& topic) {
    return is_urdf(topic) || topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
  };
  const auto handle = [&](const BagMessage& message) {
    const auto content = decoder.decode(message, 0);
    if (!content) return;
    if (is_urdf(message.topic)) {
      try {
        robot = parse_urdf(std::string(detail::text_at(*content, "data")), "/robot_description");
      } catch (const InputError&) {
      }
      return;
    }
    frames.add(*content);
  };
  read_bag(path, {wants, handle}, ignored);
  if (robot) frames.add(*robot);
  return frames;
}

}  // namespace kinecal
