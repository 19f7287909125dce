// Views of a robot that moves: intervals of a recording, and samples of several cameras.
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/tools/detect/look.hpp"
#include "support/recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::kTourStart;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double since_start(Stamp stamp) {
  return std::chrono::duration<double>(stamp - kTourStart).count();
}

/// Swings at up to 0.3 rad/s.
double swinging(double time) {
  return 0.3 * std::sin(time);
}

/// Finds one feature in each view, under the name of the camera.
ViewFinder finder_of(const std::string& name) {
  return {name, [name](const View&) {
            Found found;
            found.observations = {{name, {{name, {1.0, 2.0, 0.0}}}, {}},
                                  {"hand_" + name, {{"hand", {0.0, 0.0, 0.0}}}, {}}};
            return found;
          }};
}

class Intervals : public test::FolderTest {
 protected:
  static CaptureFinder capture_finder(const std::string& camera) {
    return {camera,
            "CheckerboardFinder2d",
            "/" + camera + "/image",
            "",
            "",
            CheckerboardSettings{},
            {"c.yaml", 2}};
  }

  /// Four seconds: joints at 50 Hz, images at 10 Hz, of another camera some milliseconds later.
  void record(const std::function<double(double)>& motion, milliseconds right_later = {},
              double joints_end = 4.0) {
    Recorder to(path(), Encoding::cdr);
    for (milliseconds time{}; time <= milliseconds(4000); time += milliseconds(20)) {
      const double seconds = std::chrono::duration<double>(time).count();
      if (seconds <= joints_end) {
        to.joints("/joint_states", {kTourStart + time, {"pan"}, {motion(seconds)}});
      }
      if (time.count() % 100 != 0) continue;
      for (const CaptureFinder& finder : finders_) {
        const Stamp later = finder.name == "right" ? right_later : milliseconds(0);
        to.image(finder.topic, kTourStart + time + later, GrayImage(8, 8, 100));
      }
    }
    to.finish();
  }

  [[nodiscard]] std::string path() const { return (folder_ / "a.mcap").string(); }

  RecordedViews open(Stamp every) {
    return {{.path = path(), .frame = finders_.size() == 1 ? "eye" : "", .every = every},
            finders_,
            diagnostics_};
  }

  static std::vector<RecordedView> views_of(const RecordedViews& recording) {
    std::vector<RecordedView> views(recording.standstills());
    recording.read([&](const RecordedStandstill& standstill) {
      views.at(standstill.number) = recording.view(standstill, 0);
    });
    return views;
  }

  std::vector<Look> looks(Stamp every) {
    const auto finders = [this] {
      std::vector<ViewFinder> all;
      for (const CaptureFinder& finder : finders_) all.push_back(finder_of(finder.name));
      return all;
    };
    return look_at(open(every), {finders, 2, false, {}});
  }

  using Recorder = test::Recorder;
  std::vector<CaptureFinder> finders_ = {capture_finder("left")};
  Diagnostics diagnostics_;
};

TEST_F(Intervals, OfAMotionGiveTheImageOfTheirMiddleWithVelocities) {
  record(swinging);
  const auto views = views_of(open(milliseconds(500)));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.notes, Each(testing::Not(HasSubstr("left out"))));
  ASSERT_EQ(views.size(), 9U) << "the ninth has only the last image";
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(views[i].view) << views[i].refusal;
    EXPECT_TRUE(views[i].in_motion);
    EXPECT_TRUE(views[i].compared) << "a view in motion has one image, which is no fault";
    const View& view = *views[i].view;
    const double time = since_start(view.stamp);
    EXPECT_NEAR(time, 0.25 + 0.5 * static_cast<double>(i), 0.0501);
    EXPECT_EQ(view.joints.stamp, view.stamp);
    EXPECT_NEAR(view.joints.positions.at(0), swinging(time), 1e-4);
    EXPECT_NEAR(view.joints.velocities.at(0), 0.3 * std::cos(time), 1e-2);
  }
}

TEST_F(Intervals, ShorterThanThePeriodOfACameraGiveEachImageOnce) {
  record([](double time) { return 0.1 * time; });
  const auto views = views_of(open(milliseconds(7)));
  std::set<Stamp> stamps;
  for (const RecordedView& view : views) stamps.insert(view.view.value().stamp);
  EXPECT_EQ(views.size(), 41U);
  EXPECT_EQ(stamps.size(), 41U);
}

TEST_F(Intervals, OfARestGiveOneView) {
  // Rests until 1 s, moves, and rests from 3 s on.
  record([](double time) { return 0.2 * std::clamp(time - 1.0, 0.0, 2.0); });
  const auto views = views_of(open(milliseconds(100)));
  std::vector<double> times;
  for (const RecordedView& view : views) times.push_back(since_start(view.view.value().stamp));
  EXPECT_EQ(std::count_if(times.begin(), times.end(), [](double t) { return t < 0.95; }), 1);
  EXPECT_EQ(std::count_if(times.begin(), times.end(), [](double t) { return t > 3.15; }), 0);
  EXPECT_EQ(
      std::count_if(times.begin(), times.end(), [](double t) { return t > 1.05 && t < 2.95; }), 19);
  EXPECT_THAT(diagnostics_.notes,
              testing::Contains(HasSubstr("left out " + std::to_string(41 - times.size()) +
                                          " views in which the robot rests where it was")));
}

TEST_F(Intervals, OfASwingThatComesByTheSamePlaceAreNotARest) {
  record([](double time) { return 0.1 * std::sin(2.0 * M_PI * time); });
  EXPECT_EQ(views_of(open(milliseconds(1000))).size(), 5U);
}

TEST_F(Intervals, InWhichJointsWereNotReadAreRefused) {
  record([](double time) { return time > 1.19 && time < 2.19 ? std::nan("") : swinging(time); });
  const auto views = views_of(open(milliseconds(500)));
  ASSERT_EQ(views.size(), 9U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(views[i].view.has_value(), i != 2 && i != 3) << i;
    if (!views[i].view) {
      EXPECT_THAT(views[i].refusal, HasSubstr("was not read within 0.25 s"));
    }
  }
}

TEST_F(Intervals, BeginAndEndWithTheJoints) {
  record(swinging, {}, 2.0);
  EXPECT_EQ(views_of(open(milliseconds(500))).size(), 5U);
}

TEST_F(Intervals, OfSeveralCamerasGiveASampleOfEachStamp) {
  finders_.push_back(capture_finder("right"));
  record(swinging, milliseconds(30));
  const std::vector<Look> apart = looks(milliseconds(500));
  ASSERT_EQ(apart.size(), 9U);
  for (std::size_t i = 0; i < 8; ++i) {
    ASSERT_EQ(apart[i].samples.size(), 2U);
    for (const Sample& sample : apart[i].samples) {
      const double time = since_start(sample.stamp.value());
      EXPECT_NEAR(sample.joint_positions.at(0), swinging(time), 1e-4);
      EXPECT_NEAR(sample.joint_velocities.at(0), 0.3 * std::cos(time), 1e-2);
    }
  }
  record(swinging);
  for (const Look& look : looks(milliseconds(500))) {
    ASSERT_EQ(look.samples.size(), 1U) << "cameras on one trigger";
    EXPECT_EQ(look.samples[0].observations.size(), 4U);
  }
}

TEST_F(Intervals, OfDepthThatIsLaterThanTheImageAreRefused) {
  finders_.front().type = "CheckerboardFinder";
  for (const milliseconds later : {milliseconds(3), milliseconds(10)}) {
    Recorder to(path(), Encoding::cdr);
    for (milliseconds time{}; time <= milliseconds(2000); time += milliseconds(20)) {
      const double seconds = std::chrono::duration<double>(time).count();
      to.joints("/joint_states", {kTourStart + time, {"pan"}, {swinging(seconds)}});
      CameraInfo camera;
      camera.width = camera.height = 8;
      camera.p = {8, 0, 4, 0, 0, 8, 4, 0, 0, 0, 1, 0};
      to.camera_info("/left/camera_info", kTourStart + time, camera);
      to.image("/left/image", kTourStart + time, GrayImage(8, 8, 100));
      to.depth("/left/depth", kTourStart + time + later, Image<std::uint16_t>(8, 8, 1000));
    }
    to.finish();
    for (const RecordedView& view : views_of(open(milliseconds(500)))) {
      if (later < milliseconds(5)) {
        EXPECT_TRUE(view.view) << view.refusal;
      } else {
        EXPECT_THAT(view.refusal,
                    HasSubstr("of which topic 'left/depth' has the same within 5 ms"));
      }
    }
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
  }
}

TEST_F(Intervals, LongerThanTheRecordingGiveTheMiddleOfIt) {
  record(swinging);
  const auto views = views_of(open(std::chrono::minutes(1)));
  ASSERT_EQ(views.size(), 1U);
  EXPECT_NEAR(since_start(views[0].view.value().stamp), 2.0, 1e-6);
}

TEST_F(Intervals, WithoutImagesWhileJointsAreReadAreAnError) {
  finders_.push_back(capture_finder("right"));
  record(swinging, std::chrono::duration_cast<milliseconds>(std::chrono::hours(1)));
  (void)open(milliseconds(500));
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("they are of another clock")));
}

}  // namespace
}  // namespace kinecal
