// Runs pieces of work on several threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace kinecal::detail {

/// The requested number of threads; for zero, the number of cores.
[[nodiscard]] inline int number_of_threads(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

/// Calls work(piece, thread) once for each piece, on up to `threads` threads, in any order.
/// @throws the first exception that `work` throws, after all threads have stopped
template <class Work>
void for_each_piece(int pieces, int threads, Work&& work) {
  std::atomic<int> next = 0;
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto run = [&](int thread) {
    try {
      for (int piece = next++; piece < pieces; piece = next++) work(piece, thread);
    } catch (...) {
      const std::scoped_lock lock(error_mutex);
      if (!error) error = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (int t = 1; t < std::min(threads, pieces); ++t) others.emplace_back(run, t);
    run(0);
  }  // waits for the others
  if (error) std::rethrow_exception(error);
}

}  // namespace kinecal::detail
