// What the program makes of raw and rectified images.
#include "support/images.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::Not;

class ImagesProgram : public test::ProgramTest {
 protected:
  /// Calibrates the board.
  /// @param key  of the camera's model
  [[nodiscard]] test::Outcome calibrate(ImageKind truth, const std::string& key = "",
                                        const std::string& lens_model = "plumb_bob") {
    test::Scenario scenario = test::board(test::lens(), truth);
    for (Sample& sample : scenario.samples) {
      sample.observations[1].camera->distortion_model = lens_model;
    }
    std::string config = test::kBoardConfig;
    config.replace(config.find("HOLDER"), 6, "base_link");
    config.replace(config.find("frame: camera}"), 14, "frame: camera" + key + "}");
    std::ostringstream text;
    write_samples(text, scenario.samples);
    write("s.yaml", text.str());
    write("c.yaml", config);
    write("gantry.urdf", test::gantry_urdf());
    return run(
        test::kinecal_program() +
        " calibrate --urdf gantry.urdf --config c.yaml --samples s.yaml --output out --force");
  }
};

TEST_F(ImagesProgram, WhatFitsIsTakenAndSaidInOneLine) {
  const test::Outcome raw = calibrate(ImageKind::raw);
  EXPECT_EQ(raw.code, 0) << raw.err;
  EXPECT_THAT(raw.err, HasSubstr(": taken as raw\n"));
  EXPECT_THAT(raw.out, Not(HasSubstr("do not use")));
  const test::Outcome rectified = calibrate(ImageKind::rectified);
  EXPECT_EQ(rectified.code, 0) << rectified.err;
  EXPECT_THAT(rectified.err, HasSubstr("note: c.yaml:5: sensor 'eye': image raw "));
  EXPECT_THAT(rectified.err, HasSubstr(": taken as rectified\n"));
}

TEST_F(ImagesProgram, TheResultSaysWhatWasTakenForNewSamples) {
  ASSERT_EQ(calibrate(ImageKind::rectified).code, 0);
  const test::Outcome same = run(test::kinecal_program() + " evaluate out s.yaml --report e.json");
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_EQ(YAML::Load(read("out/report.json"))["images"]["eye"].as<std::string>(), "rectified");
  const YAML::Node block = YAML::Load(read("e.json"))["error_blocks"][0];
  EXPECT_NEAR(block["distance"].as<double>(), block["calibration"].as<double>(), 1e-6);
}

TEST_F(ImagesProgram, AKeyIsObeyedEvenIfItIsWrong) {
  const auto noise = [&](const std::string& key) {
    const test::Outcome result = calibrate(ImageKind::raw, key);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("image")));
    return YAML::Load(read("out/report.json"))["noise"][0]["sigma"].as<double>();
  };
  EXPECT_NEAR(noise(", image: raw"), 0.29, 0.03);
  EXPECT_GT(noise(", image: rectified"), 0.36);
}

TEST_F(ImagesProgram, ALensThatCannotBeUsedIsRefusedForRawImagesOnly) {
  const test::Outcome rectified = calibrate(ImageKind::rectified, ", image: rectified", "bowl");
  EXPECT_EQ(rectified.code, 0) << rectified.err;
  const test::Outcome unknown = calibrate(ImageKind::rectified, "", "bowl");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("its lens has the distortion model 'bowl', which raw"));
  const test::Outcome raw = calibrate(ImageKind::rectified, ", image: raw", "bowl");
  EXPECT_EQ(raw.code, 1);
  EXPECT_THAT(raw.err, HasSubstr("distortion model 'bowl' is not supported in raw images"));
}

}  // namespace
}  // namespace kinecal
