// Definitions of bag_output.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/bag_output.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/bags/ros1/write_bag.hpp"
#include "kinecal/files/messages/encode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/results/staging.hpp"

namespace kinecal {
namespace detail {

/// The file of a BagOutput, its writer and the topics written so far.
class BagFile {
 public:
  BagFile(std::filesystem::path path, Encoding encoding, Compression compression)
      : path_(std::move(path)),
        encoding_(encoding),
        staging_(path_.has_parent_path() ? path_.parent_path() : "."),
        file_(staging_.path() / path_.filename(), std::ios::binary) {
    with_path([&] {
      if (encoding_ == Encoding::ros1) {
        writer_.emplace<Ros1BagWriter>(file_, compression);
      } else {
        writer_.emplace<McapWriter>(file_, McapOptions{compression});
      }
    });
  }

  void write(const BagTopic& topic, std::int64_t time, Bytes data) {
    const std::uint32_t number = number_of(topic);
    with_path([&] {
      if (auto* bag = std::get_if<Ros1BagWriter>(&writer_)) {
        bag->write(number, time, data);
      } else {
        std::get<McapWriter>(writer_).write(static_cast<std::uint16_t>(number), time, data);
      }
    });
  }

  void write(const BagTopic& topic, std::int64_t time, const MessageFields& message) {
    const BagTopic written{topic.name, topic.type, known_definition(topic.type, encoding_),
                           encoding_, known_md5(topic.type)};
    auto definition = definitions_.find(topic.type);
    if (definition == definitions_.end()) {
      const auto parsed = parse_definition(topic.type, written.definition);
      definition = definitions_.emplace(topic.type, parsed).first;
    }
    write(written, time, encode(message, definition->second, encoding_));
  }

  void finish(Existing existing) {
    with_path([&] {
      std::visit(
          [](auto& writer) {
            if constexpr (requires { writer.close(); }) writer.close();
          },
          writer_);
    });
    errno = 0;
    file_.close();
    if (!file_) throw OutputError(path_.string() + ": cannot be written to its end" + reason());
    place_file(staging_.path() / path_.filename(), path_, existing);
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

  /// The name in ROS 1, with a slash, because rosbag finds topics only by their full names.
  [[nodiscard]] static std::string name_in_ros1(const std::string& name) {
    const bool is_poses = name == "calibration_joint_states";  // robot_calibration's has no slash
    return is_poses ? name : "/" + name;
  }

  /// Calls `act`; adds path and reason to the message of its exceptions.
  template <class Act>
  void with_path(const Act& act) const {
    errno = 0;
    try {
      act();
    } catch (const std::runtime_error& error) {
      throw OutputError(path_.string() + ": " + error.what() + (file_ ? "" : reason()));
    }
    if (!file_) throw OutputError(path_.string() + ": cannot be written" + reason());
  }

  /// ": No space left on device"; empty if the system gives no reason.
  [[nodiscard]] static std::string reason() {
    return errno == 0 ? std::string() : std::string(": ") + std::strerror(errno);
  }

  std::filesystem::path path_;
  Encoding encoding_;
  StagingFolder staging_;
  std::ofstream file_;
  std::variant<std::monostate, Ros1BagWriter, McapWriter> writer_;
  /// By name, type and definition: a topic may have several versions of its type.
  std::map<std::tuple<std::string, std::string, std::string>, std::uint32_t, std::less<>> numbers_;
  std::map<std::string, MessageDefinition> definitions_;  ///< of known types, in this encoding
};

}  // namespace detail

BagOutput::BagOutput(const std::string& path, Encoding encoding, Compression compression)
    : encoding_(encoding), file_(std::make_unique<detail::BagFile>(path, encoding, compression)) {}

BagOutput::~BagOutput() = default;

void BagOutput::copy(const BagTopic& topic, std::int64_t time, Bytes data) {
  file_->write(topic, time, data);
}

void BagOutput::write(const BagTopic& topic, std::int64_t time, const MessageFields& message) {
  file_->write(topic, time, message);
}

void BagOutput::finish(Existing existing) {
  file_->finish(existing);
}

}  // namespace kinecal
