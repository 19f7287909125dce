// Undecoded messages of a recording that together form a view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/tools/detect/recorded_survey.ipp"

namespace kinecal::detail {

/// Time between two messages of one moment, at most: as for live cameras.
inline constexpr std::chrono::milliseconds kTogether{40};
/// The same while the robot moves: 0.5 mrad of a joint at 0.1 rad/s.
inline constexpr std::chrono::milliseconds kTogetherInMotion{5};

/// One or two messages of one moment.
struct RawView {
  struct Part {
    std::string topic;
    std::size_t index = 0;                         ///< among all messages of the topic
    std::shared_ptr<const MessageForm> form = {};  ///< nullptr before it was read
    std::vector<std::byte> data = {};
  };
  Stamp stamp;
  std::vector<Part> parts;

  [[nodiscard]] bool complete() const {
    return std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.form != nullptr; });
  }
};

/// Topics of a camera's messages; the stamps of the first one count.
[[nodiscard]] inline std::vector<std::string> parts_of(const ViewTopics& topics) {
  std::vector<std::string> parts;
  for (const std::string& topic : {topics.image, topics.depth, topics.cloud}) {
    if (!topic.empty()) parts.push_back(topic);
  }
  return parts;
}

/// Decodes a view.
/// @param frame  of the camera; empty: from the messages
/// @throws std::runtime_error  naming the topic, if a message cannot be read
[[nodiscard]] inline View decoded(const RawView& raw, const ViewTopics& topics,
                                  const std::optional<CameraInfo>& camera,
                                  const std::string& frame) {
  View view;
  view.stamp = raw.stamp;
  view.camera = camera;
  view.frame = frame;
  for (const RawView::Part& part : raw.parts) {
    try {
      const MessageFields message = decode(part.form->definition, part.form->encoding, part.data);
      if (view.frame.empty()) view.frame = plain_frame(text_at(message, "header.frame_id"));
      if (part.topic == topics.image) {
        view.image = gray_image(message);
      } else if (part.topic == topics.cloud) {
        read_cloud(message, view.points, view.image);
      } else if (camera) {
        view.points = points_of(depth_image(message), *camera);
      } else {
        throw std::runtime_error("depth becomes points only with a camera, which is not known");
      }
    } catch (const std::exception& error) {
      throw std::runtime_error("topic '" + printable(part.topic) + "': " + error.what());
    }
  }
  if (view.frame.empty()) {
    throw std::runtime_error("topic '" + printable(raw.parts.front().topic) +
                             "' has no frame_id; name the camera's frame with --frame");
  }
  return view;
}

/// Up to `most` items, evenly spread.
template <class T>
[[nodiscard]] std::vector<T> spread_out(const std::vector<T>& items, std::size_t most) {
  if (items.size() <= most) return items;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(items[i * (items.size() - 1) / (most - 1)]);
  return some;
}

/// Candidate views of a standstill: a few in its middle two seconds, else the one nearest to its
/// middle.  Skips its ends, because stamps and exposures are slightly off.
/// @param views  sorted
[[nodiscard]] inline std::vector<ViewStamp> worth_a_look(const std::vector<ViewStamp>& views,
                                                         const Standstill& time) {
  constexpr std::chrono::milliseconds kEnd{100}, kHalf{1000};
  constexpr std::size_t kMost = 8;
  const Stamp middle = time.begin + (time.end - time.begin) / 2;
  const ViewStamp* nearest = nullptr;
  std::vector<ViewStamp> within;
  for (const ViewStamp& view : views) {
    if (view.stamp < time.begin + kEnd || view.stamp > time.end - kEnd) continue;
    const auto away = std::chrono::abs(view.stamp - middle);
    if (away <= kHalf) within.push_back(view);
    if (nearest == nullptr || away < std::chrono::abs(nearest->stamp - middle)) nearest = &view;
  }
  if (within.empty() && nearest != nullptr) within.push_back(*nearest);
  return spread_out(within, kMost);
}

/// The view nearest to a moment; nullptr if absent.
/// @param views  sorted
[[nodiscard]] inline const ViewStamp* nearest_view(const std::vector<ViewStamp>& views,
                                                   Stamp stamp) {
  const auto next =
      std::lower_bound(views.begin(), views.end(), stamp,
                       [](const ViewStamp& view, Stamp moment) { return view.stamp < moment; });
  if (next == views.begin()) return views.empty() ? nullptr : &views.front();
  const auto last = next - 1;
  return next == views.end() || stamp - last->stamp <= next->stamp - stamp ? &*last : &*next;
}

/// The message of another topic nearest in time, if near enough.
/// @param views  sorted
[[nodiscard]] inline const ViewStamp* companion(const std::vector<ViewStamp>& views, Stamp stamp,
                                                Stamp most_apart) {
  const ViewStamp* nearest = nearest_view(views, stamp);
  const bool is_near = nearest != nullptr && std::chrono::abs(nearest->stamp - stamp) <= most_apart;
  return is_near ? nearest : nullptr;
}

}  // namespace kinecal::detail
