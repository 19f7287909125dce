// Ctrl-C or SIGTERM: a command shuts down cleanly instead of being killed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal::cli {

/// While one exists, the first Ctrl-C or SIGTERM asks the command to end, and stops waiting for a line of
/// standard input; the second one ends the program.
class Interruption {
 public:
  Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  /// True once the command was asked to end, even after this object's lifetime.
  [[nodiscard]] static bool is_asked();
};

}  // namespace kinecal::cli
