#include "kinecal/files/samples/read_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "support/data.hpp"

namespace kinecal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::StartsWith;

struct ReadText {
  std::string path;
  std::vector<Sample> samples;
  Diagnostics diagnostics;

  /// "path:line: "
  [[nodiscard]] std::string at(int line) const { return path + ":" + std::to_string(line) + ": "; }
};

ReadText read_text(const std::string& text) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  ReadText reading;
  reading.path = ::testing::TempDir() + "read_samples_" + test->name() + ".yaml";
  std::ofstream(reading.path, std::ios::binary) << text;
  reading.samples = read_samples(reading.path, reading.diagnostics);
  std::filesystem::remove(reading.path);
  return reading;
}

const std::string kJoints = "joint_states: {name: [a, b], position: [0.5, -1]}\n";
const std::string kArm =
    "observations:\n"
    "- sensor_name: arm\n"
    "  features: [{header: {frame_id: tip}, point: {x: 1, y: 2, z: 3}}]\n";
const std::string kSample = kJoints + kArm + "---\n";  // four lines and the separator

const std::string kNine = "[1, 2, 3, 4, 5, 6, 7, 8, 9]";
const std::string kTwelve = "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]";

/// A sample whose sensor has this camera_info; it stands in line 5.
std::string with_camera(const std::string& camera_info, const std::string& parameters = "") {
  return kJoints +
         "observations:\n- sensor_name: head\n  ext_camera_info:\n    camera_info: " + camera_info +
         "\n" + parameters + "---\n";
}

/// The text is refused with one message: the line of the file, and the words.
void expect_error(const std::string& text, int line, const std::vector<std::string>& words) {
  const ReadText reading = read_text(text);
  ASSERT_EQ(reading.diagnostics.errors.size(), 1u)
      << ::testing::PrintToString(reading.diagnostics.errors);
  EXPECT_THAT(reading.diagnostics.errors[0], StartsWith(reading.at(line)));
  for (const std::string& word : words) {
    EXPECT_THAT(reading.diagnostics.errors[0], HasSubstr(word));
  }
  EXPECT_THROW(reading.diagnostics.throw_if_errors(), InputError);
}

TEST(ReadSamples, OfAFileThatWasCutOffTheCompleteSamplesAreRead) {
  const std::string path = ::testing::TempDir() + "read_samples_cut_off.yaml";
  const std::string two = kSample + kSample;
  for (std::size_t size = 0; size <= two.size(); ++size) {
    std::ofstream(path, std::ios::binary) << two.substr(0, size);
    Diagnostics diagnostics;
    const std::vector<Sample> samples = read_complete_samples(path, diagnostics);
    // The line break after the last --- may be missing.
    const std::size_t complete = (size + 1 >= kSample.size()) + (size + 1 >= two.size());
    ASSERT_EQ(samples.size(), complete) << size;
    EXPECT_THAT(diagnostics.errors, IsEmpty());
    const bool is_whole =
        size == 0 || size + 1 == kSample.size() || size == kSample.size() || size + 1 >= two.size();
    if (is_whole) {
      EXPECT_THAT(diagnostics.warnings, IsEmpty()) << size;
    } else {
      const std::string line = size < kSample.size() ? ":1: " : ":6: ";
      EXPECT_THAT(diagnostics.warnings, ElementsAre(HasSubstr(line + "the last sample"))) << size;
    }
  }
  std::filesystem::remove(path);
}

TEST(ReadSamples, EachDocumentIsASampleThatKnowsItsLine) {
  const ReadText reading = read_text(kSample + "# a comment\n" + kSample);
  EXPECT_THAT(reading.diagnostics.errors, IsEmpty());
  EXPECT_THAT(reading.diagnostics.warnings, IsEmpty());
  ASSERT_EQ(reading.samples.size(), 2u);
  EXPECT_EQ(reading.samples[0].source, reading.path + ":1");
  EXPECT_EQ(reading.samples[1].source, reading.path + ":7");
  const Sample& sample = reading.samples[1];
  EXPECT_THAT(sample.joint_names, ElementsAre("a", "b"));
  EXPECT_THAT(sample.joint_positions, ElementsAre(0.5, -1.0));
  ASSERT_EQ(sample.observations.size(), 1u);
  EXPECT_EQ(sample.observations[0].sensor, "arm");
  ASSERT_EQ(sample.observations[0].features.size(), 1u);
  EXPECT_EQ(sample.observations[0].features[0].frame, "tip");
  EXPECT_EQ(sample.observations[0].features[0].point, Vector3<double>(1.0, 2.0, 3.0));
  EXPECT_FALSE(sample.observations[0].camera);
}

TEST(ReadSamples, ASensorThatOccursTwiceIsFoundAmongManyInOneSampleOnly) {
  constexpr int kSensors = 4000;
  std::string text;
  for (int sample = 0; sample < 2; ++sample) {
    text += std::string(kJoints) + "observations:\n";
    for (int i = 0; i < kSensors; ++i) {
      text += "- {sensor_name: sensor_" + std::to_string(i) + ", features: []}\n";
    }
    if (sample == 1) text += "- {sensor_name: sensor_7, features: []}\n";
    text += "---\n";
  }
  const ReadText reading = read_text(text);
  EXPECT_THAT(reading.diagnostics.errors, ElementsAre(HasSubstr("sensor 'sensor_7' occurs twice")));
}

TEST(ReadSamples, CameraIsReadWithTheKeysOfRos1AndOfRos2) {
  const std::string start = "{height: 480, width: 640, distortion_model: plumb_bob, ";
  const std::string values[4] = {"[0.1, -0.2]", kNine, kNine, kTwelve};
  for (const std::string keys : {"DKRP", "dkrp"}) {
    std::string camera_info = start;
    for (std::size_t i = 0; i < 4; ++i) {
      camera_info += std::string(i > 0 ? ", " : "") + keys[i] + ": " + values[i];
    }
    const ReadText reading = read_text(
        with_camera(camera_info + "}",
                    "    parameters: [{name: z_scaling, value: 1.25}, {name: other, value: "
                    "word}, {name: z_offset_mm, value: -1.5}]\n"));
    ASSERT_THAT(reading.diagnostics.errors, IsEmpty()) << keys;
    ASSERT_TRUE(reading.samples.at(0).observations.at(0).camera) << keys;
    const CameraInfo& camera = *reading.samples[0].observations[0].camera;
    EXPECT_EQ(camera.height, 480);
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.distortion_model, "plumb_bob");
    EXPECT_THAT(camera.d, ElementsAre(0.1, -0.2));
    EXPECT_THAT(camera.k, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
    EXPECT_THAT(camera.r, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
    EXPECT_THAT(camera.p, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
    EXPECT_EQ(camera.z_offset, -0.0015);
    EXPECT_EQ(camera.z_scaling, 1.25);
  }
}

TEST(ReadSamples, BlockStyleAndCarriageReturnsAreTheSameAsFlowStyle) {
  std::string text =
      "joint_states:\n  header:\n    seq: 0\n    stamp: {secs: 0, nsecs: 0}\n    frame_id: ''\n"
      "  name:\n  - \"a\"\n  - 'b'\n  position:\n  - 0.5\n  - -1\n  velocity: []\n  effort: []\n"
      "observations:\n  - sensor_name: \"arm\"\n    features:\n"
      "      - header:\n          seq: 7\n          frame_id: tip\n"
      "        point:\n          x: 1\n          y: 2\n          z: 3\n---\n";
  for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2) {
    text.insert(i, "\r");
  }
  const ReadText reading = read_text(text);
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  EXPECT_THAT(reading.diagnostics.warnings, IsEmpty());
  EXPECT_THAT(reading.samples.at(0).joint_names, ElementsAre("a", "b"));
  EXPECT_THAT(reading.samples[0].joint_positions, ElementsAre(0.5, -1.0));
  const Feature& feature = reading.samples[0].observations.at(0).features.at(0);
  EXPECT_EQ(feature.frame, "tip");
  EXPECT_EQ(feature.point, Vector3<double>(1.0, 2.0, 3.0));
}

TEST(ReadSamples, UnknownKeysAreSkippedHoweverDeep) {
  const ReadText reading = read_text(
      kJoints + "x: {joint_states: [{position: [word]}, &i 1, *i], observations: 3}\n" + kArm +
      "  cloud: {fields: [{name: x, offset: 0}], data: [1, 2], position: {x: word}}\n"
      "  image: ~\n"
      "? {a: 1}\n: {joint_states: 1}\n? [sensor_name]\n: 2\n---\n");
  EXPECT_THAT(reading.diagnostics.errors, IsEmpty());
  ASSERT_EQ(reading.samples.size(), 1u);
  EXPECT_EQ(reading.samples[0].joint_positions.size(), 2u);
  EXPECT_EQ(reading.samples[0].observations.size(), 1u);
}

TEST(ReadSamples, NanAndInfinityAreKept) {
  const ReadText reading = read_text(
      "joint_states: {name: [a, b, c, d, e], position: [nan, .nan, -inf, .inf, +1.5e+1]}\n" + kArm +
      "---\n");
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  const std::vector<double>& q = reading.samples.at(0).joint_positions;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(q[0]) && std::isnan(q[1]));
  EXPECT_EQ(q[2], -kInfinity);
  EXPECT_EQ(q[3], kInfinity);
  EXPECT_EQ(q[4], 15.0);
}

TEST(ReadSamples, CameraOfASensorThatIsNotACameraIsUnset) {
  const std::string zeros = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";
  const std::string message =
      "{header: {frame_id: ''}, height: 0, width: 0, distortion_model: '', D: [], K: " + zeros +
      ", R: " + zeros + ", P: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], binning_x: 0}";
  for (const std::string& camera_info : {message, std::string("{}"), std::string("~"),
                                         std::string("{height: 0, width: 0, K: [], P: []}")}) {
    const ReadText reading = read_text(with_camera(camera_info, "    parameters: []\n"));
    ASSERT_THAT(reading.diagnostics.errors, IsEmpty()) << camera_info;
    EXPECT_FALSE(reading.samples.at(0).observations.at(0).camera) << camera_info;
  }
}

TEST(ReadSamples, DepthParametersWithoutACameraAreAWarning) {
  const ReadText reading =
      read_text(with_camera("{}", "    parameters: [{name: z_scaling, value: 1.01}]\n"));
  EXPECT_THAT(reading.diagnostics.errors, IsEmpty());
  EXPECT_THAT(reading.diagnostics.warnings,
              ElementsAre(AllOf(StartsWith(reading.at(3)), HasSubstr("'head'"),
                                HasSubstr("z_scaling are not used"))));
}

TEST(ReadSamples, BinningAndARegionAreAWarningOnceForASensor) {
  const std::string sample = with_camera("{width: 4, height: 4, p: " + kTwelve +
                                         ", binning_x: 2, binning_y: 2, "
                                         "roi: {x_offset: 1, y_offset: 0, height: 2, width: 2, "
                                         "do_rectify: false}}");
  const ReadText reading = read_text(sample + sample);
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  EXPECT_THAT(reading.diagnostics.warnings,
              ElementsAre(HasSubstr("sensor 'head': camera_info has binning 2 x 2 and a region of "
                                    "interest of 2 x 2 pixels at 1, 0, which is not used")));
  const ReadText full = read_text(with_camera("{width: 4, height: 4, p: " + kTwelve +
                                              ", binning_x: 1, roi: {width: 4, height: 4}}"));
  EXPECT_THAT(full.diagnostics.warnings, IsEmpty());
}

TEST(ReadSamples, EmptyKAndRAreZeros) {
  const ReadText reading = read_text(with_camera("{width: 4, K: [], P: " + kTwelve + "}"));
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  const CameraInfo& camera = reading.samples.at(0).observations.at(0).camera.value();
  EXPECT_EQ(camera.k, (std::array<double, 9>{}));
  EXPECT_EQ(camera.r, (std::array<double, 9>{}));
}

TEST(ReadSamples, ListOfTheWrongSizeNamesSampleSensorAndSize) {
  const std::string two = kSample;  // the sample that is wrong is the second one, from line 6
  const auto expect_size = [&](const std::string& camera_info, const std::string& words) {
    expect_error(two + with_camera(camera_info), 10, {"sample at line 6", "'head'", words});
  };
  expect_size("{width: 4, K: [1, 2], P: " + kTwelve + "}", "K of camera_info has 2 numbers, not 9");
  expect_size("{width: 4, R: " + kTwelve + ", P: " + kTwelve + "}", "R of camera_info has 12 num");
  expect_size("{width: 4, p: " + kNine + "}", "P of camera_info has 9 numbers, not 12");
  expect_size("{width: 4, K: " + kNine + "}", "P of camera_info has 0 numbers, not 12");
}

TEST(ReadSamples, MissingFileIsAnError) {
  Diagnostics diagnostics;
  EXPECT_THAT(read_samples("does/not/exist.yaml", diagnostics), IsEmpty());
  EXPECT_THAT(diagnostics.errors, ElementsAre(AllOf(StartsWith("does/not/exist.yaml: "),
                                                    HasSubstr("cannot be opened"))));
}

TEST(ReadSamples, FolderIsAnError) {
  Diagnostics diagnostics;
  const std::string folder = ::testing::TempDir();
  EXPECT_THAT(read_samples(folder, diagnostics), IsEmpty());
  EXPECT_THAT(diagnostics.errors, ElementsAre(folder + ": is a folder, not a file"));
}

TEST(ReadSamples, APipeIsAnErrorAndIsNotOpened) {
  const std::string path = ::testing::TempDir() + "kinecal_pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  Diagnostics diagnostics;
  EXPECT_THAT(read_samples(path, diagnostics), IsEmpty());
  EXPECT_THAT(diagnostics.errors, ElementsAre(StartsWith(path + ": is a pipe, not a file; write")));
  std::filesystem::remove(path);
}

TEST(ReadSamples, MisspeltKeysOfKinecalAreDoubtedOnce) {
  const std::string good =
      kJoints +
      "conditions: {load: 1}\nobservations:\n- sensor_name: arm\n  features:\n"
      "  - {header: {frame_id: hand}, point: {x: 0, y: 0, z: 0}, sigma: 0.1}\n---\n";
  EXPECT_THAT(read_text(good + good).diagnostics.warnings, IsEmpty());
  const auto spoilt = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return read_text(text + text).diagnostics;
  };
  EXPECT_THAT(
      spoilt("sigma:", "sigam:").warnings,
      ElementsAre(HasSubstr("features: unknown key 'sigam' is skipped; did you mean 'sigma'?")));
  EXPECT_THAT(spoilt("sigma:", "Sigma:").warnings, ElementsAre(HasSubstr("mean 'sigma'?")));
  EXPECT_THAT(spoilt("conditions:", "condition:").warnings,
              ElementsAre(HasSubstr("sample: unknown key 'condition' is skipped; did you mean "
                                    "'conditions'?")));
  EXPECT_THAT(spoilt("sigma:", "stamp:").warnings, IsEmpty()) << "another word";
  EXPECT_THAT(spoilt("sigma:", "ID:").warnings, ElementsAre(HasSubstr("did you mean 'id'?")));
}

TEST(ReadSamples, TellsHowMuchHasBeenRead) {
  std::string text;
  while (text.size() < 1'000'000) text += kSample;
  const std::string path = ::testing::TempDir() + "kinecal_meter_" + std::to_string(getpid());
  std::ofstream(path) << text;
  Diagnostics diagnostics;
  std::vector<double> fractions;
  const auto meter = [&](double fraction, const std::string& what) {
    fractions.push_back(fraction);
    EXPECT_EQ(what, "reading " + path);
  };
  (void)read_samples(path, diagnostics, 2, meter);
  std::filesystem::remove(path);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  ASSERT_GE(fractions.size(), 3u);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.front(), 0.0);
  EXPECT_LT(fractions.front(), 0.6);
  EXPECT_GT(fractions.back(), 0.999);
}

TEST(ReadSamples, ADecimalCommaIsNamed) {
  const std::string begin = kJoints + "observations:\n- sensor_name: arm\n  features:\n  - ";
  expect_error(begin + "point: {x: 0.04, y: 0,03, z: 1}\n---\n", 5,
               {"point: unknown key '03'; decimal comma? write a dot: 0.03"});
}

TEST(ReadSamples, AFrameLosesTheSlashOfOldRos) {
  const ReadText reading = read_text(kJoints +
                                     "observations:\n- sensor_name: arm\n  features:\n"
                                     "  - {header: {frame_id: /tool}, point: {x: 1, y: 2, z: 3}}\n"
                                     "---\n");
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  EXPECT_EQ(reading.samples.at(0).observations.at(0).features.at(0).frame, "tool");
}

TEST(ReadSamples, FileWithoutSamplesIsAnError) {
  EXPECT_THAT(read_text("").diagnostics.errors, ElementsAre(HasSubstr("the file is empty")));
  for (const char* text : {"\n\n", "# nothing\n", "---\n", "---\n---\n"}) {
    const ReadText reading = read_text(text);
    EXPECT_THAT(reading.diagnostics.errors, ElementsAre(reading.path + ": no samples in this file"))
        << text;
  }
}

TEST(ReadSamples, TextThatIsNotASampleIsAnErrorWithItsLine) {
  expect_error(kSample + "hello\n", 6, {"sample", "'hello' is not a map"});
  expect_error(kSample + "- 1\n- 2\n---\n", 6, {"sample", "expected a map, found a list"});
}

TEST(ReadSamples, SampleWithoutJointStatesOrObservationsIsAnError) {
  expect_error(kSample + kArm + "---\n", 6, {"sample without 'joint_states'"});
  expect_error(kSample + kJoints + "---\n", 6, {"sample without 'observations'"});
  const ReadText empty = read_text("joint_states:\n" + kArm + "---\n");
  EXPECT_THAT(empty.diagnostics.errors,
              ElementsAre(empty.at(1) + "joint_states without 'name'",
                          empty.at(1) + "joint_states without 'position'"));
}

TEST(ReadSamples, NamesAndPositionsOfDifferentLengthAreAnError) {
  expect_error("joint_states: {name: [a, b], position: [1]}\n" + kArm + "---\n", 1,
               {"joint_states: 2 names but 1 position"});
}

TEST(ReadSamples, WhatIsNotANumberIsAnErrorWithItsValue) {
  expect_error("joint_states:\n  name: [a, b]\n  position:\n  - 0.5\n  - fast\n" + kArm, 5,
               {"position", "'fast' is not a number"});
  expect_error(kJoints +
                   "observations:\n- sensor_name: arm\n  features:\n  - point:\n"
                   "      x: 1\n      y: 0x2\n      z: 1\n---\n",
               7, {"y", "'0x2' is not a number"});
  expect_error(kJoints +
                   "observations:\n- sensor_name: arm\n  features:\n  - point:\n"
                   "      x: 1\n      y: 1\n      z:\n---\n",
               8, {"z", "'' is not a number"});
  expect_error(with_camera("{width: 4, P: " + kTwelve + ", D: [1, _]}"), 5, {"D", "'_' is not"});
  expect_error(with_camera("{width: 4.5, P: " + kTwelve + "}"), 5, {"width", "4.5", "pixels"});
  expect_error(with_camera("{}", "    parameters: [{name: z_offset_mm, value: far}]\n"), 6,
               {"z_offset_mm", "'far' is not a number"});
}

TEST(ReadSamples, PointWithoutACoordinateIsAnError) {
  expect_error(kJoints +
                   "observations:\n- sensor_name: arm\n  features: [{point: {x: 1, y: 2}}]\n"
                   "---\n",
               4, {"point without 'z'"});
  expect_error(kJoints + "observations:\n- sensor_name: arm\n  features: [{header: {}}]\n---\n", 4,
               {"features without 'point'"});
}

TEST(ReadSamples, OrientationThatIsNoUnitQuaternionIsAnError) {
  const auto pose = [](const std::string& orientation) {
    return kJoints +
           "observations:\n- sensor_name: mocap\n  features: [{point: {x: 1, y: 2, z: 3}, " +
           "orientation: " + orientation + "}]\n---\n";
  };
  expect_error(pose("{x: 0, y: 0, z: 1, w: 1}"), 4, {"orientation", "length 1"});
  expect_error(pose("{x: 0, y: 0, z: 0, w: 0}"), 4, {"orientation", "length 1"});
  expect_error(pose("{x: 0, y: 0, z: 1}"), 4, {"orientation without 'w'"});
  expect_error(pose("{x: 0, y: 0, z: up, w: 1}"), 4, {"'up' is not a number"});
}

TEST(ReadSamples, AFeatureMayHaveAnId) {
  const auto features = [](const std::string& first, const std::string& parameters = "[]") {
    return kJoints + "observations:\n- sensor_name: arm\n  features: [{point: {x: 1, y: 2, z: 3}" +
           first + "}, {point: {x: 1, y: 2, z: 3}, id: 7}]\n  ext_camera_info:\n    parameters: " +
           parameters + "\n---\n";
  };
  const auto ids = [](const ReadText& reading) {
    EXPECT_THAT(reading.diagnostics.errors, IsEmpty());
    std::vector<std::optional<int>> all;
    for (const Feature& f : reading.samples.at(0).observations[0].features) all.push_back(f.id);
    return all;
  };
  const std::string as_printed = "[{name: feature_id_0, value: 12.0}]";  // of a message
  EXPECT_THAT(ids(read_text(features(""))), ElementsAre(std::nullopt, 7));
  EXPECT_THAT(ids(read_text(features(", id: 0"))), ElementsAre(0, 7));
  EXPECT_THAT(ids(read_text(features("", as_printed))), ElementsAre(12, 7)) << "a key counts more";
  for (const char* wrong : {"-1", "1.5", "2147483648", ".nan"}) {
    expect_error(features(std::string(", id: ") + wrong), 4,
                 {"id: ", "is not a whole number from 0"});
  }
  expect_error(features(", id: A4"), 4, {"id: 'A4' is not a number"});
  expect_error(features("", "[{name: feature_id_2, value: 1}]"), 3,
               {"sensor 'arm': feature_id_2 is the id of feature 3 of 2"});
  expect_error(features("", "[{name: feature_id_0, value: 0.5}]"), 6,
               {"feature_id_0: an id is a whole number"});
  expect_error(features("", "[{name: feature_id_x, value: 1}]"), 6,
               {"feature_id_x: its name must end in the number of a feature"});
  expect_error(features("", "[{name: feature_id_0, value: 2147483647}]"), 3,
               {"feature_id_0: the ids after it are too large"});
}

TEST(ReadSamples, AFeatureMayHaveASigma) {
  const auto features = [](const std::string& sigma) {
    return kJoints +
           "observations:\n- sensor_name: arm\n  features: [{point: {x: 1, y: 2, z: 3}, " + sigma +
           "}, {point: {x: 1, y: 2, z: 3}}]\n---\n";
  };
  const ReadText reading = read_text(features("sigma: 0.002"));
  ASSERT_EQ(reading.samples.size(), 1u);
  const auto& found = reading.samples[0].observations[0].features;
  EXPECT_EQ(found.at(0).sigma, 0.002);
  EXPECT_EQ(found.at(1).sigma, std::nullopt);
  expect_error(features("sigma: small"), 4, {"sigma", "'small' is not a number"});
  expect_error(features("sigma: {x: 1}"), 4, {"sigma", "expected a word or number, found a map"});
}

TEST(ReadSamples, ASampleMayHaveConditionsOfAnyName) {
  const auto with = [](const std::string& conditions) {
    return kJoints + "conditions: " + conditions + "\n" + kArm + "---\n";
  };
  const ReadText reading = read_text(with("{temperature: 23.5, load: -1.2e3, point: .nan}") +
                                     kSample + with("{}") + with(""));
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  ASSERT_EQ(reading.samples.size(), 4u);
  const auto& found = reading.samples[0].conditions;
  EXPECT_EQ(found.size(), 3u);
  EXPECT_EQ(found.at("temperature"), 23.5);
  EXPECT_EQ(found.at("load"), -1.2e3);
  EXPECT_TRUE(std::isnan(found.at("point")));
  for (std::size_t n = 1; n < 4; ++n) EXPECT_THAT(reading.samples[n].conditions, IsEmpty());
  expect_error(with("{temperature: warm}"), 2, {"conditions", "'warm' is not a number"});
  expect_error(with("{temperature: }"), 2, {"conditions", "'' is not a number"});
  expect_error(with("{temperature: [1]}"), 2,
               {"conditions", "expected a word or number, found a list"});
  expect_error(with("{load: 1, load: 2}"), 2, {"conditions", "'load' occurs twice"});
  expect_error(with("23.5"), 2, {"conditions", "'23.5' is not a map"});
}

TEST(ReadSamples, AFeatureMayHaveConditionsOfItsOwn) {
  const auto with = [](const std::string& conditions) {
    std::string arm = kArm;
    return kJoints + "conditions: {load: 2}\n" +
           arm.replace(arm.find("}}"), 2, "}, conditions: " + conditions + "}") + "---\n";
  };
  const ReadText reading = read_text(with("{nx: 0.6, load: 1}") + with("{}"));
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  const auto& feature = reading.samples.at(0).observations[0].features[0];
  EXPECT_THAT(feature.conditions, ElementsAre(Pair("load", 1.0), Pair("nx", 0.6)));
  EXPECT_THAT(reading.samples[0].conditions, ElementsAre(Pair("load", 2.0)));
  EXPECT_THAT(reading.samples.at(1).observations[0].features[0].conditions, IsEmpty());
  expect_error(with("{nx: 1, nx: 2}"), 5, {"conditions", "'nx' occurs twice"});
}

TEST(ReadSamples, ASampleMayHaveMeasuredPosesOfFloatingJoints) {
  const auto with = [](const std::string& poses) {
    return kJoints + "poses: " + poses + "\n" + kArm + "---\n";
  };
  const ReadText reading = read_text(
      with("{flange: {xyz: [0.1, -2, 3e-1], quaternion_xyzw: [0.6, 0, 0, 0.8]}}") + kSample);
  ASSERT_THAT(reading.diagnostics.errors, IsEmpty());
  ASSERT_EQ(reading.samples.size(), 2u);
  ASSERT_EQ(reading.samples[0].poses.size(), 1u);
  const Pose<double>& pose = reading.samples[0].poses.at("flange");
  EXPECT_EQ(pose.translation, Vector3<double>(0.1, -2.0, 0.3));
  EXPECT_NEAR(pose.rotation(2, 1), 0.96, 1e-15);  // 2 q_w q_x
  EXPECT_THAT(reading.samples[1].poses, IsEmpty());
  const std::string good = "quaternion_xyzw: [0.6, 0, 0, 0.8]";
  expect_error(with("{flange: {xyz: [0.1, 2], " + good + "}}"), 2,
               {"pose of 'flange'", "xyz has 2 numbers, not 3"});
  expect_error(with("{flange: {xyz: [0.1, 2, 3], quaternion_xyzw: [1, 0, 0, 1]}}"), 2,
               {"pose of 'flange'", "a unit quaternion has length 1, not 1.41"});
  expect_error(with("{flange: {xyz: [589, 2, 3], " + good + "}}"), 2,
               {"pose of 'flange'", "it looks like millimetres; write metres"});
  expect_error(with("{flange: {" + good + "}}"), 2, {"pose of 'flange'", "xyz has 0 numbers"});
  expect_error(with("{a: {xyz: [0, 0, 0], " + good + "}, a: {xyz: [0, 0, 0], " + good + "}}"), 2,
               {"poses: 'a' occurs twice"});
}

TEST(ReadSamples, SensorThatOccursTwiceInASampleIsAnError) {
  expect_error(kJoints + kArm + "- sensor_name: arm\n---\n", 5,
               {"sample at line 1", "sensor 'arm' occurs twice"});
  expect_error(kJoints + "observations: [{features: []}]\n---\n", 2, {"without 'sensor_name'"});
}

TEST(ReadSamples, MissingSeparatorIsAnError) {
  const ReadText reading = read_text(kJoints + kArm + kJoints + kArm + "---\n");
  ASSERT_FALSE(reading.diagnostics.errors.empty());
  EXPECT_THAT(reading.diagnostics.errors[0],
              AllOf(StartsWith(reading.at(5)), HasSubstr("'joint_states' occurs twice"),
                    HasSubstr("is a '---' missing")));
}

TEST(ReadSamples, ListOrMapInTheWrongPlaceIsAnError) {
  expect_error(kJoints + "observations: {sensor_name: arm}\n---\n", 2,
               {"observations: expected a list, found a map"});
  expect_error(kJoints + "observations: [arm]\n---\n", 2, {"observations", "'arm' is not a map"});
  expect_error("joint_states: {name: [a, [b]], position: [1]}\n" + kArm, 1,
               {"name: expected a word or number, found a list"});
}

TEST(ReadSamples, ValuesThatTheRecorderLeftOutAreAnErrorWithTheRemedy) {
  expect_error(kJoints +
                   "observations:\n- sensor_name: arm\n  features:\n"
                   "  - point: {x: 1, y: 2, z: 3}\n  - '...'\n---\n",
               6, {"features", "--full-length"});
}

TEST(ReadSamples, AnchorsAreReadAndAliasesAreAnError) {
  const std::string anchored =
      "joint_states: &j {name: [&n a, b], position: [1, 2]}\n" + kArm + "---\n";
  EXPECT_THAT(read_text(anchored).diagnostics.errors, IsEmpty());
  expect_error(kJoints +
                   "observations:\n- sensor_name: arm\n  features:\n"
                   "  - point: {x: &p 1, y: *p, z: 3}\n---\n",
               5, {"y", "alias"});
  expect_error(kSample + "joint_states: *undefined\n", 6, {"not YAML"});
}

TEST(ReadSamples, SyntaxErrorIsAnErrorWithTheLinesOfErrorAndSample) {
  expect_error(kSample + "joint_states: {name: [a, b], position: [1, 2]\n" + kArm + "---\n", 7,
               {"not YAML", "the last sample begins at line 6"});
  expect_error(kSample + "\t- x: [}\n", 6, {"not YAML"});
}

TEST(ReadSamples, DeepNestingIsAnErrorAndNotAStackOverflow) {
  for (const std::string open : {"[", "{a: ", "- "}) {
    std::string text = kSample + kJoints + kArm + "cloud:\n  ";
    for (int i = 0; i < 100000; ++i) text += open;
    const ReadText reading = read_text(text);
    ASSERT_FALSE(reading.diagnostics.errors.empty()) << open;
    EXPECT_THAT(reading.diagnostics.errors.back(),
                AllOf(StartsWith(reading.path + ":"), HasSubstr("nested too deeply")));
  }
}

TEST(ReadSamples, BinaryFilesEndWithAnError) {
  std::string all;
  for (int i = 0; i < 4096; ++i) all += static_cast<char>((i * 7919) >> (i % 5));
  // A stray ',' or ']' makes the parser find empty documents without end.
  for (const std::string& text : {all, std::string(100, '\0'), std::string(",\x09Wa"),
                                  std::string("]"), std::string("}"), kSample + ", a"}) {
    const ReadText reading = read_text(text);
    ASSERT_FALSE(reading.diagnostics.errors.empty());
    EXPECT_THAT(reading.diagnostics.errors[0], StartsWith(reading.path + ":"));
  }
}

TEST(ReadSamples, FileThatIsCutOffAnywhereIsNeverSilent) {
  const std::string block =
      "joint_states:\n  name: [a, b]\n  position:\n  - 0.5\n  - -1.25\n"
      "observations:\n- sensor_name: arm\n  features:\n  - header:\n      frame_id: tip\n"
      "    point:\n      x: 1.25\n      y: 2.25\n      z: 3.25\n---\n";
  for (const std::string& sample : {kSample, block}) {
    for (std::size_t length = 1; length + 4 < sample.size(); ++length) {
      const ReadText reading = read_text(sample + sample.substr(0, length));
      const Diagnostics& d = reading.diagnostics;
      ASSERT_FALSE(d.errors.empty() && d.warnings.empty()) << sample.substr(0, length);
      const std::string& message = d.errors.empty() ? d.warnings[0] : d.errors[0];
      EXPECT_THAT(message, StartsWith(reading.path + ":")) << sample.substr(0, length);
    }
  }
}

TEST(ReadSamples, NumberThatMayBeCutOffIsAnError) {
  const std::string text = kJoints +
                           "observations:\n- sensor_name: arm\n  features:\n  - point:\n"
                           "      x: 1.25\n      y: 2.25\n      z: 3.2";
  expect_error(kSample + text, 6, {"the file ends within a line of this sample"});
  const ReadText complete = read_text(kSample + text + "5\n");
  EXPECT_THAT(complete.diagnostics.errors, IsEmpty());
  EXPECT_EQ(complete.samples.size(), 2u);
  EXPECT_THAT(complete.diagnostics.warnings,
              ElementsAre(AllOf(StartsWith(complete.at(6)), HasSubstr("no '---'"))));
}

TEST(ReadSamples, AllErrorsOfAFileAreReportedTogether) {
  const ReadText reading = read_text("joint_states: {name: [a], position: [x]}\n" + kArm + "---\n" +
                                     kSample + kArm + "---\n");
  EXPECT_THAT(reading.diagnostics.errors,
              ElementsAre(StartsWith(reading.at(1)), StartsWith(reading.at(11))));
  ASSERT_EQ(reading.samples.size(), 1u);
  EXPECT_EQ(reading.samples[0].source, reading.path + ":6");
}

TEST(ReadSamples, ManyErrorsAreNotListedWithoutEnd) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += kJoints + "---\n";
  const ReadText reading = read_text(text);
  ASSERT_EQ(reading.diagnostics.errors.size(), 21u);
  EXPECT_THAT(reading.diagnostics.errors[20], HasSubstr("more than 20 errors"));
}

TEST(ReadSamples, AsManyThreadsAsOneLikesReadTheSame) {
  const std::string path = ::testing::TempDir() + "read_samples_threads.yaml";
  {
    std::ofstream out(path, std::ios::binary);
    for (int i = 0; i < 5000; ++i) out << kSample;  // several pieces
    out << kJoints << "---\n" << kSample << ", a\n";
  }
  for (const unsigned threads : {0u, 1u, 2u, 7u}) {
    Diagnostics diagnostics;
    const std::vector<Sample> samples = read_samples(path, diagnostics, threads);
    ASSERT_EQ(samples.size(), 5001u) << threads;
    for (std::size_t i = 0; i < 5000; ++i) {
      ASSERT_EQ(samples[i].source, path + ":" + std::to_string(5 * i + 1)) << threads;
    }
    EXPECT_EQ(samples[5000].source, path + ":25003");
    EXPECT_THAT(diagnostics.errors,
                ElementsAre(path + ":25001: sample without 'observations'",
                            AllOf(StartsWith(path + ":25008: not YAML: "),
                                  HasSubstr("the last sample begins at line 25003"))));
  }
  std::filesystem::remove(path);
}

std::vector<Sample> read_set(const char* file) {
  Diagnostics diagnostics;
  auto samples = read_samples((test::data_folder() / file).string(), diagnostics);
  diagnostics.throw_if_errors();
  EXPECT_THAT(diagnostics.warnings, IsEmpty()) << file;
  return samples;
}

TEST(ReadSamples, RecordedSamplesOfFetchAreRead) {
  KINECAL_NEEDS_DATA("fetch");
  const auto samples = read_set("fetch/synth/samples.yaml");
  ASSERT_EQ(samples.size(), 100u);
  for (const Sample& sample : samples) {
    ASSERT_EQ(sample.joint_names.size(), 9u);
    ASSERT_EQ(sample.observations.size(), 2u);
    ASSERT_EQ(sample.observation("camera")->features.size(), 4u);
    ASSERT_EQ(sample.observation("arm")->features.size(), 4u);
    ASSERT_TRUE(sample.observation("camera")->camera);
    ASSERT_FALSE(sample.observation("arm")->camera);
  }
  EXPECT_EQ(samples[0].position("shoulder_pan_joint"), 0.09395647048950195);
  EXPECT_EQ(samples[99].position("head_tilt_joint"), 0.05944204330444336);
  EXPECT_THAT(samples[99].source, ::testing::EndsWith("samples.yaml:1783"));
  const Observation& camera = *samples[99].observation("camera");
  EXPECT_EQ(camera.features[0].frame, "head_camera_rgb_optical_frame");
  EXPECT_EQ(camera.features[3].point.z(), 0.4745397231957394);
  EXPECT_EQ(camera.camera->width, 640);
  EXPECT_EQ(camera.camera->d.size(), 5u);
  EXPECT_EQ(camera.camera->k[4], 554.2546911911879);
  EXPECT_EQ(camera.camera->r[8], 1.0);
  EXPECT_EQ(camera.camera->p[6], 240.5);
  EXPECT_EQ(camera.camera->z_offset, 0.0);
  EXPECT_EQ(camera.camera->z_scaling, 1.0);
}

TEST(ReadSamples, RecordedSamplesOfUr5AreRead) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  const auto grid = read_set("ur5_tracker/grid.yaml"), random = read_set("ur5_tracker/random.yaml");
  ASSERT_EQ(grid.size(), 1000u);
  ASSERT_EQ(random.size(), 20u);
  EXPECT_EQ(grid[0].position("shoulder_pan_joint"), -0.4002615411776746);
  EXPECT_EQ(grid[0].observation("tracker")->features.at(0).point,
            Vector3<double>(-0.432471963, -0.009795327, -0.097822432));
  EXPECT_EQ(grid[999].observation("tracker")->features.at(0).point,
            Vector3<double>(-0.72724487, -0.088134807, -0.108058286));
  EXPECT_EQ(grid[999].observation("arm")->features.at(0).frame, "smr");
  EXPECT_EQ(random[19].position("wrist_3_joint"), -0.1016976462678962);
  EXPECT_EQ(random[19].observation("tracker")->features.at(0).point.z(), 0.03882271);
}

TEST(ReadSamples, RecordedSamplesOfPandaAreRead) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const std::pair<const char*, std::size_t> sets[] = {
      {"panda_6/front", 62},        {"panda_6/left", 60},       {"panda_6/right", 77},
      {"panda_2/front_center", 60}, {"panda_2/front_left", 60}, {"panda_2/front_right", 60},
      {"panda_2/mid-high", 62},     {"panda_2/back_left", 62}};
  for (const auto& [set, count] : sets) {
    const std::string file = "mukca_panda/" + std::string(set) + ".yaml";
    EXPECT_EQ(read_set(file.c_str()).size(), count) << set;
  }
  const auto front = read_set("mukca_panda/panda_6/front.yaml");
  EXPECT_EQ(front[0].position("panda_joint1"), 0.45830625440697936);
  EXPECT_EQ(front[61].position("panda_joint7"), -1.4020756280488438);
  EXPECT_EQ(front[61].observation("fixture")->features.at(0).point,
            Vector3<double>(0.05, 0.0, 0.0));
}

TEST(ReadSamples, ATextInMemoryIsReadLikeItsFile) {
  const std::string wrong = kSample + kJoints + "observations: 3\n---\n" + kSample;
  for (const std::string& text : {kSample + kSample, wrong, std::string("joint_states: [")}) {
    const ReadText of_file = read_text(text);
    Diagnostics diagnostics;
    const std::vector<Sample> samples = parse_samples(text, of_file.path, diagnostics);
    EXPECT_EQ(diagnostics.errors, of_file.diagnostics.errors);
    EXPECT_EQ(diagnostics.warnings, of_file.diagnostics.warnings);
    ASSERT_EQ(samples.size(), of_file.samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(samples[i].source, of_file.samples[i].source);
      EXPECT_EQ(samples[i].joint_positions, of_file.samples[i].joint_positions);
      EXPECT_EQ(samples[i].observations.size(), of_file.samples[i].observations.size());
    }
  }
  Diagnostics diagnostics;
  EXPECT_THAT(parse_samples("#ROSBAG V2.0\n", "text", diagnostics), IsEmpty());
  EXPECT_THAT(diagnostics.errors, ElementsAre(StartsWith("text: is a bag")));
}

}  // namespace
}  // namespace kinecal
