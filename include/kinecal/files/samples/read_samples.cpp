// Definitions of read_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/samples/read_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/samples/sample_file.ipp"
#include "kinecal/files/text_file.hpp"

namespace kinecal {

std::vector<Sample> parse_samples(const std::string& text, const std::string& name_for_messages,
                                  Diagnostics& diagnostics) {
  if (detail::is_bag(std::as_bytes(std::span(text)))) {
    diagnostics.error({name_for_messages, 0},
                      "is a bag, which can be read from a file only; give its name");
    return {};
  }
  std::istringstream in(text);
  detail::SampleFile file(in, name_for_messages);
  file.read(1);
  return file.take(diagnostics);
}

std::vector<Sample> read_samples(const std::string& path, Diagnostics& diagnostics,
                                 unsigned threads, const ProgressMeter& meter) {
  if (detail::is_stream(path)) {
    return parse_samples(detail::read_text_file(path), path, diagnostics);
  }
  if (const std::string why = detail::why_no_file(path); !why.empty()) {
    diagnostics.error({path, 0}, why);
    return {};
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    diagnostics.error({path, 0}, fmt::format("cannot be opened: {}", std::strerror(errno)));
    return {};
  }
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::error_code unknown;  // of a device: then only the number of threads counts
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  detail::SampleFile file(in, path);
  if (!unknown) file.show_progress(size, meter);
  const std::uintmax_t pieces = size / detail::SampleFile::kPieceBytes + 1;
  file.read(static_cast<std::size_t>(std::min<std::uintmax_t>(threads, pieces)));
  if (in.bad()) {
    diagnostics.error({path, 0}, "cannot be read to its end");
    return {};
  }
  return file.take(diagnostics);
}

std::vector<Sample> read_complete_samples(const std::string& path, Diagnostics& diagnostics) {
  std::string text = detail::read_text_file(path);
  std::size_t end = 0;  // of the last line that is ---
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, next - at);
    at = next + 1;
    if (line == "---" || line == "---\r") end = std::min(at, text.size());
  }
  if (text.find_first_not_of(" \t\r\n", end) != std::string::npos) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    diagnostics.warning({path, static_cast<int>(line) + 1},
                        "the last sample has no '---' after it: it is cut off, and left out");
  }
  text.resize(end);
  if (end == 0) return {};
  return parse_samples(text, path, diagnostics);
}

}  // namespace kinecal
