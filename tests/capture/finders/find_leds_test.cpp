#include "kinecal/capture/finders/find_leds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/led_scene.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

Found found_in(LedScene& scene, const LedFinder& finder) {
  return find_leds(finder, scene, scene, scene.now);
}
Found found_in(LedScene& scene) {
  return found_in(scene, scene.finder());
}

/// The same, but the finder knows about where the LEDs are.
LedFinder informed(const LedScene& scene) {
  LedFinder finder = scene.finder();
  finder.frame_T_camera = [pose = scene.camera_T_gripper().inverse()](const View&) { return pose; };
  return finder;
}

TEST(FindLeds, ObservesEachLedInTheCameraAndOnItsLink) {
  LedScene scene;
  const Found found = found_in(scene);
  ASSERT_EQ(found.observations.size(), 2u) << found.refusal;
  EXPECT_EQ(found.refusal, "");
  const Observation &camera = found.observations[0], &chain = found.observations[1];
  EXPECT_EQ(camera.sensor, "camera");
  EXPECT_EQ(chain.sensor, "arm");
  EXPECT_TRUE(camera.camera.has_value());
  ASSERT_EQ(camera.features.size(), 4u);
  ASSERT_EQ(chain.features.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(camera.features[i].id, static_cast<int>(i));
    EXPECT_EQ(chain.features[i].id, static_cast<int>(i));
    EXPECT_EQ(camera.features[i].frame, "optical");
    EXPECT_EQ(chain.features[i].frame, "gripper");
    EXPECT_EQ(chain.features[i].point, scene.finder().leds[i].position);
    EXPECT_LT(
        std::hypot(found.marks[i].u - scene.pixel(i).x(), found.marks[i].v - scene.pixel(i).y()),
        0.3);
    EXPECT_LT((camera.features[i].point - scene.led_in_camera(i)).norm(), 0.002);
  }
  EXPECT_EQ(scene.code(), 0) << "all LEDs are off in the end";
}

TEST(FindLeds, WithstandsNoiseLightLatencyAndDimness) {
  LedScene noisy, drifting, late, dim;
  noisy.sigma = 6.0;
  drifting.light_drift = 20.0;
  late.latency = 0.09;
  dim.brightness = 35.0;
  for (LedScene* scene : {&noisy, &drifting, &late, &dim}) {
    const Found found = found_in(*scene);
    ASSERT_TRUE(found) << found.refusal;
    ASSERT_EQ(found.marks.size(), 4u) << found.refusal;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT(std::hypot(found.marks[i].u - scene->pixel(i).x(),
                           found.marks[i].v - scene->pixel(i).y()),
                0.3);
    }
  }
}

/// Any scene with noise, drifting light, latency, dark LEDs and, in some, somebody who walks by.
LedScene any_scene(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random()) / 4294967296.0;
  };
  LedScene scene;
  scene.random.seed(seed);
  scene.sigma = uniform(2.0, 4.0);
  scene.spot_sigma = uniform(0.7, 3.0);
  scene.brightness = uniform(50.0, 190.0);
  scene.light_drift = uniform(-10.0, 10.0);
  scene.latency = uniform(0.0, 0.08);
  scene.hole = uniform(0.0, 8.0);
  scene.depth_sigma = uniform(0.0005, 0.003);
  if (seed % 3 == 0) scene.walker = uniform(3.0, 40.0);
  scene.gripper = {uniform(-0.03, 0.03), uniform(-0.03, 0.03), uniform(0.7, 0.9)};
  for (std::size_t i = 0; i < 4; ++i) scene.works[i] = uniform(0.0, 1.0) < 0.8;
  return scene;
}

TEST(FindLeds, FindsAllThatLightAndNoOther) {
  int lit = 0, seen = 0;
  double sum = 0.0;
  for (int n = 0; n < test::repetitions(12, 5); ++n) {
    LedScene scene = any_scene(static_cast<unsigned>(n));
    for (const bool works : scene.works) lit += static_cast<int>(works);
    const Found found = n % 2 == 0 ? found_in(scene) : found_in(scene, informed(scene));
    for (std::size_t i = 0; i < found.marks.size(); ++i) {
      const auto led = static_cast<std::size_t>(*found.observations[0].features[i].id);
      const Vector3<double> pixel = scene.pixel(led);
      const double error = std::hypot(found.marks[i].u - pixel.x(), found.marks[i].v - pixel.y());
      EXPECT_TRUE(scene.works[led]) << n;
      EXPECT_LT(error, 0.3) << n;
      sum += error;
      ++seen;
    }
  }
  EXPECT_EQ(seen, lit);
  EXPECT_LT(sum / seen, 0.1) << "pixels";
}

TEST(FindLeds, WaitsForTheExposureOfASlowCamera) {
  LedScene scene;
  scene.period = std::chrono::milliseconds(200);
  scene.latency = 0.19;
  const Found found = found_in(scene);
  EXPECT_EQ(found.marks.size(), 4u) << found.refusal;
}

TEST(FindLeds, KeepsTheOthersWhenOneDoesNotLight) {
  LedScene scene;
  scene.works[1] = false;
  const Found found = found_in(scene);
  ASSERT_EQ(found.marks.size(), 3u) << found.refusal;
  EXPECT_EQ(found.observations[1].features[1].id, 2);
  EXPECT_THAT(found.refusal, HasSubstr("LED 1 (led2): it does not light"));
  scene.works.assign(4, false);
  const Found none = found_in(scene);
  EXPECT_FALSE(none);
  EXPECT_THAT(none.refusal, HasSubstr("LED 3 (led4): it does not light"));
}

TEST(FindLeds, RefusesARobotThatMoves) {
  LedScene scene;
  scene.sway = 1.0;
  const Found found = found_in(scene);
  EXPECT_FALSE(found);
  EXPECT_THAT(found.refusal, HasSubstr("move"));
}

TEST(FindLeds, TakesNothingThatWalksByForAnLed) {
  LedScene scene;
  scene.walker = 17.0;
  const Found found = found_in(scene);
  for (std::size_t i = 0; i < found.marks.size(); ++i) {
    const auto led = static_cast<std::size_t>(*found.observations[0].features[i].id);
    EXPECT_LT(std::hypot(found.marks[i].u - scene.pixel(led).x(),
                         found.marks[i].v - scene.pixel(led).y()),
              0.3);
  }
  scene.works.assign(4, false);
  EXPECT_FALSE(found_in(scene));
}

TEST(FindLeds, RefusesTwoLightsOfAlikeBrightness) {
  LedScene scene;
  scene.lights = {{200.0, 100.0, 0.9}};
  const Found found = found_in(scene);
  EXPECT_FALSE(found);
  EXPECT_THAT(found.refusal, HasSubstr("LED 0 (led1): it is ambiguous: another light"));
}

TEST(FindLeds, LooksWhereTheRobotsModelHasTheLed) {
  LedScene scene;
  scene.lights = {{100.0, 80.0, 1.5}};  // a reflection, far away
  EXPECT_FALSE(found_in(scene));
  EXPECT_EQ(found_in(scene, informed(scene)).marks.size(), 4u);
}

TEST(FindLeds, RefusesWhatIsFartherThanMaxErrorFromTheModel) {
  LedScene scene;
  LedFinder finder = informed(scene);
  finder.frame_T_camera = [pose = scene.camera_T_gripper().inverse()](const View&) {
    Pose<double> wrong = pose;
    wrong.translation += Vector3<double>(0.12, 0.0, 0.0);
    return wrong;
  };
  const Found aside = found_in(scene, finder);
  EXPECT_FALSE(aside);
  EXPECT_THAT(aside.refusal, HasSubstr("pixels from where the robot's model has it"));
  finder.frame_T_camera = [pose = scene.camera_T_gripper().inverse()](const View&) {
    Pose<double> wrong = pose;
    wrong.translation += Vector3<double>(0.0, 0.0, 0.12);
    return wrong;
  };
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("max_error is 100 mm"));
  finder.frame_T_camera = [](const View&) { return std::nullopt; };
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("do not give the pose of 'optical'"));
  finder.frame_T_camera = [](const View&) {
    Pose<double> behind;
    behind.translation.z() = 2.0;
    return behind;
  };
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("behind the camera"));
}

TEST(FindLeds, GivesTheModelTheJointsOfTheRobot) {
  LedScene scene;
  LedFinder finder = scene.finder();
  const Pose<double> pose = scene.camera_T_gripper().inverse();
  finder.frame_T_camera = [pose](const View& view) -> std::optional<Pose<double>> {
    if (!view.joints.position("elbow")) return std::nullopt;
    return pose;
  };
  EXPECT_FALSE(found_in(scene, finder));
  EXPECT_TRUE(find_leds(finder, scene, scene, scene.now, {{}, {"elbow"}, {0.1}}));
}

TEST(FindLeds, RefusesLedsWithoutDepthAndThoseThatDoNotFitTogether) {
  LedScene scene;
  scene.hole = 20.0;
  EXPECT_THAT(found_in(scene).refusal, HasSubstr("there is no depth near it"));
  LedScene other;
  LedFinder finder = other.finder();
  finder.leds[2].position.y() -= 0.03;
  const Found found = found_in(other, finder);
  EXPECT_EQ(found.marks.size(), 3u);
  EXPECT_THAT(found.refusal, HasSubstr("LED 2 (led3): it is"));
}

TEST(FindLeds, RefusesALampThatLightsAllAtOnce) {
  LedScene scene;
  struct AllLamp {
    LedScene& scene;
    Stamp light(int code) { return scene.light(code == 0 ? 0 : 15); }
  } lamp{scene};
  const Found found = find_leds(scene.finder(), scene, lamp, scene.now);
  EXPECT_FALSE(found);
  EXPECT_THAT(found.refusal, HasSubstr("ambiguous"));
}

TEST(FindLeds, SaysWhatViewsLack) {
  LedScene scene;
  const auto refusal_with = [&](std::function<void(View&)> edit) {
    scene.edit = std::move(edit);
    const Found found = found_in(scene);
    EXPECT_FALSE(found);
    return found.refusal;
  };
  EXPECT_THAT(refusal_with([](View& v) { v.camera.reset(); }), HasSubstr("no camera_info"));
  EXPECT_THAT(refusal_with([](View& v) { v.image = {}; }), HasSubstr("has no image"));
  EXPECT_THAT(refusal_with([](View& v) { v.points = {}; }), HasSubstr("has no point cloud"));
  EXPECT_THAT(refusal_with([](View& v) { v.points = PointCloud(320, 1, no_point()); }),
              HasSubstr("registered"));
  EXPECT_THAT(refusal_with([](View& v) { v.points = PointCloud(640, 480, no_point()); }),
              HasSubstr("no valid point"));
  EXPECT_THAT(refusal_with([](View& v) { v.camera->p[0] = 1000; }), HasSubstr("same camera"));
  EXPECT_THAT(refusal_with([&](View& v) {
                if (scene.views % 2 == 0) v.image = GrayImage(320, 240);
              }),
              HasSubstr("camera_info is of 640 x 480"));
}

TEST(FindLeds, SaysWhatTheSettingsLack) {
  LedScene scene;
  LedFinder finder = scene.finder();
  finder.max_iterations = 3;
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("max_iterations 3"));
  finder.leds[1].code = 0;
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("LED 1 (led2) has code 0"));
  finder.leds.clear();
  EXPECT_THAT(found_in(scene, finder).refusal, HasSubstr("no LED"));
}

}  // namespace
}  // namespace kinecal
