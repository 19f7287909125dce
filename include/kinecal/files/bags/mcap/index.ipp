// The index at the end of an MCAP file, its summary: the channels in each chunk.
//
// It lets readers skip chunks and notice missing messages; the file can be read without it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/chunk.ipp"
#include "kinecal/files/bags/mcap/records.ipp"
#include "kinecal/files/bags/mcap/topics.ipp"

namespace kinecal::detail {

struct McapIndex {
  bool complete = false;  ///< the file has an end: its recording was not interrupted
  std::map<std::uint64_t, McapChunkIndex> chunks;  ///< by their place
  std::optional<McapStatistics> statistics;
  McapTopics topics;
  std::string damage;  ///< why the summary is not used; empty if it is used or missing

  /// True if all channels and schemas are in the summary, so that chunks may be skipped.  If a
  /// writer left them out, a chunk may hold the only record of a channel or a schema.
  [[nodiscard]] bool knows_all_topics() const {
    return statistics && statistics->channels <= topics.channels() &&
           statistics->schemas <= topics.schemas();
  }
};

/// Reads the records of the summary.
inline void read_mcap_summary(Bytes summary, std::uint64_t place, McapIndex& index) {
  ByteReader in(summary, std::endian::little, place);
  while (!in.at_end()) {
    const auto op = static_cast<McapOp>(in.number<std::uint8_t>());
    const auto length = in.number<std::uint64_t>();
    const std::uint64_t start = in.place();
    const ByteReader content(in.take(length), std::endian::little, start);
    switch (op) {
      case McapOp::schema:
        index.topics.add_schema(content);
        break;
      case McapOp::channel:
        index.topics.add_channel(content);
        break;
      case McapOp::statistics:
        index.statistics.emplace(content);
        break;
      case McapOp::chunk_index: {
        McapChunkIndex chunk(content);
        index.chunks.insert_or_assign(chunk.place, std::move(chunk));
        break;
      }
      default:
        break;
    }
  }
}

/// Reads the end of a file.
/// @return  the index; empty if the recording was interrupted
[[nodiscard]] inline McapIndex read_mcap_index(ByteFile& file) {
  constexpr std::uint64_t kMostOfASummary = std::uint64_t{1} << 26;  // of some 100 GB
  constexpr std::uint64_t kEnd = kMcapHeadBytes + kMcapFooterBytes + kMcapMagic.size();
  std::vector<std::byte> buffer;
  McapIndex index;
  if (file.size() < kMcapMagic.size() + kEnd) return index;
  const std::uint64_t footer_place = file.size() - kEnd;
  file.go_to(footer_place);
  ByteReader in(file.read(kEnd, buffer), std::endian::little, footer_place);
  if (in.number<std::uint8_t>() != static_cast<std::uint8_t>(McapOp::footer) ||
      in.number<std::uint64_t>() != kMcapFooterBytes) {
    return index;
  }
  const McapFooter footer(ByteReader(in.take(kMcapFooterBytes)));
  index.complete = in.text(kMcapMagic.size()) == kMcapMagic;
  if (!index.complete || footer.summary == 0) return index;
  try {
    if (footer.summary > footer_place || footer_place - footer.summary > kMostOfASummary) {
      throw BytesError(fmt::format(
          "byte {}: the footer says that the index begins at byte {}, which is not plausible",
          footer_place, footer.summary));
    }
    file.go_to(footer.summary);
    const std::uint64_t size = footer_place - footer.summary;
    const Bytes summed = file.read(size + kMcapHeadBytes + 16, buffer);
    check_mcap_sum(summed, footer.sum, footer.summary, "the index");
    read_mcap_summary(summed.first(size), footer.summary, index);
    return index;
  } catch (const BytesError& e) {
    McapIndex without;
    without.complete = true;
    without.damage = e.what();
    return without;
  }
}

}  // namespace kinecal::detail
