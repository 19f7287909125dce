// kinecal calibrate-log of a robot before whose camera a person holds a board: the result of kinecal calibrate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <numbers>
#include <random>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "support/camera_infos.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

/// A head that pans and tilts a camera, and a camera that stands beside it.
constexpr const char* kUrdf = R"(<robot name="head">
  <link name="base"/><link name="neck"/><link name="head"/><link name="camera"/><link name="eye"/>
  <joint name="pan" type="revolute"><parent link="base"/><child link="neck"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="tilt" type="revolute"><parent link="neck"/><child link="head"/>
    <origin xyz="0.05 0 0.1"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="camera_joint" type="fixed"><parent link="head"/><child link="camera"/>
    <origin xyz="0.03 0.02 0.04" rpy="-1.5707963267948966 0 -1.5707963267948966"/></joint>
  <joint name="eye_joint" type="fixed"><parent link="base"/><child link="eye"/>
    <origin xyz="0 -0.3 0.6" rpy="-1.5707963267948966 0 -1.5707963267948966"/></joint>
</robot>
)";

constexpr const char* kConfig = R"(base_link: base
per_sample: [board]
models:
 - {name: board, type: chain3d, frame: base}
 - {name: camera, type: camera2d, frame: camera}
 - {name: eye, type: camera2d, frame: eye}
free_frames:
 - {name: camera_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: by_camera, type: chain3d_to_camera2d, model_3d: board, model_2d: camera}
 - {name: by_eye, type: chain3d_to_camera2d, model_3d: board, model_2d: eye}
)";

constexpr double kRight = 0.5 * std::numbers::pi;

/// Samples of the robot, whose camera is 5 mm and 10 mrad beside where the URDF has it.
std::vector<Sample> head_samples(std::size_t count) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.2);  // pixels
  const auto uniform = [&](double reach) {
    return std::uniform_real_distribution<double>(-reach, reach)(random);
  };
  const CameraInfo info = test::camera_info(600.0, 600.0);
  const Matrix3<double> optical = rotation_from_rpy({-kRight, 0.0, -kRight});
  std::vector<Sample> samples;
  while (samples.size() < count) {
    const double pan = uniform(0.3), tilt = uniform(0.3);
    const Pose<double> base_T_camera =
        Pose<double>{rotation_from_rpy({0, 0, pan}), {0, 0, 0.5}} *
        Pose<double>{rotation_from_rpy({0, tilt, 0}), {0.05, 0, 0.1}} *
        Pose<double>{optical * rotation_from_rpy({0.01, 0, 0}), {0.035, 0.02, 0.04}};
    const Pose<double> base_T_eye{optical, {0, -0.3, 0.6}};
    const Pose<double> base_T_board{rotation_from_rpy({0, -kRight + uniform(0.4), uniform(0.3)}) *
                                        rotation_from_rpy({0, 0, uniform(3.0)}),
                                    {1.3 + uniform(0.2), uniform(0.2), 0.6 + uniform(0.15)}};
    Sample sample;
    sample.joint_names = {"pan", "tilt"};
    sample.joint_positions = {pan, tilt};
    sample.source = "sample " + std::to_string(samples.size());
    Observation board{"board", {}, {}}, camera{"camera", {}, info}, eye{"eye", {}, info};
    const auto see = [&](const Pose<double>& base_T_lens, const Vector3<double>& in_base,
                         Observation& of) {
      const Vector3<double> p = base_T_lens.inverse() * in_base;
      const double u = 320 + 600 * p.x() / p.z(), v = 240 + 600 * p.y() / p.z();
      of.features.push_back({of.sensor, {u + noise(random), v + noise(random), 0.0}});
      return p.z() > 0.1 && u > 0 && u < 640 && v > 0 && v < 480;
    };
    bool is_seen = true;
    for (int i = 0; i < 35; ++i) {
      const Vector3<double> corner(0.04 * (i % 7) - 0.12, 0.04 * (i / 7) - 0.08, 0.0);
      board.features.push_back({"board", corner});
      const bool by_camera = see(base_T_camera, base_T_board * corner, camera);
      is_seen = see(base_T_eye, base_T_board * corner, eye) && by_camera && is_seen;
    }
    sample.observations = {board, camera, eye};
    if (is_seen) samples.push_back(sample);
  }
  return samples;
}

class HeldBoardLog : public test::ProgramTest {};

TEST_F(HeldBoardLog, FindsWhatCalibrateFinds) {
  const std::vector<Sample> samples = head_samples(60);
  const auto write_some = [&](const std::string& file, std::size_t first, std::size_t last) {
    std::ostringstream text;
    write_samples(text, {samples.data() + first, samples.data() + last});
    write(file, text.str());
  };
  write("head.urdf", kUrdf);
  write("c.yaml", kConfig);
  write_some("all.yaml", 0, 60);
  write_some("a.yaml", 0, 25);
  write_some("b.yaml", 25, 32);
  write_some("c_.yaml", 32, 60);
  const std::string input = " --urdf head.urdf --config c.yaml --samples ";
  const test::Outcome done =
      kinecal("calibrate-log" + input + "a.yaml b.yaml c_.yaml --output out");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  const test::Outcome once = kinecal("calibrate" + input + "all.yaml --output once");
  ASSERT_EQ(once.code, 0) << once.out << once.err;
  const YAML::Node report = YAML::Load(read("out/report.json")),
                   expected = YAML::Load(read("once/report.json"));
  EXPECT_EQ(report["verdict"].as<std::string>(), expected["verdict"].as<std::string>());
  ASSERT_EQ(report["parameters"].size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const YAML::Node &of = report["parameters"][i], &all = expected["parameters"][i];
    const double deviation = all["sigma"].as<double>();
    // The weights of the two blocks are their noise, which shards know to 0.3 %.
    EXPECT_NEAR(of["value"].as<double>(), all["value"].as<double>(), 0.02 * deviation);
    EXPECT_NEAR(of["sigma"].as<double>() / deviation, 1.0, 0.4);
  }
  for (std::size_t block = 0; block < 2; ++block) {
    const YAML::Node &of = report["noise"][block], &all = expected["noise"][block];
    EXPECT_NEAR(of["sigma"].as<double>() / all["sigma"].as<double>(), 1.0, 1e-3);
    EXPECT_NEAR(of["freedom"].as<double>() / all["freedom"].as<double>(), 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace kinecal
