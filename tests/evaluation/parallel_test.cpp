#include "kinecal/evaluation/parallel.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>

#include "support/thrown.hpp"

namespace kinecal {
namespace {

TEST(Parallel, DoesEachPieceOnce) {
  for (const int pieces : {1, 2, 5, 64, 1000}) {
    for (const int threads : {1, 2, 3, 7, 50}) {
      std::vector<std::atomic<int>> done(static_cast<std::size_t>(pieces));
      detail::for_each_piece(pieces, threads,
                             [&](int piece, int) { ++done[static_cast<std::size_t>(piece)]; });
      for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(Parallel, WithNoPiecesDoesNothing) {
  for (const int threads : {0, 1, 7}) {
    detail::for_each_piece(0, threads, [](int, int) { FAIL(); });
  }
}

/// What a thread works with is found under its number and is its alone.
TEST(Parallel, NumbersTheThreadsFromZeroAndNoNumberTwiceAtOnce) {
  constexpr int kThreads = 4;
  for (const int pieces : {2, 3, 200}) {
    std::array<std::atomic<bool>, kThreads> busy = {};
    std::atomic<bool> good = true;
    detail::for_each_piece(pieces, kThreads, [&](int, int thread) {
      if (thread < 0 || thread >= std::min(kThreads, pieces)) {
        good = false;
        return;
      }
      const auto t = static_cast<std::size_t>(thread);
      if (busy[t].exchange(true)) good = false;
      std::this_thread::yield();
      busy[t] = false;
    });
    EXPECT_TRUE(good);
  }
}

TEST(Parallel, UsesTheCallersThreadAlone) {
  const std::thread::id caller = std::this_thread::get_id();
  for (const int pieces : {1, 9}) {
    int called = 0;
    detail::for_each_piece(pieces, 1, [&](int, int thread) {
      ++called;
      EXPECT_EQ(thread, 0);
      EXPECT_EQ(std::this_thread::get_id(), caller);
    });
    EXPECT_EQ(called, pieces);
  }
}

TEST(Parallel, ThrowsWhatAPieceThrowsAfterAllThreadsHaveEnded) {
  for (const int threads : {1, 2, 7}) {
    for (const int bad : {0, 3, 9}) {
      std::atomic<int> running = 0;
      const auto work = [&](int piece, int) {
        ++running;
        std::this_thread::yield();
        --running;
        if (piece == bad) throw std::runtime_error("piece " + std::to_string(piece));
      };
      EXPECT_EQ(
          test::thrown<std::runtime_error>([&] { detail::for_each_piece(10, threads, work); }),
          "piece " + std::to_string(bad));
      EXPECT_EQ(running, 0);
    }
  }
}

TEST(Parallel, ThrowsOnceWhereEveryPieceThrows) {
  EXPECT_THROW(
      detail::for_each_piece(100, 7, [](int, int) { throw std::logic_error("every piece"); }),
      std::logic_error);
}

TEST(Parallel, ZeroThreadsMeansOneForEachCoreAndNeverNone) {
  EXPECT_GE(detail::number_of_threads(0), 1);
  EXPECT_GE(detail::number_of_threads(-3), 1);
  EXPECT_EQ(detail::number_of_threads(5), 5);
}

}  // namespace
}  // namespace kinecal
