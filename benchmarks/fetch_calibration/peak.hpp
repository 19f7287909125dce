// The measured peak of the processor: multiply-adds a second, all that its units can do.
//
// Independent multiply-adds in registers, of the width of the instruction set compiled for, as many
// chains as hide their latency.  Without fused multiply-add: multiplications and additions side by
// side, half of each.  The best of several repeats counts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "kinecal/geometry/packet.hpp"

namespace kinecal::bench {

[[nodiscard]] constexpr int lanes() {
  return static_cast<int>(Packet::size());
}

namespace detail {

/// Keeps the compiler from knowing a value.
template <class V>
void hide(V& value) {
  asm volatile("" : "+m"(value) : : "memory");
}

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
inline constexpr int kOperations = 2;  ///< of one step of a chain, a lane
/// Two units, four or five cycles: ten would do; registers hold twelve and two constants.
inline constexpr std::size_t kPeakChains = 12;
#else
inline constexpr int kOperations = 1;
/// Half of them multiply, half add; with two constants they fill sixteen registers.
inline constexpr std::size_t kPeakChains = 14;
#endif

/// Each chain has its own name in here: arrays that are indexed would be kept in memory.
template <std::size_t... I>
[[nodiscard]] Packet run_chains(long steps, Packet factor, Packet summand,
                                std::index_sequence<I...>) {
  // They start from values of their own: chains that are the same would be computed once.
  std::array<Packet, sizeof...(I)> x = {Packet(1.0 + double(I))...};
  for (long step = 0; step < steps; ++step) {
    if constexpr (kOperations == 2) {
      ((x[I] = x[I] * factor + summand), ...);  // one fused instruction each
    } else {
      ((x[I] = I % 2 == 0 ? Packet(x[I] * factor) : Packet(x[I] + summand)), ...);
    }
  }
  return (x[I] + ...);
}

/// Seconds that steps of all chains take.
[[nodiscard]] inline double seconds_of_chains(long steps) {
  Packet factor(1.0), summand(0.0);  // numbers stay what they are, never denormal or infinite
  hide(factor);
  hide(summand);
  const auto start = std::chrono::steady_clock::now();
  Packet sum = run_chains(steps, factor, summand, std::make_index_sequence<kPeakChains>{});
  hide(sum);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

[[nodiscard]] inline double operations(long steps) {
  return double(steps) * double(kPeakChains) * kOperations * lanes();
}

}  // namespace detail

/// Peak of one core.
/// @param repeats  of about 20 ms each
/// @returns        GFLOP/s
[[nodiscard]] inline double peak_gflops(int repeats = 15) {
  long steps = 1000;
  while (detail::seconds_of_chains(steps) < 0.02) steps *= 2;
  double best = 0.0;
  for (int i = 0; i < repeats; ++i) {
    best = std::max(best, 1e-9 * detail::operations(steps) / detail::seconds_of_chains(steps));
  }
  return best;
}

/// Peak of several threads at once: all their operations over the time from the first start to the
/// last end.
/// @returns  GFLOP/s
[[nodiscard]] inline double peak_gflops_of_threads(int threads, int repeats = 15) {
  long steps = 1000;
  while (detail::seconds_of_chains(steps) < 0.02) steps *= 2;
  double best = 0.0;
  for (int i = 0; i < repeats; ++i) {
    std::atomic<int> waiting{threads};
    std::vector<std::thread> running;
    std::chrono::steady_clock::time_point start;
    for (int t = 0; t < threads; ++t) {
      running.emplace_back([&] {
        if (--waiting == 0) start = std::chrono::steady_clock::now();
        while (waiting > 0) {
        }
        (void)detail::seconds_of_chains(steps);
      });
    }
    for (std::thread& thread : running) thread.join();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    best = std::max(best, 1e-9 * threads * detail::operations(steps) / seconds.count());
  }
  return best;
}

}  // namespace kinecal::bench
