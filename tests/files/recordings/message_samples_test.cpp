#include "kinecal/files/recordings/message_samples.ipp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/encode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/recordings/sample_message.ipp"

namespace kinecal {
namespace {

using namespace detail;

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kType = "robot_calibration_msgs/CalibrationData";

Sample made_sample() {
  Sample sample;
  sample.joint_names = {"pan", "",
                        "l\xc3\xbc"
                        "ft"};
  sample.joint_positions = {0.1, -2.0, 1.0 / 3.0};
  sample.observations.resize(2);
  sample.observations[0] = {"arm", {{"tip", {1e-300, 2.5, -3.0}}, {"", {0, 0, 0}}}, {}};
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.distortion_model = "plumb_bob";
  camera.d = {0.1, 0.2, 0.3, 0.4, 0.5};
  camera.k = {500.5, 0, 320, 0, 501, 240, 0, 0, 1};
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.p = {500.25, 0, 320, 0, 0, 501, 240, 0, 0, 0, 1, 0};
  camera.z_offset = 0.0123;
  camera.z_scaling = 1.01;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  sample.observations[1] = {"camera", {{"optical", {nan, nan, nan}}}, camera};
  return sample;
}

std::vector<Sample> read_again(const std::vector<Sample>& samples, Encoding encoding,
                               Diagnostics& diagnostics) {
  const MessageDefinition definition = parse_definition(kType, known_definition(kType, encoding));
  MessageSamples messages("made.bag");
  for (std::size_t n = 0; n < samples.size(); ++n) {
    std::deque<std::string> texts;
    const auto bytes = encode(sample_message(samples[n], texts), definition, encoding);
    messages.add(decode(definition, encoding, bytes), static_cast<int>(n) + 1);
  }
  return messages.take(diagnostics);
}

TEST(MessageSamples, AreThoseThatWereWrittenInBothEncodings) {
  const Sample sample = made_sample();
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    Diagnostics diagnostics;
    const std::vector<Sample> all = read_again({sample, sample}, encoding, diagnostics);
    EXPECT_THAT(diagnostics.errors, ElementsAre());
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[1].source, "made.bag:2");
    EXPECT_EQ(all[0].joint_names, sample.joint_names);
    EXPECT_EQ(all[0].joint_positions, sample.joint_positions);
    ASSERT_EQ(all[0].observations.size(), 2u);
    const Observation &arm = all[0].observations[0], &camera = all[0].observations[1];
    EXPECT_EQ(arm.features[0].frame, "tip");
    EXPECT_EQ(arm.features[0].point, sample.observations[0].features[0].point);
    EXPECT_FALSE(arm.camera) << "a camera_info of zeros is not a camera";
    EXPECT_TRUE(std::isnan(camera.features[0].point.x()));
    ASSERT_TRUE(camera.camera);
    EXPECT_EQ(camera.camera->width, 640);
    EXPECT_EQ(camera.camera->d, sample.observations[1].camera->d);
    EXPECT_EQ(camera.camera->k, sample.observations[1].camera->k);
    EXPECT_EQ(camera.camera->p, sample.observations[1].camera->p);
    EXPECT_EQ(camera.camera->z_offset, 0.0123);
    EXPECT_EQ(camera.camera->z_scaling, 1.01);
  }
}

/// The parameters of an observation in a message, as "name=value".
std::vector<std::string> parameters(const Observation& seen) {
  std::deque<std::string> texts;
  std::vector<std::string> all;
  for (const MessageValue& parameter : parameters_message(seen, texts)) {
    const auto& fields = *parameter.as<MessageFields>();
    all.push_back(std::string(*fields.find("name")->as<std::string_view>()) + "=" +
                  std::to_string(std::lround(*fields.find("value")->as<double>())));
  }
  return all;
}

Observation numbered(const std::vector<std::optional<int>>& ids) {
  Observation seen{"arm", {}};
  for (const auto& id : ids) seen.features.push_back({"tip", {1.0, 2.0, 3.0}, {}, {}, id});
  return seen;
}

/// The message of upstream has no field for ids.
TEST(MessageSamples, KeepIdsAsParametersOfTheCamera) {
  EXPECT_THAT(parameters(numbered({0, 1, 2, 3, 4})), ElementsAre("feature_id_0=0"));
  EXPECT_THAT(parameters(numbered({})), ElementsAre());
  EXPECT_THAT(parameters(numbered({{}, {}})), ElementsAre());
  EXPECT_THAT(parameters(numbered({7, 8, 3, 2, {}, {}, 0})),
              ElementsAre("feature_id_0=7", "feature_id_2=3", "feature_id_3=2", "feature_id_4=-1",
                          "feature_id_6=0"));
  EXPECT_THAT(parameters(made_sample().observations[1]),
              ElementsAre("z_offset_mm=12", "z_scaling=1"));
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    Sample sample = made_sample();
    const std::vector<std::optional<int>> ids = {7, 8, 3, 2, {}, {}, 0, 2147483647};
    sample.observations[0] = numbered(ids);
    sample.observations[1].features[0].id = 5;
    Diagnostics diagnostics;
    const std::vector<Sample> again = read_again({sample}, encoding, diagnostics);
    EXPECT_THAT(diagnostics.errors, ElementsAre());
    EXPECT_THAT(diagnostics.warnings, ElementsAre());
    ASSERT_EQ(again.size(), 1u);
    const Observation &arm = again[0].observations[0], &camera = again[0].observations[1];
    for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(arm.features[i].id, ids[i]);
    EXPECT_FALSE(arm.camera);
    EXPECT_EQ(camera.features[0].id, 5);
    EXPECT_EQ(camera.camera.value().z_scaling, 1.01);
  }
}

TEST(MessageSamples, ReportsErrorsAsForYaml) {
  Sample sample = made_sample();
  sample.joint_positions.pop_back();
  Diagnostics diagnostics;
  EXPECT_EQ(read_again({made_sample(), sample}, Encoding::cdr, diagnostics).size(), 1u);
  ASSERT_EQ(diagnostics.errors.size(), 1u);
  EXPECT_THAT(diagnostics.errors[0], HasSubstr("made.bag:2: joint_states: 3 names but 2"));
}

TEST(MessageSamples, TakesMessagesWithMoreAndOtherFields) {
  std::string text = known_definition(kType, Encoding::cdr);
  text.insert(0, "float32[3] wind\nstring note\n");
  const std::string feature = "Point point\n";
  text.insert(text.find(feature), "float64 confidence\n");
  const MessageDefinition definition = parse_definition(kType, text);
  std::deque<std::string> texts;
  const Sample sample = made_sample();
  const auto bytes = encode(sample_message(sample, texts), definition, Encoding::cdr);
  MessageSamples messages("made.bag");
  messages.add(decode(definition, Encoding::cdr, bytes), 1);
  Diagnostics diagnostics;
  const std::vector<Sample> all = messages.take(diagnostics);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].observations[0].features[0].point, Vector3<double>(1e-300, 2.5, -3.0));
}

TEST(MessageSamples, ReportsWhatAMessageLacks) {
  MessageSamples messages("made.bag");
  messages.add(MessageFields{}, 4);
  Diagnostics diagnostics;
  EXPECT_TRUE(messages.take(diagnostics).empty());
  EXPECT_THAT(diagnostics.errors[0], HasSubstr("made.bag:4: sample without 'joint_states'"));
}

/// Doubles whose text is long, lossy or not a number; the last is a NaN with a payload.
const std::vector<double> kDifficult = {
    0.1 + 0.2,
    1e-310,
    std::numeric_limits<double>::denorm_min(),
    -0.0,
    std::numeric_limits<double>::max(),
    std::numeric_limits<double>::infinity(),
    -std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::quiet_NaN(),
    std::bit_cast<double>(std::uint64_t{0xfff8'0000'0000'1234})};

TEST(MessageSamples, HaveTheNumbersOfTheMessageBitForBit) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  Sample sample;
  sample.observations = {{"camera", {}, CameraInfo{}}};
  CameraInfo& camera = *sample.observations[0].camera;
  camera.width = 1;
  for (const double x : kDifficult) {
    sample.joint_names.push_back("joint_" + std::to_string(sample.joint_names.size()));
    sample.joint_positions.push_back(x);
    sample.observations[0].features.push_back({"tip", {x, x, x}});
    camera.d.push_back(x);
  }
  camera.k.fill(kDifficult[0]);
  camera.r.fill(kDifficult[1]);
  camera.p.fill(kDifficult[8]);
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    Diagnostics diagnostics;
    const std::vector<Sample> all = read_again({sample}, encoding, diagnostics);
    EXPECT_THAT(diagnostics.errors, ElementsAre());
    ASSERT_EQ(all.size(), 1u);
    const Observation& seen = all[0].observations.at(0);
    ASSERT_TRUE(seen.camera);
    for (std::size_t i = 0; i < kDifficult.size(); ++i) {
      EXPECT_EQ(bits(all[0].joint_positions.at(i)), bits(kDifficult[i])) << kDifficult[i];
      EXPECT_EQ(bits(seen.camera->d.at(i)), bits(kDifficult[i])) << kDifficult[i];
      for (const double x : seen.features.at(i).point) EXPECT_EQ(bits(x), bits(kDifficult[i]));
    }
    for (const double x : seen.camera->k) EXPECT_EQ(bits(x), bits(kDifficult[0]));
    for (const double x : seen.camera->r) EXPECT_EQ(bits(x), bits(kDifficult[1]));
    for (const double x : seen.camera->p) EXPECT_EQ(bits(x), bits(kDifficult[8]));
  }
}

/// A message with one joint at `position` and one observation.
MessageFields message_of(MessageValue position, MessageFields observation) {
  MessageValue::List positions, observations;
  positions.push_back(std::move(position));
  observations.emplace_back(std::move(observation));
  static const std::vector<std::string> names = {"pan"};
  return fields("joint_states", fields("name", texts(names), "position", std::move(positions)),
                "observations", std::move(observations));
}

std::vector<Sample> read_message(const MessageFields& message, Diagnostics& diagnostics) {
  MessageSamples messages("made.bag");
  messages.add(message, 7);
  return messages.take(diagnostics);
}

TEST(MessageSamples, TakeWholeNumbersAndTextsForNumbers) {
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  constexpr std::int64_t kBetween = (std::int64_t{1} << 53) + 1;  // no double is this
  const std::pair<MessageValue, double> positions[] = {
      {std::int64_t{-3}, -3.0},         {std::uint64_t{1}, 1.0},
      {kMost, 18446744073709551616.0},  {kBetween, 9007199254740992.0},
      {std::string_view("0.25"), 0.25},
  };
  for (const auto& [position, expected] : positions) {
    Diagnostics diagnostics;
    const auto samples =
        read_message(message_of(position, fields("sensor_name", "arm")), diagnostics);
    EXPECT_THAT(diagnostics.errors, ElementsAre());
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_THAT(samples[0].joint_positions, ElementsAre(expected));
  }
}

TEST(MessageSamples, TakeANumberForItsTextWhereAWordStands) {
  const std::pair<MessageValue, std::string> names[] = {
      {std::int64_t{-9007199254740993}, "-9007199254740993"},
      {std::numeric_limits<std::uint64_t>::max(), "18446744073709551615"},
      {0.1 + 0.2, "0.30000000000000004"},
      {5.0, "5"},
      {std::numeric_limits<double>::quiet_NaN(), "nan"},
      {-std::numeric_limits<double>::infinity(), "-inf"},
  };
  for (const auto& [name, expected] : names) {
    Diagnostics diagnostics;
    const auto samples = read_message(message_of(0.5, fields("sensor_name", name)), diagnostics);
    EXPECT_THAT(diagnostics.errors, ElementsAre());
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(samples[0].observations.at(0).sensor, expected);
  }
}

TEST(MessageSamples, ReportNumbersInTheWrongPlaceAsYamlDoes) {
  const auto errors = [](MessageValue position, MessageFields observation) {
    Diagnostics diagnostics;
    (void)read_message(message_of(std::move(position), std::move(observation)), diagnostics);
    return diagnostics.errors;
  };
  const auto with_height = [](double height) {
    return fields("sensor_name", "arm", "ext_camera_info",
                  fields("camera_info", fields("height", height)));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errors(std::string_view("fast"), fields("sensor_name", "arm")),
              ElementsAre("made.bag:7: position: 'fast' is not a number"));
  EXPECT_THAT(errors(0.5, fields("sensor_name", "arm", "features", 0.5)),
              ElementsAre("made.bag:7: features: '0.5' is not a list"));
  EXPECT_THAT(errors(0.5, fields("sensor_name", "arm", "ext_camera_info", std::int64_t{-1})),
              ElementsAre("made.bag:7: ext_camera_info: '-1' is not a map"));
  EXPECT_THAT(errors(0.5, with_height(kNan)),
              testing::Contains("made.bag:7: height: nan is not a number of pixels"));
  EXPECT_THAT(errors(0.5, with_height(-std::numeric_limits<double>::infinity())),
              testing::Contains("made.bag:7: height: -inf is not a number of pixels"));
  EXPECT_THAT(errors(0.5, with_height(0.5)),
              testing::Contains("made.bag:7: height: 0.5 is not a number of pixels"));
}

}  // namespace
}  // namespace kinecal
