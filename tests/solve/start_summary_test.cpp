#include "kinecal/solve/start_summary.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(StartSummary, CountsMinimaWhoseCostsDifferByMoreThanRounding) {
  StartSummary summary;
  for (const double cost : {2.0, 1.0, 1.0 + 1e-9, 3.0, 2.0 - 1e-8}) {
    detail::add_minimum(summary, cost);
  }
  ASSERT_EQ(summary.minima.size(), 3u);
  EXPECT_EQ(summary.minima[0].cost, 1.0);
  EXPECT_EQ(summary.minima[0].solves, 2);
  EXPECT_EQ(summary.minima[1].cost, 2.0 - 1e-8);
  EXPECT_EQ(summary.minima[2].solves, 1);
}

TEST(StartSummary, CostsBelowTheRoundingAreOneMinimum) {
  StartSummary summary;
  detail::add_minimum(summary, 1e-21, 1e-18);
  detail::add_minimum(summary, 3e-20, 1e-18);
  EXPECT_EQ(summary.minima.size(), 1u);
}

TEST(StartSummary, IsEmptyWithoutASearch) {
  StartSummary summary;
  detail::add_minimum(summary, 1.0);
  EXPECT_EQ(to_string(summary), "");
}

TEST(StartSummary, SaysWhatWasDone) {
  StartSummary summary{.frames = {"tracker"}, .starts = 60, .taken = 0};
  detail::add_minimum(summary, 0.35);
  detail::add_minimum(summary, 0.00012);
  EXPECT_EQ(to_string(summary),
            "pose of 'tracker' was not known: found from 60 starts; "
            "2 minima, costs 0.00012 (taken), 0.35");
  summary.frames.emplace_back("board");
  summary.random_starts = 20;
  summary.failed = 1;
  EXPECT_EQ(to_string(summary),
            "poses of 'tracker' and 'board' were not known: found from 60 starts, and 20 random "
            "starts (joints within 10 degrees or 2 cm, frames within 10 degrees and 5 cm); 2 "
            "minima, costs 0.00012 (taken), 0.35; 1 solve ended in none");
}

/// Somebody knew it, or meant to.
TEST(StartSummary, DoesNotCallUnknownWhatWasGiven) {
  StartSummary summary{.given = {"tracker"}, .starts = 60, .taken = 0};
  detail::add_minimum(summary, 0.35);
  EXPECT_EQ(
      to_string(summary),
      "pose of 'tracker' was given, but the fit from there ended badly: found from 60 starts; "
      "1 minimum, cost 0.35");
  summary.frames = {"a", "b"};
  EXPECT_EQ(to_string(summary),
            "poses of 'a' and 'b' were not known, pose of 'tracker' was given, but the fit from "
            "there ended badly: found from 60 starts; 1 minimum, cost 0.35");
}

TEST(StartSummary, SaysThatNothingWasFound) {
  EXPECT_EQ(to_string(StartSummary{.frames = {"a"}, .starts = 60}),
            "pose of 'a' was not known: not found from 60 starts; 0 minima");
}

TEST(StartSummary, OfRandomStartsAlone) {
  StartSummary summary{.random_starts = 1, .taken = 0};
  detail::add_minimum(summary, 2.5);
  EXPECT_EQ(to_string(summary),
            "1 random start (joints within 10 degrees or 2 cm, frames within 10 degrees and 5 cm); "
            "1 minimum, cost 2.5");
}

}  // namespace
}  // namespace kinecal
