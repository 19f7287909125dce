// The messages in the records of a ROS 1 bag: who wants them, and what is wrong with them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/ros1_record.hpp"
#include "kinecal/io/bags/ros1_topics.hpp"
#include "kinecal/io/diagnostics.hpp"

namespace kinecal::detail {

class Ros1Messages {
 public:
  /// @param name  of the bag, as messages begin
  Ros1Messages(std::string name, const BagReader& reader, Diagnostics& diagnostics)
      : name_(std::move(name)), reader_(reader), diagnostics_(diagnostics), topics_(reader.wants) {}

  [[nodiscard]] Ros1Topics& topics() { return topics_; }
  [[nodiscard]] const Ros1Topics& topics() const { return topics_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }  ///< of those that were handled
  [[nodiscard]] bool too_many_errors() const { return errors_ > kMostErrors; }

  /// Connections and messages one after another: the data of a chunk.
  struct Records {
    Bytes bytes;
    std::uint64_t place;   ///< of the first byte, as messages name it
    std::string where;     ///< stands in front of messages
    bool is_whole = true;  ///< it is not where the file ends in it; that it does is told elsewhere
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
          error(all.where + "byte " + std::to_string(record.data_place) +
                ": the data of a record of unknown kind; it is left out");
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

  /// @return  its topic, nullptr if it is left out
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
                                         " mistakes; it is not read to its end");
    }
    ++errors_;
  }

  void warning(const std::string& what) { diagnostics_.warning({name_, 0}, what); }

 private:
  static constexpr std::size_t kMostErrors = 20;  ///< the rest are usually the same one again

  std::string name_;
  const BagReader& reader_;
  Diagnostics& diagnostics_;
  Ros1Topics topics_;
  std::uint64_t count_ = 0;
  std::size_t errors_ = 0;
};

}  // namespace kinecal::detail
