#include "kinecal/sensors/camera_image.hpp"

#include <gtest/gtest.h>

#include "support/camera_infos.hpp"

namespace kinecal {
namespace {

using test::right_camera_of_a_stereo_pair;

TEST(CalibratedCameraInfo, ChangesAreRelativeAndActOnKAndP) {
  const CameraInfo camera = right_camera_of_a_stereo_pair();
  const CameraInfo c = calibrated_camera_info(camera, 0.01, -0.02, 0.03, -0.04);
  EXPECT_DOUBLE_EQ(c.k[0], camera.k[0] * 1.01);
  EXPECT_DOUBLE_EQ(c.k[4], camera.k[4] * 0.98);
  EXPECT_DOUBLE_EQ(c.k[2], camera.k[2] * 1.03);
  EXPECT_DOUBLE_EQ(c.k[5], camera.k[5] * 0.96);
  EXPECT_DOUBLE_EQ(c.p[0], camera.p[0] * 1.01);
  EXPECT_DOUBLE_EQ(c.p[5], camera.p[5] * 0.98);
  EXPECT_DOUBLE_EQ(c.p[2], camera.p[2] * 1.03);
  EXPECT_DOUBLE_EQ(c.p[6], camera.p[6] * 0.96);
}

TEST(CalibratedCameraInfo, ChangedFocalLengthsKeepTheBaseline) {
  const CameraInfo camera = right_camera_of_a_stereo_pair();
  const CameraInfo c = calibrated_camera_info(camera, 0.01, -0.02, 0.03, -0.04);
  EXPECT_DOUBLE_EQ(c.p[3] / c.p[0], camera.p[3] / camera.p[0]);
  EXPECT_DOUBLE_EQ(c.p[7] / c.p[5], camera.p[7] / camera.p[5]);
}

/// The rectified pixel of a ray and the raw one keep their relation: P K^-1 stays.
TEST(CalibratedCameraInfo, TheMatrixThatWasNotUsedFollowsTheOther) {
  const CameraInfo camera = right_camera_of_a_stereo_pair();
  const auto rectified_of_raw = [](const CameraInfo& c, double u) {
    return c.p[0] * (u - c.k[2]) / c.k[0] + c.p[2];
  };
  for (const ImageKind image : {ImageKind::raw, ImageKind::rectified}) {
    const CameraInfo c = calibrated_camera_info(camera, 0.01, -0.02, 0.03, -0.04, image);
    EXPECT_NEAR(rectified_of_raw(c, 100.0), rectified_of_raw(camera, 100.0), 1e-9);
    EXPECT_DOUBLE_EQ(c.k[0], camera.k[0] * 1.01);
    EXPECT_DOUBLE_EQ(c.p[5], camera.p[5] * 0.98);
    const bool raw = image == ImageKind::raw;
    EXPECT_EQ(c.k[2] == camera.k[2] * 1.03, raw);
    EXPECT_EQ(c.p[2] == camera.p[2] * 1.03, !raw);
  }
  CameraInfo no_k = camera;
  no_k.k = {};
  EXPECT_EQ(calibrated_camera_info(no_k, 0.01, 0, 0.03, 0, ImageKind::rectified).k, no_k.k);
}

TEST(CalibratedCameraInfo, NoChangeLeavesEveryNumberAsItWas) {
  const CameraInfo camera = right_camera_of_a_stereo_pair();
  const CameraInfo c = calibrated_camera_info(camera, 0.0, 0.0, 0.0, 0.0);
  EXPECT_EQ(c.k, camera.k);
  EXPECT_EQ(c.p, camera.p);
  EXPECT_EQ(c.d, camera.d);
  EXPECT_EQ(c.r, camera.r);
}

TEST(CalibratedCameraInfo, WhatIsNotAnIntrinsicIsLeftAlone) {
  CameraInfo camera = right_camera_of_a_stereo_pair();
  camera.z_offset = 0.002;
  camera.z_scaling = 1.01;
  const CameraInfo c = calibrated_camera_info(camera, 0.1, 0.1, 0.1, 0.1);
  EXPECT_EQ(c.d, camera.d);
  EXPECT_EQ(c.r, camera.r);
  EXPECT_EQ(c.width, camera.width);
  EXPECT_EQ(c.distortion_model, camera.distortion_model);
  EXPECT_EQ(c.z_offset, camera.z_offset);
  EXPECT_EQ(c.z_scaling, camera.z_scaling);
}

}  // namespace
}  // namespace kinecal
