// Samples, and the robot they were recorded on, from a file of any format.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/recordings/known_topics.hpp"
#include "kinecal/io/recordings/message_samples.hpp"
#include "kinecal/io/recordings/read_bag.hpp"
#include "kinecal/io/samples/read_samples.hpp"

namespace kinecal {

struct Recording {
  std::vector<Sample> samples;  ///< as read_samples() gives them; of a bag Sample::source is
                                ///< "path:number of the message"
  std::string urdf;             ///< the last /robot_description; empty if there is none
};

/// Reads YAML, a ROS 1 bag, MCAP or a ROS 2 bag, whatever it is.
/// @param diagnostics  receives every mistake; also that there are no samples
/// @param threads      as for read_samples()
[[nodiscard]] inline Recording read_recording(const std::string& path, Diagnostics& diagnostics,
                                              unsigned threads = 0) {
  if (recording_format(path) == RecordingFormat::yaml) {
    return {read_samples(path, diagnostics, threads), {}};
  }
  Recording recording;
  const std::size_t errors_before = diagnostics.errors.size();
  MessageDecoder decoder(path, diagnostics);
  detail::MessageSamples samples(path);
  int number = 0;
  const auto handle = [&](const BagMessage& message) {
    if (use_of(message.topic) == TopicUse::urdf) {
      const auto text = decoder.decode(message, 1);
      const MessageValue* data = text ? text->find("data") : nullptr;
      if (data == nullptr) return;
      if (const auto* urdf = data->as<std::string_view>()) recording.urdf = *urdf;
    } else if (!samples.too_many_errors()) {
      ++number;
      if (const auto sample = decoder.decode(message, number)) samples.add(*sample, number);
    }
  };
  const auto wants = [](const BagTopic& topic) {
    const TopicUse use = use_of(topic);
    return use == TopicUse::samples || use == TopicUse::urdf;
  };
  read_bag(path, {wants, handle}, diagnostics);
  recording.samples = samples.take(diagnostics);
  if (number == 0 && diagnostics.errors.size() == errors_before) {
    diagnostics.error({path, 0},
                      "no messages of robot_calibration_msgs/CalibrationData in this bag; "
                      "'kinecal inspect' shows what is in it");
  }
  return recording;
}

}  // namespace kinecal
