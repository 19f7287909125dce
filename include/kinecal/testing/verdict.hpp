// The result of a check: all laws hold, or the first broken one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>

namespace kinecal {

/// The result of a check.
struct Verdict {
  std::string text = {};  ///< the broken law, with numbers; empty if all laws hold

  /// True if all laws hold.
  explicit operator bool() const { return text.empty(); }
  bool operator==(const Verdict&) const = default;  ///< the same text

  /// Prints the broken law.
  friend std::ostream& operator<<(std::ostream& out, const Verdict& verdict) {
    return out << (verdict ? "all laws hold" : verdict.text);
  }
};

/// The verdict if all laws hold: EXPECT_EQ(check_block(MyBlock{}), kLawsHold).
inline const Verdict kLawsHold;

}  // namespace kinecal
