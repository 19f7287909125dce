// Ctrl-C: a command ends in order instead of being killed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal::cli {

/// While one lives, the first Ctrl-C asks the command to end, and ends waiting for a line of the
/// standard input; a second one ends the program.
class Interruption {
 public:
  Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  /// True once the command was asked to end, also after this object's life.
  [[nodiscard]] static bool is_asked();
};

}  // namespace kinecal::cli
