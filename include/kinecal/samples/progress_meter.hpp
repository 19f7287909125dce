// Progress of a long task, for display: reading a file, trying starts, folds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace kinecal {

/// Receives the finished fraction, from 0 to 1, and the current activity: "reading samples.yaml".
/// Called occasionally, by one thread at a time, but not always the same one.  Empty: no reports.
using ProgressMeter = std::function<void(double fraction, const std::string& what)>;

}  // namespace kinecal
