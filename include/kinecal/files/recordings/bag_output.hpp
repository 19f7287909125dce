// Writes a bag: ROS 1, or MCAP for ROS 2.
//
// The file appears under its name only when it is complete.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/files/results/output_file.hpp"

namespace kinecal {

namespace detail {
class BagFile;
}

/// A bag being written.  It gets its name at the end: see finish().
class BagOutput {
 public:
  /// @param encoding     ros1 for a ROS 1 bag, cdr for MCAP
  /// @param compression  of its chunks
  /// @throws OutputError  if nothing can be written there
  BagOutput(const std::string& path, Encoding encoding,
            Compression compression = Compression::none);
  ~BagOutput();

  [[nodiscard]] Encoding encoding() const { return encoding_; }  ///< of its messages

  /// Copies a message unchanged: its topic must have this bag's encoding and a definition.
  /// @param time  of recording, nanoseconds
  void copy(const BagTopic& topic, std::int64_t time, Bytes data);

  /// Writes a message of a known type, in this bag's encoding.
  /// @param topic  name and type of the message
  /// @param time   of recording, nanoseconds
  void write(const BagTopic& topic, std::int64_t time, const MessageFields& message);

  /// Gives the bag its name.
  /// @throws OutputError  if the bag cannot be completed, as on a full disk, or a file is there and kept
  void finish(Existing existing = Existing::replaced);

 private:
  Encoding encoding_;
  std::unique_ptr<detail::BagFile> file_;
};

}  // namespace kinecal
