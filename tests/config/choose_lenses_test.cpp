#include "kinecal/config/choose_lenses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kRobot = R"(<robot name="stand">
  <link name="base"/><link name="optical"/>
  <joint name="mount" type="fixed"><parent link="base"/><child link="optical"/></joint>
</robot>)";

/// A camera on a stand that sees points at known places.
/// @param lens  further lines of the camera's model
/// @param free  names of free parameters
std::string config_text(const std::string& lens, const std::string& free) {
  return "base_link: base\nmodels:\n - {name: points, type: chain3d, frame: base}\n"
         " - name: camera\n   type: camera2d\n   frame: optical\n" +
         lens + "free_params: [" + free +
         "]\nerror_blocks:\n - {name: pixels, type: chain3d_to_camera2d, model_3d: points, "
         "model_2d: "
         "camera}\n";
}

CameraInfo info_of(const std::string& model, const std::vector<double>& d) {
  CameraInfo info;
  info.width = 1280;
  info.height = 960;
  info.distortion_model = model;
  info.d = d;
  info.k = {400, 0, 640, 0, 405, 480, 0, 0, 1};
  return info;
}

/// Samples of 60 points up to an angle from the axis.
std::vector<Sample> samples_of(const CameraInfo& truth, const CameraInfo& recorded, double angle) {
  const auto camera = any_built_in(lens_camera(lens_of(truth), ImageKind::raw));
  const std::vector<double> settings = camera->settings({"camera", {}, truth});
  SeededRandom random(1);
  std::vector<Sample> samples;
  for (int n = 0; n < 10; ++n) {
    Sample& sample = samples.emplace_back();
    sample.source = "samples.yaml:" + std::to_string(n + 1);
    Observation points{"points", {}, {}}, pixels{"camera", {}, recorded};
    for (int i = 0; i < 60; ++i) {
      const double from_axis = angle * std::sqrt(random.uniform(0.0, 1.0)),
                   turn = random.uniform(-3.2, 3.2), away = random.uniform(0.5, 2.0);
      const Vector3<double> p =
          away * Vector3<double>(std::sin(from_axis) * std::cos(turn),
                                 std::sin(from_axis) * std::sin(turn), std::cos(from_axis));
      const Eigen::Vector2d pixel = camera->predict(p, settings);
      points.features.push_back({"base", p});
      pixels.features.push_back({"optical", {pixel.x(), pixel.y(), 0.0}});
    }
    sample.observations = {points, pixels};
  }
  return samples;
}

/// A configuration that has been read and whose lenses and images are chosen.
struct Chosen {
  Chosen(const std::string& text, std::vector<Sample> of_robot) : samples(std::move(of_robot)) {
    config = parse_config(text, "c.yaml", diagnostics);
    if (!diagnostics.errors.empty()) return;
    choose_lenses(config, samples, diagnostics);
    choose_images(config, robot, samples, diagnostics);
  }
  [[nodiscard]] ModelConfig camera() const { return config.steps.front().models.back(); }

  Robot robot = parse_urdf(kRobot, "stand.urdf");
  Diagnostics diagnostics;
  Config config;
  std::vector<Sample> samples;
};

struct LensCase {
  std::string model;
  std::vector<double> d;
  double angle;
  std::string coefficients;
};

/// Coefficients of every lens are found from recordings that know nothing of them, and the camera_info that goes out is
/// that of the lens.
TEST(ChooseLenses, EveryLensIsCalibrated) {
  for (const LensCase& of :
       std::vector<LensCase>{{"plumb_bob", {-0.21, 0.09, 1e-3, -2e-3, 0.01}, 0.7, "k1 k2 p1 p2 k3"},
                             {"rational_polynomial",
                              {0.52, 0.03, 6e-4, -2e-4, 1e-4, 0.81, 0.11, 2e-3},
                              1.3,
                              "k1 k2 p1 p2 k3 k4 k5 k6"},
                             {"equidistant", {0.03, -0.004, 2e-3, -3e-4}, 1.7, "k1 k2 k3 k4"},
                             {"double_sphere", {-0.21, 0.58}, 1.6, "xi alpha"}}) {
    const CameraInfo truth = info_of(of.model, of.d);
    CameraInfo recorded = info_of(of.model, std::vector<double>(of.d.size(), 0.0));
    recorded.k = {410, 0, 630, 0, 395, 490, 0, 0, 1};
    if (of.model == "double_sphere") recorded.d = {0.0, 0.5};
    // At zero, those above and below the line of a quotient are the same; single_camera() begins elsewhere, too.
    if (of.model == "rational_polynomial") {
      for (std::size_t i = 0; i < of.d.size(); ++i) recorded.d[i] = 0.8 * of.d[i];
    }
    std::string free = "camera_fx, camera_fy, camera_cx, camera_cy";
    std::istringstream names(of.coefficients);
    for (std::string name; names >> name;) free += ", camera_" + name;
    Chosen chosen(config_text("", free), samples_of(truth, recorded, of.angle));
    ASSERT_THAT(chosen.diagnostics.errors, IsEmpty()) << of.model;
    EXPECT_EQ(chosen.camera().lens, of.model);
    EXPECT_EQ(chosen.camera().image, ImageKind::raw) << "coefficients are free";
    Calibration calibration =
        assemble(chosen.config, chosen.robot, chosen.samples, chosen.diagnostics);
    ASSERT_THAT(chosen.diagnostics.errors, IsEmpty()) << of.model;
    const CalibrationResult result = calibrate(calibration);
    EXPECT_TRUE(result.converged) << of.model;
    const MountedSensor& camera = calibration.steps.front().problem->sensors().back();
    const Eigen::VectorXd values = result.table.values();
    const CameraInfo found = camera.sensor().calibrated(
        recorded, camera.own_values({values.data(), static_cast<std::size_t>(values.size())}));
    EXPECT_EQ(found.distortion_model, of.model);
    ASSERT_EQ(found.d.size(), of.d.size()) << of.model;
    // Coefficients of a quotient can hardly be told apart; the lens can.
    const auto lens = any_built_in(lens_camera(of.model, ImageKind::raw));
    for (double angle = 0.0; angle < of.angle; angle += 0.1) {
      const Vector3<double> p(0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle));
      const auto pixel = [&](const CameraInfo& info) {
        return lens->predict(p, lens->settings({"camera", {}, info}));
      };
      EXPECT_LE((pixel(found) - pixel(truth)).norm(), 1e-3) << of.model << " at " << angle;
    }
    EXPECT_NEAR(found.k[0], 400.0, 1e-3) << of.model;
    EXPECT_NEAR(found.k[5], 480.0, 1e-3) << of.model;
  }
}

const std::vector<double> kBent = {-0.2, 0.1, 0, 0, 0};

TEST(ChooseLenses, TakesTheLargestOfAFamily) {
  std::vector<Sample> samples =
      samples_of(info_of("plumb_bob", kBent), info_of("plumb_bob", kBent), 0.6);
  EXPECT_EQ(Chosen(config_text("", "camera_fx"), samples).camera().lens, "plumb_bob");
  samples[3].observations[1].camera->distortion_model = "rational_polynomial";
  samples[3].observations[1].camera->d = {-0.2, 0.1, 0, 0, 0, 0.01, 0, 0};
  EXPECT_EQ(Chosen(config_text("", "camera_fx"), samples).camera().lens, "rational_polynomial");
  samples[3].observations[1].camera->distortion_model = "equidistant";
  samples[3].observations[1].camera->d = {0.1, 0, 0, 0};
  EXPECT_THAT(Chosen(config_text("", "camera_fx"), samples).diagnostics.errors,
              ElementsAre(HasSubstr("sensor 'camera' has two lenses: plumb_bob at samples.yaml:1, "
                                    "equidistant at samples.yaml:4")));
}

TEST(ChooseLenses, AGivenLensReplacesAnother) {
  const std::vector<Sample> samples =
      samples_of(info_of("plumb_bob", kBent), info_of("plumb_bob", kBent), 0.6);
  Chosen chosen(config_text("   lens: fisheye\n", "camera_fx, camera_k1"), samples);
  EXPECT_THAT(chosen.diagnostics.errors, IsEmpty());
  EXPECT_THAT(chosen.diagnostics.notes.front(),
              HasSubstr("its lens is equidistant, camera_info says plumb_bob, which is not used"));
  EXPECT_EQ(chosen.samples[0].observations[1].camera->distortion_model, "equidistant");
  EXPECT_EQ(chosen.samples[0].observations[1].camera->d, std::vector<double>(4, 0.0));
  EXPECT_THAT(config_to_yaml(chosen.config, {}), HasSubstr("\n   lens: equidistant\n"));
  // Without a free coefficient nobody knows them.
  EXPECT_THAT(
      Chosen(config_text("   lens: equidistant\n", "camera_fx"), samples).diagnostics.errors,
      ElementsAre(HasSubstr("free the coefficients of this lens")));
  // A lens that contains the recorded one begins with its coefficients.
  Chosen contains(config_text("   lens: rational_polynomial\n", "camera_k4"), samples);
  EXPECT_THAT(contains.diagnostics.errors, IsEmpty());
  EXPECT_EQ(contains.samples[0].observations[1].camera->d, kBent);
}

TEST(ChooseLenses, WhatCannotBeIsSaid) {
  const std::vector<Sample> samples =
      samples_of(info_of("plumb_bob", kBent), info_of("plumb_bob", kBent), 0.6);
  EXPECT_THAT(Chosen(config_text("   lens: equidistnt\n", "camera_fx"), samples).diagnostics.errors,
              ElementsAre(HasSubstr("lens 'equidistnt' is none of plumb_bob, rational_polynomial, "
                                    "thin_prism, equidistant, double_sphere, auto; did you mean "
                                    "'equidistant'?")));
  EXPECT_THAT(Chosen(config_text("   image: rectified\n", "camera_k1"), samples).diagnostics.errors,
              ElementsAre(HasSubstr("'camera_k1' is free, but its images are rectified")));
  Chosen unknown(config_text("", "camera_k4"), samples);
  (void)assemble(unknown.config, unknown.robot, unknown.samples, unknown.diagnostics);
  EXPECT_THAT(unknown.diagnostics.errors,
              ElementsAre(HasSubstr("free parameter 'camera_k4' is neither")));
}

}  // namespace
}  // namespace kinecal
