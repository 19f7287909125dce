// Definitions of standard_output.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/standard_output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string_view>
#include <system_error>

#include "kinecal/files/results/output_file.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The file that was the standard output when the program began.
int& standard_output() {
  static int file = STDOUT_FILENO;
  return file;
}

}  // namespace
}  // namespace detail

bool is_standard_output(const std::string& path) {
  return path == "-";
}

void reserve_standard_output() {
  int& file = detail::standard_output();
  if (file != STDOUT_FILENO) return;
  std::fflush(stdout);
  file = dup(STDOUT_FILENO);
  if (file < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    throw OutputError("the standard output is closed");
  }
}

void write_standard_output(const std::string& content) {
  std::fflush(stdout);
  for (std::string_view rest = content; !rest.empty();) {
    const ssize_t written = write(detail::standard_output(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      throw OutputError("the standard output cannot be written: " +
                        std::generic_category().message(errno));
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace kinecal
