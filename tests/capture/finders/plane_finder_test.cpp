#include "kinecal/capture/finders/plane_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "capture/room_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

PlaneFinder ground_finder(const RoomScene& scene) {
  PlaneFinder finder;
  finder.region = scene.region();
  finder.search.normal = {0.0, 0.0, 1.0};
  finder.search.offset = 0.0;
  return finder;
}

TEST(PlaneFinder, SamplesTheGroundEvenlyInTheOpticalFrame) {
  RoomScene scene;
  scene.arm = true;
  scene.clutter = 0.1;
  const View view = scene.view();
  const Found found = ground_finder(scene).find(view);
  ASSERT_EQ(found.observations.size(), 1u) << found.refusal;
  const Observation& camera = found.observations[0];
  EXPECT_EQ(camera.sensor, "camera");
  EXPECT_TRUE(camera.camera.has_value());
  ASSERT_EQ(camera.features.size(), 60u);
  double nearest = 1e9;
  for (std::size_t i = 0; i < 60; ++i) {
    const Feature& f = camera.features[i];
    EXPECT_EQ(f.frame, "optical");
    EXPECT_FALSE(f.id.has_value());
    EXPECT_LT(std::abs((scene.base_T_camera() * f.point).z()), 0.02);
    const auto u = static_cast<int>(found.marks[i].u), v = static_cast<int>(found.marks[i].v);
    EXPECT_EQ(view.points(u, v).cast<double>(), f.point);
    for (std::size_t j = 0; j < i; ++j) {
      nearest = std::min(nearest, (camera.features[j].point - f.point).norm());
    }
  }
  EXPECT_GT(nearest, 0.15) << "metres between features";
}

TEST(PlaneFinder, FindsAWallByItsNormal) {
  RoomScene scene;
  scene.tilt = 0.2;
  PlaneFinder finder = ground_finder(scene);
  finder.search.normal = {-2.0, 0.0, 0.0};
  finder.search.offset = -3.0;
  const PlaneInView plane = finder.plane_in(scene.view());
  ASSERT_EQ(plane.problem, "");
  EXPECT_NEAR(plane.found.plane.centroid.x(), 3.0, 0.005);
  EXPECT_NEAR(plane.found.plane.normal.x(), -1.0, 1e-3);
}

TEST(PlaneFinder, WorksInTheCamerasOwnFrame) {
  RoomScene scene;
  PlaneFinder finder;
  finder.region.least.setConstant(-3.0);
  finder.region.most.setConstant(3.0);
  EXPECT_TRUE(finder.find(scene.view()));
}

TEST(PlaneFinder, RefusesAPlaneThatIsNotTheExpected) {
  RoomScene scene;
  scene.ground = 0.3;
  PlaneFinder finder = ground_finder(scene);
  EXPECT_THAT(finder.find(scene.view()).refusal, HasSubstr("it is at 300 mm along the expected"));
  finder.search.normal = {1.0, 0.0, 0.0};
  finder.region.most.x() = 2.0;
  EXPECT_THAT(finder.find(scene.view()).refusal, HasSubstr("it is tilted by"));
}

TEST(PlaneFinder, RefusesABoxWithFewPointsOrWithoutAPlane) {
  RoomScene scene;
  PlaneFinder finder = ground_finder(scene);
  finder.region.least.z() = 1.0;
  EXPECT_THAT(finder.find(scene.view()).refusal,
              HasSubstr("the box in 'base_link' has 0 points of the cloud"));
  scene.clutter = 1.0;
  EXPECT_THAT(ground_finder(scene).find(scene.view()).refusal, HasSubstr("no plane dominates"));
}

TEST(PlaneFinder, RefusesToChooseBetweenTwoPlanes) {
  RoomScene scene;
  scene.tilt = 0.363;
  scene.noise = 0.0005;
  PlaneFinder finder;
  finder.region = scene.region();
  finder.region.least.z() = -0.2;
  EXPECT_THAT(finder.find(scene.view()).refusal, HasSubstr("two planes have about as many points"));
}

TEST(PlaneFinder, RefusesViewsThatLackSomething) {
  RoomScene scene;
  const PlaneFinder finder = ground_finder(scene);
  View view = scene.view();
  view.camera.reset();
  EXPECT_THAT(finder.find(view).refusal, HasSubstr("no camera_info"));
  EXPECT_THAT(finder.find(View{}).refusal, HasSubstr("no point cloud"));
  view = scene.view();
  view.points.pixels.pop_back();
  EXPECT_THAT(finder.find(view).refusal, HasSubstr("307199 values"));
  PlaneFinder lost = finder;
  lost.region.frame_T_camera = [](const View&) { return std::nullopt; };
  EXPECT_THAT(lost.find(scene.view()).refusal,
              HasSubstr("the joints of the view do not give the pose of 'optical' in 'base_link'"));
}

TEST(PlaneFinder, TakesAnyCloud) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  RoomScene scene;
  for (const float number : {nan, infinite, 0.0F, 1.0F, 1e30F}) {
    for (const int size : {1, 3, 20}) {
      View view = scene.view();
      view.camera->width = view.camera->height = size;
      view.points = PointCloud(size, size, Vector3<float>::Constant(number));
      PlaneFinder finder = ground_finder(scene);
      EXPECT_FALSE(finder.find(view)) << number;
      finder.region.least.setConstant(-static_cast<double>(infinite));
      finder.region.most.setConstant(static_cast<double>(infinite));
      EXPECT_FALSE(finder.find(view)) << number;
    }
  }
  scene.width = 64;
  scene.height = 48;
  EXPECT_TRUE(ground_finder(scene).find(scene.view()));
  PlaneFinder none = ground_finder(scene);
  none.points_max = 0;
  EXPECT_TRUE(none.find(scene.view()).observations[0].features.empty());
  none.search.iterations = 0;
  EXPECT_FALSE(none.find(scene.view()));
}

}  // namespace
}  // namespace kinecal
