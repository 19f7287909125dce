// The polynomial of a depth camera through a configuration: recovery of injected errors with honest +-, the result's
// file, names that differ, what samples do not determine, corrections that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/config/assemble.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/sensors/depth/true_depth.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/repetitions.hpp"
#include "support/scene.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::map<std::string, double> kInjected = {
    {"camera_z_offset", 0.006}, {"camera_z_scaling", -0.012}, {"camera_z_quadratic", 0.015},
    {"camera_z_x", 0.02},       {"camera_z_y", -0.015},       {"camera_z_xx", 0.05},
    {"camera_z_xy", -0.03},     {"camera_z_yy", 0.04},        {"elbow", 0.02}};

/// A configuration of arm and camera.
std::string bent_config(const std::string& free, const std::string& more = "") {
  return "base_link: base_link\nmodels:\n - {name: arm, type: chain, frame: hand}\n"
         " - {name: camera, type: camera3d, frame: camera_optical_frame}\nfree_params: [" +
         free +
         "]\nerror_blocks:\n - {name: points, type: chain3d_to_chain3d, model_a: camera, model_b: "
         "arm, sigma: 0.001}\n" +
         more;
}

std::string all_injected() {
  std::string free;
  for (const auto& [name, value] : kInjected) free += (free.empty() ? "" : ", ") + name;
  return free;
}

/// Samples of the injected errors with noise of 1 mm.
std::vector<Sample> bent_samples(int count, unsigned seed) {
  ParameterTable table = test::scene_table();
  test::add_depth_polynomial(table);
  for (const auto& [name, value] : kInjected) table[name].value = value;
  Problem problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  const Eigen::VectorXd values = table.values();
  std::vector<Sample> samples = test::exact_samples(
      problem, {values.data(), static_cast<std::size_t>(values.size())}, count, "hand", seed, 8);
  std::mt19937 random(seed + 1000);
  std::normal_distribution<double> noise(0.0, 1e-3);
  for (Sample& sample : samples) {
    sample.observations.pop_back();  // the eye's
    for (Feature& feature : sample.observations[0].features) {
      for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
    }
  }
  return samples;
}

/// The joint whose zero the URDF gets.
constexpr const char* kElbow =
    "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"elbow\" "
    "type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";

/// A calibration by a configuration.
struct Bent {
  std::vector<Sample> samples;
  Diagnostics diagnostics;
  Calibration calibration;
  JudgedResult judged;

  Bent(const std::string& config, std::vector<Sample> of) : samples(std::move(of)) {
    calibration =
        assemble(test::config_of(config), test::mobile_manipulator(), samples, diagnostics);
    if (diagnostics.errors.empty()) judged = calibrate_and_judge(calibration, samples);
  }
  [[nodiscard]] const ParameterTable& table() const { return judged.result.table; }
  [[nodiscard]] double deviation(const std::string& name) const {
    return judged.deviation(table().index(name)).value_or(0.0);
  }
  [[nodiscard]] std::vector<OutputFile> files() const {
    ResultFileOptions options;
    for (int i = 0; i < table().size(); ++i) {
      if (const auto deviation = judged.deviation(i)) options.deviations[i] = *deviation;
    }
    return result_files(test::mobile_manipulator(), kElbow, "r.urdf", calibration, judged.result,
                        samples, options);
  }
};

TEST(DepthPolynomialConfig, InjectedErrorsAreRecoveredWithinTheirDeviations) {
  constexpr double kFarthest = 4.5;  // deviations; of 900 numbers
  int covered = 0, counted = 0;
  const int seeds = test::repetitions_of_study(100, test::kIsSlow ? 4 : 20);
  for (int seed = 1; seed <= seeds; ++seed) {
    const Bent bent(bent_config(all_injected()), bent_samples(60, static_cast<unsigned>(seed)));
    ASSERT_THAT(bent.diagnostics.errors, IsEmpty());
    ASSERT_TRUE(bent.judged.result.converged);
    EXPECT_NE(bent.judged.judgement.verdict, Grade::do_not_use);
    for (const auto& [name, truth] : kInjected) {
      const double off = (bent.table()[name].value - truth) / bent.deviation(name);
      EXPECT_LT(std::abs(off), kFarthest) << name << " seed " << seed;
      EXPECT_LT(bent.deviation(name), 0.02) << name;
      covered += std::abs(off) < 2.0 ? 1 : 0;
      ++counted;
    }
  }
  EXPECT_GE(covered, 0.85 * counted) << covered << " of " << counted << " within two deviations";
  std::printf("%d of %d within two standard deviations\n", covered, counted);
}

/// The numbers of the file, applied as a driver does, give the depth that was fitted.
TEST(DepthPolynomialConfig, TheFileAppliedIsWhatWasFitted) {
  const Bent bent(bent_config(all_injected()), bent_samples(60, 1));
  const std::vector<OutputFile> files = bent.files();
  const auto file = std::find_if(files.begin(), files.end(), [](const OutputFile& of) {
    return of.name == "depth_correction_camera.yaml";
  });
  ASSERT_NE(file, files.end());
  EXPECT_THAT(file->content, HasSubstr("# The true depth of pixels of camera 'camera'."));
  EXPECT_THAT(file->content, HasSubstr("image_width: 640\nimage_height: 480\n"));
  EXPECT_THAT(file->content, testing::ContainsRegex("z_quadratic: 0\\.01.*  # 1/m, \\+- 0\\."));
  EXPECT_THAT(files.back().content, HasSubstr("depth_correction: depth_correction_camera.yaml\n"));
  const auto number = [&](const std::string& name) {
    const std::string line = "\n" + name + ": ";
    return std::stod(file->content.substr(file->content.find(line) + line.size()));
  };
  const DepthErrors errors{number("fx"),
                           number("fy"),
                           number("cx"),
                           number("cy"),
                           number("recorded_z_offset"),
                           number("recorded_z_scaling"),
                           number("z_offset"),
                           number("z_scaling"),
                           number("z_quadratic"),
                           number("z_x"),
                           number("z_y"),
                           number("z_xx"),
                           number("z_xy"),
                           number("z_yy")};
  const MountedSensor& camera = bent.calibration.steps[0].problem->sensors()[1];
  const Eigen::VectorXd all = bent.table().values();
  const std::vector<double> own =
      camera.own_values({all.data(), static_cast<std::size_t>(all.size())});
  for (const Sample& sample : bent.samples) {
    const Observation& seen = *sample.observation("camera");
    const std::vector<double> settings = camera.sensor().settings(seen);
    for (const Feature& feature : seen.features) {
      const Vector3<double> m = camera.sensor().measurement(feature.point, settings);
      EXPECT_NEAR(true_depth(errors, m.x(), m.y(), feature.point.z()),
                  camera.sensor().place(m, settings, own).z(), 1e-13);
    }
  }
}

TEST(DepthPolynomialConfig, WithoutItThereIsNoFile) {
  const Bent bent(bent_config("camera_z_offset, camera_z_scaling, elbow"), bent_samples(40, 1));
  for (const OutputFile& file : bent.files()) {
    EXPECT_THAT(file.name, testing::Not(HasSubstr("depth_correction")));
    EXPECT_THAT(file.content, testing::Not(HasSubstr("z_quadratic")));
  }
}

TEST(DepthPolynomialConfig, AMisspeltNameIsAnErrorThatNamesTheMeantOne) {
  const Bent bent(bent_config("elbow, camera_z_quadratc"), bent_samples(5, 1));
  EXPECT_THAT(bent.diagnostics.errors,
              ElementsAre(HasSubstr("did you mean 'camera_z_quadratic'?")));
}

/// At one depth, offset, scale and quadratic term are one number.
TEST(DepthPolynomialConfig, OneDepthDoesNotDetermineThem) {
  std::vector<Sample> samples = bent_samples(40, 1);
  const double scale = 0.8;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      for (Feature& feature : seen.features) feature.point *= scale / feature.point.z();
    }
  }
  const Bent bent(bent_config("camera_z_offset, camera_z_scaling, camera_z_quadratic"), samples);
  ASSERT_FALSE(bent.judged.assessments.empty());
  EXPECT_EQ(bent.judged.assessments.back().observability.unobservable.size(), 2U);
  EXPECT_THAT(bent.judged.assessments.back().observability.hold, testing::SizeIs(2));
  EXPECT_NE(bent.judged.judgement.verdict, Grade::good);
}

TEST(DepthPolynomialConfig, APriorHoldsATerm) {
  const std::string prior =
      " - {name: keep, type: outrageous, param: camera_z_quadratic, joint_scale: 1.0e+6}\n";
  const Bent bent(bent_config(all_injected(), prior), bent_samples(40, 1));
  ASSERT_THAT(bent.diagnostics.errors, IsEmpty());
  EXPECT_NEAR(bent.table()["camera_z_quadratic"].value, 0.0, 1e-6);
}

TEST(DepthPolynomialConfig, ACorrectionThatCannotBeIsASentence) {
  const auto why = [](const std::string& values) {
    const Bent bent(bent_config("elbow", "initial_values: {" + values + "}\n"),
                    bent_samples(20, 1));
    EXPECT_THAT(bent.diagnostics.errors, IsEmpty());
    return impossible_camera(bent.calibration, bent.table(), bent.samples);
  };
  EXPECT_THAT(why("camera_z_quadratic: -0.8"),
              HasSubstr("camera 'camera': its depth correction is impossible: scene:"));
  EXPECT_THAT(why("camera_z_quadratic: -3.0"), HasSubstr("m; hold z_quadratic"));
  EXPECT_THAT(why("camera_z_x: -6.0"), HasSubstr(" would be at -"));
  EXPECT_EQ(why("camera_z_quadratic: 0.01"), "");
}

}  // namespace
}  // namespace kinecal
