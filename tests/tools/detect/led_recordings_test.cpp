// LEDs from recordings: which was on when, and where it lights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "capture/led_scene.hpp"
#include "kinecal/tools/detect/detect_all.hpp"
#include "kinecal/tools/detect/led_commands.hpp"
#include "support/recording.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;
using test::Recorder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Stamp at(int milliseconds_) {
  return std::chrono::seconds(1'700'000'000) + milliseconds(milliseconds_);
}

TEST(LedCommands, SpansAreWithoutTheTimeThatASwitchTakes) {
  const std::vector<LedCommand> commands = {{at(100), 0}, {at(500), 4}, {at(900), 0}};
  const auto spans = led_spans(commands, {at(200), at(2000)}, milliseconds(100));
  ASSERT_EQ(spans.size(), 3u);
  EXPECT_EQ(spans[0].code, 0);
  EXPECT_EQ(spans[0].time.begin, at(200));
  EXPECT_EQ(spans[1].code, 4);
  EXPECT_EQ(spans[1].time.begin, at(600));
  EXPECT_EQ(spans[1].time.end, at(900));
  EXPECT_EQ(spans[2].time.end, at(2000));
}

TEST(LedCommands, BeforeTheFirstOneLedsAreDarkOnlyIfTheyNeverAreLater) {
  const Standstill time{at(0), at(1000)};
  const auto cycle = led_spans({{at(300), 0}, {at(600), 4}}, time, milliseconds(50));
  ASSERT_EQ(cycle.size(), 2u) << "the recording may have begun with an LED on";
  EXPECT_EQ(cycle[0].time.begin, at(350));
  const auto lit = led_spans({{at(300), 4}, {at(600), 8}}, time, milliseconds(50));
  ASSERT_EQ(lit.size(), 3u);
  EXPECT_EQ(lit[0].code, 0);
  EXPECT_EQ(lit[0].time.end, at(300));
}

TEST(LedCommands, ACodeIsOneOfTheFields) {
  using detail::fields;
  EXPECT_EQ(led_code(fields("goal", fields("led_code", std::int64_t{8}))), 8);
  EXPECT_EQ(led_code(fields("data", std::int64_t{2})), 2);
  EXPECT_EQ(led_code(fields("data", -2.0)), std::nullopt);
  EXPECT_EQ(led_code(fields("data", 1.5)), std::nullopt);
  EXPECT_EQ(led_code(fields("code", std::int64_t{2})), std::nullopt);
}

class LedRecordings : public test::FolderTest {
 protected:
  /// Records a robot at rest whose LEDs are switched, each twice.  Just after a switch, images show the code before.
  void record(const std::string& topic, const std::string& type, bool has_table = false) {
    Recorder to(bag(), Encoding::ros1);
    std::ofstream table(folder_ / "led.csv");
    table << "time,code\n" << std::fixed;
    constexpr int kSegment = 300, kWrong = 50, kRight = 190;  // milliseconds
    std::vector<int> codes = {0, 0};
    for (int cycle = 0; cycle < (topic.empty() ? 0 : 2); ++cycle) {
      for (const Led& led : scene_.finder().leds) codes.insert(codes.end(), {led.code, 0});
    }
    const auto image = [&](int time) {
      View view = scene_.next_view(at(time) - scene_.period);
      Image<std::uint16_t> depth(640, 480);
      for (int v = 0; v < 480; ++v) {
        for (int u = 0; u < 640; ++u) {
          const double z = view.points(u, v).z();
          depth(u, v) = std::isfinite(z) ? static_cast<std::uint16_t>(std::lround(1e3 * z)) : 0;
        }
      }
      to.camera_info("/cam/camera_info", at(time), vga_camera());
      to.image("/cam/image", at(time), view.image);
      to.depth("/cam/depth", at(time), depth);
    };
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const int begin = kSegment * static_cast<int>(i);
      for (int t = begin; t < begin + kSegment; t += 20)
        to.joints("/joint_states", {at(t), {"pan"}, {0.5 + 1e-5 * (t % 3)}});
      if (!topic.empty()) to.led(topic, type, at(begin), codes[i]);
      if (has_table)
        table << 1e-9 * static_cast<double>(at(begin).count()) << "," << codes[i] << "\n";
      image(begin + kWrong);
      scene_.now = at(begin + kWrong);
      (void)scene_.light(codes[i]);
      image(begin + kRight);
    }
    to.finish();
  }
  [[nodiscard]] std::string bag() const { return (folder_ / "leds.bag").string(); }

  DetectedSamples detect(const std::string& led = "") {
    DetectionInput input;
    input.config.finders = {{"leds",
                             "LedFinder",
                             "/cam/image",
                             "/cam/camera_info",
                             "/gripper_led_action",
                             scene_.finder(),
                             {"capture.yaml", 7}}};
    input.recordings.emplace_back(RecordingOptions{.path = bag(), .led = led}, input.config.finders,
                                  found_);
    return found_.errors.empty() ? detect_all(input, {.threads = 1}, found_) : DetectedSamples{};
  }
  void expect_all(const DetectedSamples& detected) {
    ASSERT_THAT(found_.errors, IsEmpty());
    ASSERT_EQ(detected.samples.size(), 1u) << detected.looks.at(0).refused.at(0);
    const Observation* seen = detected.samples[0].observation("camera");
    ASSERT_NE(seen, nullptr);
    ASSERT_EQ(seen->features.size(), 4u);
    for (const Feature& led : seen->features) {
      const auto truth = scene_.led_in_camera(static_cast<std::size_t>(led.id.value()));
      EXPECT_LT((led.point - truth).norm(), 0.004) << *led.id;
    }
    EXPECT_NEAR(detected.samples[0].position("pan").value(), 0.5, 1e-4);
  }

  LedScene scene_;
  Diagnostics found_;
};

TEST_F(LedRecordings, ByTheCommandsOfTheGripper) {
  record("/gripper_led_action/goal", "robot_calibration_msgs/GripperLedCommandActionGoal");
  expect_all(detect());
}

TEST_F(LedRecordings, ByATopicOrATable) {
  record("/which", "std_msgs/UInt8", true);
  expect_all(detect("which"));
  expect_all(detect((folder_ / "led.csv").string()));
}

TEST_F(LedRecordings, ATableHasCodesOfSixteenBits) {
  for (const char* code : {"65536", "1e300", "inf", "-1", "1.5"}) {
    write("led.csv", std::string("time,code\n1,") + code + "\n");
    found_ = {};
    EXPECT_THAT(read_led_table((folder_ / "led.csv").string(), found_), IsEmpty()) << code;
    EXPECT_THAT(found_.errors, ElementsAre(HasSubstr("led.csv:2: time and code of LEDs"))) << code;
  }
}

TEST_F(LedRecordings, WithoutCommandsSayWhatIsMissing) {
  record("", "");
  (void)detect();
  EXPECT_THAT(found_.errors,
              ElementsAre(testing::AllOf(
                  HasSubstr("capture.yaml:7: finder 'leds': LEDs take the times"),
                  HasSubstr("topic 'gripper_led_action/goal' of "
                            "robot_calibration_msgs/GripperLedCommandActionGoal; record it"))));
  found_ = {};
  (void)detect("witch");
  EXPECT_THAT(found_.errors, ElementsAre(HasSubstr("on topic 'witch' of --led")));
}

}  // namespace
}  // namespace kinecal
