// A robot behind the protocol's reference server, in the encodings of ROS 1 and ROS 2.
#include "kinecal/robots/ros_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "support/bridge_server.hpp"
#include "support/error_of.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

const RosArmOptions kArm = {
    .controllers = {{"/arm_controller/follow_joint_trajectory", {"shoulder", "elbow"}},
                    {"/head_controller/follow_joint_trajectory", {"head"}}},
    .duration = 0.2,
    .speed = 4.0};
const RosCameraOptions kCamera = {
    .image = "/camera/image", .cloud = "/camera/points", .camera_info = "/camera/camera_info"};
const std::string kLeds = "/gripper_controller/led_action";

/// Waits until a joint is where it was sent.
bool arrives(RosArm& arm, const std::string& joint, double position) {
  constexpr double kArrived = 1e-6;
  constexpr int kMostStates = 400;
  MeasuredJoints joints = arm.next_joints(Stamp::min());
  for (int i = 0; i < kMostStates; ++i) {
    if (std::abs(joints.position(joint).value() - position) < kArrived) return true;
    joints = arm.next_joints(joints.stamp);
  }
  return false;
}

class RosRobotTest : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    KINECAL_NEEDS_BRIDGE_SERVER();
    start();
  }
  void start(const std::string& more = "") {
    server_.emplace(R"({"encoding": ")" + GetParam() + "\"" + more + "}");
  }
  test::BridgeServer& server() { return *server_; }
  /// @param limit  of silence; nobody waits for it where the bridge speaks
  RosBridge connect(milliseconds limit = milliseconds(30000)) {
    BridgeOptions options;
    options.url = server_->url();
    options.time_limit = limit;
    return RosBridge(options);
  }

 private:
  std::optional<test::BridgeServer> server_;
};

INSTANTIATE_TEST_SUITE_P(Encodings, RosRobotTest, testing::Values("ros1", "cdr"),
                         [](const auto& one) { return one.param; });

TEST_P(RosRobotTest, JointsOfSeveralPublishersAreOneState) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  const MeasuredJoints first = arm.next_joints(Stamp::min());
  EXPECT_THAT(first.names, testing::UnorderedElementsAre("shoulder", "elbow", "head"));
  const MeasuredJoints next = arm.next_joints(first.stamp);
  EXPECT_GT(next.stamp, first.stamp);
}

TEST_P(RosRobotTest, HasItsUrdfAsATopicOrAParameter) {
  const auto urdf = [&](milliseconds limit) {
    BridgeOptions options;
    options.url = server().url();
    options.time_limit = limit;
    return robot_description(options);
  };
  constexpr milliseconds kLong(30000), kShort(300);
  start(R"(, "urdf": "<topic/>", "capabilities": ["parameters"])");
  EXPECT_EQ(urdf(kLong), "<topic/>");
  start(R"(, "urdf_parameter": "<parameter/>", "capabilities": ["parameters"])");
  EXPECT_EQ(urdf(kLong), "<parameter/>");
  start();
  EXPECT_THAT(error_of([&] { (void)urdf(kShort); }),
              HasSubstr("it has no URDF: no parameter '/robot_description', and the bridge offers "
                        "no topic '/robot_description'"));
}

TEST_P(RosRobotTest, MovesEachControllersJointsAndHoldsTheOthers) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  arm.move({{"elbow"}, {0.5}});
  EXPECT_TRUE(arrives(arm, "elbow", 0.5));
  arm.move({{"shoulder", "head", "wheel"}, {-0.25, 1.0, 7.0}});
  EXPECT_TRUE(arrives(arm, "shoulder", -0.25));
  EXPECT_TRUE(arrives(arm, "head", 1.0));
  EXPECT_NEAR(arm.next_joints(Stamp::min()).position("elbow").value(), 0.5, 1e-12);
}

TEST_P(RosRobotTest, AMotionTakesAsLongAsItsVelocityAsks) {
  RosBridge bridge = connect();
  RosArm arm(bridge, {.controllers = {kArm.controllers[0]}, .duration = 0.2, .speed = 4.0});
  MeasuredJoints joints = arm.next_joints(Stamp::min());
  arm.move({{"elbow"}, {1.0}, 0.5});
  while (joints.position("elbow").value() < 1.0) {
    const MeasuredJoints next = arm.next_joints(joints.stamp);
    const std::chrono::duration<double> time = next.stamp - joints.stamp;
    const double turned = next.position("elbow").value() - joints.position("elbow").value();
    constexpr double kFastest = 2.0;  // rad/s; at full speed it takes 0.2 s, not 0.5 s
    constexpr double kRounding = 1e-6;
    EXPECT_LE(turned, kFastest * time.count() + kRounding);
    joints = next;
  }
}

TEST_P(RosRobotTest, AViewHasImageCloudAndCameraOfOneMoment) {
  RosBridge bridge = connect();
  RosCamera camera(bridge, kCamera);
  const View first = camera.next_view(Stamp::min());
  EXPECT_EQ(first.frame, "camera_optical_frame");
  ASSERT_EQ(first.image.width, 32);
  ASSERT_EQ(first.image.height, 24);
  EXPECT_EQ(first.image(5, 3), 105);
  ASSERT_EQ(first.points.width, 32);
  EXPECT_TRUE(std::isnan(first.points(0, 0).z()));
  EXPECT_TRUE(first.points(18, 13).isApprox(Vector3<float>(0.2F, 0.1F, 2.0F), 1e-6F));
  ASSERT_TRUE(first.camera.has_value());
  EXPECT_EQ(first.camera->p[5], 20.0);
  EXPECT_EQ(first.camera->k[2], 16.0);
  EXPECT_EQ(first.camera->d.size(), 5u);
  EXPECT_GT(camera.next_view(first.stamp).stamp, first.stamp);
}

TEST_P(RosRobotTest, ACloudAloneHasBrightnessFromItsColour) {
  RosBridge bridge = connect();
  RosCamera camera(bridge, {.cloud = "/camera/points"});
  const View view = camera.next_view(Stamp::min());
  EXPECT_EQ(view.image(5, 3), 105);
  EXPECT_FALSE(view.camera.has_value());
}

TEST_P(RosRobotTest, AScanIsACloudOfOneRow) {
  RosBridge bridge = connect();
  RosCamera scanner(bridge, {.cloud = "/base_scan"});
  const View view = scanner.next_view(Stamp::min());
  EXPECT_EQ(view.frame, "laser_link");
  EXPECT_TRUE(view.image.empty());
  ASSERT_EQ(view.points.width, 5);
  EXPECT_TRUE(
      view.points(0, 0).isApprox(Vector3<float>(std::cos(0.5F), -std::sin(0.5F), 0.0F), 1e-6F));
  EXPECT_TRUE(view.points(2, 0).isApprox(Vector3<float>(2.0F, 0.0F, 0.0F), 1e-6F));
  for (const int nothing : {1, 3, 4}) EXPECT_TRUE(std::isnan(view.points(nothing, 0).x()));
  EXPECT_NEAR(view.point_time, 0.001, 1e-9);
}

TEST_P(RosRobotTest, CompressedImagesAndDepthAreThoseThatWereNot) {
  RosBridge bridge = connect();
  const std::string info = "/camera/camera_info";
  RosCamera raw(bridge, {.image = "/camera/image", .depth = "/camera/depth", .camera_info = info});
  RosCamera packed(bridge, {.image = "/camera/image/compressed",
                            .depth = "/camera/depth/compressedDepth",
                            .camera_info = info});
  const View expected = raw.next_view(Stamp::min());
  const View view = packed.next_view(Stamp::min());
  EXPECT_EQ(view.image.pixels, expected.image.pixels);
  EXPECT_TRUE(std::isnan(view.points(0, 0).z()));
  EXPECT_TRUE(view.points(18, 13).isApprox(Vector3<float>(0.2F, 0.1F, 2.0F), 1e-5F));
  EXPECT_TRUE(expected.points(18, 13).isApprox(Vector3<float>(0.2F, 0.1F, 2.0F), 1e-5F));
}

TEST_P(RosRobotTest, AViewAfterALampWasSwitchedShowsIt) {
  RosBridge bridge = connect();
  RosLamp lamp(bridge, kLeds);
  RosCamera camera(bridge, kCamera);
  for (const int code : {4, 0, 9}) {
    const Stamp lit = lamp.light(code);
    EXPECT_EQ(camera.next_view(lit).image(0, 0), code);
  }
}

TEST_P(RosRobotTest, BothNamesOfTheProtocolAreSpoken) {
  for (const char* const name : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    start(R"(, "protocol": ")" + std::string(name) + "\"");
    RosBridge bridge = connect();
    RosCamera camera(bridge, kCamera);
    EXPECT_FALSE(camera.next_view(Stamp::min()).image.empty()) << name;
  }
  start(R"(, "protocol": "chat")");
  EXPECT_THAT(error_of([&] { (void)connect(); }),
              AllOf(HasSubstr("connection: bridge 'ws://127.0.0.1:"),
                    HasSubstr("does not speak foxglove.sdk.v1")));
}

TEST_P(RosRobotTest, ARefusedGoalSkipsThePose) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  server().make(R"({"fault": "set", "values": {"refuse": true}})");
  EXPECT_THAT(error_of([&] {
                arm.move({{"elbow"}, {0.5}});
              }),
              AllOf(HasSubstr("pose: action '/arm_controller/follow_joint_trajectory'"),
                    HasSubstr(GetParam() == "ros1" ? "joint limits" : "refused")));
  server().make(R"({"fault": "set", "values": {"refuse": false}})");
  arm.move({{"elbow"}, {0.5}});
  EXPECT_TRUE(arrives(arm, "elbow", 0.5));
}

TEST_P(RosRobotTest, AControllerThatGivesUpIsReportedWithItsReason) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  server().make(R"({"fault": "set", "values": {"abort": true}})");
  arm.move({{"elbow"}, {0.5}});
  EXPECT_THAT(error_of([&] { (void)arrives(arm, "elbow", 0.5); }),
              AllOf(HasSubstr("pose: "), HasSubstr("path tolerance violated (error -4)")));
}

TEST_P(RosRobotTest, APoseWithoutAControllersJointIsSkipped) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  EXPECT_THAT(error_of([&] { arm.move({{"wheel"}, {0.5}}); }), HasSubstr("pose: no controller"));
}

TEST_P(RosRobotTest, AnActionThatIsNotOfferedIsNamedWithWhatToDo) {
  start(R"(, "hidden": true)");
  RosBridge bridge = connect(milliseconds(300));
  EXPECT_THAT(
      error_of([&] { RosArm arm(bridge, kArm); }),
      AllOf(HasSubstr("connection: "), HasSubstr("'/arm_controller/follow_joint_trajectory'"),
            HasSubstr("include_hidden:=true")));
}

TEST_P(RosRobotTest, ARobotThatAPersonMovesNeedsNoActions) {
  start(R"(, "hidden": true)");
  RosBridge bridge = connect();
  RosArm arm(bridge, {.measured = {"elbow", "head"}});
  EXPECT_EQ(arm.next_joints(Stamp::min()).position("head"), 0.0);
  EXPECT_THAT(error_of([&] { arm.move({{"elbow"}, {0.5}}); }), HasSubstr("pose: no controller"));
}

TEST_P(RosRobotTest, AStreamThatStopsIsNamedWithItsLastStamp) {
  RosBridge bridge = connect(milliseconds(1500));
  RosArm arm(bridge, kArm);
  RosCamera camera(bridge, kCamera);
  (void)camera.next_view(Stamp::min());
  const Stamp last = arm.next_joints(Stamp::min()).stamp;
  server().make(R"({"fault": "silent", "topics": ["/camera/image", "/joint_states"]})");
  EXPECT_THAT(error_of([&] { (void)camera.next_view(last + std::chrono::hours(1)); }),
              AllOf(HasSubstr("pose: topic '/camera/image': nothing after "),
                    HasSubstr("the newest message is of "), HasSubstr("the stream has stopped")));
  EXPECT_THAT(error_of([&] { (void)arm.next_joints(last + std::chrono::hours(1)); }),
              AllOf(HasSubstr("pose: topic '/joint_states': no joint positions after "),
                    HasSubstr("the newest are of ")));
}

TEST_P(RosRobotTest, ASilenceHasTheStampOfTheNewestMessage) {
  RosBridge bridge = connect(milliseconds(600));
  RosArm arm(bridge, kArm);
  RosCamera camera(bridge, kCamera);
  (void)camera.next_view(Stamp::min());
  server().make(R"({"fault": "silent", "topics": ["/camera/image"]})");
  const auto silence = [&] {
    try {
      (void)camera.next_view(arm.next_joints(Stamp::min()).stamp + milliseconds(100));
    } catch (const SilenceError& error) {
      EXPECT_EQ(error.stream, "/camera/image");
      return error.newest;
    }
    return std::optional<Stamp>();
  };
  const auto first = silence();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(silence(), first);
}

TEST_P(RosRobotTest, ATopicThatTheBridgeWithdrawsEndsTheSession) {
  RosBridge bridge = connect(milliseconds(600));
  RosArm arm(bridge, kArm);
  RosCamera camera(bridge, kCamera);
  (void)camera.next_view(Stamp::min());
  server().make(R"({"fault": "withdraw", "topic": "/camera/points"})");
  const Stamp last = arm.next_joints(arm.next_joints(Stamp::min()).stamp + milliseconds(100)).stamp;
  EXPECT_THAT(
      error_of([&] { (void)camera.next_view(last); }),
      HasSubstr("connection: topic '/camera/points': the bridge has withdrawn it; its newest "
                "message is of "));
  server().make(R"({"fault": "withdraw", "topic": "/joint_states"})");
  EXPECT_THAT(error_of([&] { (void)arm.next_joints(last + std::chrono::hours(1)); }),
              HasSubstr("connection: topic '/joint_states': the bridge has withdrawn it"));
}

TEST_P(RosRobotTest, AMisspeltTopicIsNamedWithTheOneThatWasMeant) {
  RosBridge bridge = connect(milliseconds(300));
  RosCamera camera(bridge, {.image = "/camera/imgae"});
  EXPECT_THAT(error_of([&] { (void)camera.next_view(Stamp::min()); }),
              HasSubstr("pose: the bridge offers no topic '/camera/imgae'; did you mean "
                        "'/camera/image'?"));
}

TEST_P(RosRobotTest, AJointThatNobodyMeasuresIsNamed) {
  RosBridge bridge = connect(milliseconds(300));
  RosArm arm(bridge, {.controllers = {{kArm.controllers[0].action, {"elbow", "wrist"}}}});
  EXPECT_THAT(error_of([&] { (void)arm.next_joints(Stamp::min()); }),
              HasSubstr("pose: topic '/joint_states' has no positions of joint 'wrist'"));
}

TEST_P(RosRobotTest, ImagesOfAnotherClockAreNotUsed) {
  RosBridge bridge = connect(milliseconds(600));
  RosArm arm(bridge, kArm);
  RosCamera camera(bridge, kCamera);
  server().make(R"({"fault": "set", "values": {"imageLead": 100}})");
  const Stamp now = arm.next_joints(Stamp::min()).stamp;
  EXPECT_THAT(error_of([&] { (void)camera.next_view(now + std::chrono::seconds(50)); }),
              AllOf(HasSubstr("pose: topic '/camera/image': its stamps are "),
                    HasSubstr("ahead of those of the joint states"), HasSubstr("another clock")));
  server().make(R"({"fault": "set", "values": {"imageLead": -100}})");
  (void)error_of([&] { (void)camera.next_view(now + std::chrono::hours(1)); });
  EXPECT_THAT(error_of([&] { (void)camera.next_view(now); }),
              AllOf(HasSubstr("pose: topic '/camera/image': nothing after"),
                    HasSubstr("behind the joint states"), HasSubstr("another clock")));
}

TEST_P(RosRobotTest, ATopicThatAppearsAgainIsReadOn) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  const Stamp before = arm.next_joints(Stamp::min()).stamp;
  server().make(R"({"fault": "again"})");
  EXPECT_GT(arm.next_joints(before + milliseconds(200)).stamp, before);
}

TEST_P(RosRobotTest, HalfAMessageSkipsThePoseAndNamesItsTopic) {
  RosBridge bridge = connect();
  RosArm arm(bridge, kArm);
  RosCamera camera(bridge, kCamera);
  (void)camera.next_view(Stamp::min());
  server().make(R"({"fault": "half", "topics": ["/camera/points"]})");
  const auto look = [&] {
    for (int i = 0; i < 20; ++i) (void)camera.next_view(camera.next_view(Stamp::min()).stamp);
  };
  EXPECT_THAT(error_of(look), AllOf(HasSubstr("pose: '/camera/points' sent something that is not a "
                                              "sensor_msgs/PointCloud2: byte "),
                                    HasSubstr("left")));
  server().make(R"({"fault": "half", "topics": []})");
  (void)error_of(look);
  EXPECT_FALSE(camera.next_view(Stamp::min()).points.empty());
}

TEST_P(RosRobotTest, ATopicOfAnotherTypeEndsTheSession) {
  start(R"(, "joint_type": "sensor_msgs/PointCloud2")");
  RosBridge bridge = connect();
  EXPECT_THAT(error_of([&] { (void)RosArm(bridge, kArm).next_joints(Stamp::min()); }),
              AllOf(HasSubstr("connection: "),
                    HasSubstr("topic '/joint_states' has messages of type "
                              "'sensor_msgs/PointCloud2'; expected sensor_msgs/JointState")));
}

TEST_P(RosRobotTest, ATopicThatIsTakenForTwoThingsIsNamedAtOnce) {
  start();
  RosBridge bridge = connect();
  EXPECT_THAT(error_of([&] { (void)RosCamera(bridge, {.image = "/joint_states"}); }),
              AllOf(HasSubstr("topic '/joint_states' is wanted as sensor_msgs/JointState"),
                    HasSubstr("and as sensor_msgs/Image")));
}

TEST_P(RosRobotTest, AnEncodingThatKinecalDoesNotReadIsNamed) {
  start(R"(, "topic_encoding": "protobuf")");
  RosBridge bridge = connect();
  EXPECT_THAT(error_of([&] { (void)RosArm(bridge, kArm).next_joints(Stamp::min()); }),
              AllOf(HasSubstr("connection: "), HasSubstr("its messages are 'protobuf'")));
}

TEST_P(RosRobotTest, ABridgeThatEndsEndsTheSession) {
  for (const char* const fault : {"close", "cut", "die"}) {
    start();
    RosBridge bridge = connect();
    RosArm arm(bridge, kArm);
    (void)arm.next_joints(Stamp::min());
    if (fault == std::string("die")) {
      server().kill();
    } else {
      server().make(std::string(R"({"fault": ")") + fault + "\"}");
    }
    EXPECT_THAT(
        error_of([&] { (void)arm.next_joints(Stamp::max() - Stamp(1)); }),
        AllOf(HasSubstr("connection: bridge 'ws://127.0.0.1:"), HasSubstr("the connection ended")))
        << fault;
    EXPECT_THAT(error_of([&] { arm.move({{"elbow"}, {0.1}}); }), HasSubstr("connection: bridge"));
  }
}

}  // namespace
}  // namespace kinecal
