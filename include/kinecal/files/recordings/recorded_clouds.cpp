// Reading clouds of samples.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/recorded_clouds.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Evenly thinned points of a cloud.
[[nodiscard]] std::vector<float> some_points(const PointCloud& cloud, std::size_t most) {
  std::vector<std::size_t> measured;
  for (std::size_t i = 0; i < cloud.pixels.size(); ++i) {
    if (cloud.pixels[i].allFinite()) measured.push_back(i);
  }
  const std::size_t kept = std::min(most, measured.size());
  std::vector<float> points;
  for (std::size_t i = 0; i < kept; ++i) {
    const Vector3<float>& point = cloud.pixels[measured[i * measured.size() / kept]];
    points.insert(points.end(), {point.x(), point.y(), point.z()});
  }
  return points;
}

/// The cloud of a sample's message; nullopt if it has no readable one.
[[nodiscard]] std::optional<RecordedCloud> cloud_of(const MessageFields& sample, std::size_t most) {
  for (const MessageValue& item : list_at(sample, "observations")) {
    const auto* seen = item.as<MessageFields>();
    const MessageValue* cloud = seen == nullptr ? nullptr : seen->find("cloud");
    const auto* fields = cloud == nullptr ? nullptr : cloud->as<MessageFields>();
    if (fields == nullptr || number_at(*fields, "width") == 0.0) continue;
    try {
      PointCloud points;
      GrayImage unused;
      read_cloud(*fields, points, unused);
      RecordedCloud read{std::string(text_at(*fields, "header.frame_id")),
                         some_points(points, most)};
      if (!read.points.empty()) return read;
    } catch (const std::runtime_error&) {  // a picture is not worth an error
    }
  }
  return std::nullopt;
}

}  // namespace
}  // namespace detail

std::map<std::string, RecordedCloud> read_clouds(const std::string& path,
                                                 const std::set<std::string>& wanted,
                                                 std::size_t most) {
  std::map<std::string, RecordedCloud> clouds;
  if (recording_format(path) == RecordingFormat::yaml) return clouds;
  Diagnostics unused;  // errors were reported when the samples were read
  detail::MessageDecoder decoder(path, unused);
  int number = 0;
  const auto wants = [](const BagTopic& topic) { return use_of(topic) == TopicUse::samples; };
  const auto handle = [&](const BagMessage& message) {
    const std::string source = SourceLocation{path, ++number}.str();
    if (!wanted.contains(source)) return;
    const auto sample = decoder.decode(message, number);
    if (!sample) return;
    if (auto cloud = detail::cloud_of(*sample, most)) clouds.emplace(source, std::move(*cloud));
  };
  read_bag(path, {wants, handle}, unused);
  return clouds;
}

}  // namespace kinecal
