// Definitions of magnetometer_messages.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/magnetometer_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

namespace detail {
namespace {

struct FieldReading {
  Stamp stamp = {};
  Vector3<double> field = Vector3<double>::Zero();  ///< millionths of the topic's unit
};

/// The topic to read; empty: there is none.
[[nodiscard]] std::string magnetometer_topic(const std::string& path, Diagnostics& diagnostics) {
  std::vector<std::string> names;
  for (const TopicContent& topic : bag_topics(path, diagnostics)) {
    BagTopic known;
    known.name = topic.name;
    known.type = topic.type;
    if (shows_magnetic_field(known) && topic.messages > 0) names.push_back(topic.name);
  }
  return chosen_topic(std::move(names), {"imu/mag"}, "magnetometers", path, diagnostics);
}

/// Means of readings in succession that are nearer to the first of them than a twentieth of how far all scatter.
[[nodiscard]] std::vector<FieldReading> thinned(const std::vector<FieldReading>& all) {
  constexpr double kNear = 0.05;        // of the scatter
  constexpr double kFar = 0.2;          // the same, where there are many readings
  constexpr std::size_t kEnough = 600;  // samples
  Vector3<double> mean = Vector3<double>::Zero();
  for (const FieldReading& one : all) mean += one.field / static_cast<double>(all.size());
  double scatter = 0.0;
  for (const FieldReading& one : all) {
    scatter += (one.field - mean).squaredNorm() / static_cast<double>(all.size());
  }
  const double size = std::sqrt(scatter);
  const std::size_t fewest = 1 + all.size() / kEnough;  // of a mean
  std::vector<FieldReading> means;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    Vector3<double> sum = Vector3<double>::Zero();
    const auto is_near = [&](std::size_t other, double share) {
      return (all[other].field - all[begin].field).norm() < share * size;
    };
    while (end < all.size() &&
           (end == begin || is_near(end, end - begin < fewest ? kFar : kNear))) {
      sum += all[end++].field;
    }
    means.push_back({all[begin].stamp, sum / static_cast<double>(end - begin)});
  }
  return means;
}

}  // namespace
}  // namespace detail

bool shows_magnetic_field(const BagTopic& topic) {
  if (topic.type == "sensor_msgs/MagneticField") return true;
  const std::size_t at = topic.name.find("mag");  // not that of an image
  return topic.type == "geometry_msgs/Vector3Stamped" && at != std::string::npos &&
         (at == 0 || topic.name[at - 1] == '/' || topic.name[at - 1] == '_');
}

std::vector<Sample> read_magnetometer(const std::string& path, Diagnostics& diagnostics) {
  constexpr double kMillionths = 1e6, kMostTesla = 1e-3;
  const std::string topic = detail::magnetometer_topic(path, diagnostics);
  if (topic.empty()) return {};
  detail::MessageDecoder decoder(path, diagnostics);
  std::vector<detail::FieldReading> all;
  int number = 0, unreadable = 0;
  const auto handle = [&](const BagMessage& message) {
    const auto content = decoder.decode(message, ++number);
    if (!content) return;
    const std::string vector =
        message.topic.type == "sensor_msgs/MagneticField" ? "magnetic_field" : "vector";
    const Vector3<double> field =
        kMillionths * Vector3<double>(detail::number_at(*content, vector + ".x"),
                                      detail::number_at(*content, vector + ".y"),
                                      detail::number_at(*content, vector + ".z"));
    field.allFinite() ? all.push_back({detail::header_stamp(*content), field}) : void(++unreadable);
  };
  read_bag(path, {[&](const BagTopic& of) { return of.name == topic; }, handle}, diagnostics);
  if (unreadable > 0) {
    diagnostics.note({path, 0}, fmt::format("{} of {} messages of '{}' are not numbers: left out",
                                            unreadable, number, topic));
  }
  if (all.empty()) return {};
  std::vector<double> strengths;
  for (const detail::FieldReading& one : all) strengths.push_back(one.field.norm());
  if (const double typical = median_of(std::move(strengths)); typical > kMillionths * kMostTesla) {
    diagnostics.note({path, 0}, fmt::format("'{}' is not in tesla: it reads about {:.3g}; results "
                                            "are in its unit, and reports in millionths of it",
                                            topic, typical / kMillionths));
  }
  std::vector<Sample> samples;
  for (const detail::FieldReading& mean : detail::thinned(all)) {
    Sample& sample = samples.emplace_back();
    sample.stamp = mean.stamp;
    sample.source = fmt::format("{}:{}", path, samples.size());
    sample.conditions = {
        {"mag_x", mean.field.x()}, {"mag_y", mean.field.y()}, {"mag_z", mean.field.z()}};
  }
  return samples;
}

}  // namespace kinecal
