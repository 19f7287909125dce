// How far a long task is, for whoever shows it: reading a file, trying starts, folds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace kinecal {

/// Receives the fraction that is done, from 0 to 1, and what is being done: "reading samples.yaml".
/// It is called now and then, by one thread at a time, not always the same one.  Empty: nobody wants
/// to know.
using ProgressMeter = std::function<void(double fraction, const std::string& what)>;

}  // namespace kinecal
