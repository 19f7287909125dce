#include "kinecal/procedure/session_follower.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/data.hpp"
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

}  // namespace
}  // namespace kinecal::test
