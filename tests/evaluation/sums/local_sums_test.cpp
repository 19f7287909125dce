#include "kinecal/evaluation/sums/local_sums.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/check_sums.hpp"

namespace kinecal {
namespace {

TEST(Sums, AreThoseOfRowsMultipliedOutForPointToPoint) {
  test::check_sums_of({}, PointToPoint{}, {"camera", "arm"});
  test::check_sums_of({}, PointToPoint{}, {"arm", "camera"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutThroughAVirtualFrame) {
  test::check_sums_of({.arm_frame = "board"}, PointToPoint{}, {"camera", "arm"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutWithTheBaseOnTheMovingArm) {
  test::check_sums_of({.base = "forearm"}, PointToPoint{}, {"arm", "camera"});
  test::check_sums_of({.base = "hand", .arm_frame = "board"}, PointToPoint{}, {"camera", "arm"});
}

/// The torso and most of the arm move both bodies; mimic joints turn and slide with a gain.
TEST(Sums, AreThoseOfRowsMultipliedOutWhereAParameterMovesBothBodies) {
  test::check_sums_of({}, PointToPoint{}, {"arm", "finger"});
  test::check_sums_of({}, PointToPoint{}, {"counterweight", "finger"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutForTwoDepthCameras) {
  test::check_sums_of({}, PointToPoint{}, {"camera", "second"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutForTwoDepthCamerasWithTheSameParameters) {
  test::check_sums_of({}, PointToPoint{}, {"camera", "twin"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutForPointToPlane) {
  test::check_sums_of({}, PointToPlane(0.1, 0.2, 2, -0.4), {"camera"});
  test::check_sums_of({.arm_frame = "board"}, PointToPlane(0.1, 0.2, 2, -0.4), {"arm"});
  test::check_sums_of({}, PointToPlane(1, 0, 0, 0.1), {"finger"});
}

TEST(Sums, AreThoseOfRowsMultipliedOutForSeveralBlocksAndPriorsTogether) {
  const test::Scene scene{.arm_frame = "board"};
  const auto add_blocks = [](auto& problem, TermOptions options) {
    problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"}, options);
    options.scale = 0.3;
    options.loss.type = LossType::none;
    problem.add_block("finger", PointToPoint{}, {"arm", "finger"}, options);
    problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"}, options);
    options.scale = 0.01;
    options.loss = {LossType::huber, 0.2};
    problem.add_block("reprojection", PointToPixel{}, {"camera", "eye"}, options);
    problem.add_prior("restrict", {"camera_joint", 0.0, 2.0, 3.0, {0, 0.01, -0.02, 0, 0, 0.03, 0}},
                      options);
    problem.add_prior("joint", {"elbow", 4.0, 0.0, 0.0, {0.3}}, {});
  };
  test::check_sums(scene, add_blocks, test::oracle_rows_of(scene, add_blocks), 0.05);
}

}  // namespace
}  // namespace kinecal
