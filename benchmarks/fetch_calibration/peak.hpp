// The measured peak of the processor: the most multiply-adds per second.
//
// The loop runs independent chains of multiply-adds in registers, as wide as the instruction set
// that is compiled for, and enough of them to hide the latency.  Without fused multiply-add, half
// of the chains multiply and half add.  The best of several repeats counts.
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

/// Hides a value from the compiler.
template <class V>
void hide(V& value) {
  asm volatile("" : "+m"(value) : : "memory");
}

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
inline constexpr int kOperations = 2;  ///< per step of a chain and lane
/// Two units with four or five cycles need ten; the registers hold twelve and two constants.
inline constexpr std::size_t kPeakChains = 12;
#else
inline constexpr int kOperations = 1;
/// Half multiply, half add; with two constants they fill sixteen registers.
inline constexpr std::size_t kPeakChains = 14;
#endif

/// Indices are constants here: the compiler would keep an array with variable indices in memory.
template <std::size_t... I>
[[nodiscard]] Packet run_chains(long steps, Packet factor, Packet summand,
                                std::index_sequence<I...>) {
  // Different start values, because equal chains would be computed once.
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

/// Seconds for a number of steps of all chains.
[[nodiscard]] inline double seconds_of_chains(long steps) {
  Packet factor(1.0), summand(0.0);  // numbers stay the same, never denormal or infinite
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

/// Peak of several threads at once: all operations divided by the time from the first start to the
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
