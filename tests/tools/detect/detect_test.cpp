// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/detect.hpp"

#include <gtest/gtest.h>

#include <string>

#include "support/error_of.hpp"

namespace kinecal {
namespace {

/// Finds one feature by two sensors.
ViewFinder finds(const std::string& camera) {
  return {
      "finds_" + camera, [camera](const View&) {
        Found found;
        found.observations = {{camera, {{"optical", {1, 2, 0}}}}, {"arm", {{"board", {0, 0, 0}}}}};
        found.marks = {{1, 2}};
        return found;
      }};
}

View posed() {
  View view;
  view.joints = {{}, {"q1"}, {0.5}};
  return view;
}

TEST(Detect, ASampleHasTheJointsOfTheViewAndItsSource) {
  const std::vector<ViewFinder> finders = {
      finds("camera"), {"blind", [](const View&) { return refused("too dark"); }}};
  const Detection found = detect(posed(), finders, "poses.csv:3");
  ASSERT_EQ(found.samples.size(), 1u);
  EXPECT_EQ(found.samples[0].source, "poses.csv:3");
  EXPECT_EQ(found.samples[0].position("q1"), 0.5);
  EXPECT_EQ(found.features, 1u);
  EXPECT_EQ(found.marks.size(), 1u);
  EXPECT_EQ(found.refused, std::vector<std::string>{"blind: too dark"});
}

TEST(Detect, FindersOfTheSameSensorsGiveASampleEach) {
  const std::vector<ViewFinder> finders = {finds("camera"), finds("camera")};
  EXPECT_EQ(detect(posed(), finders, "").samples.size(), 2u);
}

TEST(Detect, LedsInRecordedImagesAreAnErrorThatSaysWhy) {
  const CaptureFinder leds{"leds", "LedFinder", "", "", "", LedFinder{}, {"capture.yaml", 7}};
  const std::string error = test::error_of([&] { (void)view_finder(leds, leds.settings); });
  EXPECT_EQ(error.find("capture.yaml:7: finder 'leds': LEDs have to be switched"), 0u) << error;
}

TEST(Detect, ImpossibleSettingsAreAnErrorWithTheirPlace) {
  const CaptureFinder board{
      "board", "", "", "", "", CheckerboardSettings{.points_x = 1}, {"capture.yaml", 3}};
  const std::string error = test::error_of([&] { (void)view_finder(board, board.settings); });
  EXPECT_EQ(error.find("capture.yaml:3: finder 'board': "), 0u) << error;
}

}  // namespace
}  // namespace kinecal
