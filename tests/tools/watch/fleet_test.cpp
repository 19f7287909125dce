#include "kinecal/tools/watch/fleet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/arm_scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kDay = 86'400.0, kWeek = 7.0 * kDay, kDegree = 0.017453292519943295;

class FleetFolder : public test::FolderTest {
 protected:
  void file(const std::string& name, const std::string& content = "x") const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write(name, content);
  }
};

TEST_F(FleetFolder, HasRobotsAtAnyDepth) {
  for (const char* name :
       {"line_2/arm_10/result/report.json", "line_2/arm_9/result/report.json",
        "line_1/result/recordings/no_robot", "new/recordings/a.yaml", ".hidden/result/x"}) {
    file(name);
  }
  std::vector<std::string> names;
  for (const WatchedRobot& robot : robots_in(folder_.string())) names.push_back(robot.name);
  EXPECT_THAT(names, ElementsAre("line_1", "line_2/arm_9", "line_2/arm_10", "new"));
  const auto alone = robots_in((folder_ / "line_2" / "arm_9").string() + "/");
  ASSERT_EQ(alone.size(), 1u);
  EXPECT_EQ(alone[0].name, "arm_9");
  EXPECT_THAT(test::thrown<InputError>([&] {
                (void)robots_in(folder_.string(), {"calibrated", "bags"});
              }),
              HasSubstr("no folder in it has a folder 'calibrated'"));
  EXPECT_THAT(test::thrown<InputError>([&] { (void)robots_in((folder_ / "none").string()); }),
              HasSubstr("does not exist"));
}

TEST_F(FleetFolder, HasRecordingsButNotWhatIsBesideThem) {
  for (const char* name : {"r/a_2.yaml", "r/a_10.yaml", "r/.b.yaml", "r/c.bag.active", "r/d.part",
                           "r/columns.yaml", "r/e/metadata.yaml", "r/e/e_0.db3", "r/night/f.mcap",
                           "r/night/g.db3", "r/night/g.db3-journal", "r/calibrated/report.json"}) {
    file(name);
  }
  const std::vector<RecordingFiles> found = recordings_in((folder_ / "r").string());
  std::vector<std::string> names;
  for (const RecordingFiles& of : found) names.push_back(of.seen.name);
  ASSERT_THAT(names, ElementsAre("a_2.yaml", "a_10.yaml", "e", "night/f.mcap", "night/g.db3"));
  EXPECT_EQ(found[2].files.size(), 2u);
  EXPECT_EQ(found[2].seen.size, 2);
  const std::int64_t now = file_time_now();
  EXPECT_FALSE(is_settled(found[0], now, 60.0)) << "it was written just now";
  EXPECT_TRUE(is_settled(found[0], now + 61'000'000'000, 60.0));
  EXPECT_FALSE(is_settled(found[4], now + 61'000'000'000, 60.0)) << "it has a journal";
  EXPECT_TRUE(recordings_in((folder_ / "none").string()).empty());
}

TEST_F(FleetFolder, PassesOverWhatCannotBeLookedAt) {
  file("arm/result/report.json");
  std::filesystem::create_symlink("loop", folder_ / "loop");
  const std::vector<WatchedRobot> robots = robots_in(folder_.string());
  ASSERT_EQ(robots.size(), 1u);
  EXPECT_EQ(robots[0].name, "arm");
  EXPECT_THAT(test::thrown<InputError>([&] { (void)robots_in((folder_ / "loop").string()); }),
              HasSubstr("is not a folder"));
}

TEST_F(FleetFolder, WaitsForAFileThatIsDatedAhead) {
  file("r/a.yaml");
  std::filesystem::last_write_time(
      folder_ / "r" / "a.yaml",
      std::filesystem::file_time_type::clock::now() + std::chrono::hours(24));
  const std::vector<RecordingFiles> found = recordings_in((folder_ / "r").string());
  ASSERT_EQ(found.size(), 1u);
  const std::int64_t now = file_time_now();
  EXPECT_FALSE(is_settled(found[0], now, 60.0)) << "it was changed just now";
  EXPECT_TRUE(is_settled(found[0], now + 61'000'000'000, 60.0));
}

TEST(Fleet, KnowsARobotByItsStructure) {
  const Robot robot = parse_urdf(test::kArmUrdf, "arm.urdf");
  std::string moved = test::kArmUrdf, other = test::kArmUrdf;
  moved.replace(moved.find("0.35 0 0.02"), 11, "0.36 0 0.03");
  other.replace(other.find("\"elbow\""), 7, "\"knee\"");
  EXPECT_EQ(structure_checksum(parse_urdf(moved, "a")), structure_checksum(robot));
  EXPECT_NE(structure_checksum(parse_urdf(other, "a")), structure_checksum(robot));
}

/// Robots with nightly recordings, of which two movers are looked at.
std::vector<RobotHistory> fleet(int robots, int nights, int drifting, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<RobotHistory> all;
  for (int robot = 0; robot < robots; ++robot) {
    RobotHistory& of = all.emplace_back(RobotHistory{"arm_" + std::to_string(robot), {}});
    constexpr double kNoise = 5e-4;
    for (int night = 0; night < nights; ++night) {
      WatchedRecording& recording = of.recordings.emplace_back();
      recording.time = 1.7e9 + kDay * night;
      recording.state = RecordingState::holds;
      const double drift = robot == drifting ? 0.05 * kDegree * night / 7.0 : 0.0;
      const double off = drift + kNoise * normal(random),
                   other = 0.3 * drift + kNoise * normal(random);
      const double left = std::pow(0.5 * drift / kNoise, 2);  // what the wrong one does not explain
      recording.probability = std::uniform_real_distribution<double>(0.01, 1.0)(random);
      recording.changes = {
          {"wrist",
           false,
           {"wrist"},
           {"rad"},
           {other},
           {kNoise * kNoise},
           30.0 + left,
           left < 20.0},
          {"elbow", false, {"elbow"}, {"rad"}, {off}, {kNoise * kNoise}, 30.0, true}};
      if (off * off > 16.0 * kNoise * kNoise) {
        recording.state = RecordingState::does_not_hold;
        recording.probability = std::erfc(off / kNoise / std::sqrt(2.0));
      }
    }
  }
  return all;
}

TEST(Fleet, FindsTheOneOfFiftyRobotsThatDriftsAndNoOther) {
  const std::vector<RobotHistory> robots = fleet(50, 100, 17, 1);
  const std::vector<RobotFinding> found = judge_fleet(robots);
  ASSERT_EQ(found.size(), 50u);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(found[i].drift.has_value(), i == 17) << i;
    EXPECT_EQ(found[i].has_moved, i == 17) << i;
    EXPECT_EQ(found[i].usable, 100);
  }
  const FoundDrift& drift = *found[17].drift;
  EXPECT_EQ(drift.of.owner, "elbow");
  EXPECT_NEAR(kWeek * drift.line.slope[0], 0.05 * kDegree,
              4.0 * kWeek * drift.line.slope_deviation(0));
  ASSERT_NE(found[17].moved, nullptr);
  EXPECT_EQ(found[17].moved->owner, "elbow");
}

/// The tool is half a metre from each joint.
std::optional<ChangeSize> half_a_metre(const WatchedChange&) {
  return ChangeSize{{0.25}};
}

/// A slow drift does not hide that something else has slipped.
TEST(Fleet, MeasuresWhatDriftsAndWhatHasMovedEachByItself) {
  std::vector<RobotHistory> robots = fleet(5, 28, 1, 2);
  WatchedRecording& last = robots[1].recordings.back();
  last.state = RecordingState::does_not_hold;
  last.probability = 1e-12;
  last.changes.push_back({"shoulder", false, {"shoulder"}, {"rad"}, {1e-2}, {2.5e-7}, 20.0, true});
  const RobotFinding found = judge_fleet(robots)[1];
  ASSERT_TRUE(found.drift);
  EXPECT_EQ(found.drift->of.owner, "elbow");
  ASSERT_NE(found.moved, nullptr);
  EXPECT_EQ(found.moved->owner, "shoulder");
  WatchLimits limits{.size = half_a_metre, .limit = 4e-3, .now = 1.7e9 + 28.0 * kDay};
  const RobotDecision decision = decide(found, limits);
  EXPECT_EQ(decision.state, FleetState::recalibrate);
  EXPECT_NEAR(decision.change.value(), 5e-3, 1e-9) << "of the shoulder";
  limits.limit = 6e-3;
  EXPECT_EQ(decide(found, limits).state, FleetState::drifts);
  limits.size = [](const WatchedChange& of) {
    return of.owner == "elbow" ? half_a_metre(of) : std::nullopt;
  };
  EXPECT_EQ(decide(found, limits).state, FleetState::recalibrate) << "an unknown size matters";
  last.changes.clear();
  limits.size = half_a_metre;
  const RobotFinding nothing_alone = judge_fleet(robots)[1];
  ASSERT_TRUE(nothing_alone.drift);
  EXPECT_EQ(decide(nothing_alone, limits).state, FleetState::recalibrate);
}

/// A mover of every fifth recording has a fifth of their residuals, and explains less.
TEST(Fleet, ComparesMoversThatAreInDifferentRecordings) {
  std::vector<RobotHistory> robots = fleet(1, 100, 0, 4);
  for (std::size_t night = 0; night < 100; ++night) {
    WatchedRecording& recording = robots[0].recordings[night];
    const double drift = recording.changes[1].change[0];
    recording.statistic = 30.0 + std::pow(drift / 5e-4, 2);
    WatchedChange& seldom = recording.changes[0];
    seldom.owner = "shoulder";
    seldom.change = {drift};
    seldom.score = 32.0 + 0.25 * std::pow(drift / 5e-4, 2);
    if (night % 5 != 0) recording.changes.erase(recording.changes.begin());
  }
  const std::vector<RobotFinding> found = judge_fleet(robots);
  ASSERT_TRUE(found[0].drift);
  EXPECT_EQ(found[0].drift->of.owner, "elbow");
  EXPECT_TRUE(found[0].drift->alike.empty());
}

TEST(Fleet, SaysWhenTheLimitIsReached) {
  const std::vector<RobotHistory> robots = fleet(5, 28, 1, 2);
  const std::vector<RobotFinding> found = judge_fleet(robots);
  ASSERT_TRUE(found[1].drift);
  WatchLimits limits{
      .size = half_a_metre, .limit = 4e-3, .now = 1.7e9 + 28.0 * kDay, .ahead = 7.0 * kDay};
  const RobotDecision later = decide(found[1], limits);  // 8e-3 rad: nine weeks, in about five
  ASSERT_TRUE(later.passes);
  EXPECT_NEAR(later.passes->time, 1.7e9 + 8e-3 / (0.05 * kDegree) * kWeek,
              4.0 * later.passes->deviation);
  EXPECT_LT(later.passes->deviation, 3.0 * kWeek);
  EXPECT_EQ(later.state, FleetState::drifts) << "what has moved so far does not matter";
  limits.ahead = 100.0 * kDay;
  EXPECT_EQ(decide(found[1], limits).state, FleetState::recalibrate);
  EXPECT_EQ(decide(found[0], limits).state, FleetState::holds);
  EXPECT_EQ(decide({}, limits).state, FleetState::not_known);
}

TEST(Fleet, DoesNotTakeOneOfAThousandForAMove) {
  std::vector<RobotHistory> robots = fleet(10, 20, -1, 3);
  WatchedRecording& last = robots[4].recordings.back();
  last.state = RecordingState::does_not_hold;
  last.probability = 1e-3;
  EXPECT_FALSE(judge_fleet(robots)[4].has_moved) << "one of 200 recordings";
  last.probability = 1e-6;
  EXPECT_TRUE(judge_fleet(robots)[4].has_moved);
  last.changes.clear();
  const RobotFinding nothing_alone = judge_fleet(robots)[4];
  EXPECT_EQ(nothing_alone.moved, nullptr);
  EXPECT_EQ(decide(nothing_alone, {}).state, FleetState::recalibrate);
  robots[4].recordings.push_back({.time = 1.8e9, .reason = "is cut off"});
  const RobotFinding refused = judge_fleet(robots)[4];
  EXPECT_TRUE(refused.is_last_refused);
  EXPECT_TRUE(refused.has_moved) << "by the last one that could be read";
}

}  // namespace
}  // namespace kinecal
