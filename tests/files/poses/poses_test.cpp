// Poses are written and read without loss; errors name line and key.
#include "kinecal/files/poses/poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<CapturePose> read(const std::string& text, Diagnostics& diagnostics) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "poses.yaml";
  std::ofstream(path) << text;
  return read_poses_yaml(path.string(), diagnostics);
}

std::string written(const std::vector<CapturePose>& poses) {
  std::ostringstream out;
  write_poses_yaml(out, poses);
  return out.str();
}

TEST(Poses, AreReadAsTheyWereWrittenToTheLastBit) {
  const std::vector<CapturePose> poses = {
      {{"pan", "a: b, [c]"}, {std::numbers::pi, -1e-300}, {"led_finder", "no"}},
      {{"pan"}, {-0.1}, {}},
      {{}, {}, {"ground"}}};
  for (const auto& some : {poses, std::vector<CapturePose>{}}) {
    Diagnostics diagnostics;
    EXPECT_EQ(read(written(some), diagnostics), some);
    EXPECT_THAT(diagnostics.errors, IsEmpty());
    EXPECT_THAT(diagnostics.warnings, IsEmpty());
  }
}

TEST(Poses, AreReadInBlocksAndWithoutFeatures) {
  Diagnostics diagnostics;
  const auto poses = read(
      "# by hand\n- joints:\n  - pan\n  - tilt\n  positions:\n  - 1\n  - -2.5\n"
      "- {features: [], positions: [0.5], joints: [pan]}\n",
      diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(poses, ElementsAre(CapturePose{{"pan", "tilt"}, {1.0, -2.5}, {}},
                                 CapturePose{{"pan"}, {0.5}, {}}));
}

TEST(Poses, ReportAllTheirErrorsTogether) {
  Diagnostics diagnostics;
  (void)read(
      "- {joints: [a], positions: [1]}\n"
      "- {joints: [a, a], positions: [1, x]}\n"
      "- {jionts: [a], positions: [.nan]}\n"
      "- nothing\n",
      diagnostics);
  EXPECT_THAT(
      diagnostics.errors,
      testing::IsSupersetOf({HasSubstr("poses.yaml:2: pose 2: positions: 'x'"),
                             HasSubstr("poses.yaml:2: pose 2: joint 'a' occurs twice"),
                             HasSubstr("poses.yaml:3: pose 3: unknown key 'jionts'; did you mean "
                                       "'joints'?"),
                             HasSubstr("poses.yaml:3: pose 3: positions: '.nan'"),
                             HasSubstr("poses.yaml:3: pose 3: joints is missing"),
                             HasSubstr("poses.yaml:4: pose 4 is 'nothing', not a map")}));
}

TEST(Poses, OneWithoutAPositionOfAJointIsLeftOut) {
  Diagnostics diagnostics;
  const auto poses =
      read("- {joints: [a, b], positions: [1]}\n- {joints: [a], positions: [2]}\n", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, ElementsAre(HasSubstr("poses.yaml:1: pose 1: 2 joints but 1 "
                                                          "position; the pose is left out")));
  EXPECT_EQ(poses.size(), 1u);
  (void)read("- {joints: [a, b], positions: [1]}\n", diagnostics);
  EXPECT_THAT(diagnostics.errors, ElementsAre(HasSubstr("no pose is left")));
}

TEST(Poses, AreAListAndNothingElse) {
  Diagnostics diagnostics;
  (void)read("joints: [a]\n", diagnostics);
  EXPECT_THAT(diagnostics.errors, ElementsAre(HasSubstr("the file is a map, not a list")));
  EXPECT_THROW((void)read("- {joints: [a", diagnostics), InputError);
  EXPECT_THROW((void)read_poses_yaml("nowhere.yaml", diagnostics), InputError);
}

TEST(Poses, AreNotWrittenWhereAPositionIsMissing) {
  std::ostringstream out;
  EXPECT_THROW(write_poses_yaml(out, {{{"a"}, {}, {}}}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
