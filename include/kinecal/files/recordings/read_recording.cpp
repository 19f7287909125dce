// Definitions of read_recording.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/read_recording.hpp"

#include <cstddef>
#include <string>
#include <string_view>

#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/recordings/accelerometer_messages.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/base_messages.hpp"
#include "kinecal/files/recordings/magnetometer_messages.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/message_samples.ipp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/text/characters.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Reports a name with a line end, which would begin a line of what is printed.
void check_names(const std::vector<Sample>& samples, Diagnostics& diagnostics) {
  for (const Sample& sample : samples) {
    const auto has_line_end = [&](const std::string& name) {
      if (name.find('\n') == std::string::npos) return false;
      diagnostics.error({sample.source, 0}, "the name '" + one_line(name) + "' has a line end");
      return true;
    };
    for (const std::string& joint : sample.joint_names) {
      if (has_line_end(joint)) return;
    }
    for (const auto& [joint, pose] : sample.poses) {
      if (has_line_end(joint)) return;
    }
    for (const Observation& seen : sample.observations) {
      if (has_line_end(seen.sensor)) return;
      for (const Feature& feature : seen.features) {
        if (has_line_end(feature.frame)) return;
      }
    }
  }
}

/// What the topics of a bag show, beside robot_calibration's messages.
struct SensedTopics {
  bool drive = false, field = false, joints = false, imu = false;

  void look_at(const BagTopic& topic) {
    drive = drive || shows_base(topic);
    field = field || shows_magnetic_field(topic);
    joints = joints || topic.type == "sensor_msgs/JointState";
    imu = imu || topic.type == "sensor_msgs/Imu";
  }
  [[nodiscard]] bool any() const { return drive || field || (joints && imu); }
};

/// The samples of a drive and of a magnetometer, or of an accelerometer.
/// @returns  false if the bag has none of them
[[nodiscard]] bool read_sensed(const std::string& path, const SensedTopics& topics,
                               std::vector<Sample>& samples, Diagnostics& diagnostics) {
  std::vector<Sample> of_field;
  if (topics.field) of_field = read_magnetometer(path, diagnostics);
  if (topics.drive) {
    Diagnostics of_drive;
    samples = read_base_drive(path, of_drive).samples;
    for (const auto list : {&Diagnostics::errors, &Diagnostics::warnings, &Diagnostics::doubts,
                            &Diagnostics::refutable, &Diagnostics::notes}) {
      if (!of_field.empty() && !of_drive.errors.empty()) break;
      (diagnostics.*list)
          .insert((diagnostics.*list).end(), (of_drive.*list).begin(), (of_drive.*list).end());
    }
  }
  double run = 0.0;  // each reading is a run of its own
  for (const Sample& sample : samples) {
    const auto of = sample.conditions.find(kRun);
    if (of != sample.conditions.end()) run = std::max(run, of->second);
  }
  for (Sample& sample : of_field) {
    if (!samples.empty()) sample.conditions[kRun] = ++run;
  }
  samples.insert(samples.end(), of_field.begin(), of_field.end());
  if (topics.drive || !of_field.empty()) return true;
  if (!topics.joints || !topics.imu) return false;
  samples = read_gravity(path, diagnostics);
  return true;
}

}  // namespace
}  // namespace detail

bool gives_sensed_samples(const std::vector<TopicContent>& topics) {
  detail::SensedTopics sensed;
  for (const TopicContent& topic : topics) {
    if (topic.messages == 0) continue;
    BagTopic known;
    known.name = topic.name;
    known.type = topic.type;
    sensed.look_at(known);
  }
  return sensed.any();
}

Recording read_recording(const std::string& path, Diagnostics& diagnostics, unsigned threads,
                         const ProgressMeter& meter) {
  Recording recording = read_as_recorded(path, diagnostics, threads, meter);
  detail::check_names(recording.samples, diagnostics);
  set_joint_moves(recording.samples);
  set_joint_velocities(recording.samples);
  return recording;
}

Recording read_as_recorded(const std::string& path, Diagnostics& diagnostics, unsigned threads,
                           const ProgressMeter& meter) {
  if (path.find('\n') != std::string::npos) {  // places of samples begin with it
    throw InputError("'" + detail::one_line(path) + "': the name of a file has a line end");
  }
  if (is_hand_eye_samples(path)) return {read_hand_eye_samples(path, {}, diagnostics), {}};
  if (is_csv_table(path)) return {read_csv_by_columns_beside(path, diagnostics), {}};
  if (recording_format(path) == RecordingFormat::yaml) {
    return {read_samples(path, diagnostics, threads, meter), {}};
  }
  Recording recording;
  const std::size_t errors_before = diagnostics.errors.size();
  detail::MessageDecoder decoder(path, diagnostics);
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
  detail::SensedTopics sensed;
  const auto wants = [&](const BagTopic& topic) {
    const TopicUse use = use_of(topic);
    sensed.look_at(topic);
    return use == TopicUse::samples || use == TopicUse::urdf;
  };
  read_bag(path, {wants, handle, meter}, diagnostics);
  recording.samples = samples.take(diagnostics);
  if (number == 0 && diagnostics.errors.size() == errors_before &&
      !detail::read_sensed(path, sensed, recording.samples, diagnostics) &&
      diagnostics.errors.size() == errors_before) {
    diagnostics.error({path, 0},
                      "no messages of robot_calibration_msgs/CalibrationData in this bag; "
                      "'kinecal inspect' shows what is in it");
  }
  return recording;
}

}  // namespace kinecal
