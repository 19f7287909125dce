#include "kinecal/files/samples/write_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/samples/read_samples.hpp"
#include "support/data.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

std::string written(const std::vector<Sample>& samples) {
  std::ostringstream out;
  write_samples(out, samples);
  return out.str();
}

std::vector<Sample> read_back(const std::string& text) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = ::testing::TempDir() + "write_samples_" + test->name() + ".yaml";
  std::ofstream(path, std::ios::binary) << text;
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_samples(path, diagnostics);
  std::filesystem::remove(path);
  diagnostics.throw_if_errors();
  EXPECT_TRUE(diagnostics.warnings.empty());
  return samples;
}

void expect_same(const CameraInfo& a, const CameraInfo& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.distortion_model, b.distortion_model);
  EXPECT_EQ(a.d, b.d);
  EXPECT_EQ(a.k, b.k);
  EXPECT_EQ(a.r, b.r);
  EXPECT_EQ(a.p, b.p);
  EXPECT_EQ(a.z_offset, b.z_offset);
  EXPECT_EQ(a.z_scaling, b.z_scaling);
}

void expect_same(const Sample& a, const Sample& b) {
  EXPECT_EQ(a.joint_names, b.joint_names);
  EXPECT_EQ(a.joint_positions, b.joint_positions);
  EXPECT_EQ(a.conditions, b.conditions);
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    const Observation &x = a.observations[i], &y = b.observations[i];
    EXPECT_EQ(x.sensor, y.sensor);
    ASSERT_EQ(x.features.size(), y.features.size());
    for (std::size_t j = 0; j < x.features.size(); ++j) {
      EXPECT_EQ(x.features[j].frame, y.features[j].frame);
      EXPECT_EQ(x.features[j].point, y.features[j].point);
      EXPECT_EQ(x.features[j].sigma, y.features[j].sigma);
      EXPECT_EQ(x.features[j].id, y.features[j].id);
      EXPECT_EQ(x.features[j].conditions, y.features[j].conditions);
    }
    ASSERT_EQ(x.camera.has_value(), y.camera.has_value());
    if (x.camera) expect_same(*x.camera, *y.camera);
  }
}

/// Samples with random numbers of every size, names that need quotes, and lists that are empty.
std::vector<Sample> difficult_samples() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto number = [&] { return normal(random) * std::pow(10.0, 8.0 * normal(random)); };
  std::vector<Sample> samples(50);
  for (Sample& sample : samples) {
    sample.joint_names = {"pan_joint", "with space",
                          "off",       "/ns/tilt: 2",
                          "7",         "\xc2\x85\xe2\x80\xa8\x7f\xc2\x80\xef\xbb\xbf\xc3\xa9"};
    for (std::size_t i = 0; i < 6; ++i) sample.joint_positions.push_back(number());
    CameraInfo camera;
    camera.width = 640;
    camera.height = 480;
    camera.d = {number(), number()};
    for (double& v : camera.k) v = number();
    for (double& v : camera.r) v = number();
    for (double& v : camera.p) v = number();
    camera.z_offset = 0.01 * normal(random);
    camera.z_scaling = 1.0 + 0.01 * normal(random);
    sample.observations.push_back({"camera", {{"rgb", {number(), number(), number()}}}, camera});
    sample.observations.push_back({"arm", {{"", {-0.0, 1.0, number()}}, {"null", {}}}});
    sample.observations.push_back({"empty", {}});
    sample.observations[0].features[0].sigma = std::abs(number());
    sample.observations[0].features[0].conditions = {{"nx", number()}, {"with: space", number()}};
    sample.observations[1].features[1].id = static_cast<int>(random() % 2147483648u);
    sample.conditions = {{"temperature", number()}, {"7", number()}, {"with: space", number()}};
  }
  samples.push_back({{}, {}, {}, ""});
  return samples;
}

TEST(WriteSamples, PosesKeepTheirOrientation) {
  const Vector3<double> w(0.3, -0.2, 2.5);
  Sample sample{{"elbow"}, {0.5}, {{"mocap", {{"stand", {0.1, 0.2, 0.3}, exp(w)}}}}, ""};
  const std::vector<Sample> again = read_back(written({sample}));
  ASSERT_EQ(again.size(), 1u);
  const Feature& feature = again[0].observations[0].features[0];
  EXPECT_EQ(feature.point, sample.observations[0].features[0].point);
  ASSERT_TRUE(feature.rotation.has_value());
  EXPECT_LE((log(*feature.rotation) - w).norm(), 1e-14);
}

TEST(WriteSamples, WhatIsWrittenReadsBackExactly) {
  const std::vector<Sample> samples = difficult_samples();
  const std::vector<Sample> back = read_back(written(samples));
  ASSERT_EQ(back.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) expect_same(samples[i], back[i]);
}

TEST(WriteSamples, MeasuredPosesReadBack) {
  Sample sample;
  sample.poses["flange joint"] = {exp(Vector3<double>(0.3, -1.2, 2.0)), {0.1, -2.0, 1e-3}};
  sample.poses["other"] = {};
  const std::vector<Sample> back = read_back(written({sample}));
  ASSERT_EQ(back.size(), 1u);
  ASSERT_EQ(back[0].poses.size(), 2u);
  const Pose<double>&a = sample.poses["flange joint"], &b = back[0].poses.at("flange joint");
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_LE((a.rotation - b.rotation).norm(), 1e-15);
}

TEST(WriteSamples, NanAndInfinityReadBack) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Sample sample{
      {"a"}, {-kInfinity}, {{"arm", {{"tip", {std::nan(""), kInfinity, 0.0}}}}}, ""};
  const std::vector<Sample> back = read_back(written({sample}));
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].joint_positions[0], -kInfinity);
  const auto& point = back[0].observations[0].features[0].point;
  EXPECT_TRUE(std::isnan(point.x()));
  EXPECT_EQ(point.y(), kInfinity);
}

TEST(WriteSamples, SeparatorFollowsEachSampleAndKeysAreThoseOfRos1) {
  CameraInfo camera;
  camera.width = 4;
  camera.z_offset = -0.0123;
  const Sample sample{{"a"}, {0.5}, {{"camera", {{"tip", {1.0, 2.0, 3.0}}}, camera}}, ""};
  const std::string zeros9 = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";
  const std::string zeros12 = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";
  EXPECT_EQ(written({sample}),
            "joint_states: {name: [a], position: [0.5]}\n"
            "observations:\n"
            "- sensor_name: camera\n"
            "  features:\n"
            "  - {header: {frame_id: tip}, point: {x: 1.0, y: 2.0, z: 3.0}}\n"
            "  ext_camera_info:\n"
            "    camera_info: {height: 0, width: 4, distortion_model: '', D: [], K: " +
                zeros9 + ", R: " + zeros9 + ", P: " + zeros12 +
                "}\n"
                "    parameters: [{name: z_offset_mm, value: -12.3}, {name: z_scaling, value: "
                "1.0}]\n"
                "---\n");
}

TEST(WriteSamples, NamesAndPositionsOfDifferentLengthAreRefused) {
  std::ostringstream out;
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] {
              write_samples(out, {{{"a", "b"}, {0.5}, {}, "recorded.yaml:7"}});
            }),
            "sample recorded.yaml:7: 2 joint names but 1 position; it cannot be written");
}

void expect_same_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  Diagnostics diagnostics;
  const std::string back = written(read_samples(path.string(), diagnostics));
  EXPECT_TRUE(diagnostics.errors.empty());
  EXPECT_TRUE(back == text) << path << " is not the same file after reading and writing";
}

TEST(WriteSamples, RecordedFilesOfFetchComeBackByteForByte) {
  KINECAL_NEEDS_DATA("fetch");
  expect_same_file(test::data_folder() / "fetch/synth/samples.yaml");
}

TEST(WriteSamples, RecordedFilesOfUr5ComeBackByteForByte) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  expect_same_file(test::data_folder() / "ur5_tracker/random.yaml");
}

TEST(WriteSamples, RecordedFilesOfPandaComeBackByteForByte) {
  KINECAL_NEEDS_DATA("mukca_panda");
  expect_same_file(test::data_folder() / "mukca_panda/panda_6/front.yaml");
}

}  // namespace
}  // namespace kinecal
