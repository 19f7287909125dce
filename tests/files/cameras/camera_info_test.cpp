#include "kinecal/files/cameras/camera_info.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <string>
#include <vector>

#include "support/camera_infos.hpp"

namespace kinecal {
namespace {

using test::right_camera_of_a_stereo_pair;

TEST(CameraInfo, FileHasTheKeysThatDriversRead) {
  const YAML::Node file = YAML::Load(to_camera_info_yaml(right_camera_of_a_stereo_pair(), "head"));
  EXPECT_EQ(file.size(), 8u);
  EXPECT_EQ(file["image_width"].as<int>(), 640);
  EXPECT_EQ(file["image_height"].as<int>(), 480);
  EXPECT_EQ(file["camera_name"].as<std::string>(), "head");
  EXPECT_EQ(file["distortion_model"].as<std::string>(), "plumb_bob");
  const auto expect_size = [&](const char* matrix, int rows, int cols) {
    EXPECT_EQ(file[matrix]["rows"].as<int>(), rows) << matrix;
    EXPECT_EQ(file[matrix]["cols"].as<int>(), cols) << matrix;
    EXPECT_EQ(file[matrix]["data"].size(), static_cast<std::size_t>(rows * cols)) << matrix;
  };
  expect_size("camera_matrix", 3, 3);
  expect_size("distortion_coefficients", 1, 5);
  expect_size("rectification_matrix", 3, 3);
  expect_size("projection_matrix", 3, 4);
}

TEST(CameraInfo, FileKeepsEveryDigit) {
  const CameraInfo camera = right_camera_of_a_stereo_pair();
  const YAML::Node file = YAML::Load(to_camera_info_yaml(camera, "head"));
  EXPECT_EQ((file["camera_matrix"]["data"].as<std::array<double, 9>>()), camera.k);
  EXPECT_EQ((file["rectification_matrix"]["data"].as<std::array<double, 9>>()), camera.r);
  EXPECT_EQ((file["projection_matrix"]["data"].as<std::array<double, 12>>()), camera.p);
  EXPECT_EQ(file["distortion_coefficients"]["data"].as<std::vector<double>>(), camera.d);
}

TEST(CameraInfo, FileOfACameraWithoutDistortionIsStillYaml) {
  const YAML::Node file = YAML::Load(to_camera_info_yaml(CameraInfo{}, "a: b"));
  EXPECT_EQ(file["distortion_coefficients"]["cols"].as<int>(), 0);
  EXPECT_EQ(file["distortion_coefficients"]["data"].size(), 0u);
  EXPECT_EQ(file["camera_name"].as<std::string>(), "a: b");
  EXPECT_EQ(file["distortion_model"].as<std::string>(), "");
}

TEST(CameraInfo, IsBlankOnlyIfEverythingIsZero) {
  EXPECT_TRUE(is_blank(CameraInfo{}));
  EXPECT_FALSE(is_blank(right_camera_of_a_stereo_pair()));
  CameraInfo camera;
  camera.p[0] = 500.0;
  EXPECT_FALSE(is_blank(camera));
}

}  // namespace
}  // namespace kinecal
