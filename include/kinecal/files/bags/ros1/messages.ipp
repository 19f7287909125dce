// Passes on the wanted messages of a ROS 1 bag, and reports errors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/ros1/records.ipp"
#include "kinecal/files/bags/ros1/topics.ipp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

class Ros1Messages {
 public:
  /// @param name  of the bag, for messages
  Ros1Messages(std::string name, const BagReader& reader, Diagnostics& diagnostics)
      : name_(std::move(name)), reader_(reader), diagnostics_(diagnostics), topics_(reader.wants) {}

  [[nodiscard]] Ros1Topics& topics() { return topics_; }
  [[nodiscard]] const Ros1Topics& topics() const { return topics_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }  ///< handled so far
  [[nodiscard]] bool too_many_errors() const { return errors_ > kMostErrors; }

  /// The data of a chunk: connections and messages, one after another.
  struct Records {
    Bytes bytes;
    std::uint64_t place;   ///< of the first byte, for messages
    std::string where;     ///< beginning of messages
    bool is_whole = true;  ///< false if the file ends in it; reported elsewhere
  };

  void records(const Records& all) {
    ByteReader reader(all.bytes, std::endian::little, all.place);
    try {
      while (!reader.at_end() && !too_many_errors()) {
        const Ros1Record record = next_ros1_record(reader);
        const Ros1Op op = record.fields.op();
        if (op == Ros1Op::connection) {
          connection(record, all.where);
        } else if (op == Ros1Op::message) {
          if (const BagTopic* topic = wanted(record.fields, all.where)) {
            handle(*topic, ros1_time(record.fields, "time"), record.data);
          }
        } else {
          error(all.where + at_byte(record.data_place) +
                "the data of a record of unknown kind; it is left out");
        }
      }
    } catch (const BytesError& e) {
      if (all.is_whole) error(all.where + e.what() + "; the rest of the chunk is lost");
    }
  }

  void connection(const Ros1Record& record, const std::string& where) {
    try {
      topics_.add(record.fields, record.data, record.data_place);
    } catch (const BytesError& e) {
      error(where + e.what());
    }
  }

  /// @return  its topic; nullptr if the message is not wanted
  [[nodiscard]] const BagTopic* wanted(const Ros1Fields& message, const std::string& where) {
    try {
      return topics_.wanted(message);
    } catch (const BytesError& e) {
      error(where + e.what());
    }
    return nullptr;
  }

  /// @throws PassedOn  if the user's function throws
  void handle(const BagTopic& topic, std::int64_t time, Bytes data) {
    ++count_;
    pass_on([&] { reader_.handle({topic, time, data}); });
  }

  void error(const std::string& what) {
    if (errors_ < kMostErrors) {
      diagnostics_.error({name_, 0}, what);
    } else if (errors_ == kMostErrors) {
      diagnostics_.error({name_, 0}, "more than " + std::to_string(kMostErrors) +
                                         " errors; the rest of the bag is not read");
    }
    ++errors_;
  }

  void warning(const std::string& what) { diagnostics_.warning({name_, 0}, what); }

 private:
  static constexpr std::size_t kMostErrors = 20;  ///< further ones usually repeat the same error

  std::string name_;
  const BagReader& reader_;
  Diagnostics& diagnostics_;
  Ros1Topics topics_;
  std::uint64_t count_ = 0;
  std::size_t errors_ = 0;
};

}  // namespace kinecal::detail
