// Faults of a view of a target, for view_search.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>

namespace kinecal::detail {

/// The fault of a view, and its size.
struct ViewFault {
  double size = 0.0;
  std::string what;  ///< of the largest part

  void add(double part, const char* name) {
    if (part > 0.0 && part >= largest_) {
      largest_ = part;
      what = name;
    }
    size += std::max(part, 0.0);
  }

 private:
  double largest_ = 0.0;
};

}  // namespace kinecal::detail
