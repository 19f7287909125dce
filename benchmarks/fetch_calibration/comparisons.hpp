// Variations of the normal equations' time: blocks through jets, losses, features, threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "work.hpp"

namespace kinecal::bench {

/// Measures and prints them, each next to its control.
/// @param rounds        number of interleaved rounds; times are medians over them
/// @param most_samples  for the comparison of threads
void print_comparisons(const FetchWork& work, int rounds, int most_samples);

}  // namespace kinecal::bench
