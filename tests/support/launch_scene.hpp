// On disk: the result of a calibration, and a robot's folder to install it into.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "support/temporary_folder.hpp"

namespace kinecal::test {

/// As on Fetch: some CRLF, comments that look like settings, both kinds of quotes.
inline const char* const kLaunch =
    "<?xml version=\"1.0\"?>\r\n"
    "<launch>\n"
    "  <!-- <param name=\"calibration_date\" value=\"a comment\"/> -->\n"
    "  <param name=\"calibration_date\" value='uncalibrated'/>\r\n"
    "  <param name=\"robot_description\" textfile=\"$(find robot)/robot.urdf\" />\n"
    "  <param name=\"head_camera/driver/z_offset_mm\" value=\"0\" />\n"
    "  <param name=\"head_camera/driver/z_scaling\" value=\"1.0\" />\n"
    "  <arg   name=\"rgb_camera_info_url\" default=\"file://$(find robot)/rgb.yaml\" />\n"
    "  <arg   name=\"depth_camera_info_url\" default=\"file://$(find robot)/depth.yaml\" />\n"
    "  <!-- end -->\n"
    "</launch>";

class InstallScene : public FolderTest {
 protected:
  InstallScene() {
    std::filesystem::create_directories(folder_ / "out");
    std::filesystem::create_directories(folder_ / "robot");
    write("robot/robot.launch", kLaunch);
    write("out/calibrated.urdf", urdf("1"));
    write("out/depth_camera.yaml", camera("500.0"));
    write("out/rgb_camera.yaml", camera("600.0"));
    write("out/calibration_2026_01_02_03_04_05.yaml",
          "elbow: 0.02\ncamera_z_offset: -0.0025\ncamera_z_scaling: 0.01\n"
          "depth_info: depth_camera.yaml\nrgb_info: rgb_camera.yaml\nurdf: calibrated.urdf\n");
    write("out/report.json", "{\n  \"converged\": true,\n  \"termination\": \"a\\u0001\"\n}\n");
  }

  [[nodiscard]] static std::string urdf(const std::string& z) {
    return "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\">"
           "<origin xyz=\"0 0 " +
           z + "\"/><parent link=\"a\"/><child link=\"b\"/></joint></robot>\n";
  }
  [[nodiscard]] static std::string camera(const std::string& f) {
    return "image_width: 640\nimage_height: 480\ncamera_name: camera\n"
           "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [" +
           f + ", 0.0, 320.0, 0.0, " + f +
           ", 240.0, 0.0, 0.0, 1.0]\ndistortion_model: plumb_bob\n"
           "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.0, 0.0, 0.0, 0.0, 0.0]\n"
           "rectification_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
           "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [" +
           f + ", 0.0, 320.0, 0.0, 0.0, " + f + ", 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
  }

  [[nodiscard]] std::string launch() const { return read("robot/robot.launch"); }
  /// Replaces the first occurrence of a text in a file.
  void spoil(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = read(name);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(name, text.replace(at, from.size(), to));
  }
  /// Every file of the robot's folder, by name, with its content.
  [[nodiscard]] std::map<std::string, std::string> robot() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "robot")) {
      const std::string name = entry.path().filename().string();
      all[name] = entry.is_directory() ? "(folder)" : read("robot/" + name);
    }
    return all;
  }
};

}  // namespace kinecal::test
