#include "kinecal/capture/boards/target_pose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"

namespace kinecal {
namespace {

using ::testing::HasSubstr;

/// The corners of a tag, metres.
std::vector<TargetCorner> tag_of(double size, const Vector3<double>& centre = {0, 0, 0}) {
  std::vector<TargetCorner> corners;
  for (int k = 0; k < 4; ++k) {
    TargetCorner corner;
    corner.id = k;
    corner.target =
        centre +
        0.5 * size * Vector3<double>(k == 1 || k == 2 ? 1.0 : -1.0, k >= 2 ? 1.0 : -1.0, 0.0);
    corners.push_back(corner);
  }
  return corners;
}

CameraInfo wide_lens() {
  CameraInfo camera = test::camera_640();
  camera.distortion_model = "plumb_bob";
  camera.d = {-0.25, 0.06, 1e-3, -5e-4, 0.0};
  return camera;
}

/// Sets the pixels of corners, with noise.
void see(std::vector<TargetCorner>& corners, const CameraInfo& camera,
         const Pose<double>& camera_T_target, double noise = 0.0, int seed = 1) {
  const Lens lens(camera);
  SeededRandom random(static_cast<std::uint64_t>(seed));
  for (TargetCorner& corner : corners) {
    corner.pixel = lens.project(camera_T_target * corner.target);
    const double u = random.normal(), v = random.normal();
    corner.pixel += noise * Eigen::Vector2d(u, v);
  }
}

/// A tag that faces the camera, tilted, radians.
Pose<double> before_camera(double distance, double tilt, double about, double roll) {
  Pose<double> pose;
  const Vector3<double> axis(std::cos(about), std::sin(about), 0.0);
  pose.rotation = exp(Vector3<double>(tilt * axis)) * exp(Vector3<double>(0, 0, roll)) *
                  exp(Vector3<double>(std::numbers::pi, 0, 0));
  pose.translation = {0.1 * distance, -0.05 * distance, distance};
  return pose;
}

double degrees_between(const Pose<double>& a, const Pose<double>& b) {
  return log(Matrix3<double>(a.rotation * b.rotation.transpose())).norm() * 180.0 /
         std::numbers::pi;
}

TEST(TargetPose, OfExactCornersIsExactThroughADistortedLens) {
  const CameraInfo camera = wide_lens();
  for (int i = 0; i < 50; ++i) {
    SeededRandom random(static_cast<std::uint64_t>(i));
    const Pose<double> truth = before_camera(random.uniform(0.3, 0.8), random.uniform(0.3, 1.1),
                                             random.uniform(0.0, 6.28), random.uniform(0.0, 6.28));
    std::vector<TargetCorner> corners = tag_of(0.1);
    see(corners, camera, truth);
    const TargetPose found = target_pose(corners, camera);
    ASSERT_TRUE(found.camera_T_target) << i << ": " << found.fault;
    EXPECT_LT(degrees_between(*found.camera_T_target, truth), 1e-3) << i;
    EXPECT_LT((found.camera_T_target->translation - truth.translation).norm(), 1e-6) << i;
    EXPECT_LT(found.rms, 1e-4);
  }
}

/// Rays of such lenses have any length, and may be more than 90 degrees from the axis.
TEST(TargetPose, OfFisheyesIsExactToo) {
  CameraInfo camera = test::camera_640();
  camera.k = {180, 0, 320, 0, 180, 240, 0, 0, 1};
  for (const auto& [lens, d] :
       {std::pair<std::string, std::vector<double>>{"equidistant", {0.02, -0.004, 1e-3, 0}},
        {"double_sphere", {-0.2, 0.6}}}) {
    camera.distortion_model = lens;
    camera.d = d;
    for (const double angle : {0.0, 0.9, 1.7}) {
      const Matrix3<double> aside = exp(Vector3<double>(0, angle, 0));
      const Pose<double> facing = before_camera(0.4, 0.6, 0.3, 0.8);
      const Pose<double> truth{aside * facing.rotation, aside * facing.translation};
      std::vector<TargetCorner> corners = tag_of(0.16);
      see(corners, camera, truth);
      const TargetPose pose = target_pose(corners, camera);
      ASSERT_TRUE(pose.camera_T_target) << lens << " at " << angle << ": " << pose.fault;
      EXPECT_LT((pose.camera_T_target->translation - truth.translation).norm(), 1e-8);
      EXPECT_LT((pose.camera_T_target->rotation - truth.rotation).norm(), 1e-7);
    }
  }
}

TEST(TargetPose, OfTagsInTwoPlanesUsesAllCorners) {
  std::vector<TargetCorner> corners = tag_of(0.05, {0, 0, 0.02});
  for (TargetCorner& corner : tag_of(0.05, {0.1, 0, -0.03})) corners.push_back(corner);
  const Pose<double> truth = before_camera(0.5, 0.4, 1.0, 2.0);
  see(corners, test::camera_640(), truth);
  const TargetPose found = target_pose(corners, test::camera_640());
  ASSERT_TRUE(found.camera_T_target) << found.fault;
  EXPECT_LT(degrees_between(*found.camera_T_target, truth), 1e-3);
  EXPECT_LT((found.camera_T_target->translation - truth.translation).norm(), 1e-6);
}

TEST(TargetPose, IsNeverTheReflectionButRefusedWhereBothFit) {
  const CameraInfo camera = test::camera_640();
  int near_found = 0, far_refused = 0;
  for (int i = 0; i < 200; ++i) {
    SeededRandom random(static_cast<std::uint64_t>(i + 100));
    const double tilt = random.uniform(0.35, 1.0), about = random.uniform(0.0, 6.28),
                 roll = random.uniform(0.0, 6.28);
    for (const double distance : {0.4, 3.0}) {
      const Pose<double> truth = before_camera(distance, tilt, about, roll);
      std::vector<TargetCorner> corners = tag_of(0.1);
      see(corners, camera, truth, 0.1, i + 1);
      const TargetPose found = target_pose(corners, camera);
      if (distance < 1.0) near_found += found.camera_T_target ? 1 : 0;
      if (distance > 1.0) far_refused += found.camera_T_target ? 0 : 1;
      if (!found.camera_T_target) {
        EXPECT_THAT(found.fault, HasSubstr("degrees apart fit alike"));
        continue;
      }
      // The reflection of a tilt of 20 degrees is 40 degrees off.
      EXPECT_LT(degrees_between(*found.camera_T_target, truth), 12.0) << i << " at " << distance;
    }
  }
  EXPECT_GE(near_found, 198);
  EXPECT_GE(far_refused, 60);
}

TEST(TargetPose, TooFewCornersAndACameraWithoutLensAreFaults) {
  std::vector<TargetCorner> corners = tag_of(0.1);
  see(corners, test::camera_640(), before_camera(0.5, 0.5, 0.0, 0.0));
  EXPECT_THAT(target_pose(corners, CameraInfo{}).fault, HasSubstr("camera's lens"));
  corners.pop_back();
  EXPECT_THAT(target_pose(corners, test::camera_640()).fault, HasSubstr("too few"));
}

TEST(TargetPose, AFinderGivesOneFeatureToTheCameraAndOneToTheArm) {
  std::vector<TargetCorner> corners = tag_of(0.1);
  const Pose<double> truth = before_camera(0.5, 0.5, 1.0, 1.0);
  see(corners, test::camera_640(), truth);
  View view;
  view.frame = "optical";
  view.camera = test::camera_640();
  TargetSettings settings;
  settings.corners = CornerKind::pose;
  settings.frame = "tag";
  const Found found = observed(view, settings, corners);
  ASSERT_TRUE(found) << found.refusal;
  ASSERT_EQ(found.observations[0].features.size(), 1u);
  ASSERT_EQ(found.observations[1].features.size(), 1u);
  const Feature &seen = found.observations[0].features[0],
                &held = found.observations[1].features[0];
  EXPECT_EQ(seen.frame, "optical");
  EXPECT_LT((seen.point - truth.translation).norm(), 1e-6);
  ASSERT_TRUE(seen.rotation && held.rotation);
  EXPECT_LT((*seen.rotation - truth.rotation).norm(), 1e-5);
  EXPECT_EQ(held.frame, "tag");
  EXPECT_TRUE(held.point.isZero());
  EXPECT_TRUE(held.rotation->isIdentity());
  EXPECT_EQ(found.marks.size(), 4u);
}

}  // namespace
}  // namespace kinecal
