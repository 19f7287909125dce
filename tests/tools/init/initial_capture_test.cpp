// What init writes for a capture has the names of its configuration, and is refused until it is
// filled in.
#include "kinecal/tools/init/initial_capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// Reads what was written.
template <class Read>
auto read_written(const std::string& text, Diagnostics& diagnostics, Read&& read) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "written.yaml";
  std::ofstream(path) << text;
  return read(path.string(), diagnostics);
}

/// With numbers in place of the zeros.
std::string filled_in(std::string text) {
  text = std::regex_replace(text, std::regex("(columns|rows|points_x|points_y): 0"), "$1: 6");
  text = std::regex_replace(text, std::regex("(squares_x|squares_y): 0"), "$1: 5");
  text = std::regex_replace(text, std::regex("marker_size: 0.0"), "marker_size: 0.02");
  text = std::regex_replace(text, std::regex("size: 0.0( |\n)"), "size: 0.03$1");
  return std::regex_replace(text, std::regex("poses: \\[\\]"),
                            "poses: [{code: 1, topic: led1, x: 0.01, y: 0, z: 0}]");
}

/// The settings of a finder's target.
const TargetSettings* target_of(const FinderSettings& settings) {
  if (const auto* board = std::get_if<CheckerboardSettings>(&settings)) return &board->target;
  if (const auto* tags = std::get_if<AprilTagSettings>(&settings)) return &tags->target;
  const auto* charuco = std::get_if<CharucoSettings>(&settings);
  return charuco != nullptr ? &charuco->target : nullptr;
}

InitAnswers fetch_answers(const InitTargetWord& word, const std::string& camera_type) {
  InitAnswers answers;
  answers.target = word.target;
  answers.board = word.board;
  answers.arm = "gripper_link";
  answers.camera = "head_camera_rgb_optical_frame";
  answers.camera_type = camera_type;
  answers.camera_name = "eye";
  return answers;
}

TEST(InitialCapture, HasTheNamesOfTheConfiguration) {
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  for (const InitTargetWord& word : kInitTargets) {
    if (word.target == InitTarget::grip) continue;  // of two arms
    for (const char* type : {"camera3d", "camera2d"}) {
      const InitAnswers answers = fetch_answers(word, type);
      if (word.target == InitTarget::ground && answers.camera_type == "camera2d") continue;
      SCOPED_TRACE(std::string(word.word) + " " + type);
      const std::string text = initial_capture(robot, answers);
      const bool in_pixels = answers.camera_type == "camera2d";
      EXPECT_EQ(text.empty(),
                word.target == InitTarget::tracker || word.target == InitTarget::robot ||
                    word.target == InitTarget::distance || word.target == InitTarget::gravity ||
                    (word.target == InitTarget::leds && in_pixels));
      if (text.empty()) continue;
      Diagnostics diagnostics;
      const auto capture = read_written(filled_in(text), diagnostics, read_capture_config);
      const auto config = read_written(initial_config(robot, answers), diagnostics,
                                       [](auto&& path, auto& of) { return read_config(path, of); });
      EXPECT_THAT(diagnostics.errors, testing::IsEmpty()) << filled_in(text);
      ASSERT_FALSE(capture.finders.empty());
      const StepConfig& step = config.steps.front();
      std::vector<std::string> models, frames;
      for (const ModelConfig& model : step.models) models.push_back(model.name);
      for (const FreeFrameConfig& frame : step.free_frames) frames.push_back(frame.name);
      for (const CaptureFinder& finder : capture.finders) {
        if (is_touched(word.target)) {
          EXPECT_THAT(frames, testing::Contains(std::get<TouchFinder>(finder.settings).frame));
          continue;
        }
        EXPECT_EQ(finder.type.ends_with("2d"), in_pixels);
        const TargetSettings* target = target_of(finder.settings);
        if (target == nullptr) continue;
        EXPECT_THAT(models, testing::Contains(target->camera_sensor));
        EXPECT_THAT(models, testing::Contains(target->chain_sensor));
        EXPECT_THAT(frames, testing::Contains(target->frame));
      }
    }
  }
}

TEST(InitialCapture, IsRefusedUntilItIsFilledIn) {
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  for (const char* name : {"checkerboard", "apriltag", "world_charuco", "leds"}) {
    Diagnostics diagnostics;
    (void)read_written(initial_capture(robot, fetch_answers(*init_target(name), "camera3d")),
                       diagnostics, read_capture_config);
    EXPECT_FALSE(diagnostics.errors.empty()) << name;
  }
}

TEST(InitialCapture, MovesTheJointsOfArmAndHead) {
  const Robot robot = read_urdf(test::source_folder() + "/examples/robots/fetch/fetch.urdf");
  const std::string text = initial_capture(robot, fetch_answers(*init_target("leds"), "camera3d"));
  EXPECT_THAT(text, HasSubstr("joints: [head_pan_joint, head_tilt_joint]"));
  EXPECT_THAT(text, HasSubstr("wrist_roll_joint]"));
}

}  // namespace
}  // namespace kinecal
