// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/image_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "kinecal/files/images/png_bytes.hpp"
#include "support/error_of.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

class ImageFolderTest : public testing::Test {
 protected:
  ImageFolderTest() {
    std::filesystem::create_directories(path("images"));
    std::filesystem::create_directories(path("depth"));
    for (const char* name : {"a.png", "b.png"}) {
      write("images/" + std::string(name), detail::png_bytes(GrayImage(4, 3, 7)));
      write("depth/" + std::string(name), detail::png_bytes(Image<std::uint16_t>(4, 3, 1500)));
    }
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
  }
  [[nodiscard]] std::vector<PosedImage> list(const std::string& table,
                                             const std::string& columns = "") {
    write("poses.csv", table);
    return list_images({path("images"), path("poses.csv"), columns, path("depth")}, diagnostics_);
  }

  /// The name of a photograph: "shot7 (640x480).png".
  [[nodiscard]] static std::string shot(int number) {
    return "shot" + std::to_string(number) + " (640x480).png";
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(ImageFolderTest, AColumnNamesTheImageAndTheOthersAreJoints) {
  const auto images = list("image,q1,q2\nb.png,0.5,-1\na.png,0.25,2\n");
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].path, path("images/b.png"));
  EXPECT_THAT(images[0].joints.names, ElementsAre("q1", "q2"));
  EXPECT_THAT(images[0].joints.positions, ElementsAre(0.5, -1.0));
  EXPECT_EQ(images[1].source, path("poses.csv") + ":3");
}

TEST_F(ImageFolderTest, TheColumnOfImagesMayHaveAnyNameIfItsCellsAreImages) {
  for (const char* name : {"Image", "FILENAME", "photo"}) {
    const auto images = list(std::string("q1,") + name + "\n0.5,b.png\n0.25,a.png\n");
    ASSERT_EQ(images.size(), 2u) << name;
    EXPECT_EQ(images[0].path, path("images/b.png"));
    EXPECT_THAT(images[0].joints.names, ElementsAre("q1"));
  }
}

TEST_F(ImageFolderTest, WithoutNamesRowsAreInTheOrderOfTheSortedFiles) {
  const auto images = list("q1;q2\n1;2\n3;4\n");
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].path, path("images/a.png"));
  EXPECT_THAT(images[1].joints.positions, ElementsAre(3.0, 4.0));
}

TEST_F(ImageFolderTest, WithoutNamesNumbersInNamesAreNumbers) {
  for (const char* name : {"a.png", "b.png"}) {
    std::filesystem::remove(path(std::string("images/") + name));
  }
  std::string table = "q1\n";
  for (int i = 1; i <= 12; ++i) {
    for (const char* folder : {"images/", "depth/"}) write(folder + shot(i), "");
    table += std::to_string(i) + "\n";
  }
  const auto images = list(table);
  EXPECT_THAT(diagnostics_.errors, testing::IsEmpty());
  ASSERT_EQ(images.size(), 12u);
  for (int i = 1; i <= 12; ++i) {
    const PosedImage& image = images[static_cast<std::size_t>(i - 1)];
    EXPECT_EQ(image.path, path("images/" + shot(i)));
    EXPECT_EQ(image.depth, path("depth/" + shot(i)));
    EXPECT_THAT(image.joints.positions, ElementsAre(i));
  }
}

TEST_F(ImageFolderTest, ColumnsOfAFileMayBeInDegrees) {
  write("columns.yaml",
        "joints: {unit: degrees, columns: {elbow: q1}}\n"
        "observations:\n - {sensor: arm, frame: board, constant: [0, 0, 0]}\n");
  const auto images = list("image,q1\na.png,180\nb.png,90\n", path("columns.yaml"));
  ASSERT_EQ(images.size(), 2u);
  EXPECT_THAT(images[0].joints.names, ElementsAre("elbow"));
  EXPECT_DOUBLE_EQ(images[0].joints.positions[0], std::numbers::pi);
}

TEST_F(ImageFolderTest, PosesMayBeInATextFileForEachImage) {
  std::filesystem::create_directories(path("poses"));
  write("poses/a.txt", "1 0 0 0.5\n0 0 -1 0.1\n0 1 0 0.3\n");
  write("poses/b.txt", "[1, 0, 0, 0.7],\n[0, 1, 0, 0.1],\n[0, 0, 1, 0.3]\n");
  write("columns.yaml",
        "poses:\n  flange: {form: matrix, columns: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, "
        "11, 12]}\n");
  const ImageFolder folder{path("images"), path("poses"), path("columns.yaml"), ""};
  const auto images = list_images(folder, diagnostics_);
  EXPECT_THAT(diagnostics_.errors, testing::IsEmpty());
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].path, path("images/a.png"));
  EXPECT_EQ(images[0].joints.poses.at("flange").translation, Vector3<double>(0.5, 0.1, 0.3));
  EXPECT_EQ(images[0].joints.poses.at("flange").rotation(1, 2), -1.0);
  EXPECT_EQ(images[1].joints.poses.at("flange").translation.x(), 0.7);
  write("poses/b.txt", "1 2 3\n");
  EXPECT_THAT(error_of([&] { (void)list_images(folder, diagnostics_); }),
              HasSubstr("b.txt: has 3 numbers, but a.txt has 12"));
}

TEST_F(ImageFolderTest, EveryRowNeedsItsImageAndEveryImageItsRow) {
  (void)list("image,q1\na.png,1\na.png,2\nc.png,3\n");
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr(":3: image 'a.png' has a row already"),
                                               HasSubstr(":4: image 'c.png' is not in "),
                                               HasSubstr("has no row for image b.png")));
}

TEST_F(ImageFolderTest, AnotherCameraMayHaveTheImageOfARow) {
  std::filesystem::create_directories(path("right"));
  write("right/c.png", detail::png_bytes(GrayImage(4, 3, 7)));
  write("poses.csv", "image,q1\na.png,1\nc.png,2\nb.png,3\n");
  const auto images =
      list_images({path("images"), path("poses.csv"), "", "", {path("right")}}, diagnostics_);
  EXPECT_THAT(diagnostics_.errors, testing::IsEmpty());
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[1].path, path("images/b.png"));
  write("poses.csv", "image,q1\na.png,1\nc.png,2\nb.png,3\nd.png,4\n");
  (void)list_images({path("images"), path("poses.csv"), "", "", {path("right")}}, diagnostics_);
  EXPECT_THAT(diagnostics_.errors,
              testing::ElementsAre(testing::HasSubstr("image 'd.png' is not in " + path("images") +
                                                      ", nor in that of another camera")));
}

TEST_F(ImageFolderTest, MoreRowsThanImagesAreAnErrorWithBothNumbers) {
  (void)list("q1\n1\n2\n3\n");
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(HasSubstr("there is no image for this row: the table has 3 rows")));
}

TEST_F(ImageFolderTest, AFolderWithoutImagesIsAnError) {
  Diagnostics diagnostics;
  write("poses.csv", "q1\n1\n");
  EXPECT_THAT(
      error_of([&] {
        (void)list_images({folder_.path().string(), path("poses.csv"), "", ""}, diagnostics);
      }),
      HasSubstr("has no PNG, JPEG, BMP or TIFF images"));
}

#ifdef KINECAL_HAVE_PNG
TEST_F(ImageFolderTest, AViewHasTheImageItsPointsAndTheJoints) {
  CameraInfo camera;
  camera.width = 4;
  camera.height = 3;
  camera.p = {2, 0, 1, 0, 0, 2, 1, 0, 0, 0, 1, 0};
  const auto images = list("image,q1\na.png,1\nb.png,2\n");
  ASSERT_EQ(images.size(), 2u);
  const View view = read_view(images[0], camera, "optical");
  EXPECT_EQ(view.frame, "optical");
  EXPECT_EQ(view.image(3, 2), 7);
  EXPECT_FLOAT_EQ(view.points(3, 1).x(), 1.5F);
  EXPECT_EQ(view.joints.position("q1"), 1.0);
}

TEST_F(ImageFolderTest, DepthOfAnotherSizeIsAnErrorThatNamesBoth) {
  write("depth/a.png", detail::png_bytes(Image<std::uint16_t>(5, 3, 1500)));
  const auto images = list("image,q1\na.png,1\nb.png,2\n");
  ASSERT_EQ(images.size(), 2u);
  const std::string error = error_of([&] { (void)read_view(images[0], CameraInfo{}, "optical"); });
  EXPECT_THAT(error, HasSubstr("depth/a.png: has 5x3 pixels, but "));
  EXPECT_THAT(error, HasSubstr("images/a.png has 4x3"));
}
#endif

TEST_F(ImageFolderTest, AMissingFolderOfDepthIsOneError) {
  write("poses.csv", "q1\n1\n2\n");
  EXPECT_THAT(
      error_of([&] {
        (void)list_images({path("images"), path("poses.csv"), "", path("none")}, diagnostics_);
      }),
      HasSubstr("none: is not a folder with images of depth"));
}

TEST_F(ImageFolderTest, ATableWithoutRowsIsOneError) {
  EXPECT_TRUE(list("image,q1\n").empty());
  EXPECT_THAT(diagnostics_.errors, ElementsAre(HasSubstr("poses.csv: the table has no rows")));
}

}  // namespace
}  // namespace kinecal
