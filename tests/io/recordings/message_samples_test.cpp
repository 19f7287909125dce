#include "kinecal/io/recordings/message_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "kinecal/io/messages/decode.hpp"
#include "kinecal/io/messages/encode.hpp"
#include "kinecal/io/messages/known_definitions.hpp"
#include "kinecal/io/recordings/sample_message.hpp"

namespace kinecal {
namespace {

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
  detail::MessageSamples messages("made.bag");
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto bytes = encode(sample_message(samples[n]), definition, encoding);
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
    EXPECT_FALSE(arm.camera) << "a camera_info of zeros is none";
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

TEST(MessageSamples, TellsWhatIsWrongAsForYaml) {
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
  const auto bytes = encode(sample_message(made_sample()), definition, Encoding::cdr);
  detail::MessageSamples messages("made.bag");
  messages.add(decode(definition, Encoding::cdr, bytes), 1);
  Diagnostics diagnostics;
  const std::vector<Sample> all = messages.take(diagnostics);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].observations[0].features[0].point, Vector3<double>(1e-300, 2.5, -3.0));
}

TEST(MessageSamples, MissesWhatAMessageHasNot) {
  detail::MessageSamples messages("made.bag");
  messages.add(MessageFields{}, 4);
  Diagnostics diagnostics;
  EXPECT_TRUE(messages.take(diagnostics).empty());
  EXPECT_THAT(diagnostics.errors[0], HasSubstr("made.bag:4: sample without 'joint_states'"));
}

}  // namespace
}  // namespace kinecal
