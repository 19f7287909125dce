// A board seen by a camera, with raw or rectified pixels that carry the same camera_info.
#include "kinecal/config/choose_images.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "support/images.hpp"

namespace kinecal {
namespace {

using test::board;
using test::lens;
using test::Scenario;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Diagnostics choose(Scenario& scenario) {
  Diagnostics diagnostics;
  choose_images(scenario.config, scenario.robot, scenario.samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  return diagnostics;
}

ImageKind image_of(const Scenario& scenario) {
  return scenario.config.steps[0].models[1].image;
}

TEST(ChooseImages, WhatFitsIsTakenAndSaid) {
  Scenario raw = board(lens(), ImageKind::raw), rectified = board(lens(), ImageKind::rectified);
  EXPECT_THAT(choose(raw).notes,
              ElementsAre(testing::MatchesRegex(".*:5: sensor 'eye': image raw 0\\.[0-9]+ px, "
                                                "rectified [0-9.]+ px: taken as raw")));
  EXPECT_EQ(image_of(raw), ImageKind::raw);
  EXPECT_THAT(choose(rectified).notes, ElementsAre(HasSubstr(": taken as rectified")));
  EXPECT_EQ(image_of(rectified), ImageKind::rectified);
}

TEST(ChooseImages, WhatIsTakenFitsTheNoise) {
  for (const ImageKind truth : {ImageKind::raw, ImageKind::rectified}) {
    Scenario scenario = board(lens(), truth);
    (void)choose(scenario);
    const CalibrationResult result = calibrate(scenario.calibration());
    ASSERT_TRUE(result.converged);
    EXPECT_NEAR(result.blocks[0].after.rms, std::sqrt(2.0) * 0.29, 0.03) << "pixels";
  }
}

TEST(ChooseImages, FewSamplesAndBadOnesDoNotMatter) {
  for (const ImageKind truth : {ImageKind::raw, ImageKind::rectified}) {
    Scenario few = board(lens(), truth, 5), bad = board(lens(), truth, 15);
    (void)choose(few);
    EXPECT_EQ(image_of(few), truth);
    for (const std::size_t i : {2u, 9u}) {
      for (Feature& feature : bad.samples[i].observations[1].features) feature.point.x() += 80.0;
    }
    (void)choose(bad);
    EXPECT_EQ(image_of(bad), truth);
  }
}

TEST(ChooseImages, MatricesThatDifferAreTriedWithoutDistortionToo) {
  CameraInfo info = lens();
  info.d = {0, 0, 0, 0, 0};
  info.p[2] = 390;  // the focal lengths are free, the principal point is not
  Scenario raw = board(info, ImageKind::raw), rectified = board(info, ImageKind::rectified);
  (void)choose(raw);
  EXPECT_EQ(image_of(raw), ImageKind::raw);
  (void)choose(rectified);
  EXPECT_EQ(image_of(rectified), ImageKind::rectified);
}

TEST(ChooseImages, WhatFitsAlikeIsLeftAsItIsSilently) {
  CameraInfo weak = test::camera_info(), none = weak;
  weak.d = {1e-5, 0, 0, 0, 0};
  for (const CameraInfo& info : {weak, none}) {
    Scenario scenario = board(info, ImageKind::raw);
    const Diagnostics diagnostics = choose(scenario);
    EXPECT_THAT(diagnostics.notes, IsEmpty());
    EXPECT_THAT(diagnostics.warnings, IsEmpty());
    EXPECT_EQ(image_of(scenario), ImageKind::automatic);
  }
}

TEST(ChooseImages, AKeyIsObeyedInAllSteps) {
  Scenario scenario = board(lens(), ImageKind::raw);
  scenario.config.steps.push_back(scenario.config.steps[0]);
  scenario.config.steps[0].models[1].image = ImageKind::rectified;
  EXPECT_THAT(choose(scenario).notes, IsEmpty());
  EXPECT_EQ(image_of(scenario), ImageKind::rectified);
  EXPECT_EQ(scenario.config.steps[1].models[1].image, ImageKind::rectified);
}

TEST(ChooseImages, ALensThatCannotBeUsedIsRefusedForRawImagesOnly) {
  Scenario scenario = board(lens(), ImageKind::rectified);
  for (Sample& sample : scenario.samples) {
    sample.observations[1].camera->distortion_model = "bowl";
  }
  Diagnostics refused;
  choose_images(scenario.config, scenario.robot, scenario.samples, refused);
  EXPECT_THAT(refused.errors,
              ElementsAre(AllOf(HasSubstr("sensor 'eye': its lens has the distortion model "
                                          "'bowl', which raw images cannot have"),
                                HasSubstr("write 'image: rectified' in the model"))));
  EXPECT_TRUE(calibrate(scenario.calibration()).converged) << "its pixels count as rectified";
  scenario.config.steps[0].models[1].image = ImageKind::raw;
  EXPECT_THROW((void)scenario.calibration(), InputError);
}

TEST(ChooseImages, ADistortionWithTooFewNumbersIsNamed) {
  Scenario scenario = board(lens(), ImageKind::raw);
  for (Sample& sample : scenario.samples) {
    sample.observations[1].camera->distortion_model = "plumb_bob";
    sample.observations[1].camera->d = {0.1, 0.2, 0.3};
  }
  Diagnostics refused;
  choose_images(scenario.config, scenario.robot, scenario.samples, refused);
  EXPECT_THAT(refused.errors,
              ElementsAre(HasSubstr(
                  "sensor 'eye': its lens: plumb_bob has 5 distortion coefficients, not 3")));
}

/// Without K by P, and without P by K; both are solved and neither is refused as impossible.
TEST(ChooseImages, OneMatrixOfZerosIsNoObstacle) {
  CameraInfo no_k = lens(), no_p = lens();
  no_k.k = {};
  no_p.p = {};
  for (const auto& [info, kind] :
       {std::pair(no_k, ImageKind::rectified), std::pair(no_p, ImageKind::raw)}) {
    Scenario scenario = board(info, kind);
    (void)choose(scenario);
    const Calibration calibration = scenario.calibration();
    const CalibrationResult result = calibrate(calibration);
    ASSERT_TRUE(result.converged);
    EXPECT_NEAR(result.blocks[0].after.rms, std::sqrt(2.0) * 0.29, 0.03);
    EXPECT_EQ(impossible_camera(calibration, result.table, scenario.samples), "");
  }
  Scenario mirrored = board(lens(), ImageKind::raw);
  const Calibration calibration = mirrored.calibration();
  CalibrationResult result = calibrate(calibration);
  result.table["eye_fx"].value = -2.0123456789;
  EXPECT_THAT(impossible_camera(calibration, result.table, mirrored.samples),
              testing::ContainsRegex("lengths -[0-9.]{1,7} and .*is the image mirrored"));
  no_k.p = {};
  Scenario scenario = board(lens(), ImageKind::raw);
  for (Sample& sample : scenario.samples) sample.observations[1].camera = no_k;
  EXPECT_THROW((void)scenario.calibration(), InputError);
}

TEST(ChooseImages, ARawImageOfATurnedCameraIsWarnedOf) {
  CameraInfo info = lens();
  const Matrix3<double> turn = exp(Vector3<double>(0.0, 0.02, 0.0));
  for (int i = 0; i < 9; ++i) info.r[static_cast<std::size_t>(i)] = turn(i / 3, i % 3);
  Scenario raw = board(info, ImageKind::raw), rectified = board(info, ImageKind::rectified);
  EXPECT_THAT(choose(raw).warnings, ElementsAre(HasSubstr("by 1.1 degrees")));
  EXPECT_THAT(choose(rectified).warnings, IsEmpty());
}

/// The camera of the written files.
CameraInfo written_camera(const Scenario& scenario, const Calibration& calibration,
                          const CalibrationResult& result) {
  for (const OutputFile& file : result_files(scenario.robot, test::gantry_urdf(), "gantry.urdf",
                                             calibration, result, scenario.samples, {})) {
    if (file.name != "rgb_eye.yaml") continue;
    const test::TemporaryFolder folder;
    const std::string path = (folder.path() / file.name).string();
    std::ofstream(path) << file.content;
    Diagnostics diagnostics;
    return read_camera_file(path, diagnostics);
  }
  ADD_FAILURE() << "no camera file";
  return {};
}

TEST(ChooseImages, WrittenCamerasHaveWhatWasFoundInTheMatrixThatWasUsed) {
  for (const ImageKind truth : {ImageKind::raw, ImageKind::rectified}) {
    Scenario scenario = board(lens(), truth);
    (void)choose(scenario);
    const Calibration calibration = scenario.calibration();
    CalibrationResult result = calibrate(calibration);
    result.table["eye_cx"].value = 0.01;
    const CameraInfo c = written_camera(scenario, calibration, result);
    const bool raw = truth == ImageKind::raw;
    EXPECT_DOUBLE_EQ(raw ? c.k[2] : c.p[2], 1.01 * (raw ? 320 : 325));
    EXPECT_DOUBLE_EQ(raw ? c.p[2] : c.k[2], raw ? 325 + 3.2 * 520 / 550 : 320 + 3.25 * 550 / 520);
    EXPECT_NEAR(c.k[0] / 550, 1.0, 2e-3);
    EXPECT_DOUBLE_EQ(c.k[0] / 550, c.p[0] / 520);
  }
}

}  // namespace
}  // namespace kinecal
