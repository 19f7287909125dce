// A base behind the protocol's reference server: recorded, driven, and stopped whatever happens.
#include "kinecal/robots/ros_base.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "support/bridge_server.hpp"
#include "support/error_of.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;

/// Fast, as no base is: a test does not wait.
const BaseDriving kFast = {.turn = 20.0,
                           .speed = 4.0,
                           .distance = 1.0,
                           .turn_acceleration = 400.0,
                           .acceleration = 80.0,
                           .rest = milliseconds(150),
                           .silence = milliseconds(5000)};

/// The base of the server stops by itself after so many seconds without a command: however busy the machine is, it goes no
/// longer after the last one.
constexpr double kTimeout = 0.25;

class RosBaseTest : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { KINECAL_NEEDS_BRIDGE_SERVER(); }
  RosBase& start(const std::string& base = "{}") {
    server_.emplace(R"({"encoding": ")" + GetParam() + R"(", "base": )" + base + "}");
    BridgeOptions options;
    options.url = server_->url();
    base_.emplace(options, BaseTopics{},
                  [this](const std::string& topic, const std::string& type, std::int64_t time,
                         const MessageFields&) {
                    recorded_.insert(topic + " " + type);
                    times_.push_back(time);
                  });
    return *base_;
  }
  /// What a drive says at its end.
  std::string drive(
      const BaseDriving& driving = kFast,
      const std::function<bool()>& is_interrupted = [] { return false; }) {
    return drive_base(*base_, driving, is_interrupted,
                      [this](const std::string& line) { said_.push_back(line); });
  }
  /// Velocities that the base was given: ahead and turn.
  std::vector<std::vector<double>> commands() {
    return nlohmann::json::parse(server_->make(R"({"fault": "commands"})"));
  }

  std::optional<test::BridgeServer> server_;
  std::optional<RosBase> base_;
  std::set<std::string> recorded_;
  std::vector<std::int64_t> times_;
  std::vector<std::string> said_;
};
INSTANTIATE_TEST_SUITE_P(Encodings, RosBaseTest, testing::Values("ros1", "cdr"));

TEST_P(RosBaseTest, RecordsWithoutACommand) {
  RosBase& base = start();
  base.record(milliseconds(300));
  EXPECT_THAT(recorded_,
              AllOf(Contains("/odom nav_msgs/Odometry"), Contains("/imu sensor_msgs/Imu"),
                    Contains("/base_scan sensor_msgs/LaserScan"),
                    Contains("/joint_states sensor_msgs/JointState")));
  EXPECT_GT(base.received().at("/odom"), 5);
  EXPECT_NEAR(base.ahead()->nearest, 3.0, 1e-6);
  EXPECT_THAT(commands(), IsEmpty());
}

TEST_P(RosBaseTest, DrivesTurnsAndStraightRunsAndStops) {
  RosBase& base = start();
  EXPECT_EQ(drive(), "");
  EXPECT_EQ(said_.size(), 8u) << testing::PrintToString(said_);
  const auto all = commands();
  double left = 0.0, right = 0.0, ahead = 0.0, back = 0.0;
  for (const auto& command : all) {
    EXPECT_TRUE(command[0] == 0.0 || command[1] == 0.0);
    left = std::max(left, command[1]), right = std::min(right, command[1]);
    ahead = std::max(ahead, command[0]), back = std::min(back, command[0]);
  }
  EXPECT_EQ(left, 20.0);
  EXPECT_EQ(right, -20.0);
  EXPECT_EQ(ahead, 4.0);
  EXPECT_EQ(back, -4.0);
  EXPECT_THAT(all.back(), ElementsAre(0.0, 0.0));
  // It is where it began, but for what its two runs back are late: a period of commands and one of the server, 20 ms each, and
  // as much again for a busy machine.
  constexpr double kLate = 0.1;  // seconds
  EXPECT_LT(std::hypot(base.odometry()->x, base.odometry()->y),
            kLate * (0.5 * kFast.speed + kFast.speed));
}

TEST_P(RosBaseTest, DoesNotBeginARunForWhichThereIsNoRoom) {
  start(R"({"wall": 1.2})");
  EXPECT_EQ(drive(), "");
  EXPECT_THAT(
      said_.front(),
      HasSubstr("no straight runs: the nearest ahead is at 1.20 m, and a run of 1.00 m needs "
                "1.40 m up to a wall"));
  for (const auto& command : commands()) EXPECT_EQ(command[0], 0.0);
}

/// A scanner that looks to the left shows no wall ahead; where one looks must be known.
TEST_P(RosBaseTest, DoesNotBeginARunForWhichNothingShowsWhatIsAhead) {
  start(R"({"mount": 1.5707963})");
  EXPECT_EQ(drive(), "");
  EXPECT_EQ(said_.front(), "no straight runs: there is no scan that shows what is ahead");
  base_.reset();
  said_.clear();
  start(R"({"mount": null})");
  EXPECT_EQ(drive(), "");
  EXPECT_EQ(
      said_.front(),
      "no straight runs: /tf_static does not say how 'laser_link', the frame of /base_scan, is "
      "mounted on 'base_link', the frame of the odometry");
  for (const auto& command : commands()) EXPECT_EQ(command[0], 0.0);
}

/// What is ahead comes nearer during a run, as a person does who walks in front of the base.
TEST_P(RosBaseTest, DoesNotGoNearerThanTheLeastRangeInARun) {
  start();
  BaseDriving driving = kFast;
  driving.speed = 1.0;
  bool is_near = false;
  double nearest = 3.0;
  const std::string why = drive(driving, [&] {
    const bool is_ahead = !said_.empty() && said_.back().find(" ahead at ") != std::string::npos;
    if (is_ahead && !is_near) {
      server_->make(R"({"fault": "base", "values": {"wall": 1.0}})");
      is_near = true;
    }
    if (base_->ahead()) nearest = std::min(nearest, base_->ahead()->nearest);
    return false;
  });
  EXPECT_EQ(why, "");
  EXPECT_TRUE(is_near);
  EXPECT_LT(nearest, driving.least_range) << "a metre ahead, it would touch the wall";
  EXPECT_GT(nearest, driving.least_range - kTimeout * driving.speed);
}

TEST_P(RosBaseTest, AnInterruptionStopsIt) {
  start(R"({"timeout": 60})");  // so only a command of zero stops it
  EXPECT_EQ(
      drive(kFast, [&] { return base_->odometry() && std::abs(base_->odometry()->yaw) > 1.0; }),
      "interrupted");
  EXPECT_EQ(said_.size(), 1u) << "in the first turn";
  const auto all = commands();
  EXPECT_THAT(all, Contains(ElementsAre(0.0, Gt(0.0))));
  EXPECT_THAT(all.back(), ElementsAre(0.0, 0.0));
  base_->record(milliseconds(100));
  const double yaw = base_->odometry()->yaw;
  base_->record(milliseconds(200));
  EXPECT_NEAR(base_->odometry()->yaw, yaw, 1e-9) << "it stands";
}

TEST_P(RosBaseTest, SilentOdometryStopsIt) {
  start();
  base_->record(milliseconds(100));
  bool is_silent = false;
  BaseDriving driving = kFast;
  driving.silence = milliseconds(500);
  driving.turn = 3.0;  // a turn takes longer than it takes to fall silent
  const std::string why = drive(driving, [&] {
    if (!is_silent && !said_.empty()) {
      server_->make(R"({"fault": "silent", "topics": ["/odom"]})");
      is_silent = true;
    }
    return false;
  });
  EXPECT_EQ(why, "no odometry for 500 ms: the base was stopped");
  EXPECT_THAT(commands().back(), ElementsAre(0.0, 0.0));
}

/// A turn in place needs no scan; a run ahead does.  Odometry would fall silent by chance on a busy machine, in half a second.
TEST_P(RosBaseTest, SilentScansStopARunAheadButNoTurn) {
  start();
  bool is_silent = false;
  BaseDriving driving = kFast;
  driving.silence = milliseconds(2000);
  const std::string why = drive(driving, [&] {
    if (!is_silent && !said_.empty()) {
      server_->make(R"({"fault": "silent", "topics": ["/base_scan"]})");
      is_silent = true;
    }
    return false;
  });
  EXPECT_EQ(why, "no scan for 2000 ms: the base was stopped");
  EXPECT_EQ(said_.size(), 5u) << "four turns and a run: " << testing::PrintToString(said_);
  EXPECT_THAT(commands().back(), ElementsAre(0.0, 0.0));
  EXPECT_LT(std::hypot(base_->odometry()->x, base_->odometry()->y), kTimeout * 0.5 * driving.speed);
}

TEST_P(RosBaseTest, ScansThatFallSilentStopTheRun) {
  start();
  bool is_silent = false;
  BaseDriving driving = kFast;
  driving.silence = milliseconds(2000);
  driving.speed = 0.5;  // a run of a metre takes four seconds
  const std::string why = drive(driving, [&] {
    const bool is_ahead = !said_.empty() && said_.back().find(" ahead at ") != std::string::npos;
    if (is_ahead && !is_silent) {
      server_->make(R"({"fault": "silent", "topics": ["/base_scan"]})");
      is_silent = true;
    }
    return false;
  });
  EXPECT_EQ(why, "no scan for 2000 ms: the base was stopped");
  const double gone = std::hypot(base_->odometry()->x, base_->odometry()->y);
  EXPECT_GT(gone, 0.0);
  EXPECT_LT(gone, (2.0 + kTimeout) * 0.5 * driving.speed) << "two seconds at half the speed";
}

TEST_P(RosBaseTest, ALostConnectionIsSaid) {
  start();
  EXPECT_THAT(test::error_of([&] {
                (void)drive(kFast, [&] {
                  if (!said_.empty()) server_->make(R"({"fault": "cut"})");
                  return false;
                });
              }),
              AllOf(HasSubstr("connection: bridge 'ws://127.0.0.1:"),
                    HasSubstr("the base may be moving: only its own driver can stop it now")));
}

TEST_P(RosBaseTest, WithoutOdometryNothingMoves) {
  start();
  server_->make(R"({"fault": "silent", "topics": ["/odom"]})");
  base_.reset();
  BridgeOptions options;
  options.url = server_->url();
  base_.emplace(options, BaseTopics{.odom = "/odometry"},
                [](const std::string&, const std::string&, std::int64_t, const MessageFields&) {});
  EXPECT_THAT(drive(), HasSubstr("the bridge offers no topic '/odometry'"));
  for (const auto& command : commands()) EXPECT_THAT(command, ElementsAre(0.0, 0.0));
}

}  // namespace
}  // namespace kinecal
