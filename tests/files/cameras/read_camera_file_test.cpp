#include "kinecal/files/cameras/read_camera_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using K = std::array<double, 9>;
using P = std::array<double, 12>;
const K kMatrix = {550.5, 0, 320.25, 0, 551.5, 240.75, 0, 0, 1};
const P kProjection = {550.5, 0, 320.25, 0, 0, 551.5, 240.75, 0, 0, 0, 1, 0};
const K kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};

const char* const kKalibr = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.29, 0.075, 0.0002, -0.0001]
  distortion_model: radtan
  intrinsics: [550.5, 551.5, 320.25, 240.75]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [500.0, 501.0, 300.0, 200.0]
  resolution: [1280, 720]
)";

const char* const kOpencv = R"(%YAML:1.0
---
calibration_time: "Tue 01 Jan 2030 10:00:00"
image_width: 640
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.505e+02, 0., 3.2025e+02, 0., 5.515e+02,
       240.75, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.29, 0.075, 0.0002, -0.0001, 0.01 ]
avg_reprojection_error: 0.25
)";

const char* const kMessage = R"(header:
  stamp: {sec: 1, nanosec: 2}
  frame_id: head
height: 480
width: 640
distortion_model: plumb_bob
d: [0.1, -0.2, 0.001, 0.002, 0.0]
k: [550.5, 0.0, 320.25, 0.0, 551.5, 240.75, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [550.5, 0.0, 320.25, -33.0, 0.0, 551.5, 240.75, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
roi: {x_offset: 0}
---
)";

class CameraFile : public test::FolderTest {
 protected:
  CameraInfo read(const std::string& text, const std::string& which = {}) {
    const std::string path = (folder_ / "c.yaml").string();
    std::ofstream(path, std::ios::binary) << text;
    diagnostics_ = {};
    return read_camera_file(path, diagnostics_, which);
  }
  /// All errors, without the folder.
  std::string refusal(const std::string& text, const std::string& which = {}) {
    try {
      (void)read(text, which);
      diagnostics_.throw_if_errors();
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string before = folder_.string() + "/";
      for (auto at = message.find(before); at != std::string::npos; at = message.find(before)) {
        message.erase(at, before.size());
      }
      return message;
    }
    return "(not refused)";
  }
  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  Diagnostics diagnostics_;
};

TEST_F(CameraFile, WhatIsWrittenIsReadBack) {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.distortion_model = "rational_polynomial";
  camera.d = {0.1, -0.2, 0.001, 1.0 / 3.0, 0.0, 1, 2, 3};
  camera.k = kMatrix;
  camera.r = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  camera.p = kProjection;
  camera.p[3] = -1.0 / 3.0;
  for (const std::string& text :
       {to_camera_info_yaml(camera, "a: b"), to_camera_message_yaml(camera)}) {
    const CameraInfo again = read(text);
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_EQ(again.width, 640);
    EXPECT_EQ(again.height, 480);
    EXPECT_EQ(again.distortion_model, camera.distortion_model);
    EXPECT_EQ(again.d, camera.d);
    EXPECT_EQ(again.k, camera.k);
    EXPECT_EQ(again.r, camera.r);
    EXPECT_EQ(again.p, camera.p);
  }
}

TEST_F(CameraFile, ReadsMessagesOfBothRos) {
  std::string ros1 = kMessage;
  for (const char* key : {"d", "k", "r", "p"}) {
    ros1 = replaced(ros1, std::string("\n") + key + ":",
                    std::string("\n") + static_cast<char>(*key - 32) + ":");
  }
  for (const std::string& text : {std::string(kMessage), ros1}) {
    const CameraInfo camera = read(text);
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.k, kMatrix);
    EXPECT_EQ(camera.p[3], -33.0);
    EXPECT_THAT(camera.d, ElementsAre(0.1, -0.2, 0.001, 0.002, 0.0));
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  }
}

TEST_F(CameraFile, AKOfZerosIsAnErrorInItsLine) {
  std::string text = kMessage;
  text = replaced(text, "k: [550.5, 0.0, 320.25, 0.0, 551.5,", "k: [0.0, 0.0, 320.25, 0.0, 0.0,");
  text = replaced(text, "p: [550.5, 0.0, 320.25, -33.0, 0.0, 551.5,",
                  "p: [0.0, 0.0, 320.25, -33.0, 0.0, 0.0,");
  EXPECT_THAT(refusal(text), HasSubstr("c.yaml:8: focal lengths 0 and 0 are not greater than"));
}

TEST_F(CameraFile, WarnsOfBinningAndOfARegion) {
  (void)read(replaced(kMessage, "binning_x: 0", "binning_x: 2\nbinning_y: 2"));
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("c.yaml: camera_info has binning 2 x 2, "
                                                           "which is not used: K and P are")));
  const std::string part = "roi: {x_offset: 8, y_offset: 4, width: 320, height: 240}";
  (void)read(replaced(kMessage, "roi: {x_offset: 0}", part));
  EXPECT_THAT(
      diagnostics_.warnings,
      ElementsAre(HasSubstr("has a region of interest of 320 x 240 pixels at 8, 4, which")));
  (void)read(
      replaced(kMessage, "roi: {x_offset: 0}",  // the full image
               "binning_y: 1\nroi: {x_offset: 0, width: 640, height: 480, do_rectify: true}"));
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(CameraFile, ReadsOneCameraOfACamchain) {
  const CameraInfo camera = read(kKalibr, "cam0");
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.distortion_model, "plumb_bob");
  EXPECT_THAT(camera.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001, 0.0));
  EXPECT_EQ(camera.k, kMatrix);
  EXPECT_EQ(camera.r, kIdentity);
  EXPECT_EQ(camera.p, kProjection);
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("rectified to it")));
  EXPECT_EQ(read(kKalibr, "cam1").k[4], 501.0);
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
}

TEST_F(CameraFile, ACameraMustBeChosenIfThereAreSeveral) {
  EXPECT_THAT(refusal(kKalibr),
              HasSubstr("c.yaml: there are several cameras, cam0 to cam1; choose one"));
  EXPECT_THAT(refusal(kKalibr, "cma1"), HasSubstr("no camera 'cma1'; did you mean 'cam1'?"));
  EXPECT_THAT(refusal(kMessage, "cam0"), HasSubstr("there is no 'cam0'"));
  const std::string text = kKalibr;
  EXPECT_EQ(read(text.substr(0, text.find("cam1:"))).k, kMatrix);
}

TEST_F(CameraFile, ReadsKalibrsFisheyes) {
  CameraInfo camera = read(replaced(kKalibr, "radtan", "equidistant"), "cam0");
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(camera.distortion_model, "equidistant");
  EXPECT_THAT(camera.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001));
  EXPECT_EQ(camera.k, kMatrix);
  camera = read(replaced(replaced(replaced(replaced(kKalibr, "model: pinhole", "model: ds"),
                                           "radtan", "none"),
                                  "[-0.29, 0.075, 0.0002, -0.0001]", "[]"),
                         "[550.5,", "[-0.2, 0.6, 550.5,"),
                "cam0");
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(camera.distortion_model, "double_sphere");
  EXPECT_THAT(camera.d, ElementsAre(-0.2, 0.6));
  EXPECT_EQ(camera.k, kMatrix);
}

TEST_F(CameraFile, WhatIsWrittenForKalibrAndOpencvIsReadBack) {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.k = kMatrix;
  const auto check = [&](const std::string& text, const std::string& which) {
    const CameraInfo again = read(text, which);
    EXPECT_THAT(diagnostics_.errors, IsEmpty()) << text;
    EXPECT_EQ(again.distortion_model, camera.distortion_model) << text;
    EXPECT_EQ(again.d, camera.d) << text;
    EXPECT_EQ(again.k, camera.k) << text;
    EXPECT_EQ(again.width, 640) << text;
  };
  for (const auto& [model, d] :
       std::map<std::string, std::vector<double>>{{"plumb_bob", {0.1, -0.2, 1.0 / 3.0, 0.02, 0.0}},
                                                  {"equidistant", {0.1, -0.2, 1.0 / 3.0, 0.02}},
                                                  {"double_sphere", {-0.2, 1.0 / 3.0}}}) {
    camera.distortion_model = model;
    camera.d = d;
    check(to_kalibr_yaml(camera, "cam0"), "");
    if (model == "double_sphere") {
      EXPECT_THROW((void)to_opencv_yaml(camera), std::invalid_argument);
    } else {
      check(to_opencv_yaml(camera), "");
    }
  }
  camera.distortion_model = "rational_polynomial";
  camera.d = {0.1, -0.2, 0.001, 1.0 / 3.0, 0.0, 1, 2, 3};
  check(to_opencv_yaml(camera), "");
  EXPECT_THROW((void)to_kalibr_yaml(camera, "cam0"), std::invalid_argument) << "eight coefficients";
  camera.d.resize(14, 0.0);
  check(to_opencv_yaml(camera), "");
}

TEST_F(CameraFile, RefusesKalibrsOtherModelsByName) {
  EXPECT_EQ(refusal(replaced(kKalibr, "model: pinhole", "model: omni"), "cam0"),
            "c.yaml:3: cam0: camera_model 'omni' is not supported; it must be pinhole or ds");
  EXPECT_EQ(refusal(replaced(kKalibr, "radtan", "fov"), "cam0"),
            "c.yaml:5: cam0: distortion_model 'fov' is not supported; it must be radtan or "
            "equidistant or none");
  EXPECT_EQ(refusal(replaced(kKalibr, "550.5, 551.5", "550.5"), "cam0"),
            "c.yaml:6: cam0: intrinsics has 3 numbers, not 4");
  EXPECT_THAT(refusal(replaced(kKalibr, "resolution: [640, 480]", "res: []"), "cam0"),
              HasSubstr("cam0: resolution is missing"));
  EXPECT_THAT(refusal(replaced(kKalibr, "[640, 480]", "[640.5, 480]"), "cam0"),
              HasSubstr("640.5 is not a number of pixels"));
}

TEST_F(CameraFile, ReadsOpencvWithItsHeaderAndTags) {
  for (const std::string& begin : {std::string(), std::string("\xEF\xBB\xBF")}) {
    const CameraInfo camera = read(begin + kOpencv);
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.height, 480);
    EXPECT_EQ(camera.distortion_model, "plumb_bob");
    EXPECT_THAT(camera.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001, 0.01));
    EXPECT_EQ(camera.k, kMatrix);
    EXPECT_EQ(camera.p, kProjection);
  }
}

TEST_F(CameraFile, OpencvsKeysMayBeWrittenInOtherWays) {
  std::string text = replaced(kOpencv, "camera_matrix", "cameraMatrix");
  text = replaced(text, "distortion_coefficients", "Distortion_Coefficients");
  text = replaced(text, "---\n", "");  // older versions
  text = replaced(text, "rows: 5", "rows: 4");
  text = replaced(text, ", 0.01 ]", " ]");
  const CameraInfo camera = read(text);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(camera.k, kMatrix);
  EXPECT_THAT(camera.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001, 0.0));
}

TEST_F(CameraFile, OpencvsDistortionHasManyNames) {
  for (const char* key :
       {"dist_coeff", "dist_coeffs", "distCoeffs", "distortion_coefs", "distortion_coeff", "dist",
        "distortion", "distortion_parameters", "camera_distortion", "lens_distortion", "Distortion",
        "cameraDistCoeffs", "dist_matrix", "d", "D", "distortion-coefficients"}) {
    const CameraInfo camera = read(replaced(kOpencv, "distortion_coefficients", key));
    EXPECT_THAT(diagnostics_.errors, IsEmpty()) << key;
    EXPECT_THAT(camera.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001, 0.01)) << key;
  }
}

TEST_F(CameraFile, ADistortionUnderAnUnknownNameIsNotLostInSilence) {
  for (const char* key : {"distorsion", "kc", "radial_tangential", "lens", "coefficients", "my_d",
                          "distotion_coeficients", "dist_coeffs_left", "D1", "calib"}) {
    EXPECT_THAT(refusal(replaced(kOpencv, "distortion_coefficients", key)),
                AllOf(HasSubstr("c.yaml:13: unknown key '" + std::string(key) + "'"),
                      HasSubstr("call it 'distortion_coefficients'")));
  }
  const std::string apart = replaced(kOpencv, "distortion_coefficients", "per_view_errors");
  EXPECT_THAT(refusal(apart + "k1: -0.29\nk2: 0.075\n"),
              AllOf(HasSubstr("unknown key 'k1'"), HasSubstr("unknown key 'k2'"),
                    HasSubstr("list the coefficients under 'distortion_coefficients'")));
}

TEST_F(CameraFile, NoDistortionAtAllIsAWarningAndOtherMatricesAreNotTakenForOne) {
  const std::string text = replaced(kOpencv, "distortion_coefficients", "per_view_errors") +
                           "tvec: [0.1, 0.2, 0.3]\nroi: [0, 0, 640, 480]\n"
                           "distance_to_board: 1.5\n";
  EXPECT_THAT(read(text).d, testing::Each(0.0));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings,
              ElementsAre(HasSubstr("there is no distortion_coefficients; the lens is taken")));
}

TEST_F(CameraFile, ACameraInfoWithItsDistortionUnderAnotherKeyIsRefused) {
  CameraInfo camera;
  camera.k = kMatrix;
  camera.p = kProjection;
  camera.width = camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.d = {-0.3, 0.1, 0.001, 0.002, 0.01};
  const std::string text = to_camera_info_yaml(camera, "head");
  for (const char* key :
       {"dist_coeff", "distortion_coefs", "distortion", "distorsion", "D_coeffs"}) {
    EXPECT_THAT(refusal(replaced(text, "distortion_coefficients", key)),
                AllOf(HasSubstr("unknown key '" + std::string(key) + "'"),
                      HasSubstr("call it 'distortion_coefficients'")));
  }
  EXPECT_THAT(refusal(replaced(kMessage, "\nd:", "\ndist:")), HasSubstr("call it 'd'"));
  (void)read(replaced(text, "distortion_coefficients", "distortion_coefficients: []\nknown"));
  EXPECT_THAT(diagnostics_.errors, IsEmpty()) << "no distortion, as it says";
}

TEST_F(CameraFile, RefusesWhatOpencvHasAndCameraInfoHasNot) {
  EXPECT_THAT(
      refusal(replaced(replaced(kOpencv, ", 0.01 ]", " , 0.01, 0 ]"), "rows: 5", "rows: 6")),
      HasSubstr("c.yaml:13: distortion_coefficients has 6 numbers; OpenCV has 4, 5, 8, 12 "
                "or 14"));
  EXPECT_THAT(refusal(replaced(kOpencv, "flags: 0", "fisheye_model: 1")),
              HasSubstr("c.yaml:13: distortion_coefficients has 5 numbers; a fisheye_model has 4"));
  EXPECT_THAT(refusal(replaced(kOpencv, "rows: 5", "rows: 4")),
              HasSubstr("distortion_coefficients has 5 numbers, not '4' x '1'"));
}

TEST_F(CameraFile, KeysThatDecideAreNotLostInAnyFormat) {
  EXPECT_EQ(refusal(replaced(kKalibr, "distortion_coeffs", "distortion_coefficients"), "cam0"),
            "c.yaml:4: cam0: unknown key 'distortion_coefficients'; did you mean "
            "'distortion_coeffs'?");
  EXPECT_EQ(refusal(replaced(kKalibr, "resolution", "image_size"), "cam0"),
            "c.yaml:7: cam0: unknown key 'image_size'; did you mean 'resolution'?");
  EXPECT_THAT(refusal(replaced(kKalibr, "  cam_overlaps: [1]", "  lens_scale: 2"), "cam0"),
              HasSubstr("unknown key 'lens_scale' looks like a unit or scale"));
  EXPECT_THAT(refusal(replaced(kOpencv, "image_width: 640\nimage_height: 480",
                               "frameSize: [640, 480]\nsquare_size: 0.02")),
              HasSubstr("c.yaml:4: unknown key 'frameSize' looks like the size of the image"));
  EXPECT_THAT(refusal(replaced(kMessage, "\nd:", "\nCamera.k1: 0.3\nx:")),
              HasSubstr("unknown key 'Camera.k1': is it the distortion"));
  EXPECT_THAT(refusal(replaced(kMessage, "\nd:", "\nlens: {k1: 0.3}\nx:")),
              HasSubstr("unknown key 'lens': is it the distortion"));
  EXPECT_EQ(refusal(replaced(kOpencv, "flags: 0", "square_size: 0.02\nboard_width: 9")),
            "(not refused)")
      << "of what calibrated the camera";
}

TEST_F(CameraFile, WithoutASizeIsReadWithAWarning) {
  const CameraInfo camera = read(replaced(kMessage, "width: 640\n", ""));
  EXPECT_EQ(camera.width, 0);
  EXPECT_THAT(diagnostics_.errors, testing::IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, testing::ElementsAre(HasSubstr("c.yaml: the size of the")));
}

TEST_F(CameraFile, OneMatrixOfZerosIsReadWithAWarning) {
  CameraInfo camera;
  camera.width = camera.height = 480;
  camera.p = kProjection;
  (void)read(to_camera_info_yaml(camera, "head"));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("c.yaml: K is zero; P is used")));
  camera.k = kMatrix;
  camera.p = {};
  diagnostics_ = {};
  (void)read(to_camera_info_yaml(camera, "head"));
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("c.yaml: P is zero; K is used")));
  camera.k = {};
  EXPECT_THAT(refusal(to_camera_info_yaml(camera, "head")), HasSubstr("focal lengths 0 and 0"));
}

TEST_F(CameraFile, ReportsErrorsWithTheirLine) {
  EXPECT_THAT(refusal(replaced(kMessage, "0.0, 0.0, 1.0]\nr", "0.0, 1.0]\nr")),
              HasSubstr("c.yaml:8: k has 8 numbers, not 9"));
  EXPECT_THAT(refusal(replaced(kMessage, "551.5", "abc")),
              HasSubstr("c.yaml:8: k: 'abc' is not a finite number"));
  EXPECT_THAT(refusal(replaced(kMessage, "551.5", ".nan")), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal(replaced(kMessage, "551.5", "0")), HasSubstr("not greater than zero"));
  EXPECT_THAT(refusal(replaced(kMessage, "0.0, 0.0, 1.0]\nr", "0.0, 0.0, 0.0]\nr")),
              HasSubstr("the last row of the camera matrix is 0 0 0, not 0 0 1"));
  EXPECT_THAT(refusal(replaced(kMessage, "width: 640", "width: -1")), HasSubstr("c.yaml:5: width"));
  EXPECT_THAT(refusal(replaced(kMessage, "roi", "K: []\nroi")),
              HasSubstr("c.yaml:8: 'k' says the same as 'K' in line 12; keep one of them"));
  EXPECT_THAT(refusal(replaced(kMessage, "roi", "k: []\nroi")), HasSubstr("'k' occurs twice"));
  EXPECT_THAT(refusal("camera_matrix: {rows: 3, cols: 3, data: 5}"),
              HasSubstr("c.yaml:1: camera_matrix is neither a list of numbers"));
}

TEST_F(CameraFile, RefusesAMisspeltMatrixInsteadOfDoingWithoutIt) {
  CameraInfo camera;
  camera.k = kMatrix;
  camera.p = kProjection;
  camera.width = camera.height = 480;
  const std::string text = to_camera_info_yaml(camera, "head");
  EXPECT_THAT(refusal(replaced(text, "projection_matrix", "projecton_matrix")),
              HasSubstr("unknown key 'projecton_matrix'; did you mean 'projection_matrix'?"));
  (void)read(text + "grabber: 1\n");
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("unknown key 'grabber' is ignored")));
}

TEST_F(CameraFile, RefusesWhatIsNotACameraFile) {
  EXPECT_THAT(refusal("a: 1"),
              HasSubstr("c.yaml: is not a camera file: it has neither camera_matrix"));
  EXPECT_THAT(refusal(""), HasSubstr("c.yaml: is not a camera file"));
  EXPECT_THAT(refusal("[1, 2"), HasSubstr("c.yaml:"));
  EXPECT_THAT(refusal(","), HasSubstr("c.yaml:"));
  EXPECT_THROW((void)read_camera_file((folder_ / "none.yaml").string(), diagnostics_), InputError);
  EXPECT_THROW((void)read_camera_file(folder_.string(), diagnostics_), InputError);
}

std::vector<Sample> two_samples() {
  Sample sample;
  sample.observations = {{"camera", {}, {}}, {"arm", {}, {}}};
  return {sample, sample};
}

class SetCamera : public CameraFile {
 protected:
  /// "NAME=" and a file of this text.
  std::string argument(const std::string& name, const std::string& text) {
    (void)read(text);
    diagnostics_ = {};
    return name + "=" + (folder_ / "c.yaml").string();
  }
};

TEST_F(SetCamera, FillsWhatHasNoCamera) {
  std::vector<Sample> samples = two_samples();
  set_camera(samples, argument("camera", kMessage), diagnostics_);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_THAT(diagnostics_.warnings, IsEmpty());
  for (const Sample& sample : samples) {
    ASSERT_TRUE(sample.observations[0].camera);
    EXPECT_EQ(sample.observations[0].camera->k, kMatrix);
    EXPECT_FALSE(sample.observations[1].camera);
  }
}

TEST_F(SetCamera, LeavesWhatWasRecordedAndSaysSo) {
  std::vector<Sample> samples = two_samples();
  samples[0].observations[0].camera = CameraInfo{};  // as photographs have it: nothing but a size
  samples[1].observations[0].camera = CameraInfo{};
  samples[1].observations[0].camera->k = kMatrix;
  set_camera(samples, argument("camera", kKalibr) + ":cam1", diagnostics_);
  EXPECT_EQ(samples[0].observations[0].camera->width, 1280);
  EXPECT_EQ(samples[1].observations[0].camera->width, 0);
  EXPECT_THAT(diagnostics_.warnings, ElementsAre(HasSubstr("1 of 2 samples have a camera_info")));
}

TEST_F(SetCamera, RefusesASensorThatNoSampleHas) {
  std::vector<Sample> samples = two_samples();
  set_camera(samples, argument("camra", kMessage), diagnostics_);
  EXPECT_THAT(diagnostics_.errors,
              ElementsAre(AllOf(HasSubstr("'camra'"), HasSubstr("did you mean 'camera'?"))));
  EXPECT_THROW(set_camera(samples, "camera", diagnostics_), InputError);
  EXPECT_THROW(set_camera(samples, "=c.yaml", diagnostics_), InputError);
}

const char* const kStereo = R"(%YAML:1.0
---
M1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 550.5, 0., 320.25, 0., 551.5, 240.75, 0., 0., 1. ]
D1: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.29, 0.075, 0.0002, -0.0001, 0.01 ]
M2: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 600., 0., 330., 0., 601., 250., 0., 0., 1. ]
D2: !!opencv-matrix
   rows: 1
   cols: 14
   dt: d
   data: [ -0.1, 0.2, 0., 0., 0., 0., 0., 0.3, 0., 0., 0., 0., 0., 0. ]
)";

/// As OpenCV's sample stereo_calib writes intrinsics.yml, and others do under other names.
TEST_F(CameraFile, ReadsACameraOfAStereoFile) {
  std::string named = kStereo;
  for (const auto& [from, to] : {std::pair("M1", "cameraMatrix_left"),
                                 {"D1", "dist_coeffs_left"},
                                 {"M2", "cameraMatrix_right"},
                                 {"D2", "dist_coeffs_right"}}) {
    named = replaced(named, from, to);
  }
  for (const auto& [text, first, second] :
       {std::tuple(std::string(kStereo), "1", "2"), {named, "left", "right"}}) {
    const CameraInfo one = read(text, first);
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_EQ(one.k, kMatrix);
    EXPECT_THAT(one.d, ElementsAre(-0.29, 0.075, 0.0002, -0.0001, 0.01));
    EXPECT_EQ(one.distortion_model, "plumb_bob");
    const CameraInfo two = read(text, second);
    EXPECT_THAT(diagnostics_.errors, IsEmpty());
    EXPECT_EQ(two.k, (K{600, 0, 330, 0, 601, 250, 0, 0, 1}));
    EXPECT_EQ(two.distortion_model, "rational_polynomial");
    EXPECT_EQ(two.d.at(7), 0.3);
  }
  EXPECT_THAT(refusal(kStereo),
              HasSubstr("c.yaml: there are several cameras, 1, 2; choose one: c.yaml:1"));
  EXPECT_THAT(refusal(kStereo, "3"), HasSubstr("c.yaml: there is no camera '3'"));
}

/// The lens of the second camera must not be lost either.
TEST_F(CameraFile, AStereoCameraWithItsDistortionUnderAnotherNameIsRefused) {
  EXPECT_THAT(refusal(replaced(kStereo, "D1:", "Dx1:"), "1"),
              HasSubstr("c.yaml:8: unknown key 'Dx1'"));
}

TEST_F(CameraFile, ReadsOpencvXml) {
  const std::string xml = R"(<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Tue 01 Jan 2030 10:00:00"</calibration_time>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    5.505e+02 0. 3.2025e+02 0. 5.515e+02 240.75 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>5</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>
    -0.29 0.075 0.0002 -0.0001 0.01</data></distortion_coefficients>
</opencv_storage>
)";
  const CameraInfo camera = read(xml), yaml = read(kOpencv);
  EXPECT_THAT(diagnostics_.errors, IsEmpty());
  EXPECT_EQ(camera.k, yaml.k);
  EXPECT_EQ(camera.d, yaml.d);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.distortion_model, "plumb_bob");
  EXPECT_THAT(refusal(replaced(xml, "240.75 0.", "240.75 x")),
              HasSubstr("c.yaml:10: camera_matrix: 'x' is not"));
  EXPECT_THAT(refusal(replaced(xml, "</opencv_storage>", "")),
              HasSubstr("c.yaml:18: malformed XML"));
  EXPECT_THAT(refusal("<robot name='a'/>"),
              HasSubstr("a camera file of OpenCV in XML begins with <opencv_storage>"));
  EXPECT_THAT(refusal(replaced(replaced(xml, "distortion_coefficients type", "lens type"),
                               "</distortion_coefficients>", "</lens>")),
              HasSubstr("unknown key 'lens'"));
}

}  // namespace
}  // namespace kinecal
