// What nothing ties to the robot is named before anything is solved.
#include "kinecal/config/frame_gaps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kCell = R"(<robot name="cell">
  <link name="base"/>
  <link name="left_foot"/><link name="left_hand"/><link name="right_foot"/><link name="right_hand"/>
  <link name="left_eye"/><link name="right_eye"/>
  <joint name="left_mount" type="fixed"><parent link="base"/><child link="left_foot"/></joint>
  <joint name="right_mount" type="fixed"><parent link="base"/><child link="right_foot"/></joint>
  <joint name="left_arm" type="revolute"><parent link="left_foot"/><child link="left_hand"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="right_arm" type="revolute"><parent link="right_foot"/><child link="right_hand"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="left_eye_joint" type="fixed"><parent link="base"/><child link="left_eye"/></joint>
  <joint name="right_eye_joint" type="fixed"><parent link="base"/><child link="right_eye"/></joint>
</robot>
)";

const char* const kCellConfig = R"(base_link: base
models:
 - {name: left_hand, type: chain3d, frame: left_hand}
 - {name: right_hand, type: chain3d, frame: right_hand}
 - {name: wall, type: chain3d, frame: base}
 - {name: left_eye, type: camera2d, frame: left_eye}
 - {name: right_eye, type: camera2d, frame: right_eye}
free_frames:
 - {name: right_mount, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: left_eye_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: right_eye_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: left_board, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: right_board, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: poster, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: ll, type: chain3d_to_camera2d, model_3d: left_hand, model_2d: left_eye}
 - {name: rr, type: chain3d_to_camera2d, model_3d: right_hand, model_2d: right_eye}
 - {name: rl, type: chain3d_to_camera2d, model_3d: right_hand, model_2d: left_eye}
 - {name: wl, type: chain3d_to_camera2d, model_3d: wall, model_2d: left_eye}
 - {name: wr, type: chain3d_to_camera2d, model_3d: wall, model_2d: right_eye}
)";

/// Observations of a sample: sensors, and the frames of their features.
Sample compared_sample(const std::vector<std::pair<std::string, std::string>>& seen,
                       int first_id = 0) {
  Sample all;
  for (const auto& [sensor, frame] : seen) {
    Observation& one = all.observations.emplace_back(Observation{sensor, {}});
    for (int i = 0; i < 4; ++i) {
      Feature feature{.frame = frame, .point = {0.1 * i, 0.0, 0.0}};
      feature.id = (sensor.ends_with("eye") ? first_id : 0) + i;
      one.features.push_back(feature);
    }
  }
  return all;
}

class FrameGaps : public testing::Test {
 protected:
  std::vector<FrameGap> gaps(const std::vector<std::string>& unknown,
                             const std::vector<Sample>& samples) {
    return frame_gaps(robot_, "base", config_.steps.front(), unknown, samples);
  }
  Robot robot_ = parse_urdf(kCell, "cell.urdf");
  Diagnostics diagnostics_;
  Config config_ = parse_config(kCellConfig, "c.yaml", diagnostics_);
  Sample left_ = compared_sample({{"left_hand", "left_board"}, {"left_eye", "left_eye"}});
  Sample right_ = compared_sample({{"right_hand", "right_board"}, {"right_eye", "right_eye"}});
};

TEST_F(FrameGaps, AreNoneWhereAnArmMovesWhatACameraSees) {
  EXPECT_THAT(gaps({"left_eye_joint", "left_board"}, {left_}), IsEmpty());
  EXPECT_THAT(
      gaps({"left_eye_joint", "left_board", "right_eye_joint", "right_board"}, {left_, right_}),
      IsEmpty());
}

TEST_F(FrameGaps, AreTwoArmsThatNothingRelates) {
  const std::vector<std::string> unknown = {"right_mount", "left_board", "right_board",
                                            "left_eye_joint"};
  // The right camera is known, and so says where the right arm stands; the left one sees the left arm only.
  EXPECT_THAT(gaps(unknown, {left_, right_}), IsEmpty());
  const std::vector<std::string> none_known = {"right_mount", "left_board", "right_board",
                                               "left_eye_joint", "right_eye_joint"};
  const auto found = gaps(none_known, {left_, right_});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].frames, ElementsAre("right_eye_joint", "right_mount"));
  EXPECT_THAT(found[0].sensors, ElementsAre("right_eye", "right_hand"));
  EXPECT_THAT(found[0].others, testing::Contains("left_eye"));
  // A camera that sees both closes it.
  const Sample both = compared_sample({{"right_hand", "right_board"}, {"left_eye", "left_eye"}});
  EXPECT_THAT(gaps(none_known, {left_, right_, both}), IsEmpty());
  const Sample other_ids =
      compared_sample({{"right_hand", "right_board"}, {"left_eye", "left_eye"}}, 100);
  EXPECT_EQ(gaps(none_known, {left_, right_, other_ids}).size(), 1u) << "no corner in common";
}

TEST_F(FrameGaps, AreACameraThatSeesOnlyAPosterOfItsOwn) {
  const Sample poster = compared_sample({{"wall", "poster"}, {"right_eye", "right_eye"}});
  const std::vector<std::string> unknown = {"left_board", "left_eye_joint", "right_eye_joint",
                                            "poster"};
  check_frame_gaps(robot_, "base", config_.steps.front(), unknown, std::vector{left_, poster},
                   diagnostics_);
  EXPECT_THAT(
      diagnostics_.errors,
      ElementsAre("c.yaml:14: nothing says where 'poster' and 'right_eye_joint' are: the "
                  "samples compare 'right_eye' and 'wall' only with each other.  Record "
                  "samples in which one of them sees what one of 'left_eye' and 'left_hand' "
                  "sees or holds; or, if a pose is known, write it into "
                  "free_frames_initial_values and do not free it"));
  const Sample by_left = compared_sample({{"wall", "poster"}, {"left_eye", "left_eye"}});
  EXPECT_THAT(gaps(unknown, {left_, poster, by_left}), IsEmpty());
}

}  // namespace
}  // namespace kinecal
