// Finds ruined captures.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/ruined.hpp"

namespace kinecal {

std::vector<CaptureError> ruined_captures(const Assessment& last) {
  std::vector<CaptureError> ruined;
  for (const CaptureError& error : last.captures) {
    if (error.bad) ruined.push_back(error);
  }
  constexpr double kMost = 0.25;
  const double most = kMost * static_cast<double>(last.captures.size());
  if (static_cast<double>(ruined.size()) > most) ruined.clear();
  return ruined;
}

}  // namespace kinecal
