// kinecal convert: samples and poses from one format to another.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/convert.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <optional>
#include <sstream>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/text/counted.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// What was read.  Bags are not read into it if they are copied message by message.
struct Content {
  std::vector<Sample> samples;
  std::vector<CapturePose> poses;
};

/// Samples or poses in YAML.
Content read_yaml(const std::string& input, Diagnostics& diagnostics) {
  if (is_poses_yaml(input)) return {{}, read_poses_yaml(input, diagnostics)};
  Content content;
  Diagnostics found;
  try {
    ProgressLine line;
    content.samples = read_as_recorded(input, found, 0, line.meter()).samples;
  } catch (const InputError& error) {
    found.errors.emplace_back(error.what());
  }
  diagnostics.notes.insert(diagnostics.notes.end(), found.notes.begin(), found.notes.end());
  diagnostics.errors.insert(diagnostics.errors.end(), found.errors.begin(), found.errors.end());
  diagnostics.warnings.insert(diagnostics.warnings.end(), found.warnings.begin(),
                              found.warnings.end());
  return content;
}

/// What YAML can hold of a bag: its samples or, without any, its poses.  Warns of the rest.
Content read_bag_content(const std::string& input, Diagnostics& diagnostics) {
  Diagnostics reported_later;  // when the messages are read
  const std::vector<TopicContent> topics = bag_topics(input, reported_later);
  const bool has_samples = std::any_of(topics.begin(), topics.end(), [](const TopicContent& topic) {
    return topic.use == TopicUse::samples && topic.messages > 0;
  });
  if (!has_samples && gives_sensed_samples(topics)) {
    return {read_as_recorded(input, diagnostics).samples, {}};
  }
  const TopicUse used = has_samples ? TopicUse::samples : TopicUse::poses;
  for (const TopicContent& topic : topics) {
    if (topic.use == used || topic.messages == 0) continue;
    diagnostics.warning({input, 0},
                        fmt::format("topic '{}' ({}) is left out: YAML holds only {}", topic.name,
                                    topic.type, has_samples ? "samples" : "poses"));
  }
  if (has_samples) return {read_as_recorded(input, diagnostics).samples, {}};
  return {{}, read_bag_poses(input, diagnostics)};
}

Content read_content(const ConvertOptions& options, Diagnostics& diagnostics) {
  if (!options.columns.empty()) {
    return {read_csv_samples(options.input, options.columns, diagnostics), {}};
  }
  return recording_format(options.input) == RecordingFormat::yaml
             ? read_yaml(options.input, diagnostics)
             : read_bag_content(options.input, diagnostics);
}

std::string counted_content(const Content& content) {
  if (content.samples.empty()) return counted(content.poses.size(), "pose");
  return counted(content.samples.size(), "sample");
}

/// Writes everything that was read, as YAML.
/// @return  what was written, in words
std::string write_yaml(const Content& content, const std::string& output) {
  std::ostringstream text;
  if (content.samples.empty()) {
    write_poses_yaml(text, content.poses);
  } else {
    write_samples(text, content.samples);
  }
  write_output(output, text.str());
  return counted_content(content);
}

/// Writes a bag from a bag, or from what was read.
/// @return  what was written, in words; nothing if there were errors
std::optional<std::string> write_bag(const ConvertOptions& options, Encoding encoding,
                                     Diagnostics& diagnostics) {
  const bool from_bag =
      options.columns.empty() && recording_format(options.input) != RecordingFormat::yaml;
  Content content;
  if (!from_bag) content = read_content(options, diagnostics);
  if (!diagnostics.errors.empty()) return std::nullopt;
  const OutputFolder folder(folder_of(options.output));  // creates it if it is missing
  BagOutput bag(options.output, encoding,
                encoding == Encoding::cdr ? best_mcap_compression() : Compression::none);
  std::string words = counted_content(content);
  if (from_bag) {
    const Clouds clouds = options.drop_clouds ? Clouds::drop : Clouds::keep;
    const auto messages = convert_bag(options.input, bag, clouds, diagnostics);
    words = counted(static_cast<std::size_t>(messages), "message");
  } else {
    write_samples(bag, content.samples);
    write_poses(bag, content.poses);
  }
  if (!diagnostics.errors.empty()) return std::nullopt;
  bag.finish(existing_at(options.output));
  return words;
}

}  // namespace

int convert(const ConvertOptions& options) {
  check_output(options.output, {options.input, options.columns}, options.force);
  const std::optional<Encoding> encoding = output_encoding(options.output);
  Diagnostics diagnostics;
  std::optional<std::string> words;
  if (encoding) {
    words = write_bag(options, *encoding, diagnostics);
  } else if (const Content content = read_content(options, diagnostics);
             diagnostics.errors.empty()) {
    words = write_yaml(content, options.output);
  }
  print(diagnostics);
  if (!words) return kBadInput;
  say("wrote {}: {}\n", options.output, *words);
  return kDone;
}

}  // namespace kinecal::cli
