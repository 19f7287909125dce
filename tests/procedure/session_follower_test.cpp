#include "kinecal/procedure/session_follower.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/session_end.hpp"
#include "support/data.hpp"
#include "support/mesh_robot_test.hpp"
#include "support/thrown.hpp"

namespace kinecal::test {
namespace {

using ::testing::HasSubstr;

std::string file(const char* name) {
  return (data_folder() / "fetch/synth" / name).string();
}

/// The Fetch, its configuration and its samples.
struct FetchSession {
  Diagnostics diagnostics = {};
  Robot robot = read_urdf(file("fetch_arm_head.urdf"));
  Config config = read_config(file("calibrate.yaml"), diagnostics);
  std::vector<Sample> samples = read_samples(file("samples.yaml"), diagnostics);
};

TEST(SessionFollower, FollowsASessionOfTheFetch) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const FetchSession fetch;
  SessionFollower follower(fetch.config, fetch.robot);
  FollowedState state;
  int known_from = 0;
  for (std::size_t i = 0; i < fetch.samples.size(); ++i) {
    state = follower.add(fetch.samples[i]);
    EXPECT_EQ(state.problem, "");
    EXPECT_TRUE(state.online.fits) << "sample " << i + 1 << ": " << state.online.times;
    if (known_from == 0 && state.online.known) known_from = static_cast<int>(i) + 1;
  }
  EXPECT_GE(known_from, 3);  // 12 residuals each, 24 that can be observed
  EXPECT_LE(known_from, 12);
  EXPECT_EQ(follower.frames(), std::pair(std::string("wrist_roll_link"),
                                         std::string("head_camera_rgb_optical_frame")));
  EXPECT_NEAR(state.online.noise, 1e-3, 1e-4);          // metres: the error block has no sigma
  EXPECT_NEAR(state.online.position, 1.21e-3, 0.1e-3);  // as the whole calibration says
  ASSERT_TRUE(state.next.has_value());
  EXPECT_LT(state.next->position, state.online.position);
}

TEST(SessionFollower, SaysWhatIsWrongWithASampleAndGoesOn) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const FetchSession fetch;
  SessionFollower follower(fetch.config, fetch.robot);
  Sample poor = fetch.samples[0];
  poor.joint_names.pop_back();
  poor.joint_positions.pop_back();
  EXPECT_THAT(follower.add(poor).problem, HasSubstr("joint"));
  for (std::size_t i = 0; i < 20; ++i) (void)follower.add(fetch.samples[i]);
  Sample slipped = fetch.samples[20];
  for (Observation& seen : slipped.observations) {
    if (seen.sensor != "camera") continue;
    for (Feature& feature : seen.features) feature.point.y() += 0.02;
  }
  EXPECT_FALSE(follower.add(slipped).online.fits);
  EXPECT_TRUE(follower.add(fetch.samples[21]).online.fits);
}

TEST(SessionFollower, NamesALinkThatDoesNotExist) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const FetchSession fetch;
  EXPECT_THAT(test::thrown<InputError>([&] {
                const SessionFollower follower(fetch.config, fetch.robot, "wrist_rol_link");
              }),
              HasSubstr("did you mean 'wrist_roll_link'?"));
}

TEST(SessionFollower, DoesNotFollowABoardThatAPersonHolds) {
  KINECAL_NEEDS_DATA("fetch/synth");
  FetchSession fetch;
  fetch.config.per_sample.push_back({"board", {"calibrate.yaml", 2}});
  EXPECT_THAT(
      test::thrown<InputError>([&] { const SessionFollower follower(fetch.config, fetch.robot); }),
      HasSubstr("calibrate.yaml:2: per_sample: a session cannot be"));
}

TEST(Accuracy, IsANameANumberAndAUnit) {
  EXPECT_EQ(parse_accuracy("gripper 1 mm").position, 1e-3);
  EXPECT_EQ(parse_accuracy("gripper 1 mm").frame, "");
  EXPECT_NEAR(parse_accuracy("tool0 0.1 deg").rotation.value(), 0.1 * M_PI / 180.0, 1e-15);
  EXPECT_EQ(parse_accuracy("tool0 0.1 deg").frame, "tool0");
  for (const char* wrong : {"", "gripper", "gripper mm", "gripper 1", "gripper -1 mm", "1 mm",
                            "gripper 1 miles", "gripper 1 mm 2", "gripper nan mm"}) {
    EXPECT_THROW((void)parse_accuracy(wrong), InputError) << wrong;
  }
}

TEST(Accuracy, IsReachedByAKnownPoseOnly) {
  const Accuracy millimetre = parse_accuracy("gripper 1 mm");
  OnlineState state;
  state.position = 0.5e-3;
  EXPECT_FALSE(millimetre.reached(state));
  state.known = true;
  EXPECT_TRUE(millimetre.reached(state));
  state.position = 2e-3;
  EXPECT_FALSE(millimetre.reached(state));
}

/// Sessions of an arm that is its own target.
class SessionOfASurface : public MeshRobotTest {
 protected:
  SessionFollower follower(const std::string& config) {
    CalibrationSetup setup = setup_of(config);
    return SessionFollower(std::move(*setup.config), setup.robot, "", setup.urdf_text, setup.urdf);
  }
  std::vector<Sample> clouds(const CloudPlan& plan) {
    return mesh_robot_samples(parse_urdf(urdf_, "arm.urdf"), plan);
  }
};

TEST_F(SessionOfASurface, IsJudgedAsItsCalibration) {
  SessionFollower session = follower(mesh_config(""));  // the camera's pose is searched for
  FollowedState state;
  const std::vector<Sample> samples = clouds({.samples = 6, .noise = 0.001});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    state = session.add(samples[i]);
    EXPECT_EQ(state.problem, "") << "sample " << i + 1;
    EXPECT_EQ(state.online.known, i >= 2) << "sample " << i + 1;
    EXPECT_TRUE(state.online.fits);
  }
  EXPECT_EQ(session.frames(), std::pair(std::string("base"), std::string("camera")));
  const CalibratedRobot all = session.calibrate_all();
  ASSERT_TRUE(all.is_usable());
  EXPECT_LT(distance_of(camera_in(all.result.table), true_camera()), 1e-3);
  const PoseUncertainty& pose = all.assessments.back().compared.at(0);
  EXPECT_NEAR(state.online.position, pose.position, 1e-3 * pose.position);
  EXPECT_NEAR(state.online.rotation, pose.rotation, 1e-3 * pose.rotation);
  const Accuracy loose{.frame = "", .position = 3.0 * pose.position, .rotation = {}},
      tight{.frame = "", .position = 0.3 * pose.position, .rotation = {}};
  EXPECT_EQ(why_go_on(loose, session, {}), "");
  EXPECT_THAT(why_go_on(tight, session, {}), HasSubstr("'base' in 'camera' is known to "));
}

TEST_F(SessionOfASurface, NamesACloudOfSomethingElse) {
  SessionFollower session = follower(mesh_config(kStart));
  const std::vector<Sample> samples = clouds({.samples = 5, .noise = 0.001});
  for (std::size_t i = 0; i < 4; ++i) (void)session.add(samples[i]);
  Sample other = samples[4];  // the camera was knocked before it
  for (Feature& point : other.observations[0].features) point.point.x() += 0.04;
  const FollowedState state = session.add(other);
  EXPECT_FALSE(state.online.fits && state.problem.empty());
  const FollowedState after = session.add(samples[4]);
  EXPECT_EQ(after.problem, "");
  EXPECT_TRUE(after.online.fits);
  EXPECT_TRUE(after.online.known);
}

}  // namespace
}  // namespace kinecal::test
