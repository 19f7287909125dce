// Definitions of read_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "kinecal/io/samples/read_samples.hpp"
#include "kinecal/io/samples/sample_file.ipp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

KINECAL_INLINE std::vector<Sample> read_samples(const std::string& path, Diagnostics& diagnostics,
                                                unsigned threads, const ProgressMeter& meter) {
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

}  // namespace kinecal
