// First pass over a recording: joint positions, camera settings, and times of images.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "kinecal/files/messages/camera_message.ipp"
#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/joint_tracks.hpp"
#include "kinecal/tools/detect/view_topics.hpp"

namespace kinecal::detail {

/// The form of a topic's messages.
struct MessageForm {
  MessageDefinition definition;
  Encoding encoding = Encoding::ros1;
};

/// Forms of topics.
class MessageForms {
 public:
  /// @throws DefinitionError  if the bag's definition cannot be read
  [[nodiscard]] std::shared_ptr<const MessageForm> of(const BagTopic& topic) {
    auto& form = forms_[{topic.type, topic.definition, topic.encoding}];
    if (!form) {
      const std::string text = topic.definition.empty()
                                   ? known_definition(topic.type, topic.encoding)
                                   : topic.definition;
      form = std::make_shared<const MessageForm>(
          MessageForm{parse_definition(topic.type, text), topic.encoding});
    }
    return form;
  }

 private:
  std::map<std::tuple<std::string, std::string, Encoding>, std::shared_ptr<const MessageForm>>
      forms_;  ///< by type, definition and encoding
};

/// A message of images, depth or points in a recording.
struct ViewStamp {
  Stamp stamp;             ///< of the header; of recording if that is zero
  std::int64_t ahead = 0;  ///< time of recording minus stamp, nanoseconds
  std::size_t index = 0;   ///< among all messages of the topic
};

/// The stamp of a message's header, or the time of recording if that was not set.
[[nodiscard]] inline Stamp stamp_of(const MessageFields& message, std::int64_t time) {
  const Stamp stamp = header_stamp(message);
  return stamp == Stamp{} ? Stamp(time) : stamp;
}

/// The content of a recording, without its images.
struct RecordedSurvey {
  struct Topic {
    RecordedTopic topic;
    std::vector<ViewStamp> views = {};      ///< readable ones
    std::size_t messages = 0, damaged = 0;  ///< their numbers
    std::size_t unstamped = 0;              ///< messages without a stamp
    std::string damage = {};                ///< of the first one
    std::optional<CameraInfo> camera = {};  ///< the first one
    std::string image_part = {};            ///< the doubt about a partial image
    bool camera_changes = false;
  };
  std::map<std::string, Topic> topics = {};  ///< by name
  JointTracks joints = {};
  std::vector<std::int64_t> joints_ahead = {};  ///< as ViewStamp::ahead

  static bool wants(const BagTopic& topic) {
    constexpr std::array<std::string_view, 5> kTypes = {
        "sensor_msgs/JointState", "sensor_msgs/Image", "sensor_msgs/CompressedImage",
        "sensor_msgs/PointCloud2", "sensor_msgs/CameraInfo"};
    return std::find(kTypes.begin(), kTypes.end(), topic.type) != kTypes.end();
  }

  void add(const BagMessage& message, MessageForms& forms) {
    Topic& topic =
        topics.try_emplace(message.topic.name, Topic{{message.topic.name, message.topic.type}})
            .first->second;
    const std::size_t index = topic.messages++;
    try {
      const auto form = forms.of(message.topic);
      const MessageFields content = decode(form->definition, form->encoding, message.data);
      if (header_stamp(content) == Stamp{}) ++topic.unstamped;
      const Stamp stamp = stamp_of(content, message.time);
      take(topic, message.topic.type, content, {stamp, message.time - stamp.count(), index});
    } catch (const std::runtime_error& error) {  // bytes or definition
      if (topic.damaged++ == 0) topic.damage = error.what();
    }
  }

  /// Sorts the views of each topic by stamps, after all messages were added.
  void sort_views() {
    for (auto& [name, topic] : topics) {
      std::stable_sort(topic.views.begin(), topic.views.end(),
                       [](const ViewStamp& a, const ViewStamp& b) { return a.stamp < b.stamp; });
    }
  }

 private:
  void take(Topic& topic, std::string_view type, const MessageFields& content,
            const ViewStamp& view) {
    if (type == "sensor_msgs/JointState") {
      joints.add(topic.topic.name, joints_of(content, view.stamp));
      joints_ahead.push_back(view.ahead);
    } else if (type == "sensor_msgs/CameraInfo") {
      const CameraInfo camera = camera_of(content);
      const auto is_number = [](double x) { return std::isfinite(x); };
      if (!std::all_of(camera.k.begin(), camera.k.end(), is_number) ||
          !std::all_of(camera.p.begin(), camera.p.end(), is_number) ||
          !std::all_of(camera.d.begin(), camera.d.end(), is_number)) {
        throw std::runtime_error("its K, P or D has something that is not a number");
      }
      if (!topic.camera) {
        topic.camera = camera;
        topic.image_part = doubt_image_part(image_part_of(content), camera);
      }
      const CameraInfo& first = *topic.camera;
      topic.camera_changes |= camera.k != first.k || camera.p != first.p || camera.d != first.d ||
                              camera.width != first.width || camera.height != first.height;
    } else {
      if (topic.topic.encoding.empty()) {
        const std::string_view encoding = text_at(content, "encoding");
        topic.topic.encoding = encoding.empty() ? text_at(content, "format") : encoding;
      }
      topic.views.push_back(view);
    }
  }

  /// @throws std::runtime_error  if names and positions differ in number, or a joint occurs twice
  [[nodiscard]] static MeasuredJoints joints_of(const MessageFields& state, Stamp stamp) {
    MeasuredJoints joints;
    joints.stamp = stamp;
    for (const MessageValue& name : list_at(state, "name")) {
      if (const auto* text = name.as<std::string_view>()) joints.names.emplace_back(*text);
    }
    for (const MessageValue& position : list_at(state, "position")) {
      position.visit_number([&](auto x) { joints.positions.push_back(static_cast<double>(x)); });
    }
    if (!joints.positions.empty() && joints.positions.size() != joints.names.size()) {
      throw std::runtime_error("it has " + std::to_string(joints.names.size()) +
                               " names of joints and " + std::to_string(joints.positions.size()) +
                               " positions");
    }
    for (std::size_t i = 0; i < joints.positions.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (joints.names[i] != joints.names[j] || joints.positions[i] == joints.positions[j]) {
          continue;
        }
        throw std::runtime_error("joint '" + joints.names[i] + "' is in it twice, at " +
                                 std::to_string(joints.positions[j]) + " and " +
                                 std::to_string(joints.positions[i]));
      }
    }
    return joints;
  }
};

}  // namespace kinecal::detail
