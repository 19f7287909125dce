#include "kinecal/config/cameras/later_cameras.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera_rig.hpp"
#include "support/cameras_alone.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A rig whose first samples are in one file, the others in another.
struct TwoFiles {
  static constexpr std::size_t kFirst = 18;

  explicit TwoFiles(const std::string& lens = "equidistant")
      : rig(test::two_fisheyes()),
        first(test::cameras_config({"left", "right"}, lens, "k1 k2 k3 k4"),
              {rig.samples.begin(), rig.samples.begin() + kFirst}),
        later(rig.samples.begin() + kFirst, rig.samples.end()) {}
  bool prepare() {
    return prepare_later_cameras(first.robot, first.config, first.samples, later, diagnostics);
  }
  [[nodiscard]] Observation& seen(std::size_t sample, const std::string& sensor) {
    for (Observation& one : later[sample].observations) {
      if (one.sensor == sensor) return one;
    }
    throw std::logic_error("no " + sensor);
  }

  test::Rig rig;
  test::Cameras first;
  std::vector<Sample> later;
  Diagnostics diagnostics;
};

TEST(LaterCameras, AreThoseOfTheFirstFile) {
  TwoFiles files;
  ASSERT_TRUE(files.prepare());
  EXPECT_THAT(files.diagnostics.notes, IsEmpty());
  for (const char* name : {"left", "right"}) {
    const CameraInfo& first = *files.first.samples[1].observation(name)->camera;
    const CameraInfo& later = *files.later[1].observation(name)->camera;
    EXPECT_EQ(later.k, first.k);
    EXPECT_EQ(later.d, first.d);
    EXPECT_EQ(later.distortion_model, first.distortion_model);
    EXPECT_EQ(later.width, 1280);
  }
  for (std::size_t s = 0; s < files.later.size(); ++s) {
    const Pose<double>& found = files.later[s].poses.at("board");
    const Pose<double>& truth = files.rig.boards[TwoFiles::kFirst + s];
    EXPECT_LE((found.translation - truth.translation).norm(), 0.01) << s;
    EXPECT_LE((found.rotation - truth.rotation).norm(), 0.02) << s;
  }
}

/// Where the second camera stands is known from the first file.
TEST(LaterCameras, APoseThatOnlyTheSecondCameraShows) {
  TwoFiles files;
  constexpr std::size_t kBoth = 1;  // of the later samples: 19 of all
  std::erase_if(files.later[kBoth].observations,
                [](const Observation& seen) { return seen.sensor == "left"; });
  ASSERT_TRUE(files.prepare());
  const Pose<double>& found = files.later[kBoth].poses.at("board");
  const Pose<double>& truth = files.rig.boards[TwoFiles::kFirst + kBoth];
  EXPECT_LE((found.translation - truth.translation).norm(), 0.01);
}

TEST(LaterCameras, AFileMayLackACamera) {
  TwoFiles files;
  for (Sample& sample : files.later) {
    std::erase_if(sample.observations,
                  [](const Observation& seen) { return seen.sensor == "right"; });
  }
  EXPECT_TRUE(files.prepare());
  EXPECT_TRUE(files.later[0].poses.contains("board"));
}

TEST(LaterCameras, ImagesOfAnotherSizeAreAnError) {
  TwoFiles files;
  for (std::size_t s = 0; s < files.later.size(); ++s) files.seen(s, "left").camera->width = 640;
  EXPECT_FALSE(files.prepare());
  EXPECT_THAT(files.diagnostics.errors,
              ElementsAre(AllOf(HasSubstr("camera 'left': images of two sizes: 1280x960 at view 0"),
                                HasSubstr("640x960 at view 18"))));
}

TEST(LaterCameras, ViewsWithoutFourCornersAreLeftOut) {
  for (const std::size_t spoiled : {3U, 12U}) {
    TwoFiles files;
    for (std::size_t s = 0; s < spoiled; ++s) {
      for (Observation& seen : files.later[s].observations) {
        if (seen.sensor != "board" && seen.features.size() > 3) seen.features.resize(3);
      }
    }
    EXPECT_EQ(files.prepare(), spoiled < files.later.size());
    if (spoiled < files.later.size()) {
      EXPECT_THAT(files.diagnostics.notes,
                  ElementsAre(AllOf(HasSubstr("view 18"), HasSubstr("no camera shows where"),
                                    HasSubstr("2 more"))));
      EXPECT_EQ(files.later[0].observation("board"), nullptr);
    } else {
      EXPECT_THAT(
          files.diagnostics.errors,
          ElementsAre(AllOf(HasSubstr("view 18"), HasSubstr("in any sample of this file"))));
    }
  }
}

/// The first file has decided about the lens; a camera with other intrinsics is another one.
TEST(LaterCameras, OnlyACameraWithTheSameIntrinsicsGetsTheLens) {
  TwoFiles files;
  const CameraInfo first = *files.first.samples[0].observation("left")->camera;
  CameraInfo same = first, other = first;
  same.d = {0.5, 0.0, 0.0, 0.0};
  other.k[0] *= 1.1;
  files.seen(0, "left").camera = same;
  files.seen(1, "left").camera = other;
  ASSERT_TRUE(files.prepare());
  EXPECT_EQ(files.seen(0, "left").camera->d, first.d);
  EXPECT_EQ(files.seen(1, "left").camera->k, other.k);
}

}  // namespace
}  // namespace kinecal
