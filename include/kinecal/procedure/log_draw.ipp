// Draws samples evenly from the files of a log: for calibrate_log.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Samples that are kept in memory while files are read.
inline constexpr std::int64_t kKeptOfLog = 100000;

/// What is known of a file after it was read once.
struct FileContent {
  std::int64_t samples = 0;
  std::optional<std::chrono::nanoseconds> begin =
      {};                                 ///< earliest stamp; nullopt: some sample has none
  std::vector<std::int64_t> places = {};  ///< of the samples that were kept, ascending
  std::vector<Sample> kept = {};
};

/// The i-th of `count` places that are spread evenly over `size`.
[[nodiscard]] inline std::int64_t even_place(std::int64_t i, std::int64_t count,
                                             std::int64_t size) {
  return (2 * i + 1) * size / (2 * count);
}

/// Reads a file, and keeps at most so many of its samples, evenly.
[[nodiscard]] inline FileContent content_of(std::vector<Sample> samples, std::int64_t most) {
  FileContent content;
  content.samples = std::ssize(samples);
  bool all_have = !samples.empty();
  for (const Sample& sample : samples) {
    all_have = all_have && sample.stamp.has_value();
    if (!all_have) break;
    content.begin = std::min(content.begin.value_or(*sample.stamp), *sample.stamp);
  }
  if (!all_have) content.begin.reset();
  const std::int64_t count = std::min(most, content.samples);
  for (std::int64_t i = 0; i < count; ++i) {
    content.places.push_back(even_place(i, count, content.samples));
    content.kept.push_back(std::move(samples[static_cast<std::size_t>(content.places.back())]));
  }
  return content;
}

/// Files by the time of their first sample; by name if some file has samples without a stamp.
[[nodiscard]] inline std::vector<int> order_of(const std::vector<FileContent>& files,
                                               const std::vector<std::string>& names) {
  std::vector<int> order(files.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const bool have_times = std::all_of(files.begin(), files.end(), [](const FileContent& file) {
    return file.begin || file.samples == 0;
  });
  const auto key = [&](int file) {
    const auto f = static_cast<std::size_t>(file);
    const std::chrono::nanoseconds begin =
        have_times ? files[f].begin.value_or(std::chrono::nanoseconds::max())
                   : std::chrono::nanoseconds{};
    return std::pair(begin, names[f]);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

/// How many samples each file gives to a draw: in proportion.
[[nodiscard]] inline std::vector<std::int64_t> shares_of(const std::vector<FileContent>& files,
                                                         std::int64_t drawn, std::int64_t total) {
  std::vector<std::int64_t> shares;
  std::int64_t before = 0;  // samples of the files so far
  for (const FileContent& file : files) {
    const auto until = [&](std::int64_t samples) {
      return total <= drawn ? samples : samples * drawn / total;
    };
    shares.push_back(until(before + file.samples) - until(before));
    before += file.samples;
  }
  return shares;
}

/// Samples that were drawn, and their numbers in the log, from 1.
struct Draw {
  std::vector<Sample> samples = {};
  std::vector<int> numbers = {};
};

/// Moves a draw out of the samples that were kept.
/// @param files  in their order
/// @param most   samples of the draw
/// @param total  samples of all files
[[nodiscard]] inline Draw draw_of(std::vector<FileContent> files, std::int64_t most,
                                  std::int64_t total) {
  const std::vector<std::int64_t> shares = shares_of(files, most, total);
  Draw draw;
  std::int64_t before = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    FileContent& file = files[f];
    const std::int64_t count = std::min(shares[f], std::ssize(file.kept));
    for (std::int64_t i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(even_place(i, count, std::ssize(file.kept)));
      draw.samples.push_back(std::move(file.kept[k]));
      draw.numbers.push_back(static_cast<int>(before + file.places[k] + 1));
    }
    before += file.samples;
  }
  return draw;
}

}  // namespace kinecal::detail
