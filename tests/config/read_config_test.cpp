#include "kinecal/config/read_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/data.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Messages = std::vector<std::string>;

// A line for each item, so that the line of a message says which item it is about.
const std::string kRos1 = R"(base_link: torso
models:
 - {name: arm, type: chain, frame: gripper}
 - {name: camera, type: camera3d, frame: optical}
 - {name: eye, type: camera2d, frame: lens}
free_params: [shoulder, elbow]
free_frames:
 - {name: board, x: true, y: true, z: true}
error_blocks:
 - {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm}
)";

const std::string kRos2 = R"(robot_calibration:
  ros__parameters:
    base_link: torso
    calibration_steps: [calibrate]
    calibrate:
      models: [arm, camera, eye]
      arm: {type: chain3d, frame: gripper}
      camera: {type: camera3d, frame: optical}
      eye: {type: camera2d, frame: lens}
      free_params: [shoulder, elbow]
      free_frames: [board]
      board: {x: true, y: true, z: true}
      error_blocks: [hand_eye]
      hand_eye: {type: chain3d_to_chain3d, model_a: camera, model_b: arm}
)";

/// The text with the first `from` replaced.
std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

struct ReadConfig {
  Config config;
  Messages errors, warnings;

  [[nodiscard]] const StepConfig& step() const { return config.steps.at(0); }
};

/// A folder for one test of one process, removed afterwards.
struct TestFolder {
  std::filesystem::path path;

  TestFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path = std::filesystem::path(::testing::TempDir()) /
           ("kinecal_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(path);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() { std::filesystem::remove_all(path); }
};

/// Reads the text as calibrate.yaml.  Messages that begin with the file's whole path are given with
/// its name instead.
ReadConfig read(const std::string& text) {
  const TestFolder folder;
  const std::string path = (folder.path / "calibrate.yaml").string();
  std::ofstream(path) << text;
  Diagnostics diagnostics;
  ReadConfig reading;
  reading.config = read_config(path, diagnostics);
  const auto shorten = [&](Messages messages) {
    for (std::string& m : messages) {
      if (m.starts_with(path)) m.replace(0, path.size(), "calibrate.yaml");
    }
    return messages;
  };
  reading.errors = shorten(diagnostics.errors);
  reading.warnings = shorten(diagnostics.warnings);
  return reading;
}

Messages errors(const std::string& text) {
  return read(text).errors;
}
Messages warnings(const std::string& text) {
  return read(text).warnings;
}

/// kRos1 with another error block in line 10.
std::string with_block(const std::string& block) {
  return with(kRos1, "{name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm}",
              "{name: block, " + block + "}");
}

/// All of a configuration but its places.
std::string describe(const Config& config) {
  std::ostringstream out;
  out << config.base_link << "\n";
  for (const StepConfig& step : config.steps) {
    out << "step " << step.name << " " << step.max_num_iterations << "\n";
    for (const auto& m : step.models) {
      out << "model " << m.name << " " << m.type << " " << m.frame << " " << m.param_name << "\n";
    }
    for (const auto& p : step.free_params) out << "param " << p.name << "\n";
    for (const auto& f : step.free_frames) {
      out << "frame " << f.name;
      for (bool axis : f.axes) out << " " << axis;
      out << "\n";
    }
    for (const auto& i : step.frame_initial_values) {
      out << "initial " << i.name << " " << i.xyz.transpose() << " " << i.rpy.transpose() << "\n";
    }
    for (const auto& i : step.initial_values) out << "value " << i.name << " " << i.value << "\n";
    for (const auto& b : step.bounds) {
      out << "bound " << b.name << " " << b.lower << " " << b.upper << "\n";
    }
    for (const auto& b : step.error_blocks) {
      out << "block " << b.name << " " << b.type << " " << b.param << " "
          << b.exclusive.value_or(false) << " " << b.sigma.value_or(1.0) << " " << b.loss.type
          << " " << b.loss.scale;
      for (const auto& model : b.models) out << " " << model;
      for (const auto& [name, number] : b.numbers) out << " " << name << "=" << number;
      out << "\n";
    }
  }
  return out.str();
}

// ---- both dialects ----

TEST(ReadConfig, BaseTextsOfThisTestAreWithoutMistakes) {
  for (const std::string& text : {kRos1, kRos2}) {
    const ReadConfig reading = read(text);
    EXPECT_THAT(reading.errors, IsEmpty());
    EXPECT_THAT(reading.warnings, IsEmpty());
    EXPECT_EQ(reading.config.base_link, "torso");
    ASSERT_EQ(reading.config.steps.size(), 1u);
    EXPECT_EQ(reading.step().models.size(), 3u);
  }
}

TEST(ReadConfig, DialectsOfTheSameContentGiveTheSameConfig) {
  const std::string settings = R"(verbose: true
base_link: torso
max_num_iterations: 70
models:
 - {name: arm, type: chain, frame: gripper}
 - {name: camera, type: camera3d, frame: optical, topic: /points, param_name: cam}
 - {name: eye, type: camera2d, frame: lens}
free_params: [shoulder, camera_fx]
free_frames:
 - {name: board, x: true, roll: 1, pitch: 'true', yaw: yes}
free_frames_initial_values:
 - {name: board, x: 0.5, roll: 0.1}
initial_values: {shoulder: 0.25, held: -1}
bounds: {shoulder: [-0.5, .inf]}
error_blocks:
 - {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm, sigma: 0.01}
 - {name: pixels, type: chain3d_to_camera2d, model_3d: arm, model_2d: eye, scale: 2}
 - {name: ground, type: chain3d_to_plane, model: camera, d: 0.1, loss: {type: huber, scale: 3}}
 - {name: walls, type: plane_to_plane, model_a: camera, model_b: arm, samples: alone}
 - {name: prior, type: outrageous, param: board, joint_scale: 0}
)";
  const std::string ros2 = R"(/**:
  ros__parameters:
    verbose: true
    base_link: torso
    calibration_steps: [calibrate]
    calibrate:
      max_num_iterations: 70
      models: [arm, camera, eye]
      arm: {type: chain3d, frame: gripper}
      camera: {type: camera3d, frame: optical, topic: /points, param_name: cam}
      eye: {type: camera2d, frame: lens}
      free_params: [shoulder, camera_fx]
      free_frames: [board]
      board: {x: true, roll: 1, pitch: 'true', yaw: yes}
      free_frames_initial_values: [board]
      board_initial_values: {x: 0.5, roll: 0.1}
      initial_values: {shoulder: 0.25, held: -1}
      bounds: {shoulder: [-0.5, .inf]}
      error_blocks: [hand_eye, pixels, ground, walls, prior]
      hand_eye: {type: chain3d_to_chain3d, model_a: camera, model_b: arm, sigma: 0.01}
      pixels: {type: chain3d_to_camera2d, model_3d: arm, model_2d: eye, scale: 2}
      ground: {type: chain3d_to_plane, model: camera, d: 0.1, loss: {type: huber, scale: 3}}
      walls: {type: plane_to_plane, model_a: camera, model_b: arm, samples: alone}
      prior: {type: outrageous, param: board, joint_scale: 0}
)";
  const ReadConfig one = read(settings), two = read(ros2);
  EXPECT_THAT(one.errors, IsEmpty());
  EXPECT_THAT(one.warnings, IsEmpty());
  EXPECT_THAT(two.errors, IsEmpty());
  EXPECT_THAT(two.warnings, IsEmpty());
  EXPECT_EQ(describe(one.config), describe(two.config));
  EXPECT_EQ(describe(one.config), R"(torso
step calibrate 70
model arm chain3d gripper arm
model camera camera3d optical cam
model eye camera2d lens eye
param shoulder
param camera_fx
frame board 1 0 0 1 1 1
initial board 0.5   0   0 0.1   0   0
value shoulder 0.25
value held -1
bound shoulder -0.5 inf
block hand_eye chain3d_to_chain3d  0 0.01 none 1 camera arm
block pixels chain3d_to_camera2d  0 1 none 1 arm eye scale=2
block ground chain3d_to_plane  0 1 huber 3 camera a=0 b=0 c=1 d=0.1 scale=1
block walls plane_to_plane  1 1 none 1 camera arm normal_scale=1 offset_scale=1
block prior outrageous board 0 1 none 1 joint_scale=0 mean=0 mean_a=0 mean_b=0 mean_c=0 mean_x=0 mean_y=0 mean_z=0 position_scale=1 rotation_scale=1
)");
}

TEST(ReadConfig, AFixedFrameIsAFrameWithoutFreeAxesAndWithItsPose) {
  const ReadConfig ros1 = read(with(kRos1, "error_blocks:",
                                    "fixed_frames:\n - {name: smr, x: 0.05, z: -0.1, yaw: 0.5}\n"
                                    "error_blocks:"));
  const ReadConfig ros2 = read(with(kRos2, "      error_blocks",
                                    "      fixed_frames: [smr]\n"
                                    "      smr: {x: 0.05, z: -0.1, yaw: 0.5}\n      error_blocks"));
  for (const ReadConfig* reading : {&ros1, &ros2}) {
    EXPECT_THAT(reading->errors, IsEmpty());
    EXPECT_THAT(reading->warnings, IsEmpty());
    ASSERT_EQ(reading->step().free_frames.size(), 2u);
    const FreeFrameConfig& frame = reading->step().free_frames[1];
    EXPECT_EQ(frame.name, "smr");
    EXPECT_TRUE(frame.is_fixed);
    EXPECT_EQ(frame.axes, (std::array<bool, 6>{}));
    std::map<std::string, double> values;
    for (const auto& value : reading->step().initial_values) values[value.name] = value.value;
    EXPECT_EQ(values, (std::map<std::string, double>{{"smr_x", 0.05},
                                                     {"smr_y", 0.0},
                                                     {"smr_z", -0.1},
                                                     {"smr_a", 0.0},
                                                     {"smr_b", 0.0},
                                                     {"smr_c", 0.5}}));
  }
  EXPECT_THAT(errors(with(kRos1, "error_blocks:",
                          "fixed_frames:\n - {name: board, x: 0.05}\nerror_blocks:")),
              ElementsAre(HasSubstr("fixed frame 'board': is one of free_frames, too")));
}

TEST(ReadConfig, TextsWithControlCharactersAreErrors) {
  EXPECT_THAT(errors(with(kRos1, "frame: gripper", "frame: \"grip\\eper\"")),
              ElementsAre("calibrate.yaml:3: model 'arm': frame is 'grip\\x1bper', not a text"));
}

TEST(ReadConfig, ItemsKeepTheLineThatTheUserHasToMend) {
  const ReadConfig ros1 = read(kRos1), ros2 = read(kRos2);
  EXPECT_EQ(ros1.step().models[1].place.line, 4);
  EXPECT_EQ(ros1.step().free_params[1].place.line, 6);
  EXPECT_EQ(ros1.step().error_blocks[0].place.line, 10);
  EXPECT_EQ(ros2.step().models[1].place.line, 8);
  EXPECT_EQ(ros2.step().free_frames[0].place.line, 12);
  EXPECT_EQ(ros2.step().error_blocks[0].place.line, 14);
  EXPECT_EQ(ros2.step().place.line, 5);
}

TEST(ReadConfig, GathersAllMistakesOfAFile) {
  std::string text = with(kRos1, "type: chain,", "type: chian,");
  text = with(with(text, "x: true", "x: maybe"), "model_b: arm", "model_b: leg");
  EXPECT_THAT(
      errors(text),
      ElementsAre(
          "calibrate.yaml:3: model 'arm': type 'chian' is not a model; did you mean 'chain'?",
          "calibrate.yaml:8: free frame 'board': x is 'maybe', not true or false",
          "calibrate.yaml:10: error block 'hand_eye': model_b 'leg' is not a model"));
}

// ---- the file ----

TEST(ReadConfig, SyntaxErrorsThrowWithTheLine) {
  EXPECT_THAT(
      test::thrown<InputError>([&] {
        (void)read(with(kRos1, "free_params: [shoulder, elbow]", "free_params: [shoulder, elbow"));
      }),
      HasSubstr("calibrate.yaml:7: "));
  EXPECT_THROW((void)read("a: b: c"), InputError);
  EXPECT_THROW((void)read("a: *nothing"), InputError);
  EXPECT_THROW((void)read(std::string(100000, '[')), InputError);
}

TEST(ReadConfig, FilesThatCannotBeReadThrowWithTheirName) {
  Diagnostics diagnostics;
  for (const std::string path : {"/nowhere/calibrate.yaml", "/"}) {
    EXPECT_THAT(test::thrown<InputError>([&] { (void)read_config(path, diagnostics); }),
                HasSubstr(path));
  }
}

TEST(ReadConfig, EmptyFilesAreErrors) {
  for (const std::string text : {"", "\n", "# nothing\n", "---\n", "---\n---\n"}) {
    EXPECT_THAT(errors(text), ElementsAre("calibrate.yaml: the file is empty, not a map")) << text;
  }
  EXPECT_THAT(errors("- a\n"), ElementsAre("calibrate.yaml: the file is a list, not a map"));
  EXPECT_THAT(errors("<?xml version=\"1.0\"?>\n<robot name=\"r\"/>\n"),
              ElementsAre("calibrate.yaml: this is a URDF, not a configuration"));
  EXPECT_THAT(errors("abc\n"), ElementsAre("calibrate.yaml: the file is 'abc', not a map"));
}

TEST(ReadConfig, SecondDocumentIsAnErrorButASeparatorIsNot) {
  EXPECT_THAT(errors("---\n" + kRos1 + "---\n"), IsEmpty());
  EXPECT_THAT(errors(kRos1 + "---\na: 1\n"),
              ElementsAre(HasSubstr("calibrate.yaml:12: a second document begins here")));
}

TEST(ReadConfig, KeyThatOccursTwiceIsAnError) {
  EXPECT_THAT(errors(kRos1 + "free_params: [wrist]\n"),
              ElementsAre("calibrate.yaml:11: key 'free_params' occurs twice; the first is in line "
                          "6"));
  EXPECT_THAT(errors(with(kRos1, "x: true", "x: true, x: false")),
              ElementsAre("calibrate.yaml:8: free frame: key 'x' occurs twice; the first is in "
                          "line 8"));
  EXPECT_THAT(errors(with(kRos2, "      board: {", "      arm: {type: chain3d}\n      board: {")),
              ElementsAre("calibrate.yaml:12: step 'calibrate': key 'arm' occurs twice; the first "
                          "is in line 7"));
}

TEST(ReadConfig, MergeKeysGiveWhatTheMapDoesNotHave) {
  const std::string text =
      "defaults: &d {frame: gripper, type: camera2d}\nmore: &m {type: chain, x: 1}\n" +
      with(kRos1, "type: chain, frame: gripper", "<<: [*m, *d], x: 2");
  EXPECT_THAT(errors(text), IsEmpty());
  EXPECT_THAT(warnings(text),
              Contains("calibrate.yaml:5: model 'arm': unknown key 'x' is ignored"));
  EXPECT_THAT(errors(with(kRos1, "frame: gripper", "frame: gripper, <<: 3")),
              ElementsAre("calibrate.yaml:3: model: merge key '<<' is '3', not a map"));
}

TEST(ReadConfig, KeysBelowANameAreNamedOnce) {
  const auto indented = [](std::string text) {
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) text.insert(at, "  ");
    return text;
  };
  EXPECT_THAT(errors("robot_calibration:\n" + indented(kRos1)),
              ElementsAre("calibrate.yaml:1: the keys are below 'robot_calibration'; move them to "
                          "the top"));
  EXPECT_THAT(errors("fetch:\n" + indented(kRos2)), IsEmpty()) << "a namespace";
  EXPECT_THAT(errors("node:\n  calibration_steps: [a]\n  a: {}\n"),
              ElementsAre("calibrate.yaml:1: calibration_steps is below 'node'; add "
                          "'ros__parameters:' between the two"));
}

TEST(ReadConfig, InitialValuesThatTheListLacksAreNamed) {
  EXPECT_THAT(
      errors(with(
          kRos2, "      error_blocks:", "      board_initial_values: {x: 1}\n      error_blocks:")),
      ElementsAre("calibrate.yaml:13: step 'calibrate': 'board_initial_values' is not used: "
                  "add 'board' to the list 'free_frames_initial_values'"));
}

TEST(ReadConfig, KeysThatAreNoTextAreErrors) {
  EXPECT_THAT(errors(kRos1 + "? [a, b]\n: 1\n"),
              ElementsAre("calibrate.yaml:11: a key is a list, not a text"));
}

TEST(ReadConfig, AnchorsAreFollowedAlsoInACircle) {
  EXPECT_THAT(errors(with(with(kRos1, "[shoulder, elbow]", "&p [shoulder, elbow]"),
                          "frame: gripper", "frame: &g gripper")),
              IsEmpty());
  EXPECT_THAT(errors("models: &m [*m]\nfree_params: &p [*p]\nerror_blocks: &e {a: *e}\n"),
              Contains(HasSubstr("calibrate.yaml:1: models: a list is not a map with a name")));
}

TEST(ReadConfig, ListForAMapAndMapForAListAreErrors) {
  EXPECT_THAT(errors(with(kRos1, "[shoulder, elbow]", "{shoulder: true}")),
              ElementsAre("calibrate.yaml:6: free_params is a map, not a list"));
  EXPECT_THAT(errors(with(kRos1, "[shoulder, elbow]", "[[shoulder], elbow]")),
              ElementsAre("calibrate.yaml:6: free_params: a list is not a name of a parameter"));
  EXPECT_THAT(errors(with(kRos1, "type: chain,", "type: [chain],")),
              ElementsAre("calibrate.yaml:3: model 'arm': type is a list, not a text"));
  EXPECT_THAT(errors("models: {arm: {type: chain}}\nfree_params: [a]\nerror_blocks: 7\n"),
              ElementsAre("calibrate.yaml:1: models is a map, not a list",
                          "calibrate.yaml:3: error_blocks is '7', not a list"));
  EXPECT_THAT(errors(with(kRos2, "{x: true, y: true, z: true}", "[x, y]")),
              Contains("calibrate.yaml:12: step 'calibrate': board is a list, not a map"));
  EXPECT_THAT(errors(kRos1 + "initial_values: [1]\nbounds: 3\n"),
              ElementsAre("calibrate.yaml:11: initial_values is a list, not a map",
                          "calibrate.yaml:12: bounds is '3', not a map"));
}

TEST(ReadConfig, UnknownKeyIsAWarningAndAMisspeltOneAnError) {
  EXPECT_THAT(warnings(kRos1 + "colour: red\n"),
              ElementsAre("calibrate.yaml:11: unknown key 'colour' is ignored"));
  EXPECT_THAT(errors(with(kRos1, "free_params", "free_parms")),
              ElementsAre("calibrate.yaml:6: unknown key 'free_parms'; did you mean "
                          "'free_params'?"));
  EXPECT_THAT(errors(with(kRos1, "x: true", "rol: true")),
              ElementsAre("calibrate.yaml:8: free frame 'board': unknown key 'rol'; did you mean "
                          "'roll'?"));
  EXPECT_THAT(errors(with(kRos1, "frame: gripper", "frame: gripper, para_name: a")),
              ElementsAre("calibrate.yaml:3: model 'arm': unknown key 'para_name'; did you mean "
                          "'param_name'?"));
  EXPECT_THAT(warnings(with_block("type: outrageous, param: board, model_a: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': unknown key 'model_a' is "
                          "ignored"));
  EXPECT_THAT(errors(with(kRos2, "free_frames", "free_frame")),
              Contains("calibrate.yaml:11: step 'calibrate': unknown key 'free_frame'; did you "
                       "mean 'free_frames'?"));
  EXPECT_THAT(errors(with(kRos2, "base_link", "base_lnk")),
              ElementsAre("calibrate.yaml:3: unknown key 'base_lnk'; did you mean 'base_link'?"));
}

TEST(ReadConfig, TheImageOfACamera2dIsRawOrRectified) {
  const auto image = [](const std::string& text) {
    return read(text).config.steps[0].models[2].image;
  };
  EXPECT_EQ(image(kRos1), ImageKind::automatic);
  EXPECT_EQ(image(with(kRos1, "frame: lens", "frame: lens, image: raw")), ImageKind::raw);
  EXPECT_EQ(image(with(kRos2, "frame: lens", "frame: lens, image: rectified")),
            ImageKind::rectified);
  EXPECT_THAT(errors(with(kRos1, "frame: lens", "frame: lens, image: rectfied")),
              ElementsAre("calibrate.yaml:5: model 'eye': image 'rectfied' is neither raw nor "
                          "rectified; did you mean 'rectified'?"));
  EXPECT_THAT(errors(with(kRos1, "frame: optical", "frame: optical, image: raw")),
              ElementsAre("calibrate.yaml:4: model 'camera': image is a key of camera2d, but the "
                          "type is 'camera3d'"));
}

TEST(ReadConfig, KeysOfTheCaptureAreIgnoredInSilence) {
  const ReadConfig reading =
      read(with(kRos1, "frame: optical", "frame: optical, topic: /p, camera_info_topic: /i") +
           "verbose: true\n");
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
}

// ---- the whole ----

TEST(ReadConfig, NoModelsNoBlocksAndNothingFreeAreErrors) {
  EXPECT_THAT(errors("verbose: true\n"),
              ElementsAre(HasSubstr("calibrate.yaml: no model is given"),
                          HasSubstr("calibrate.yaml: no error block is given"),
                          HasSubstr("calibrate.yaml: nothing is free")));
  EXPECT_THAT(errors("models: []\nerror_blocks:\nfree_params: [a]\n"),
              ElementsAre(HasSubstr("calibrate.yaml:1: no model is given"),
                          HasSubstr("calibrate.yaml:2: no error block is given")));
  EXPECT_THAT(errors(with(kRos2, "[calibrate]", "[]")),
              Contains(HasSubstr("calibrate.yaml:4: no step is given")));
  EXPECT_THAT(errors(with(with(kRos2, "[shoulder, elbow]", "[]"), "{x: true, y: true, z: true}",
                          "{x: false}")),
              ElementsAre(HasSubstr("calibrate.yaml:5: step 'calibrate': nothing is free")));
}

TEST(ReadConfig, NothingMayBeFreeWhereASearchFollows) {
  const auto messages = [](const std::string& text, NothingFree nothing_free) {
    Diagnostics diagnostics;
    (void)parse_config(text, "calibrate.yaml", diagnostics, nothing_free);
    return diagnostics.errors;
  };
  const std::string open =
      "models:\n - {name: arm, type: chain3d, frame: tip}\n"
      " - {name: eye, type: camera3d, frame: head}\n"
      "error_blocks:\n - {name: both, type: chain3d_to_chain3d, model_a: arm, model_b: eye}\n";
  const std::string empty = open + "free_params: []\n";
  const auto is_refused =
      ElementsAre(HasSubstr("nothing is free; name parameters under 'free_params' or frames under "
                            "'free_frames', or let 'kinecal identify' find them"));
  EXPECT_THAT(messages(open, NothingFree::is_error), is_refused);
  EXPECT_THAT(messages(open, NothingFree::without_lists), testing::IsEmpty());
  EXPECT_THAT(messages(empty, NothingFree::without_lists), is_refused);
  EXPECT_THAT(messages(empty, NothingFree::is_allowed), testing::IsEmpty());
}

TEST(ReadConfig, NumberOfIterationsIsAPositiveInteger) {
  EXPECT_EQ(read(kRos1).step().max_num_iterations, 1000);
  EXPECT_EQ(read(kRos1 + "max_num_iterations: 50\n").step().max_num_iterations, 50);
  for (const std::string bad : {"0", "-3", "1.5", "many", "99999999999", "[3]"}) {
    EXPECT_THAT(errors(kRos1 + "max_num_iterations: " + bad + "\n"),
                ElementsAre(HasSubstr("calibrate.yaml:11: max_num_iterations is ")))
        << bad;
  }
}

// ---- models ----

TEST(ReadConfig, ModelNeedsATypeAndAFrame) {
  EXPECT_THAT(errors(with(kRos1, ", frame: gripper", "")),
              ElementsAre("calibrate.yaml:3: model 'arm': frame is missing"));
  EXPECT_THAT(errors(with(kRos1, "frame: gripper", "frame: ")),
              ElementsAre("calibrate.yaml:3: model 'arm': frame is empty, not a text"));
  EXPECT_THAT(errors(with(kRos2, "type: chain3d, ", "")),
              ElementsAre("calibrate.yaml:7: model 'arm': type is missing"));
  EXPECT_THAT(errors(with(kRos1, "name: arm, ", "")),
              Contains("calibrate.yaml:3: model: name is missing"));
  EXPECT_THAT(errors(with(kRos1, "type: camera3d", "type: camera_3d")),
              ElementsAre("calibrate.yaml:4: model 'camera': type 'camera_3d' is not a model; did "
                          "you mean 'camera3d'?"));
}

TEST(ReadConfig, ItemsOfTheOtherDialectAreExplained) {
  EXPECT_THAT(errors(with(kRos1, "{name: arm, type: chain, frame: gripper}", "arm")),
              Contains("calibrate.yaml:3: models: 'arm' is not a map with a name; lists of names "
                       "are read under ros__parameters only"));
  EXPECT_THAT(errors(with(kRos2, "free_frames: [board]", "free_frames: [{name: board}]")),
              ElementsAre("calibrate.yaml:11: step 'calibrate': free_frames: a map is not a name; "
                          "under ros__parameters a list holds names, and the map of each stands "
                          "beside the list"));
}

TEST(ReadConfig, MoreThanARobotHasIsAnErrorAndNamesAreOfFiles) {
  const auto with_models = [](int count, const std::string& name) {
    std::string models;
    for (int i = 0; i < count; ++i) {
      models += " - {name: " + name + std::to_string(i) + ", type: chain, frame: tip}\n";
    }
    return with(kRos1, "free_params", models + "free_params");
  };
  EXPECT_THAT(errors(with_models(497, "m")), IsEmpty());
  EXPECT_THAT(errors(with_models(498, "m")),
              Contains("calibrate.yaml:503: models has 501 items, and at most 500 are read"));
  EXPECT_THAT(errors(with_models(1, std::string(199, 'm'))), IsEmpty());
  EXPECT_THAT(errors(with_models(1, std::string(200, 'm'))),
              ElementsAre(AllOf(HasSubstr("calibrate.yaml:6: model 'mmm"),
                                HasSubstr("...' has a name of 201 characters; at most 200"))));
  EXPECT_THAT(errors(with(kRos2, "[board]", "[" + std::string(201, 'b') + "]")),
              Contains(HasSubstr("has a name of 201 characters")));
}

TEST(ReadConfig, NamesThatOccurTwiceAreErrorsWithBothLines) {
  EXPECT_THAT(errors(with(kRos1, "free_params",
                          " - {name: arm, type: chain, frame: a}\n"
                          "free_params")),
              ElementsAre("calibrate.yaml:6: model 'arm' occurs twice; the first is in line 3"));
  EXPECT_THAT(errors(with(kRos1, "error_blocks", " - {name: board, x: true}\nerror_blocks")),
              ElementsAre("calibrate.yaml:9: free frame 'board' occurs twice; the first is in line "
                          "8"));
  EXPECT_THAT(errors(kRos1 + " - {name: hand_eye, type: outrageous, param: board}\n"),
              ElementsAre("calibrate.yaml:11: error block 'hand_eye' occurs twice; the first is in "
                          "line 10"));
  EXPECT_THAT(errors(with(kRos2, "[arm, camera, eye]", "[arm, camera, eye, arm]")),
              ElementsAre("calibrate.yaml:6: step 'calibrate': model 'arm' occurs twice; the first "
                          "is in line 7"));
  EXPECT_THAT(errors(with(kRos2, "[calibrate]", "\n    - calibrate\n    - calibrate")),
              ElementsAre("calibrate.yaml:6: step 'calibrate' occurs twice; the first is in line "
                          "5"));
}

TEST(ReadConfig, AParameterThatIsFreedTwiceCountsOnce) {
  const ReadConfig twice =
      read(with(kRos1, "[shoulder, elbow]", "[shoulder,\n elbow,\n shoulder]"));
  EXPECT_THAT(twice.errors, IsEmpty());
  EXPECT_THAT(twice.warnings,
              ElementsAre("calibrate.yaml:8: free parameter 'shoulder' occurs twice and counts "
                          "once; the other is in line 6"));
  EXPECT_EQ(twice.step().free_params.size(), 2u);
  const ReadConfig axis = read(with(kRos1, "elbow", "board_x"));
  EXPECT_THAT(axis.errors, IsEmpty());
  EXPECT_THAT(
      axis.warnings,
      ElementsAre("calibrate.yaml:6: free parameter 'board_x' occurs twice and counts once; "
                  "the other is in line 8"));
  EXPECT_EQ(axis.step().free_params.size(), 1u);
}

// ---- free frames ----

TEST(ReadConfig, AxesAreFlagsInEverySpelling) {
  const ReadConfig reading = read(with(kRos1, "x: true, y: true, z: true",
                                       "x: 1, y: 'true', z: On, roll: 0, pitch: 'False', yaw: no"));
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.step().free_frames[0].axes,
              ElementsAre(true, true, true, false, false, false));
  for (const std::string bad : {"2", "0.5", "perhaps", "yEs", "[true]", "", "!own true"}) {
    EXPECT_THAT(errors(with(kRos1, "y: true", "y: " + bad)),
                ElementsAre(HasSubstr("calibrate.yaml:8: free frame 'board': y is ")))
        << bad;
  }
}

TEST(ReadConfig, FrameWithoutAFreeAxisIsAWarning) {
  EXPECT_THAT(warnings(with(kRos1, "x: true, y: true, z: true", "x: false")),
              ElementsAre("calibrate.yaml:8: free frame 'board': no axis is free"));
}

const std::string kInitial = "free_frames_initial_values:\n - {name: board, x: 0.5, z: -1e-3}\n";

TEST(ReadConfig, InitialValuesOfFramesAreRead) {
  const ReadConfig reading = read(kRos1 + kInitial);
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
  EXPECT_EQ(reading.step().frame_initial_values.at(0).xyz, Vector3<double>(0.5, 0.0, -1e-3));
}

TEST(ReadConfig, InitialValueOfAFrameNeedsItsMap) {
  EXPECT_THAT(errors(with(kRos2, "      error_blocks",
                          "      free_frames_initial_values: [board]\n      error_blocks")),
              ElementsAre("calibrate.yaml:13: step 'calibrate': initial value of free frame "
                          "'board' has no map 'board_initial_values' beside the list "
                          "'free_frames_initial_values'"));
}

TEST(ReadConfig, InitialValueOfAnAxisThatIsNotFreeIsIgnoredWithAWarning) {
  EXPECT_THAT(warnings(kRos1 + with(kInitial, "x: 0.5", "yaw: 0.2, pitch: 0.0")),
              ElementsAre("calibrate.yaml:12: initial value of free frame 'board': yaw is not "
                          "free: its initial value is ignored, as robot_calibration does"));
  // Two angles make a rotation vector with a third component.
  EXPECT_THAT(warnings(with(kRos1, "x: true", "roll: true, yaw: true") +
                       "free_frames_initial_values:\n - {name: board, roll: 0.5, yaw: 0.5}\n"),
              Contains(HasSubstr("calibrate.yaml:12: initial value of free frame 'board': pitch "
                                 "is not free")));
}

TEST(ReadConfig, TextsThatAreNotNumbersAreErrors) {
  for (const std::string bad :
       {"abc", ".nan", ".inf", "1e999", "'1,5'", "0x10", "!degrees 90", "deg(90)", "[1]", ""}) {
    EXPECT_THAT(errors(kRos1 + with(kInitial, "0.5", bad)),
                Contains(HasSubstr("calibrate.yaml:12")))
        << bad;
  }
  EXPECT_THAT(errors(kRos1 + with(kInitial, "0.5", "!degrees 90")),
              ElementsAre("calibrate.yaml:12: initial value of free frame 'board': x is '!degrees "
                          "90', not a finite number"));
}

// ---- kinecal's own values and bounds ----

TEST(ReadConfig, BoundsAreAPairInOrderOfAFreeParameter) {
  EXPECT_EQ(read(kRos1 + "bounds: {board_x: [-1, 2]}\n").step().bounds.at(0).upper, 2.0);
  EXPECT_THAT(errors(kRos1 + "bounds: {elbow: [1, 1]}\n"),
              ElementsAre("calibrate.yaml:11: bounds: elbow: the lower bound 1.0 is not below the "
                          "upper bound 1.0"));
  for (const std::string bad : {"[1]", "[1, 2, 3]", "[a, 2]", "[.nan, 1]"}) {
    EXPECT_THAT(errors(kRos1 + "bounds: {elbow: " + bad + "}\n"),
                ElementsAre("calibrate.yaml:11: bounds: elbow is not a list of two numbers, "
                            "[lower, upper]"));
  }
  EXPECT_THAT(errors(kRos1 + "bounds: {elbow: 3}\n"),
              ElementsAre("calibrate.yaml:11: bounds: elbow is '3', not a list"));
  EXPECT_THAT(errors(kRos1 + "bounds:\n  elbw: [0, 1]\n"),
              ElementsAre("calibrate.yaml:12: bounds: 'elbw' is not free in this step; did you "
                          "mean 'elbow'?"));
}

TEST(ReadConfig, InitialValuesOfParametersAreNumbers) {
  EXPECT_EQ(read(kRos1 + "initial_values: {held: -2.5}\n").step().initial_values.at(0).value, -2.5);
  EXPECT_THAT(errors(kRos1 + "initial_values:\n  elbow: high\n"),
              ElementsAre("calibrate.yaml:12: initial_values: elbow is 'high', not a finite "
                          "number"));
}

// ---- error blocks ----

TEST(ReadConfig, ReferenceToNoModelIsAnErrorInTheLineOfTheBlock) {
  const std::string many_lines = R"( - name: hand_eye
   type: chain3d_to_chain3d
   model_a: camra
   model_b: arm
)";
  EXPECT_THAT(errors(with(kRos1,
                          " - {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, "
                          "model_b: arm}\n",
                          many_lines)),
              ElementsAre("calibrate.yaml:10: error block 'hand_eye': model_a 'camra' is not a "
                          "model; did you mean 'camera'?"));
  EXPECT_THAT(errors(with(kRos2, "model_a: camera", "model_a: camra")),
              ElementsAre("calibrate.yaml:14: error block 'hand_eye': model_a 'camra' is not a "
                          "model; did you mean 'camera'?"));
}

TEST(ReadConfig, BlockNeedsItsTypeItsModelsAndItsParameter) {
  EXPECT_THAT(errors(with_block("model_a: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': type is missing"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_chain3d, model_a: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': model_b is missing"));
  EXPECT_THAT(errors(with_block("type: outrageous")),
              ElementsAre("calibrate.yaml:10: error block 'block': param is missing"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_chian3d, model_a: arm, model_b: camera")),
              ElementsAre("calibrate.yaml:10: error block 'block': type 'chain3d_to_chian3d' is "
                          "not an error block; did you mean 'chain3d_to_chain3d'?"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_chain3d, model_a: arm, model_b: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': compares model 'arm' with "
                          "itself"));
}

TEST(ReadConfig, BlocksCompareACameraWithTheSurfaceOfLinks) {
  const auto block_with = [](const std::string& keys) {
    const StepConfig step = read(with_block("type: chain3d_to_mesh, " + keys)).step();
    const BlockConfig& block = step.error_blocks[0];
    EXPECT_THAT(block.models, ElementsAre("camera", "camera_surface"));
    EXPECT_TRUE(step.models.back().is_surface);
    EXPECT_EQ(step.models.back().name, "camera_surface");
    EXPECT_EQ(step.models.back().links, block.surface->links);
    return block;
  };
  EXPECT_THAT(block_with("model: camera, link_name: base").surface->links, ElementsAre("base"));
  EXPECT_THAT(block_with("model: camera, links: [a, b]").surface->links, ElementsAre("a", "b"));
  EXPECT_THAT(block_with("camera: camera, link_names: [a, b]").surface->links,
              ElementsAre("a", "b"));
  EXPECT_THAT(block_with("model: camera").surface->links, IsEmpty()) << "all that have a mesh";
  const BlockConfig block = block_with(
      "model: camera, geometry: collision, points: 100, loss: {type: cauchy, scale: 0.005}");
  EXPECT_EQ(block.surface->geometry, "collision");
  EXPECT_EQ(block.surface->points, 100);
  EXPECT_EQ(block.loss.scale, 0.005);
}

TEST(ReadConfig, WrongKeysOfASurfaceAreErrors) {
  EXPECT_THAT(
      errors(with_block("type: chain3d_to_mesh, model: camera, links: [a], link_name: b")),
      ElementsAre("calibrate.yaml:10: error block 'block': 'link_name' and 'links' both name "
                  "the links of the surface"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_mesh, model: camera, links: []")),
              ElementsAre("calibrate.yaml:10: error block 'block': links has no link"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_mesh, model: camera, geometry: inertial")),
              ElementsAre(HasSubstr("geometry")));
}

TEST(ReadConfig, AliasesOfOldVersionsAreRead) {
  const BlockConfig arm =
      read(with_block("type: camera3d_to_arm, camera: camera, arm: arm")).step().error_blocks[0];
  EXPECT_EQ(arm.type, "chain3d_to_chain3d");
  EXPECT_THAT(arm.models, ElementsAre("camera", "arm"));
  EXPECT_THAT(errors(with_block("type: camera3d_to_arm, model_a: camera, model_b: arm")),
              IsEmpty());
  EXPECT_THAT(errors(with_block("type: camera3d_to_arm, camera: camra, arm: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': camera 'camra' is not a model; "
                          "did you mean 'camera'?"));

  const ReadConfig ground = read(with_block("type: camera3d_to_ground, camera: camera, ground: g"));
  EXPECT_THAT(ground.errors, IsEmpty());
  EXPECT_THAT(ground.warnings, IsEmpty());
  BlockConfig plane = ground.step().error_blocks[0];
  EXPECT_EQ(plane.type, "chain3d_to_plane");
  EXPECT_THAT(plane.models, ElementsAre("camera"));
  EXPECT_EQ(plane.ground, "g");
  EXPECT_EQ(plane.numbers["c"], 1.0);
  EXPECT_EQ(plane.numbers["scale"], 1.0);
}

TEST(ReadConfig, PlaneTakesItsModelUnderEitherKeyAndNeedsANormal) {
  EXPECT_THAT(
      read(with_block("type: chain3d_to_plane, model_a: arm")).step().error_blocks[0].models,
      ElementsAre("arm"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_plane, model: arm, model_a: arm")),
              ElementsAre("calibrate.yaml:10: error block 'block': 'model' and 'model_a' are the "
                          "same model"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_plane, model: arm, c: 0")),
              ElementsAre("calibrate.yaml:10: error block 'block': the plane's normal (a, b, c) "
                          "has length zero"));
}

TEST(ReadConfig, AScaleIsPositive) {
  for (const std::string scale : {"0", "-1"}) {
    EXPECT_THAT(errors(with_block("type: chain3d_to_plane, model: arm, scale: " + scale)),
                ElementsAre("calibrate.yaml:10: error block 'block': scale is " + scale +
                            ", not greater than zero"));
  }
  EXPECT_THAT(
      errors(with_block("type: plane_to_plane, model_a: arm, model_b: camera, normal_scale: 0")),
      IsEmpty());
}

TEST(ReadConfig, ModelsOfTheWrongKindAreErrors) {
  EXPECT_THAT(errors(with_block("type: chain3d_to_camera2d, model_3d: arm, model_2d: camera")),
              ElementsAre("calibrate.yaml:10: error block 'block': model_2d 'camera' is a camera3d;"
                          " it must be a camera2d, which observes pixels"));
  EXPECT_THAT(errors(with_block("type: chain3d_to_camera2d, model_3d: eye, model_2d: eye")),
              Contains("calibrate.yaml:10: error block 'block': model_3d 'eye' is a camera2d; it "
                       "must be a chain3d or camera3d or board, which observe points"));
  for (const std::string type : {"chain3d_to_chain3d", "plane_to_plane"}) {
    EXPECT_THAT(errors(with_block("type: " + type + ", model_a: arm, model_b: eye")),
                ElementsAre(HasSubstr("calibrate.yaml:10: error block 'block': model_b 'eye' is a "
                                      "camera2d; it must be")));
  }
  EXPECT_THAT(errors(with_block("type: chain3d_to_plane, model: eye")),
              ElementsAre(HasSubstr("calibrate.yaml:10: error block 'block': model 'eye' is")));
}

TEST(ReadConfig, WeightingOfABlockIsChecked) {
  const std::string plane = "type: chain3d_to_plane, model: arm, ";
  for (const std::string bad : {"0", "-1", ".inf", ".nan", "wide"}) {
    EXPECT_THAT(errors(with_block(plane + "sigma: " + bad)),
                ElementsAre(HasSubstr("calibrate.yaml:10: error block 'block': sigma is '" + bad +
                                      "', not a finite number greater than zero")));
  }
  EXPECT_THAT(errors(with_block(plane + "samples: alon")),
              ElementsAre("calibrate.yaml:10: error block 'block': samples 'alon' is not one of "
                          "all, exclusive, alone; did you mean 'alone'?"));
  EXPECT_THAT(errors(with_block(plane + "loss: {type: hubber}")),
              ElementsAre("calibrate.yaml:10: error block 'block': loss: type 'hubber' is not one "
                          "of none, huber, cauchy, tukey; did you mean 'huber'?"));
  EXPECT_THAT(errors(with_block(plane + "loss: {type: tukey, scale: 0}")),
              ElementsAre(HasSubstr("calibrate.yaml:10: error block 'block': loss: scale is '0'")));
  EXPECT_THAT(errors(with_block(plane + "loss: {scale: 2}")),
              ElementsAre("calibrate.yaml:10: error block 'block': loss: type is missing"));
  EXPECT_THAT(errors(with_block(plane + "loss: huber")),
              ElementsAre("calibrate.yaml:10: error block 'block': loss is 'huber', not a map"));
  EXPECT_THAT(errors(with_block(plane + "scale: big")),
              ElementsAre("calibrate.yaml:10: error block 'block': scale is 'big', not a finite "
                          "number"));
}

// ---- steps ----

const std::string kRos1Steps = R"(base_link: torso
max_num_iterations: 30
models:
 - {name: arm, type: chain, frame: gripper}
 - {name: camera, type: camera3d, frame: optical}
initial_values: {elbow: 0.5}
bounds: {wrist: [-1, 1], elbow: [-2, 2]}
cal_steps:
  b_second:
    max_num_iterations: 40
    free_params: [elbow, wrist]
    bounds: {elbow: [-3, 3]}
  a_first:
    free_params: [elbow]
    free_frames:
     - {name: board, x: true, roll: true, yaw: true}
    error_blocks:
     - {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm}
)";

TEST(ReadConfig, Ros1StepsRunInAlphabeticalOrderAndTakeOverWhatTheyLeaveOut) {
  const ReadConfig reading = read(kRos1Steps);
  EXPECT_THAT(reading.errors, IsEmpty());
  ASSERT_EQ(reading.config.steps.size(), 2u);
  const StepConfig &first = reading.config.steps[0], &second = reading.config.steps[1];
  EXPECT_EQ(first.name, "a_first");
  EXPECT_EQ(second.name, "b_second");
  EXPECT_EQ(first.max_num_iterations, 30);
  EXPECT_EQ(second.max_num_iterations, 40);
  EXPECT_EQ(first.models.size(), 2u);
  EXPECT_EQ(second.models.size(), 2u);
  EXPECT_EQ(first.free_params.size(), 1u);
  EXPECT_EQ(second.free_params.size(), 2u);
  EXPECT_EQ(second.free_frames.size(), 1u);
  EXPECT_EQ(second.error_blocks.size(), 1u);
}

TEST(ReadConfig, Ros1StepsAllStartTheirFreeFramesAtTheInitialValues) {
  const std::string text = with(kRos1Steps, "    error_blocks:\n",
                                "    free_frames_initial_values:\n     - {name: board, x: 0.1}\n"
                                "    error_blocks:\n");
  const ReadConfig reading = read(text);
  EXPECT_THAT(reading.errors, IsEmpty());
  ASSERT_EQ(reading.config.steps.size(), 2u);
  for (const StepConfig& step : reading.config.steps) {
    ASSERT_EQ(step.frame_initial_values.size(), 1u) << step.name;
    EXPECT_EQ(step.frame_initial_values[0].xyz.x(), 0.1) << step.name;
  }
}

TEST(ReadConfig, ErrorsInListsThatStepsShareAreReportedOnce) {
  EXPECT_THAT(errors(with(kRos1Steps, "model_a: camera", "model_a: camra")),
              ElementsAre("calibrate.yaml:18: error block 'hand_eye': model_a 'camra' is not a "
                          "model; did you mean 'camera'?"));
}

TEST(ReadConfig, ValuesAndBoundsOfTheFileReachTheirSteps) {
  const ReadConfig reading = read(kRos1Steps);
  const StepConfig &first = reading.config.steps[0], &second = reading.config.steps[1];
  EXPECT_EQ(first.initial_values.size(), 1u);
  EXPECT_THAT(second.initial_values, IsEmpty());
  ASSERT_EQ(first.bounds.size(), 1u);
  EXPECT_EQ(first.bounds[0].upper, 2.0);
  ASSERT_EQ(second.bounds.size(), 2u);
  EXPECT_EQ(second.bounds[0].upper, 3.0);
  EXPECT_EQ(second.bounds[1].name, "wrist");
  EXPECT_THAT(errors(with(kRos1Steps, "wrist: [-1, 1]", "wrst: [-1, 1]")),
              ElementsAre("calibrate.yaml:7: bounds: 'wrst' is not free in any step; did you mean "
                          "'wrist'?"));
}

TEST(ReadConfig, StepsHaveOneBaseLink) {
  EXPECT_THAT(errors(with(kRos1Steps, "  b_second:", "  b_second:\n    base_link: torso")),
              IsEmpty());
  EXPECT_THAT(errors(with(kRos1Steps, "  b_second:", "  b_second:\n    base_link: base")),
              ElementsAre("calibrate.yaml:10: step 'b_second': base_link 'base' differs from "
                          "'torso' in line 1; all steps must have the same base_link"));
}

TEST(ReadConfig, StepsUnderCalStepsAreAMap) {
  EXPECT_THAT(errors("cal_steps: [a]\n"),
              ElementsAre("calibrate.yaml:1: cal_steps is a list, not a map"));
  EXPECT_THAT(errors("cal_steps:\n"),
              ElementsAre("calibrate.yaml:1: cal_steps is empty, not a map"));
  EXPECT_THAT(errors("cal_steps: {}\n"), ElementsAre("calibrate.yaml:1: cal_steps has no steps"));
  EXPECT_THAT(errors("cal_steps:\n  a: 3\n"),
              ElementsAre("calibrate.yaml:2: cal_steps: a is '3', not a map"));
  EXPECT_THAT(errors(with(kRos1Steps, "  a_first:", "  b_second: {}\n  a_first:")),
              ElementsAre("calibrate.yaml:13: cal_steps: key 'b_second' occurs twice; the first is "
                          "in line 9"));
}

const std::string kRos2Second = R"(    extra:
      models: [camera]
      camera: {type: camera3d, frame: optical}
      free_frames: [lamp]
      lamp: {x: true}
      free_frames_initial_values: [board, lamp]
      board_initial_values: {x: 1}
      lamp_initial_values: {x: 2}
      error_blocks: [ground]
      ground: {type: chain3d_to_plane, model: camera}
)";

TEST(ReadConfig, Ros2StepsRunInTheirOrderAndTakeOverNothing) {
  const std::string text = with(kRos2, "[calibrate]", "[calibrate, extra]") + kRos2Second;
  const ReadConfig reading = read(text);
  EXPECT_THAT(reading.errors, IsEmpty());
  ASSERT_EQ(reading.config.steps.size(), 2u);
  EXPECT_EQ(reading.config.steps[1].name, "extra");
  EXPECT_EQ(reading.config.steps[1].models.size(), 1u);
  EXPECT_THAT(reading.config.steps[1].free_params, IsEmpty());
  EXPECT_THAT(errors(with(text, "model: camera", "model: arm")),
              ElementsAre("calibrate.yaml:24: error block 'ground': model 'arm' is not a model"));
}

TEST(ReadConfig, Ros2ItemsWithoutAMapAreErrorsWithTheNearestOne) {
  EXPECT_THAT(errors(with(kRos2, "[calibrate]", "[calibrat]")),
              Contains("calibrate.yaml:4: step 'calibrat' has no map 'calibrat' beside "
                       "calibration_steps; did you mean 'calibrate'?"));
  EXPECT_THAT(errors(with(kRos2, "board: {", "bord: {")),
              Contains("calibrate.yaml:11: step 'calibrate': free frame 'board' has no map 'board' "
                       "beside the list 'free_frames'; did you mean 'bord'?"));
  EXPECT_THAT(warnings(with(kRos2, "board: {", "bord: {")), IsEmpty());
  // A map that no list names is not a misspelling of its neighbour.
  EXPECT_THAT(warnings(with(kRos2, "[arm, camera, eye]", "[arm, camera]")),
              ElementsAre("calibrate.yaml:9: step 'calibrate': unknown key 'eye' is ignored"));
  EXPECT_THAT(warnings(with(kRos2, "      arm:", "      arm1: {type: chain3d}\n      arm:")),
              ElementsAre("calibrate.yaml:7: step 'calibrate': unknown key 'arm1' is ignored"));
}

TEST(ReadConfig, Ros2ItemsOfOneNameAreOneKeyAndAnError) {
  EXPECT_THAT(errors(with(with(kRos2, "[board]", "[arm]"), "board: {x", "unused: {x")),
              Contains("calibrate.yaml:7: step 'calibrate': model 'arm' and free frame 'arm' are "
                       "the same key 'arm'; rename one of them"));
  EXPECT_THAT(errors(with(kRos2, "[hand_eye]", "[hand_eye, board]")),
              ElementsAre("calibrate.yaml:12: step 'calibrate': free frame 'board' and error block "
                          "'board' are the same key 'board'; rename one of them"));
  EXPECT_THAT(errors(with(with(kRos1, "name: board", "name: arm"), "name: hand_eye", "name: arm")),
              IsEmpty());
}

TEST(ReadConfig, MissingOrMisspeltRosParametersAreFound) {
  EXPECT_THAT(errors(with(kRos2, "ros__parameters", "ros_parameters")),
              ElementsAre("calibrate.yaml:2: unknown key 'ros_parameters' of node "
                          "'robot_calibration'; did you mean 'ros__parameters'?"));
  EXPECT_THAT(errors("calibration_steps: [a]\n"),
              ElementsAre("calibrate.yaml:1: calibration_steps stands outside of '<node>: "
                          "ros__parameters:'"));
  EXPECT_THAT(errors("a:\n  ros__parameters: 3\n"),
              ElementsAre("calibrate.yaml:2: node 'a': ros__parameters is '3', not a map"));
}

TEST(ReadConfig, OtherNodesOfAFileAreIgnored) {
  const ReadConfig reading = read(kRos2 + "other:\n  ros__parameters: {a: 1}\n");
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, ElementsAre("calibrate.yaml:15: node 'other' is ignored; "
                                            "'robot_calibration' is used"));
  EXPECT_THAT(errors(with(kRos2, "robot_calibration:", "first:") +
                     "other:\n  ros__parameters: {calibration_steps: [a]}\n"),
              ElementsAre("calibrate.yaml:15: two nodes have calibration_steps, 'first' and "
                          "'other'; keep one"));
  EXPECT_THAT(errors(kRos2 + "other:\n  ros__parameters: {calibration_steps: [a]}\n"), IsEmpty())
      << "the name of upstream's node decides";
}

// ---- real files ----

struct Counts {
  std::string file;
  std::size_t models, free, blocks;
};

void expect_counts(const std::filesystem::path& folder, const Counts& expected) {
  SCOPED_TRACE(expected.file);
  Diagnostics diagnostics;
  const Config config = read_config((folder / expected.file).string(), diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
  ASSERT_EQ(config.steps.size(), 1u);
  EXPECT_EQ(config.steps[0].models.size(), expected.models);
  EXPECT_EQ(free_parameters(config.steps[0]).size(), expected.free);
  EXPECT_EQ(config.steps[0].error_blocks.size(), expected.blocks);
}

TEST(ReadConfig, FetchsOwnFilesLoad) {
  KINECAL_NEEDS_DATA("fetch");
  const auto folder = test::data_folder() / "fetch";
  expect_counts(folder, {"calibrate.yaml", 2, 29, 2});
  expect_counts(folder, {"synth/calibrate.yaml", 2, 26, 2});
  Diagnostics diagnostics;
  Config config = read_config((folder / "calibrate_with_ground.yaml").string(), diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
  EXPECT_EQ(free_parameters(config.steps.at(0)).size(), 28u);
  BlockConfig plane = config.steps.at(0).error_blocks.at(1);
  EXPECT_EQ(plane.type, "chain3d_to_plane");
  EXPECT_THAT(plane.models, ElementsAre("camera"));
  EXPECT_EQ(plane.numbers["c"], 1.0);
}

TEST(ReadConfig, TrackerFilesHaveTheCountsOfTheirTable) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  for (const Counts& counts : std::vector<Counts>{{"base_tool.yaml", 2, 9, 1},
                                                  {"offsets.yaml", 2, 13, 1},
                                                  {"full.yaml", 2, 25, 1},
                                                  {"weak.yaml", 2, 27, 1},
                                                  {"redundant.yaml", 2, 51, 1}}) {
    expect_counts(test::data_folder() / "ur5_tracker", counts);
  }
}

TEST(ReadConfig, SocketFilesHaveTheCountsOfTheirTable) {
  KINECAL_NEEDS_DATA("mukca_panda");
  for (const std::string robot : {"panda_6", "panda_2"}) {
    const auto folder = test::data_folder() / "mukca_panda" / robot;
    for (const Counts& counts : std::vector<Counts>{{"minimal.yaml", 2, 30, 1},
                                                    {"stable.yaml", 2, 28, 1},
                                                    {"frames.yaml", 2, 51, 8},
                                                    {"redundant.yaml", 2, 51, 1}}) {
      expect_counts(folder, counts);
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string file = entry.path().filename().string();
      if (file.ends_with("_fixture.yaml")) expect_counts(folder, {file, 2, 6, 1});
    }
  }
}

}  // namespace
}  // namespace kinecal
