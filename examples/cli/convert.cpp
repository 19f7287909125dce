// kinecal convert: samples and poses from one format to another.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/io/recordings/convert.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/io/csv/read_csv_samples.hpp"
#include "kinecal/io/recordings/bag_topics.hpp"
#include "kinecal/io/recordings/pose_messages.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/samples/write_samples.hpp"

namespace kinecal::cli {
namespace {

/// What was read, unless it is copied message by message.
struct Content {
  std::vector<Sample> samples;
  std::vector<CapturePose> poses;
};

/// The encoding of the bag to write; nothing for YAML.
/// @throws InputError  if the name tells no format
std::optional<Encoding> output_encoding(const std::string& output) {
  const std::string extension = std::filesystem::path(output).extension().string();
  if (extension == ".bag") return Encoding::ros1;
  if (extension == ".mcap") return Encoding::cdr;
  if (extension == ".yaml" || extension == ".yml") return std::nullopt;
  throw InputError(output + ": is to be in no known format; name it .yaml, .bag or .mcap");
}

/// YAML of poses is a list, that of samples begins with a key.
bool is_list_of_poses(const std::string& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#' || line.starts_with("---")) continue;
    return line[first] == '-' || line[first] == '[';
  }
  return false;
}

Content read_content(const ConvertOptions& options, Diagnostics& diagnostics) {
  const std::string& input = options.input;
  if (!options.columns.empty()) {
    return {read_csv_samples(input, options.columns, diagnostics), {}};
  }
  const std::string extension = std::filesystem::path(input).extension().string();
  if (extension == ".csv" || extension == ".tsv" || extension == ".txt") {
    throw InputError(input + ": is a table; say what its columns mean: --columns FILE");
  }
  if (recording_format(input) == RecordingFormat::yaml) {
    if (is_list_of_poses(input)) return {{}, read_poses_yaml(input, diagnostics)};
    return {read_samples(input, diagnostics), {}};
  }
  const std::vector<TopicContent> topics = bag_topics(input, diagnostics);
  if (!diagnostics.errors.empty()) return {};
  const bool has_samples = std::any_of(topics.begin(), topics.end(), [](const TopicContent& topic) {
    return topic.use == TopicUse::samples && topic.messages > 0;
  });
  if (has_samples) return {read_recording(input, diagnostics).samples, {}};
  return {{}, read_bag_poses(input, diagnostics)};
}

std::string counted(const Content& content) {
  if (content.samples.empty()) return fmt::format("{} poses", content.poses.size());
  return fmt::format("{} samples", content.samples.size());
}

/// Everything that is in the input, as YAML.
std::string write_yaml(const Content& content, const std::filesystem::path& output) {
  std::ostringstream text;
  if (content.samples.empty()) {
    write_poses_yaml(text, content.poses);
  } else {
    write_samples(text, content.samples);
  }
  OutputFolder folder(output.has_parent_path() ? output.parent_path() : ".");
  folder.write({{output.filename().string(), text.str()}});
  return counted(content);
}

/// A bag from a bag, or from what was read.
/// @return  what was written, in words; nothing if there were mistakes
std::optional<std::string> write_bag(const ConvertOptions& options, Encoding encoding,
                                     Diagnostics& diagnostics) {
  const bool from_bag =
      options.columns.empty() && recording_format(options.input) != RecordingFormat::yaml;
  Content content;
  if (!from_bag) content = read_content(options, diagnostics);
  if (!diagnostics.errors.empty()) return std::nullopt;
  BagOutput bag(options.output, encoding,
                encoding == Encoding::cdr ? best_mcap_compression() : Compression::none);
  std::string words = counted(content);
  if (from_bag) {
    const Clouds clouds = options.drop_clouds ? Clouds::drop : Clouds::keep;
    words = fmt::format("{} messages", convert_bag(options.input, bag, clouds, diagnostics));
  } else {
    write_samples(bag, content.samples);
    write_poses(bag, content.poses);
  }
  if (!diagnostics.errors.empty()) return std::nullopt;
  bag.finish();
  return words;
}

void check_output(const ConvertOptions& options) {
  const std::filesystem::path output = options.output;
  if (!options.force && std::filesystem::exists(std::filesystem::symlink_status(output))) {
    throw OutputError(options.output + ": exists; give --force to replace it, or another name");
  }
  std::error_code missing;
  if (std::filesystem::equivalent(output, options.input, missing) ||
      std::filesystem::equivalent(output, options.columns, missing)) {
    throw OutputError(options.output + ": would replace an input; choose another name");
  }
}

}  // namespace

int convert(const ConvertOptions& options) {
  check_output(options);
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
  fmt::print("wrote {}: {}\n", options.output, *words);
  return kDone;
}

}  // namespace kinecal::cli
