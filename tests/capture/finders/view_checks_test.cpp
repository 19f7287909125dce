#include "kinecal/capture/finders/view_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "capture/led_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

View good_view() {
  View view;
  view.frame = "optical";
  view.camera = vga_camera();
  view.image = GrayImage(640, 480);
  view.points = points_of(DepthImage(640, 480, 1.0F), *view.camera);
  return view;
}

TEST(ViewChecks, AViewWithAllIsGood) {
  EXPECT_EQ(image_and_depth_problem(good_view()), "");
}

TEST(ViewChecks, SizesMustBeThoseOfThePixels) {
  View view = good_view();
  view.image.width = 641;
  EXPECT_EQ(image_problem(view), "the image has 307200 values, which are not 641 x 480");
  view.image.width = -640;
  view.image.height = -480;
  EXPECT_NE(image_problem(view), "");
  EXPECT_EQ(cloud_problem(View{}), "the view has no point cloud");
}

TEST(ViewChecks, CameraInfoMustBeOfTheImage) {
  View view = good_view();
  view.camera->width = 1280;
  EXPECT_THAT(camera_problem(view), HasSubstr("camera_info is of 1280 x 480 pixels"));
  view.image = {};
  EXPECT_THAT(camera_problem(view), HasSubstr("the cloud has 640 x 480 points"));
  view.camera->width = view.camera->height = 0;  // as some drivers leave it
  EXPECT_EQ(camera_problem(view), "");
  view.camera->p[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(camera_problem(view), HasSubstr("has no focal length in P"));
  view.camera.reset();
  EXPECT_THAT(camera_problem(view), HasSubstr("the camera of 'optical' sent no camera_info"));
}

TEST(ViewChecks, PointsMustBeWhereTheirPixelsAre) {
  View view = good_view();
  view.camera->p[2] += 2.0;  // drivers round
  EXPECT_EQ(registration_problem(view), "");
  view.camera->p[2] += 20.0;
  EXPECT_THAT(registration_problem(view), HasSubstr("22 px from where camera_info sees them"));
  view.points.pixels.assign(view.points.pixels.size(), no_point());
  EXPECT_THAT(registration_problem(view), HasSubstr("no valid point"));
  view.points.width = 307200;
  view.points.height = 1;
  EXPECT_THAT(registration_problem(view), HasSubstr("the cloud has 307200 x 1 points"));
}

}  // namespace
}  // namespace kinecal
