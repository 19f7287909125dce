// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/recorded_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include "support/laser_room.hpp"
#include "support/recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::kTourStart;
using test::Recorder;
using test::Tour;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A bright square that moves with a joint.
GrayImage picture(double position) {
  GrayImage image(64, 48, 30);
  const int left = 20 + static_cast<int>(std::lround(20.0 * position));
  for (int v = 20; v < 40; ++v) {
    for (int u = left; u < left + 20; ++u) {
      if (image.contains(u, v)) image(u, v) = 200;
    }
  }
  return image;
}

CameraInfo small_camera() {
  CameraInfo camera;
  camera.width = 64;
  camera.height = 48;
  camera.p = {60, 0, 32, 0, 0, 60, 24, 0, 0, 0, 1, 0};
  return camera;
}

/// What is recorded beside the usual.
struct TourRecording {
  Encoding encoding = Encoding::cdr;
  bool joints = true, camera_info = true;
  int binning = 0;
  Stamp camera_ahead{};                                     ///< stamps of images
  std::string image_encoding = "mono8";                     ///< as images have it
  std::function<void(Recorder&, Stamp, double)> more = {};  ///< at 50 Hz
  std::function<GrayImage(double position, double time)> scene = {};
};

class RecordedViewsTest : public test::FolderTest {
 protected:
  Tour tour_{{"pan", "tilt"}, {{0.0, 0.1}, {0.5, -0.2}, {-0.5, 0.3}}};
  std::vector<CaptureFinder> finders_ = {{"board",
                                          "CheckerboardFinder2d",
                                          "/cam/image",
                                          "/cam/camera_info",
                                          "",
                                          CheckerboardSettings{},
                                          {"c.yaml", 2}}};
  Diagnostics diagnostics_;

  void record(const TourRecording& how = {}, const std::string& name = "a.mcap") {
    Recorder to(path(name), how.encoding);
    to.camera_ahead = how.camera_ahead;
    test::play(
        tour_,
        [&](Stamp stamp, double time) {
          const auto at = tour_.positions(time);
          if (how.joints) {  // by two nodes
            to.joints("/joint_states", {stamp, {"pan"}, {at[0]}});
            to.joints("/joint_states", {stamp + std::chrono::milliseconds(3), {"tilt"}, {at[1]}});
          }
          if (how.more) how.more(to, stamp, time);
        },
        [&](Stamp stamp, double time) {
          const double position = tour_.positions(time)[0];
          if (how.camera_info) {
            to.camera_info("/cam/camera_info", stamp, small_camera(), how.binning);
          }
          to.image("/cam/image", stamp, how.scene ? how.scene(position, time) : picture(position),
                   how.image_encoding);
        });
    to.finish();
  }

  [[nodiscard]] std::string path(const std::string& name = "a.mcap") const {
    return (folder_ / name).string();
  }

  RecordedViews open(RecordingOptions options = {}) {
    if (options.path.empty()) options.path = path();
    return {std::move(options), finders_, diagnostics_};
  }

  static std::vector<RecordedView> views_of(const RecordedViews& recording) {
    std::vector<RecordedView> views(recording.standstills());
    recording.read([&](const RecordedStandstill& standstill) {
      views.at(standstill.number) = recording.view(standstill, 0);
    });
    return views;
  }
};

TEST_F(RecordedViewsTest, WarnsOfImagesThatAreNotTheFullOnes) {
  for (const Encoding encoding : {Encoding::cdr, Encoding::ros1}) {
    record({.encoding = encoding, .binning = 2});
    EXPECT_EQ(open().standstills(), 3u);
    ASSERT_EQ(diagnostics_.warnings.size(), 1u);
    EXPECT_THAT(diagnostics_.warnings[0],
                AllOf(HasSubstr("topic 'cam/camera_info'"), HasSubstr("binning 2 x 2")));
    diagnostics_ = {};
  }
}

TEST_F(RecordedViewsTest, EachStandstillGivesAViewWithItsJoints) {
  for (const Encoding encoding : {Encoding::cdr, Encoding::ros1}) {
    record({.encoding = encoding});
    const RecordedViews recording = open();
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_THAT(diagnostics_.warnings, IsEmpty());
    const auto views = views_of(recording);
    ASSERT_EQ(views.size(), tour_.poses.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
      ASSERT_TRUE(views[i].view) << views[i].refusal;
      const View& view = *views[i].view;
      EXPECT_EQ(view.frame, "optical");
      EXPECT_EQ(view.camera.value().p, small_camera().p);
      EXPECT_EQ(view.image.pixels, picture(tour_.poses[i][0]).pixels);
      EXPECT_NEAR(view.joints.position("pan").value(), tour_.poses[i][0], tour_.noise);
      EXPECT_NEAR(view.joints.position("tilt").value(), tour_.poses[i][1], tour_.noise);
      EXPECT_EQ(tour_.pose_at(std::chrono::duration<double>(view.stamp - kTourStart).count()), i);
      EXPECT_EQ(view.joints.stamp, view.stamp);
    }
  }
}

TEST_F(RecordedViewsTest, WithoutJointsThereAreNoViews) {
  record({.joints = false});
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("a.mcap: has no joint positions")));
}

TEST_F(RecordedViewsTest, StampsOfAnotherClockAreAnErrorOrADoubt) {
  record({.camera_ahead = std::chrono::hours(1)});
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("they are of another clock")));
  diagnostics_ = {};
  record({.camera_ahead = std::chrono::milliseconds(1500)});
  (void)open();
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.doubts,
              ElementsAre(HasSubstr("topic 'cam/image': its stamps are 1.500 s ahead of those")));
}

TEST_F(RecordedViewsTest, StampsLaterThanTheirRecordingAreADoubt) {
  for (const int ahead : {60, 150, 800}) {  // messages are recorded 30 ms after their moment
    record({.camera_ahead = milliseconds(ahead)});
    diagnostics_ = {};
    (void)open();
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_THAT(diagnostics_.doubts, ElementsAre(HasSubstr("ahead of those of the joint states")))
        << ahead;
  }
  for (const int ahead : {-300, 0, 40}) {  // latency, or the jitter of exposures
    record({.camera_ahead = milliseconds(ahead)});
    diagnostics_ = {};
    (void)open();
    EXPECT_THAT(diagnostics_.doubts, IsEmpty()) << ahead;
  }
}

TEST_F(RecordedViewsTest, DepthOfAnotherCameraIsAnError) {
  finders_.front().type = "CheckerboardFinder";
  for (const double focal : {60.0, 40.0}) {
    const auto depth = [&](Recorder& to, Stamp stamp, double) {
      CameraInfo own = small_camera();
      own.p[0] = own.p[5] = focal;
      to.camera_info("/depth/camera_info", stamp, own);
      to.depth("/depth/image", stamp, Image<std::uint16_t>(64, 48, 1000));
    };
    record({.more = depth});
    diagnostics_ = {};
    (void)open();
    if (focal == 60.0) {
      EXPECT_THAT(diagnostics_.errors, IsEmpty());
    } else {
      EXPECT_THAT(diagnostics_.errors,
                  ElementsAre(AllOf(HasSubstr("topic 'depth/image': its depth is not registered"),
                                    HasSubstr("focal length 40 px instead of 60 px"),
                                    HasSubstr("record aligned depth"))));
    }
  }
}

TEST_F(RecordedViewsTest, DepthOfAnotherFrameIsAnErrorUnlessTheFrameIsNamed) {
  finders_.front().type = "CheckerboardFinder";
  const auto depth = [](Recorder& to, Stamp stamp, double) {
    to.frame = "depth_optical";
    to.depth("/depth/image", stamp, Image<std::uint16_t>(64, 48, 1000));
    to.frame = "optical";
  };
  record({.more = depth});
  (void)open();
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(AllOf(HasSubstr("frame 'depth_optical' instead of 'optical'"),
                                HasSubstr("name its frame with --frame"))));
  diagnostics_ = {};
  EXPECT_EQ(open({.path = path(), .frame = "optical"}).standstills(), 3U);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
}

/// A wall that a depth camera beside the image's sees at an angle: where the transform is known, points are on it.
TEST_F(RecordedViewsTest, DepthOfAnotherCameraIsProjectedWhereItIsKnownWhereItStands) {
  finders_.front().type = "CheckerboardFinder";
  const Pose<double> housing_T_optical{exp(Vector3<double>(0.0, 0.1, 0.0)), {0.01, 0.0, 0.0}};
  const Pose<double> housing_T_depth{exp(Vector3<double>(0.0, 0.13, 0.0)), {0.06, 0.0, 0.0}};
  const Vector3<double> normal(0.2, 0.0, -1.0), on_wall(0.0, 0.0, 1.0);  // in depth_optical
  CameraInfo own = small_camera();
  own.p[0] = own.p[5] = 50.0;
  Image<std::uint16_t> millimetres(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const Vector3<double> ray((u - 32) / 50.0, (v - 24) / 50.0, 1.0);
      millimetres(u, v) =
          static_cast<std::uint16_t>(std::lround(1000.0 * normal.dot(on_wall) / normal.dot(ray)));
    }
  }
  enum class Known { nowhere, tf, moving, urdf };
  for (const Known known : {Known::nowhere, Known::tf, Known::moving, Known::urdf}) {
    for (const Encoding encoding : {Encoding::cdr, Encoding::ros1}) {
      const auto depth = [&](Recorder& to, Stamp stamp, double time) {
        to.frame = "depth_optical";
        to.camera_info("/depth/camera_info", stamp, own);
        to.depth("/depth/image", stamp, millimetres);
        to.frame = "optical";
        if (known != Known::tf && known != Known::moving) return;
        Pose<double> moved = housing_T_depth;
        if (known == Known::moving) moved.translation.z() = 1e-3 * time;
        to.transform("/tf_static", stamp, "housing", "/optical", housing_T_optical);
        to.transform("/tf", stamp, "housing", "depth_optical", moved);
      };
      record({.encoding = encoding, .more = depth});
      diagnostics_ = {};
      RecordingOptions options;
      if (known == Known::urdf) {
        options.robot =
            Robot("r", {{"a", JointType::fixed, "housing", "optical", housing_T_optical},
                        {"b", JointType::fixed, "housing", "depth_optical", housing_T_depth}});
      }
      const RecordedViews recording = open(options);
      if (known == Known::nowhere || known == Known::moving) {
        EXPECT_THAT(diagnostics_.errors,
                    ElementsAre(AllOf(HasSubstr("depth is not registered to the image"),
                                      HasSubstr("knows where 'depth_optical' stands in 'optical' "
                                                "(record tf and tf_static"))));
        continue;
      }
      EXPECT_THAT(diagnostics_.errors, IsEmpty());
      EXPECT_THAT(diagnostics_.notes, Contains(HasSubstr("from 50.0 mm and 1.72 deg away")));
      const Pose<double> depth_T_optical = housing_T_depth.inverse() * housing_T_optical;
      for (const RecordedView& seen : views_of(recording)) {
        ASSERT_TRUE(seen.view) << seen.refusal;
        const PointCloud& points = seen.view->points;
        ASSERT_EQ(points.width, 64);
        int count = 0;
        for (int v = 0; v < 48; ++v) {
          for (int u = 0; u < 64; ++u) {
            const Vector3<double> p = points(u, v).cast<double>();
            if (!p.allFinite()) continue;
            ++count;
            EXPECT_NEAR(normal.dot(depth_T_optical * p - on_wall), 0.0, 1e-3);
            EXPECT_NEAR(p.x() / p.z(), (u - 32) / 60.0, 1e-6);
          }
        }
        EXPECT_GT(count, 64 * 48 * 9 / 10);
      }
    }
  }
}

TEST_F(RecordedViewsTest, DepthOfTheSameCameraMayBeSmallerThanItsImage) {
  finders_.front().type = "CheckerboardFinder";
  CameraInfo half = small_camera();
  half.width = 32;
  half.height = 24;
  half.p = {30, 0, 15.75, 0, 0, 30, 11.75, 0, 0, 0, 1, 0};
  const auto depth = [&](Recorder& to, Stamp stamp, double) {
    to.camera_info("/depth/camera_info", stamp, half);
    to.depth("/depth/image", stamp, Image<std::uint16_t>(32, 24, 1000));
  };
  record({.more = depth});
  const RecordedViews recording = open();
  ASSERT_THAT(diagnostics_.errors, IsEmpty());
  for (const RecordedView& seen : views_of(recording)) {
    ASSERT_TRUE(seen.view) << seen.refusal;
    const Vector3<double> p = seen.view->points(47, 24).cast<double>();
    EXPECT_LE((p - Vector3<double>(15.0 / 60.0, 0.0, 1.0)).norm(), 1e-6);
  }
}

TEST_F(RecordedViewsTest, JointsThatScatterAtRestAreNamed) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.06);
  const auto worn = [&](Recorder& to, Stamp stamp, double) {
    to.joints("/joint_states", {stamp, {"worn"}, {0.2 + noise(random)}});
  };
  record({.more = worn});
  (void)open();
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(AllOf(HasSubstr("readings of joints 'worn' scatter even at rest"),
                                HasSubstr("(radians or metres)"))));
}

TEST_F(RecordedViewsTest, ARobotThatNeverRestsIsAnErrorThatNamesTheJoint) {
  const auto scanner = [](Recorder& to, Stamp stamp, double time) {
    to.joints("/joint_states", {stamp, {"scanner"}, {3.0 * time}});
  };
  record({.more = scanner});
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("joints 'scanner' always move")));
  diagnostics_ = {};
  EXPECT_EQ(open({.path = path(), .restless = {"scanner"}}).standstills(), 3U);
  (void)open({.path = path(), .restless = {"scaner"}});
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("has no joint 'scaner'; did you mean 'scanner'?")));
}

TEST_F(RecordedViewsTest, ARobotThatAlwaysMovesShouldRest) {
  const auto turning = [](Recorder& to, Stamp stamp, double time) {
    to.joints("/joint_states", {stamp, {"pan", "tilt"}, {0.3 * time, 0.2 * time}});
  };
  record({.joints = false, .more = turning});
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("let it rest for a second in each pose")));
}

TEST_F(RecordedViewsTest, AnImageThatMovesWhileTheJointsRestIsRefused) {
  const auto passer_by = [](double position, double time) {
    const bool second = time > 1.5 && time < 2.5;
    return second ? picture(1.5 * std::sin(20.0 * time)) : picture(position);
  };
  record({.scene = passer_by});
  const auto views = views_of(open());
  ASSERT_EQ(views.size(), 3U);
  EXPECT_TRUE(views[0].view && views[2].view);
  EXPECT_THAT(views[1].refusal, HasSubstr("the image moves although the joints stand still"));
}

TEST_F(RecordedViewsTest, UnknownEncodingsAreRefusedWithTheirTopic) {
  record({.image_encoding = "rainbow"});
  for (const RecordedView& view : views_of(open())) {
    EXPECT_THAT(view.refusal, HasSubstr("topic 'cam/image': images of encoding 'rainbow' are not"));
  }
}

TEST_F(RecordedViewsTest, TheUsersCameraTakesThePlaceOfAMissingOne) {
  record({.camera_info = false});
  EXPECT_FALSE(views_of(open()).at(0).view.value().camera);
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("has no camera_info")));
  diagnostics_ = {};
  const auto views = views_of(open({.path = path(), .frame = "eye", .camera = small_camera()}));
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  EXPECT_TRUE(views.at(0).view.value().camera);
  EXPECT_EQ(views.at(0).view.value().frame, "eye");
}

TEST_F(RecordedViewsTest, ATruncatedRecordingGivesWhatItHas) {
  record({.encoding = Encoding::ros1}, "a.bag");
  const auto size = std::filesystem::file_size(folder_ / "a.bag");
  std::filesystem::resize_file(folder_ / "a.bag", size * 6 / 10);
  const RecordedViews recording = open({.path = path("a.bag")});
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, testing::Contains(HasSubstr("a.bag")));
  const auto views = views_of(recording);
  ASSERT_FALSE(views.empty());
  EXPECT_LT(views.size(), 3U);
  EXPECT_TRUE(views.front().view);
}

TEST_F(RecordedViewsTest, DamagedMessagesAreCounted) {
  const auto uneven = [](Recorder& to, Stamp stamp, double) {
    to.joints("/joint_states", {stamp, {"a", "b"}, {1.0}});
  };
  record({.more = uneven});
  EXPECT_EQ(open().standstills(), 3U);
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("messages cannot be read; the first: it has 2 names of joints "
                                    "and 1 positions")));
}

TEST_F(RecordedViewsTest, FindersOfTheSameTopicsShareACamera) {
  finders_.push_back(finders_.front());
  record();
  const RecordedViews recording = open();
  EXPECT_EQ(recording.cameras().size(), 1U);
  EXPECT_EQ(recording.camera_of(1), 0U);
}

TEST_F(RecordedViewsTest, DepthOfTheSameMomentGivesAPointForEachPixel) {
  finders_.push_back(finders_.front());
  finders_.back().type = "CheckerboardFinder";
  const auto depth = [](Recorder& to, Stamp stamp, double time) {
    const auto distance = static_cast<std::uint16_t>(time < 1.2 ? 1000 : 2000);
    const Stamp late = stamp + std::chrono::milliseconds(10);
    to.depth("/cam/depth", late, Image<std::uint16_t>(64, 48, distance));
  };
  record({.more = depth});
  const RecordedViews recording = open();
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  ASSERT_EQ(recording.cameras().size(), 2U);
  std::vector<float> distances;
  recording.read([&](const RecordedStandstill& standstill) {
    EXPECT_TRUE(recording.view(standstill, 0).view.value().points.empty());
    const View view = recording.view(standstill, recording.camera_of(1)).view.value();
    EXPECT_EQ(view.points.width, view.image.width);
    distances.push_back(view.points(10, 10).z());
  });
  EXPECT_THAT(distances, ElementsAre(1.0F, 2.0F, 2.0F));
}

TEST_F(RecordedViewsTest, WhatIsNotABagIsAnError) {
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("a.mcap: does not exist")));
  diagnostics_ = {};
  write("a.mcap", "samples: []\n");
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("a.mcap: is not a bag")));
}

/// A laser that tilts, in a room.
class RecordedScans : public RecordedViewsTest {
 protected:
  RecordedScans() {
    finders_[0].type = "ScanFinder";
    finders_[0].topic = "/scan";
    finders_[0].settings = ScanFinder{};
  }
  static double tilt_at(double time) { return 0.2 + 0.3 * std::sin(1.2 * time); }

  /// @param time_step  between beams, seconds, as scans say it
  void record_scans(double time_step) {
    constexpr double kStep = 0.5e-3, kFirst = -1.2;  // seconds, radians
    Recorder to(path(), Encoding::ros1);
    to.frame = "laser";
    for (int i = 0; i <= 300; ++i) {
      const Stamp since = milliseconds(10 * i);
      const double time = 0.01 * i;
      to.joints("/joint_states", {kTourStart + since, {"tilt"}, {tilt_at(time)}});
      if (i % 20 != 10) continue;
      std::vector<double> ranges;
      for (int beam = 0; beam <= 120; ++beam) {
        ranges.push_back(
            test::room_range(test::laser_pose(tilt_at(time + kStep * beam)), kFirst + 0.02 * beam));
      }
      ranges[7] = std::numeric_limits<double>::quiet_NaN();
      ranges[8] = 0.01;
      to.scan("/scan", kTourStart + since, kFirst, ranges, time_step);
    }
    to.finish();
  }

  /// The largest distance of a point to the room, metres, of all scans.
  double farthest_off() {
    double most = 0.0;
    for (const RecordedView& seen : views_of(open({.path = path(), .every = milliseconds(400)}))) {
      if (!seen.view) continue;  // joints are not known at the ends
      std::vector<View> parts = seen.later;
      parts.push_back(*seen.view);
      ++scans_;
      for (const View& part : parts) {
        EXPECT_EQ(part.frame, "laser");
        const Pose<double> laser = test::laser_pose(part.joints.position("tilt").value());
        for (const Vector3<float>& point : part.points.pixels) {
          if (!point.allFinite()) continue;
          ++points_;
          most = std::max(most, test::off_room(laser * Vector3<double>(point.cast<double>())));
        }
      }
    }
    return most;
  }
  int scans_ = 0, points_ = 0;
};

TEST_F(RecordedScans, GiveEachBeamTheJointsOfItsTime) {
  record_scans(0.5e-3);
  EXPECT_LT(farthest_off(), 4e-3) << "a quarter of a milliradian at ranges up to 10 m";
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  EXPECT_GE(scans_, 5);
  EXPECT_GT(points_, 60 * scans_) << "some beams leave the room or range_max";
}

TEST_F(RecordedScans, WithoutTimesOfBeamsAreAWarning) {
  record_scans(0.0);
  EXPECT_GT(farthest_off(), 5e-3);
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("topic 'scan': 15 scans have no time_increment")));
}

TEST_F(RecordedScans, WithoutJointStatesAreAnError) {
  Recorder to(path(), Encoding::ros1);
  to.scan("/scan", kTourStart, -1.0, {1.0, 1.0, 1.0}, 1e-3);
  to.finish();
  (void)open();
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("joint")));
}

}  // namespace
}  // namespace kinecal
