// kinecal detect as users of recordings meet it: a robot that moved through poses becomes samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/tools/detect/image_folder.hpp"
#include "support/paths.hpp"
#include "support/recording.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::Recorder;
using testing::HasSubstr;

/// A picture whose content is some columns further right.
GrayImage moved(const GrayImage& image, int columns) {
  GrayImage result = image;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) result((u + columns) % image.width, v) = image(u, v);
  }
  return result;
}

class DetectRecording : public test::ProgramTest {
 protected:
  DetectRecording() {
    fs::copy(fs::path(test::source_folder()) / "examples/robots/panda/panda.urdf", folder_);
  }

  /// Photographs of four poses, and a recording in which the robot stands a second in each.
  void record(const std::string& bag, Encoding encoding, bool compressed) {
    if (!fs::exists(folder_ / "photos")) {
      const Outcome made = kinecal("simulate panda.urdf --target apriltag --poses 4 -o photos");
      ASSERT_EQ(made.code, 0) << made.err;
    }
    Diagnostics diagnostics;
    const std::string photos = (folder_ / "photos").string();
    const auto images =
        list_images({photos + "/images", photos + "/poses.csv", "", ""}, diagnostics);
    const CameraInfo camera = read_camera_file(photos + "/camera.yaml", diagnostics);
    diagnostics.throw_if_errors();
    tour_ = {images.front().joints.names, {}};
    std::vector<std::string> files;
    for (const PosedImage& image : images) {
      tour_.poses.push_back(image.joints.positions);
      files.push_back(read(fs::path(image.path).lexically_relative(folder_)));
    }
    Recorder to((folder_ / bag).string(), encoding);
    to.camera_info("/eye/camera_info", test::kTourStart, camera);
    test::play(
        tour_,
        [&](Stamp stamp, double time) {
          to.joints("/joint_states", {stamp, tour_.names, tour_.positions(time)});
        },
        [&](Stamp stamp, double time) {
          const std::string& file = files[tour_.pose_at(time)];
          const int columns = static_cast<int>(100.0 * tour_.progress_at(time));
          if (compressed && columns == 0)
            return to.compressed("/eye/image/compressed", stamp, file);
          const GrayImage image = moved(decode_image(file, "photo"), columns);
          if (!compressed) return to.image("/eye/image", stamp, image);
          to.compressed("/eye/image/compressed", stamp, detail::png_bytes(image));
        });
    to.finish();
  }

  test::Tour tour_;
};

const std::string kPhotos =
    " --images photos/images --poses photos/poses.csv --camera photos/camera.yaml --frame optical ";

#if defined(KINECAL_HAVE_PNG) && defined(KINECAL_HAVE_APRILTAG)
TEST_F(DetectRecording, EachStandstillGivesTheSampleOfItsPhotograph) {
  record("drive.mcap", Encoding::cdr, true);
  record("drive.bag", Encoding::ros1, false);
  ASSERT_EQ(kinecal("detect photos/capture.yaml -o photos.yaml" + kPhotos).code, 0);
  const std::vector<Sample> expected = test::samples_in(folder_ / "photos.yaml");
  for (const std::string bag : {"drive.mcap", "drive.bag"}) {
    const Outcome found = kinecal("detect photos/capture.yaml --bag " + bag + " -o " + bag +
                                  ".yaml --contact-sheet " + bag + ".html");
    ASSERT_EQ(found.code, 0) << found.err;
    EXPECT_THAT(found.out, HasSubstr(": 4 of 4 standstills: "));
    EXPECT_THAT(found.err, HasSubstr("takes images from topic 'eye/image"));
    EXPECT_THAT(read(bag + ".html"), HasSubstr("4  " + bag + " at "));
    const std::vector<Sample> seen = test::samples_in(folder_ / (bag + ".yaml"));
    ASSERT_EQ(seen.size(), expected.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t j = 0; j < tour_.names.size(); ++j) {
        EXPECT_NEAR(seen[i].position(tour_.names[j]).value(), tour_.poses[i][j], tour_.noise);
      }
      const auto& features = seen[i].observations.at(0).features;
      const auto& of_photo = expected[i].observations.at(0).features;
      ASSERT_EQ(features.size(), of_photo.size());
      EXPECT_EQ(features.front().point, of_photo.front().point);
      EXPECT_EQ(features.front().frame, "optical");
      EXPECT_TRUE(seen[i].observations.at(0).camera);
    }
  }
}

TEST_F(DetectRecording, PhotographsAndRecordingsGoTogetherOnAnyNumberOfThreads) {
  record("drive.mcap", Encoding::cdr, true);
  const std::string both = "detect photos/capture.yaml --bag drive.mcap" + kPhotos;
  const Outcome found = kinecal(both + "--threads 1 --contact-sheet one.html -o one.yaml");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr(": 8 of 8 views: "));
  ASSERT_EQ(kinecal(both + "--threads 3 --contact-sheet many.html -o many.yaml").code, 0);
  EXPECT_EQ(read("many.yaml"), read("one.yaml"));
  EXPECT_EQ(read("many.html"), read("one.html"));
}

TEST_F(DetectRecording, ATruncatedRecordingGivesWhatItHas) {
  record("drive.bag", Encoding::ros1, false);
  fs::resize_file(folder_ / "drive.bag", fs::file_size(folder_ / "drive.bag") / 2);
  const Outcome found = kinecal("detect photos/capture.yaml --bag drive.bag -o samples.yaml");
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.err, HasSubstr("warning: drive.bag: "));
  EXPECT_GE(test::samples_in(folder_ / "samples.yaml").size(), 1U);
}
#endif

#if defined(KINECAL_HAVE_PNG) && defined(KINECAL_HAVE_OPENCV)
TEST_F(DetectRecording, TurnedBoardsArePutRightWhereTheRobotIsKnown) {
  write("scene.yaml", "seed: 1\ntarget: {type: checkerboard, columns: 6, rows: 4}\n");
  ASSERT_EQ(kinecal("simulate panda.urdf --scene scene.yaml --poses 6 -o photos").code, 0);
  const std::string photos =
      "detect photos/capture.yaml --images photos/images --poses photos/poses.csv --camera "
      "photos/camera.yaml --frame camera_color_optical_frame --force -o samples.yaml ";
  EXPECT_THAT(kinecal(photos).err, HasSubstr("Give --urdf, --board-link"));
  const std::vector<Sample> before = test::samples_in(folder_ / "samples.yaml");
  const Outcome found = kinecal(photos + "--urdf panda.urdf --board-link panda_link0");
  EXPECT_THAT(found.err, HasSubstr("note: photos/capture.yaml:2: finder 'checkerboard_finder': the "
                                   "board was turned in "));
  const std::vector<Sample> after = test::samples_in(folder_ / "samples.yaml");
  ASSERT_EQ(after.size(), before.size());
  std::size_t turned = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto& was = before[i].observation("camera")->features;
    const auto& is = after[i].observation("camera")->features;
    if (is.front().point == was.front().point) continue;
    EXPECT_EQ(is.front().point, was.back().point);
    ++turned;
  }
  EXPECT_GT(turned, 0U);
  EXPECT_LE(2 * turned, after.size());
  EXPECT_THAT(kinecal(photos + "--urdf panda.urdf --board-link panda_link").err,
              HasSubstr("--board-link: the robot has no link 'panda_link'; did you mean"));
}
#endif

TEST_F(DetectRecording, WhatIsMissingIsNamed) {
  write("capture.yaml",
        "features:\n  board:\n    type: robot_calibration/CheckerboardFinder2d\n    topic: /eye\n");
  Recorder to((folder_ / "eyes.mcap").string(), Encoding::cdr);
  for (const char* topic : {"left/image", "right/image"}) {
    to.image(topic, test::kTourStart, GrayImage(8, 8));
  }
  to.finish();
  const Outcome failed = kinecal("detect --bag eyes.mcap capture.yaml -o samples.yaml");
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("error: eyes.mcap: has no joint positions"));
  EXPECT_THAT(failed.err,
              HasSubstr("error: capture.yaml:2: finder 'board': eyes.mcap has images on "
                        "topics 'left/image', 'right/image'; name one"));
  EXPECT_THAT(kinecal("detect capture.yaml -o samples.yaml").err,
              HasSubstr("give photographs (--images and --frame), masks (--masks and --frame) or "
                        "recordings (--bag)"));
  EXPECT_THAT(kinecal("detect capture.yaml --bag eyes.mcap --board-link a -o samples.yaml").err,
              HasSubstr("--urdf"));
}

TEST_F(DetectRecording, ARecordingGivenTwiceIsRefused) {
  write("capture.yaml",
        "features:\n  board:\n    type: robot_calibration/CheckerboardFinder2d\n    topic: /eye\n");
  Recorder to((folder_ / "one.mcap").string(), Encoding::cdr);
  to.image("eye", test::kTourStart, GrayImage(8, 8));
  to.finish();
  fs::copy(folder_ / "one.mcap", folder_ / "copy.mcap");
  fs::create_symlink("one.mcap", folder_ / "link.mcap");
  fs::create_directory(folder_ / "folder");
  fs::copy(folder_ / "one.mcap", folder_ / "folder/0.mcap");
  for (const std::string other : {"one.mcap", "./one.mcap", "copy.mcap", "link.mcap", "folder"}) {
    const Outcome twice = kinecal("detect capture.yaml -o s.yaml --bag one.mcap --bag " + other);
    EXPECT_EQ(twice.code, 1) << other;
    EXPECT_THAT(twice.err, HasSubstr("--bag: " + other + " is the same recording as one.mcap"));
  }
  std::string changed = read("copy.mcap");
  changed.back() = static_cast<char>(~changed.back());
  write("copy.mcap", changed);
  EXPECT_THAT(kinecal("detect capture.yaml -o s.yaml --bag one.mcap --bag copy.mcap").err,
              testing::Not(HasSubstr("is the same recording")));
}

TEST_F(DetectRecording, DepthThatIsNotRecordedIsAnError) {
  write("capture.yaml",
        "features:\n  board:\n    type: robot_calibration/CheckerboardFinder2d\n    topic: /eye\n");
  Recorder to((folder_ / "eye.mcap").string(), Encoding::cdr);
  to.image("eye", test::kTourStart, GrayImage(8, 8));
  to.finish();
  const Outcome failed = kinecal("detect capture.yaml -o s.yaml --bag eye.mcap --depth /eye/depth");
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err,
              HasSubstr("eye.mcap: --depth: has no topic 'eye/depth' of depth; it has none"));
}

}  // namespace
}  // namespace kinecal
