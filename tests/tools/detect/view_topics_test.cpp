// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/view_topics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const RecordedTopic kImage{"cam/image_raw", "sensor_msgs/Image", "rgb8"};
const RecordedTopic kCompressed{"cam/image_raw/compressed", "sensor_msgs/CompressedImage",
                                "rgb8; jpeg compressed bgr8"};
const RecordedTopic kDepth{"cam/depth", "sensor_msgs/Image", "16UC1"};
const RecordedTopic kCloud{"cam/points", "sensor_msgs/PointCloud2", ""};
const RecordedTopic kInfo{"cam/camera_info", "sensor_msgs/CameraInfo", ""};
const RecordedTopic kOther{"side/image", "sensor_msgs/Image", "mono8"};

CaptureFinder finder(const std::string& type, const std::string& topic) {
  return {"board", type, topic, topic + "_info", "", CheckerboardSettings{}, {"c.yaml", 3}};
}
const std::string kPixels = "CheckerboardFinder2d", kPoints = "CheckerboardFinder";

struct Chosen {
  ViewTopics topics;
  Diagnostics diagnostics;
};
Chosen choose(const std::vector<RecordedTopic>& recorded, const CaptureFinder& wanted,
              const ViewWishes& wishes = {"a.bag"}) {
  Chosen chosen;
  chosen.topics = choose_topics(recorded, {wanted}, wishes, chosen.diagnostics).at(0);
  return chosen;
}

TEST(ViewTopics, ThoseOfTheConfigurationAreTaken) {
  const Chosen chosen =
      choose({kOther, kImage, kCompressed, kInfo}, finder(kPixels, "/cam/image_raw"));
  EXPECT_EQ(chosen.topics, (ViewTopics{"cam/image_raw", "", "", "cam/camera_info"}));
  EXPECT_THAT(chosen.diagnostics.errors, IsEmpty());
  EXPECT_THAT(chosen.diagnostics.notes, IsEmpty());
}

TEST(ViewTopics, CompressedImagesStandForRawOnes) {
  const Chosen chosen = choose({kOther, kCompressed, kInfo}, finder(kPixels, "cam/image_raw"));
  EXPECT_EQ(chosen.topics.image, "cam/image_raw/compressed");
  EXPECT_EQ(chosen.topics.camera_info, "cam/camera_info");
}

TEST(ViewTopics, TheOnlyCandidateIsTakenWithANote) {
  const Chosen chosen = choose({kImage, kCompressed, kDepth, kInfo}, finder(kPixels, "/points"));
  EXPECT_EQ(chosen.topics.image, "cam/image_raw");
  EXPECT_THAT(chosen.diagnostics.notes,
              ElementsAre(HasSubstr("c.yaml:3: finder 'board': takes images from topic "
                                    "'cam/image_raw' of a.bag, the only one")));
}

TEST(ViewTopics, SeveralCandidatesAreListed) {
  const Chosen chosen = choose({kImage, kOther, kInfo}, finder(kPixels, "/points"));
  EXPECT_THAT(
      chosen.diagnostics.errors,
      ElementsAre(HasSubstr("a.bag has images on topics 'cam/image_raw', 'side/image'; name "
                            "one as the finder's topic, which is 'points'")));
}

TEST(ViewTopics, WithoutACandidateTheTopicHasToBeRecorded) {
  EXPECT_THAT(choose({kCloud, kInfo}, finder(kPixels, "/image")).diagnostics.errors,
              ElementsAre(HasSubstr("a.bag has images on no topic; record 'image'")));
}

TEST(ViewTopics, OnlyAScanFinderLooksForScans) {
  const RecordedTopic scan{"base_scan", "sensor_msgs/LaserScan", ""};
  EXPECT_EQ(choose({kCloud, scan, kInfo}, finder(kPoints, "/x")).topics.cloud, "cam/points");
  EXPECT_EQ(choose({kCloud, scan}, finder(kPoints, "/base_scan")).topics,
            (ViewTopics{"", "", "base_scan", ""}));
  CaptureFinder of_scans = finder("ScanFinder", "/x");
  of_scans.settings = ScanFinder{};
  const Chosen chosen = choose({kImage, kCloud, scan, kInfo}, of_scans);
  EXPECT_EQ(chosen.topics, (ViewTopics{"", "", "base_scan", ""}));
  EXPECT_THAT(chosen.diagnostics.notes,
              ElementsAre(HasSubstr("takes scans from topic 'base_scan'")));
  EXPECT_EQ(choose({kImage, kCloud}, of_scans).topics.cloud, "cam/points");
  EXPECT_THAT(choose({kImage}, of_scans).diagnostics.errors,
              ElementsAre(HasSubstr("scans or clouds on no topic")));
}

TEST(ViewTopics, PointsComeFromACloudOrFromDepthBesideAnImage) {
  EXPECT_EQ(choose({kImage, kCloud, kInfo}, finder(kPoints, "/x")).topics.cloud, "cam/points");
  const Chosen depth = choose({kImage, kDepth, kInfo}, finder(kPoints, "/cam/image_raw"));
  EXPECT_EQ(depth.topics, (ViewTopics{"cam/image_raw", "cam/depth", "", "cam/camera_info"}));
  EXPECT_EQ(choose({kImage, kDepth, kInfo}, finder(kPoints, "/cam/depth")).topics, depth.topics);
  EXPECT_THAT(choose({kImage, kInfo}, finder(kPoints, "/cam/image_raw")).diagnostics.errors,
              ElementsAre(HasSubstr("depth for 'cam/image_raw' on no topic")));
  const Chosen named = choose({kImage, kDepth, kInfo, {"far", "sensor_msgs/Image", "32FC1"}},
                              finder(kPoints, "/cam/image_raw"), {"a.bag", "/far"});
  EXPECT_EQ(named.topics.depth, "far");
}

TEST(ViewTopics, AMissingCameraIsAWarningAndSeveralAreAnError) {
  EXPECT_THAT(choose({kImage}, finder(kPixels, "cam/image_raw")).diagnostics.warnings,
              ElementsAre(HasSubstr("a.bag has no camera_info; give the camera with --camera")));
  EXPECT_THAT(
      choose({kImage}, finder(kPixels, "cam/image_raw"), {"a.bag", "", true}).diagnostics.warnings,
      IsEmpty());
  const RecordedTopic left{"l/camera_info", kInfo.type}, right{"r/camera_info", kInfo.type};
  EXPECT_THAT(choose({kImage, left, right}, finder(kPixels, "cam/image_raw")).diagnostics.errors,
              ElementsAre(HasSubstr("camera_info on topics 'l/camera_info', 'r/camera_info'")));
}

TEST(ViewTopics, SixteenBitGrayIsDepthIfItsNameSaysSo) {
  const RecordedTopic depth{"cam/depth/image_raw", "sensor_msgs/Image", "mono16"},
      infrared{"cam/infra/image_raw", "sensor_msgs/Image", "mono16"};
  const Chosen chosen = choose({kImage, depth, kInfo}, finder(kPoints, "/cam/image_raw"));
  EXPECT_EQ(chosen.topics.depth, depth.name);
  EXPECT_EQ(choose({infrared, kInfo}, finder(kPixels, "/x")).topics.image, infrared.name);
  EXPECT_EQ(camera_info_beside("cam/depth/image/compressedDepth"), "cam/depth/camera_info");
}

}  // namespace
}  // namespace kinecal
