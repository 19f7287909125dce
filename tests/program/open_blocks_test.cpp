// Sensors, error blocks and joint models beyond robot_calibration's, from configuration to result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kOpenElbow = 0.03, kGear = 0.02;

const char* const kOpenUrdf = R"(<robot name="arm">
  <link name="base"/><link name="turret"/><link name="upper"/><link name="hand"/>
  <joint name="pan" type="revolute">
    <parent link="base"/><child link="turret"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <origin xyz="0.1 0 0.5"/><parent link="turret"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0"/><parent link="upper"/><child link="hand"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>
)";

/// Makes samples of an arm whose elbow has a wrong zero and a wrong gear ratio.
class OpenBlocksProgram : public test::ProgramTest {
 protected:
  OpenBlocksProgram() : robot_(parse_urdf(kOpenUrdf, "arm.urdf")) { write("arm.urdf", kOpenUrdf); }

  /// @param observe  adds observations, given the true pose of the hand in the base
  template <class Observe>
  void record(Observe&& observe) {
    const RuntimeChain arm = make_chain(robot_, "base", "hand");
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-1.2, 1.2);
    std::vector<Sample> samples;
    for (int n = 0; n < 30; ++n) {
      Sample sample{
          {"pan", "shoulder", "elbow"}, {angle(random), angle(random), angle(random)}, {}, ""};
      const auto true_position = [&](const std::string& joint) {
        const double q = *sample.position(joint);
        return joint == "elbow" ? q * (1.0 + kGear) + kOpenElbow : q;
      };
      observe(forward_kinematics(arm, true_position), sample);
      samples.push_back(sample);
    }
    std::ofstream out(folder_ / "samples.yaml");
    write_samples(out, samples);
  }
  /// Calibrates; the configuration is what follows `base_link`.
  test::Outcome calibrate(const std::string& config, const std::string& options = "") {
    write("calibrate.yaml", "base_link: base\n" + config);
    return run(test::kinecal_program() +
               " calibrate --urdf arm.urdf --config calibrate.yaml --samples samples.yaml "
               "--output result --force " +
               options);
  }
  [[nodiscard]] double value(const std::string& name) {
    return YAML::Load(read("result/calibration.yaml"))[name].as<double>();
  }

  Robot robot_;
  int results_ = 0;  ///< folders of results that were renamed
};

TEST_F(OpenBlocksProgram, CalibratesAgainstMotionCapture) {
  const Pose<double> stand{exp(Vector3<double>(0.1, -0.2, 0.3)), Vector3<double>(1.0, -0.5, 0.2)};
  record([&](const Pose<double>& hand, Sample& sample) {
    const Pose<double> seen = stand.inverse() * hand;
    sample.observations = {
        {"body", {{"hand", Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
        {"mocap", {{"stand", seen.translation, seen.rotation}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: body, type: chain6d, frame: hand}
 - {name: mocap, type: chain6d, frame: base}
free_params: [elbow, elbow_gear_ratio]
free_frames:
 - {name: stand, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: track, type: pose_to_pose, model_a: body, model_b: mocap, translation_scale: 1000, rotation_scale: 500}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-9);
  EXPECT_NEAR(value("elbow_gear_ratio"), kGear, 1e-9);
  EXPECT_NEAR(value("stand_x"), 1.0, 1e-9);
  EXPECT_THAT(result.err, HasSubstr("a URDF cannot hold 'elbow_gear_ratio'"));
}

TEST_F(OpenBlocksProgram, WritesTheErrorsOfAMimicJointIntoTheUrdf) {
  const auto urdf = [](const std::string& mimic) {
    std::string text = kOpenUrdf;
    return text.insert(text.rfind("<limit"), mimic);
  };
  robot_ = parse_urdf(urdf("<mimic joint='shoulder' multiplier='0.52' offset='0.03'/>"), "true");
  record([&](const Pose<double>& hand, Sample& sample) {
    sample.observations = {
        {"body", {{"hand", Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
        {"mocap", {{"base", hand.translation, hand.rotation}}}};
  });
  write("arm.urdf", urdf("<mimic joint='shoulder' multiplier='0.5'/>"));
  const test::Outcome result = calibrate(R"(models:
 - {name: body, type: chain6d, frame: hand}
 - {name: mocap, type: chain6d, frame: base}
free_params: [elbow_mimic_multiplier, elbow_mimic_offset]
error_blocks:
 - {name: track, type: pose_to_pose, model_a: body, model_b: mocap, translation_scale: 1000, rotation_scale: 500}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow_mimic_multiplier"), 0.02, 1e-9);
  EXPECT_THAT(result.err, testing::Not(HasSubstr("cannot hold")));
  const Robot calibrated = parse_urdf(read("result/calibrated.urdf"), "calibrated.urdf");
  EXPECT_NEAR(calibrated.joint("elbow").mimic->multiplier, 0.52, 1e-9);
  EXPECT_NEAR(calibrated.joint("elbow").mimic->offset, 0.03, 1e-9);
}

TEST_F(OpenBlocksProgram, LeavesOutAnOrientationThatIsNotANumberWithACount) {
  int n = 0;
  record([&](const Pose<double>& hand, Sample& sample) {
    Matrix3<double> seen = hand.rotation;
    if (n++ == 3) seen(0, 0) = std::nan("");
    sample.observations = {
        {"body", {{"hand", Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
        {"mocap", {{"base", hand.translation, seen}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: body, type: chain6d, frame: hand}
 - {name: mocap, type: chain6d, frame: base}
free_params: [elbow, elbow_gear_ratio]
error_blocks:
 - {name: track, type: pose_to_pose, model_a: body, model_b: mocap}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("1 feature is not a number and left out"));
  EXPECT_THAT(result.err, HasSubstr("sensor 'mocap'"));
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-9);
}

/// Weights so small that their squares vanish: no crash, and no robot that only looks calibrated.
TEST_F(OpenBlocksProgram, RefusesWhatDeterminesNothing) {
  record([&](const Pose<double>& hand, Sample& sample) {
    sample.observations = {{"arm", {{"hand", hand.inverse() * Vector3<double>(0.5, 0.1, 0.3)}}}};
  });
  for (const char* block :
       {"type: chain3d_to_plane, sigma: 1e300", "type: point_to_line, sigma: 1e300",
        "type: chain3d_to_plane, scale: 1e-300"}) {
    const test::Outcome result = calibrate(std::string(R"(models:
 - {name: arm, type: chain3d, frame: hand}
free_params: [shoulder, elbow]
error_blocks:
 - {name: known, model: arm, )") + block + "}\n");
    EXPECT_EQ(result.code, 2) << block << result.err;
    EXPECT_THAT(result.err + result.out, HasSubstr("none of its 2 free parameters")) << block;
    EXPECT_FALSE(fs::exists(folder_ / "result" / "calibrated.urdf"));
  }
}

TEST_F(OpenBlocksProgram, CalibratesOnAPlaneWhoseNormalIsLong) {
  record([&](const Pose<double>& hand, Sample& sample) {
    Vector3<double> p = hand * Vector3<double>(0.2, 0.1, 0.05);
    p.z() = 0.4;
    sample.observations = {{"arm", {{"hand", hand.inverse() * p}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: arm, type: chain3d, frame: hand}
free_params: [elbow, elbow_gear_ratio]
error_blocks:
 - {name: table, type: chain3d_to_plane, model: arm, c: 1e200, d: -0.4e200}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-8);
}

TEST_F(OpenBlocksProgram, CalibratesOnABallBarOfUnknownLength) {
  const Vector3<double> tip(0.2, 0.1, 0.05), socket(0.5, 0.1, 0.3);
  // Poses are random, so the hand holds the bar at another of its points in each sample: the one where
  // a bar of length 0.35 from the socket towards the tip ends.
  record([&](const Pose<double>& hand, Sample& sample) {
    const Vector3<double> p = hand * tip;
    const Vector3<double> end = socket + 0.35 * (p - socket).normalized();
    sample.observations = {{"arm", {{"hand", hand.inverse() * end}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: arm, type: chain3d, frame: hand}
free_params: [elbow, elbow_gear_ratio, bar_x, bar_y, bar_z, bar_radius]
error_blocks:
 - {name: bar, type: point_to_sphere, model: arm, x: 0.45, y: 0.12, z: 0.33, radius: 0.3}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-8);
  EXPECT_NEAR(value("bar_x"), 0.5, 1e-8);
  EXPECT_NEAR(value("bar_radius"), 0.35, 1e-8);
}

TEST_F(OpenBlocksProgram, CalibratesOnABarBetweenTwoPoints) {
  const Vector3<double> tip(0.2, 0.1, 0.05), socket(0.5, 0.1, 0.3);
  record([&](const Pose<double>& hand, Sample& sample) {
    const Vector3<double> end = socket + 0.35 * (hand * tip - socket).normalized();
    sample.observations = {{"arm", {{"hand", hand.inverse() * end}}},
                           {"socket", {{"base", socket}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: socket, type: chain3d, frame: base}
free_params: [elbow, elbow_gear_ratio, bar_length]
error_blocks:
 - {name: bar, type: point_distance, model_a: arm, model_b: socket, length: 0.3}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-8);
  EXPECT_NEAR(value("elbow_gear_ratio"), kGear, 1e-8);
  EXPECT_NEAR(value("bar_length"), 0.35, 1e-8);
}

TEST_F(OpenBlocksProgram, CalibratesAlongAKnownLine) {
  const Vector3<double> point(0.3, -0.2, 0.1), direction(1.0, 2.0, -0.5);
  double along = -0.5;
  record([&](const Pose<double>& hand, Sample& sample) {
    along += 0.03;
    const Vector3<double> p_base = point + along * direction;
    sample.observations = {{"arm", {{"hand", hand.inverse() * p_base}}}};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: arm, type: chain3d, frame: hand}
free_params: [elbow, elbow_gear_ratio]
error_blocks:
 - {name: rail, type: point_to_line, model: arm, x: 0.3, y: -0.2, z: 0.1, a: 1, b: 2, c: -0.5}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-8);
  EXPECT_NEAR(value("elbow_gear_ratio"), kGear, 1e-8);
}

/// A camera in the hand and one in the base see the same points; nobody knows where these are.
TEST_F(OpenBlocksProgram, CalibratesWithTwoCameras) {
  constexpr double kFocal = 0.01;
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.k = {500, 0, 320, 0, 500, 240, 0, 0, 1};
  info.p = {500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0};
  const auto pixel = [](const Vector3<double>& p, double f) {
    return Vector3<double>(320 + f * p.x() / p.z(), 240 + f * p.y() / p.z(), 0.0);
  };
  std::mt19937 random(2);
  std::uniform_real_distribution<double> side(-0.5, 0.5), depth(1.0, 2.0);
  record([&](const Pose<double>& hand, Sample& sample) {
    Observation eye{"eye", {}, info}, wall{"wall", {}, info};
    while (eye.features.size() < 4) {
      const Vector3<double> p(side(random), side(random), depth(random)), p_base = hand * p;
      if (p_base.z() < 0.2) continue;  // behind the other camera
      eye.features.push_back({"hand", pixel(p, 500 * (1.0 + kFocal))});
      wall.features.push_back({"base", pixel(p_base, 500)});
    }
    sample.observations = {eye, wall};
  });
  const test::Outcome result = calibrate(R"(models:
 - {name: eye, type: camera2d, frame: hand}
 - {name: wall, type: camera2d, frame: base}
free_params: [elbow, elbow_gear_ratio, eye_fx, eye_fy]
error_blocks:
 - {name: stereo, type: camera2d_to_camera2d, model_a: eye, model_b: wall}
)");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), kOpenElbow, 1e-8);
  EXPECT_NEAR(value("elbow_gear_ratio"), kGear, 1e-8);
  EXPECT_NEAR(value("eye_fx"), kFocal, 1e-8);
  EXPECT_NEAR(value("eye_fy"), kFocal, 1e-8);
}

TEST_F(OpenBlocksProgram, AMeanHoldsAParameterThatSamplesDoNotDetermine) {
  record([&](const Pose<double>& hand, Sample& sample) {
    sample.observations = {{"arm", {{"hand", Vector3<double>::Zero()}}},
                           {"tracker", {{"base", hand.translation}}}};
  });
  const std::string config = R"(models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: tracker, type: chain3d, frame: base}
free_params: [shoulder, elbow]
error_blocks:
 - {name: track, type: chain3d_to_chain3d, model_a: arm, model_b: tracker}
 - {name: drawing, type: outrageous, param: elbow, joint_scale: 1, mean: 0.03}
)";
  const test::Outcome result = calibrate(config);  // the elbow turns about the point itself
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(value("elbow"), 0.03, 1e-9);
}

TEST_F(OpenBlocksProgram, APriorHoldsAParameterOfABlockAndOfAJointModel) {
  record([&](const Pose<double>& hand, Sample& sample) {
    sample.observations = {{"arm", {{"hand", hand.inverse() * Vector3<double>(0.85, 0.12, 0.33)}}}};
  });
  const auto config = [](const std::string& free, const std::string& prior) {
    return R"(models:
 - {name: arm, type: chain3d, frame: hand}
free_params: [)" +
           free + R"(]
error_blocks:
 - {name: bar, type: point_to_sphere, model: arm, x: 0.45, y: 0.12, z: 0.33, radius: 0.3}
 - {name: keep_radius, type: outrageous, param: )" +
           prior + R"(, mean: 0.37, sigma: 1.0e-9}
 - {name: keep_gear, type: outrageous, param: elbow_gear_ratio, joint_scale: 1.0e+9, mean: -0.01}
)";
  };
  // The sphere is 7 cm too large now: the values are kept, and the residuals show that it is wrong.
  const test::Outcome result =
      calibrate(config("bar_radius, elbow, elbow_gear_ratio", "bar_radius"), "--report r.json");
  ASSERT_EQ(result.code, 2) << result.err;
  std::map<std::string, double> found;
  for (const YAML::Node& parameter : YAML::Load(read("r.json"))["parameters"]) {
    found[parameter["name"].as<std::string>()] = parameter["value"].as<double>();
  }
  EXPECT_NEAR(found.at("bar_radius"), 0.37, 1e-12);
  EXPECT_NEAR(found.at("elbow_gear_ratio"), -0.01, 1e-12);

  const test::Outcome misspelt =
      calibrate(config("bar_radius, elbow, elbow_gear_ratio", "bar_radios"));
  EXPECT_EQ(misspelt.code, 1);
  EXPECT_THAT(misspelt.err, HasSubstr("calibrate.yaml:7: error block 'keep_radius': param "
                                      "'bar_radios' is not a free joint, a free frame or a "
                                      "parameter; did you mean 'bar_radius'?"));
  const test::Outcome held = calibrate(config("elbow, elbow_gear_ratio", "bar_radius"));
  EXPECT_THAT(held.err, HasSubstr("warning: calibrate.yaml:7: error block 'keep_radius' has no "
                                  "effect: no step frees its param 'bar_radius'"));
}

/// One bad capture of a tracker says itself how bad it is.
TEST_F(OpenBlocksProgram, AnOutlierWithALargeSigmaDoesNotPullTheResult) {
  const auto record_with = [&](double error, std::optional<double> sigma) {
    int n = 0;
    record([&](const Pose<double>& hand, Sample& sample) {
      const Vector3<double> tip(0.2, 0.1, 0.05);
      Vector3<double> seen = hand * tip;
      if (n == 7) seen.y() += error;
      sample.observations = {{"arm", {{"hand", tip}}}, {"tracker", {{"base", seen}}}};
      if (n++ == 7) sample.observations[1].features[0].sigma = sigma;
    });
  };
  const std::string config = R"(models:
 - {name: arm, type: chain3d, frame: hand}
 - {name: tracker, type: chain3d, frame: base}
free_params: [shoulder, elbow, elbow_gear_ratio]
error_blocks:
 - {name: track, type: chain3d_to_chain3d, model_a: arm, model_b: tracker, sigma: 0.0001}
)";
  const auto elbow = [&] {
    const test::Outcome result = calibrate(config);
    EXPECT_EQ(result.code, 0) << result.err;
    fs::rename(folder_ / "result", folder_ / ("result" + std::to_string(++results_)));
    return YAML::Load(read("result" + std::to_string(results_) + "/calibration.yaml"))["elbow"]
        .as<double>();
  };
  record_with(0.3, std::nullopt);
  EXPECT_EQ(calibrate(config, "--keep-outliers").code, 2);  // sigma 0.1 mm given, 5.7 mm shown
  record_with(0.3, 100.0);
  EXPECT_NEAR(elbow(), kOpenElbow, 1e-8);
  record_with(0.3, -1.0);
  EXPECT_THAT(calibrate(config).err, HasSubstr("samples.yaml:"));
  EXPECT_THAT(calibrate(config).err,
              HasSubstr("sensor 'tracker': the sigma of feature 1 must be positive and finite, is "
                        "-1"));
  const test::Outcome bag = run(test::kinecal_program() + " convert samples.yaml samples.bag");
  EXPECT_EQ(bag.code, 1);
  EXPECT_THAT(bag.err, HasSubstr("cannot hold the sigma of a feature; write YAML"));
  record([](const Pose<double>&, Sample& sample) { sample.conditions["temperature"] = 20.0; });
  EXPECT_THAT(run(test::kinecal_program() + " convert samples.yaml samples.bag").err,
              HasSubstr("cannot hold conditions; write YAML"));
}

TEST_F(OpenBlocksProgram, RefusesWhatCannotBe) {
  record([&](const Pose<double>&, Sample& sample) {
    sample.observations = {{"arm", {{"hand", Vector3<double>(0.1, 0, 0)}}}};
  });
  const auto expect_refused = [&](const std::string& free, const std::string& block,
                                  const std::string& message) {
    const test::Outcome result =
        calibrate("models:\n - {name: arm, type: chain3d, frame: hand}\nfree_params: [" + free +
                  "]\nerror_blocks:\n - {name: b, " + block + ", model: arm}\n");
    EXPECT_EQ(result.code, 1) << result.out;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(folder_ / "result"));
  };
  const std::string plane = "type: chain3d_to_plane";
  expect_refused("elbow_gear_ration", plane, "did you mean 'elbow_gear_ratio'?");
  expect_refused("hand_gear_ratio", plane,
                 "calibrate.yaml:4: free parameter 'hand_gear_ratio' is neither a joint of the "
                 "robot nor a parameter of a joint, sensor or error block");
  expect_refused("b_radius", plane, "calibrate.yaml:4: ");
  expect_refused("elbow", "type: point_to_line, c: 0",
                 "calibrate.yaml:6: error block 'b': the line's");
  expect_refused("elbow", "type: point_to_sphere, radius: -1",
                 "calibrate.yaml:6: error block 'b': radius is negative");
  expect_refused("elbow", "type: point_to_sphere, radious: 1", "did you mean 'radius'?");
  // A pose sensor whose samples have points.
  const test::Outcome points = calibrate(R"(models:
 - {name: arm, type: chain6d, frame: hand}
 - {name: mocap, type: chain6d, frame: base}
free_params: [elbow]
error_blocks:
 - {name: track, type: pose_to_pose, model_a: arm, model_b: mocap}
)");
  EXPECT_EQ(points.code, 1);
  EXPECT_THAT(points.err, HasSubstr("sensor 'arm': a feature has no orientation"));
}

}  // namespace
}  // namespace kinecal
