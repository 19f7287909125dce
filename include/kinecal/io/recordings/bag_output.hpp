// A bag that is written: ROS 1, or MCAP for ROS 2.
//
// It appears under its name when it is complete, not before.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "kinecal/io/bags/write_mcap.hpp"
#include "kinecal/io/bags/write_ros1_bag.hpp"
#include "kinecal/io/messages/encode.hpp"
#include "kinecal/io/messages/known_definitions.hpp"
#include "kinecal/io/results/file_set.hpp"

namespace kinecal {

class BagOutput {
 public:
  /// @param encoding     ros1 for a ROS 1 bag, cdr for MCAP
  /// @param compression  of its chunks
  /// @throws OutputError  if nothing can be written there
  BagOutput(std::filesystem::path path, Encoding encoding,
            Compression compression = Compression::none)
      : path_(std::move(path)),
        encoding_(encoding),
        staging_(path_.has_parent_path() ? path_.parent_path() : "."),
        file_(staging_.path() / path_.filename(), std::ios::binary) {
    name_mistakes([&] {
      if (encoding_ == Encoding::ros1) {
        writer_.emplace<Ros1BagWriter>(file_, compression);
      } else {
        writer_.emplace<McapWriter>(file_, McapOptions{compression});
      }
    });
  }

  [[nodiscard]] Encoding encoding() const { return encoding_; }

  /// Writes a message as it is: its topic must have this bag's encoding and a definition.
  void copy(const BagTopic& topic, std::int64_t time, Bytes data) {
    write(number_of(topic), time, data);
  }

  /// Writes a message of a known type, in this bag's encoding.
  /// @param topic  name and type of the message
  void write(const BagTopic& topic, std::int64_t time, const MessageFields& message) {
    const BagTopic written{topic.name, topic.type, known_definition(topic.type, encoding_),
                           encoding_, known_md5(topic.type)};
    auto definition = definitions_.find(topic.type);
    if (definition == definitions_.end()) {
      const auto parsed = parse_definition(topic.type, written.definition);
      definition = definitions_.emplace(topic.type, parsed).first;
    }
    write(number_of(written), time, encode(message, definition->second, encoding_));
  }

  /// Gives the bag its name.
  /// @throws OutputError  if it could not be written to its end, as on a full disk
  void finish() {
    name_mistakes([&] {
      std::visit(
          [](auto& writer) {
            if constexpr (requires { writer.close(); }) writer.close();
          },
          writer_);
    });
    file_.close();
    if (!file_) throw OutputError(path_.string() + ": cannot be written to its end");
    detail::rename_file(staging_.path() / path_.filename(), path_);
  }

 private:
  [[nodiscard]] std::uint32_t number_of(const BagTopic& topic) {
    const auto key = std::tie(topic.name, topic.type, topic.definition);
    if (const auto known = numbers_.find(key); known != numbers_.end()) return known->second;
    std::uint32_t number = 0;
    if (auto* bag = std::get_if<Ros1BagWriter>(&writer_)) {
      BagTopic named = topic;
      named.name = name_in_ros1(topic.name);
      number = bag->add_topic(named, topic.name.ends_with("robot_description"));
    } else {
      number = std::get<McapWriter>(writer_).add_topic(topic);
    }
    return numbers_.emplace(key, number).first->second;
  }

  /// As rosbag records it, since rosbag finds a topic only by its whole name.
  [[nodiscard]] static std::string name_in_ros1(const std::string& name) {
    const bool poses = name == "calibration_joint_states";  // robot_calibration's own, without
    return poses ? name : "/" + name;
  }

  void write(std::uint32_t number, std::int64_t time, Bytes data) {
    name_mistakes([&] {
      if (auto* bag = std::get_if<Ros1BagWriter>(&writer_)) {
        bag->write(number, time, data);
      } else {
        std::get<McapWriter>(writer_).write(static_cast<std::uint16_t>(number), time, data);
      }
    });
  }

  /// Does something; what goes wrong is told with the bag's name.
  template <class Do>
  void name_mistakes(const Do& act) const {
    try {
      act();
    } catch (const std::runtime_error& error) {
      throw OutputError(path_.string() + ": " + error.what());
    }
  }

  std::filesystem::path path_;
  Encoding encoding_;
  detail::StagingFolder staging_;
  std::ofstream file_;
  std::variant<std::monostate, Ros1BagWriter, McapWriter> writer_;
  /// By name, type and definition: of one topic there may be messages of several versions.
  std::map<std::tuple<std::string, std::string, std::string>, std::uint32_t, std::less<>> numbers_;
  std::map<std::string, MessageDefinition> definitions_;  ///< of known types, in this encoding
};

}  // namespace kinecal
