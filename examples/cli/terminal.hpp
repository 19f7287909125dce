// Text for people: colored and as wide as the terminal; as it is in a file or a pipe.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace kinecal::cli {

/// How a command speaks.
struct Manner {
  std::string color = "auto";  ///< "auto": on a terminal, without NO_COLOR; "always"; "never"
  bool quiet = false;          ///< only the last line
  bool verbose = false;        ///< also raw values, and what each step did
  bool json = false;           ///< the report as JSON, and nothing else
};

/// Columns of the terminal behind a file descriptor; 80 if that is not known.
[[nodiscard]] std::size_t terminal_width(int descriptor);

/// Prints text, for which lines are broken at the width of the terminal, with the verdict in its color.
void show(const std::string& text, const Manner& manner);

}  // namespace kinecal::cli
