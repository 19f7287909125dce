#include "kinecal/files/recordings/read_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/convert.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "support/data.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RecordingTest : public test::FolderTest {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }

  [[nodiscard]] Recording read(const std::string& file) {
    return read_recording(file, diagnostics_);
  }

  void convert(const std::string& from, const std::string& to, Encoding encoding,
               Clouds clouds = Clouds::keep) {
    BagOutput bag(to, encoding);
    (void)convert_bag(from, bag, clouds, diagnostics_);
    bag.finish();
  }

  Diagnostics diagnostics_;
};

void expect_same(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].joint_names, b[n].joint_names);
    EXPECT_EQ(a[n].joint_positions, b[n].joint_positions);
    ASSERT_EQ(a[n].observations.size(), b[n].observations.size());
    for (std::size_t s = 0; s < a[n].observations.size(); ++s) {
      const Observation &x = a[n].observations[s], &y = b[n].observations[s];
      EXPECT_EQ(x.sensor, y.sensor);
      ASSERT_EQ(x.features.size(), y.features.size());
      for (std::size_t i = 0; i < x.features.size(); ++i) {
        EXPECT_EQ(x.features[i].frame, y.features[i].frame);
        EXPECT_EQ(x.features[i].point, y.features[i].point);
      }
      ASSERT_EQ(x.camera.has_value(), y.camera.has_value());
      if (!x.camera) continue;
      EXPECT_EQ(x.camera->p, y.camera->p);
      EXPECT_EQ(x.camera->d, y.camera->d);
      EXPECT_EQ(x.camera->z_offset, y.camera->z_offset);
      EXPECT_EQ(x.camera->z_scaling, y.camera->z_scaling);
    }
  }
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<Sample> made_samples() {
  std::vector<Sample> samples(3);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n].joint_names = {"pan", "tilt"};
    samples[n].joint_positions = {0.1 * static_cast<double>(n), -1.0};
    samples[n].observations = {{"arm", {{"tip", {0.1, 0.2, 1.0 / 3.0}}}, {}}};
  }
  return samples;
}

TEST_F(RecordingTest, OfRos1HoldsTheSamplesOfTheYamlAndTheUrdf) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const auto synth = test::data_folder() / "fetch/synth";
  const Recording bag = read(synth / "calibration_data.bag");
  const Recording yaml = read(synth / "samples.yaml");
  EXPECT_THAT(diagnostics_.errors, ElementsAre());
  EXPECT_EQ(bag.samples.size(), 100u);
  expect_same(bag.samples, yaml.samples);
  EXPECT_EQ(bag.urdf, content(synth / "fetch_arm_head.urdf"));
  EXPECT_THAT(bag.samples[41].source, HasSubstr("calibration_data.bag:42"));
}

TEST_F(RecordingTest, ConvertedToMcapAndBackIsTheSame) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const auto synth = test::data_folder() / "fetch/synth";
  const std::string bag = synth / "calibration_data.bag";
  convert(bag, path("a.mcap"), Encoding::cdr, Clouds::drop);
  convert(path("a.mcap"), path("b"), Encoding::ros1);
  convert(path("b"), path("c"), Encoding::ros1);
  EXPECT_THAT(diagnostics_.errors, ElementsAre());
  EXPECT_THAT(diagnostics_.warnings, ElementsAre());
  const Recording original = read(bag);
  for (const char* file : {"a.mcap", "b", "c"}) {
    SCOPED_TRACE(file);
    const Recording converted = read(path(file));
    expect_same(converted.samples, original.samples);
    EXPECT_EQ(converted.urdf, original.urdf);
  }
  EXPECT_EQ(content(path("b")), content(path("c"))) << "a copy is a copy";
}

TEST_F(RecordingTest, OfSamplesAndAUrdfIsReadAgain) {
  const std::vector<Sample> samples = made_samples();
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    const std::string file = path(encoding == Encoding::ros1 ? "a" : "b");
    BagOutput bag(file, encoding);
    write_samples(bag, samples);
    write_urdf(bag, "<robot/>");
    EXPECT_FALSE(std::filesystem::exists(file)) << "half a bag has no name";
    bag.finish();
    const Recording recording = read(file);
    expect_same(recording.samples, samples);
    EXPECT_EQ(recording.urdf, "<robot/>");
    const auto topics = bag_topics(file, diagnostics_);
    ASSERT_EQ(topics.size(), 2u);
    EXPECT_EQ(topics[0].name, "calibration_data");
    EXPECT_EQ(topics[0].messages, 3);
    EXPECT_EQ(topics[0].use, TopicUse::samples);
    EXPECT_EQ(topics[1].use, TopicUse::urdf);
  }
  EXPECT_EQ(recording_format(path("a")), RecordingFormat::ros1_bag);
  EXPECT_EQ(recording_format(path("b")), RecordingFormat::mcap);
  EXPECT_THAT(diagnostics_.errors, ElementsAre());
}

TEST_F(RecordingTest, HasVelocitiesFromNeighboursInTime) {
  std::vector<Sample> samples = made_samples();  // pan moves by 0.1 from each to the next
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n].stamp = std::chrono::milliseconds(1000 + 100 * static_cast<long>(n));
  }
  std::ofstream yaml(path("a.yaml"));
  write_samples(yaml, samples);
  yaml.close();
  BagOutput bag(path("a.mcap"), Encoding::cdr);
  write_samples(bag, samples);
  bag.finish();
  for (const char* file : {"a.yaml", "a.mcap"}) {
    SCOPED_TRACE(file);
    const Recording recording = read(path(file));
    ASSERT_EQ(recording.samples.size(), 3u);
    EXPECT_NEAR(recording.samples[1].velocity("pan").value_or(0.0), 1.0, 1e-9);
    EXPECT_NEAR(recording.samples[1].velocity("tilt").value_or(1.0), 0.0, 1e-9);
    EXPECT_NEAR(recording.samples[2].move("pan").value_or(0.0), 0.1, 1e-9);
    const Recording copy = read_as_recorded(path(file), diagnostics_);
    EXPECT_THAT(copy.samples[1].joint_velocities, ElementsAre()) << "a copy has what is recorded";
  }
  EXPECT_THAT(diagnostics_.errors, ElementsAre());
}

TEST_F(RecordingTest, TellsHowMuchHasBeenRead) {
  std::vector<Sample> samples(500);
  for (Sample& sample : samples) {
    sample.joint_names = {"elbow"};
    sample.joint_positions = {0.5};
    sample.observations = {{"arm", std::vector<Feature>(100, Feature{"hand", {1.0, 2.0, 3.0}})}};
  }
  for (const auto& [name, encoding] :
       {std::pair("large.bag", Encoding::ros1), std::pair("large.mcap", Encoding::cdr)}) {
    BagOutput bag(path(name), encoding);
    write_samples(bag, samples);
    bag.finish();
    ASSERT_GT(std::filesystem::file_size(path(name)), 2'000'000u);
    std::vector<double> fractions;
    const auto meter = [&, file = path(name)](double fraction, const std::string& what) {
      fractions.push_back(fraction);
      EXPECT_EQ(what, "reading " + file);
    };
    EXPECT_EQ(read_recording(path(name), diagnostics_, 1, meter).samples.size(), 500u);
    EXPECT_THAT(fractions, testing::SizeIs(testing::Ge(2u))) << name;
    EXPECT_THAT(fractions, testing::Each(testing::AllOf(testing::Gt(0.0), testing::Le(1.0))));
  }
}

TEST_F(RecordingTest, OfACompressedFileIsRead) {
  if (!is_available(Compression::zstd)) GTEST_SKIP() << "built without zstd";
  BagOutput bag(path("a.mcap"), Encoding::cdr);
  write_samples(bag, made_samples());
  bag.finish();
  const auto packed = detail::pack(detail::as_bytes(content(path("a.mcap"))), Compression::zstd);
  write("a.mcap.zstd", {reinterpret_cast<const char*>(packed.data()), packed.size()});
  EXPECT_EQ(recording_format(path("a.mcap.zstd")), RecordingFormat::zstd);
  expect_same(read(path("a.mcap.zstd")).samples, made_samples());
  EXPECT_THAT(diagnostics_.errors, ElementsAre());
}

TEST_F(RecordingTest, OfRos1HasTheTopicsThatRobotCalibrationLooksFor) {
  BagOutput bag(path("a"), Encoding::ros1);
  write_samples(bag, made_samples());
  write_urdf(bag, "<robot/>");
  write_poses(bag, {{{"pan"}, {0.5}, {}}});
  bag.finish();
  convert(path("a"), path("b"), Encoding::ros1);
  for (const char* file : {"a", "b"}) {
    const std::string bytes = content(path(file));
    EXPECT_THAT(bytes, HasSubstr("topic=/calibration_data"));
    EXPECT_THAT(bytes, HasSubstr("topic=/robot_description"));
    EXPECT_THAT(bytes, HasSubstr("topic=calibration_joint_states"));
  }
}

TEST_F(RecordingTest, WithoutSamplesSaysSo) {
  BagOutput bag(path("a"), Encoding::cdr);
  write_urdf(bag, "<robot/>");
  bag.finish();
  EXPECT_TRUE(read(path("a")).samples.empty());
  ASSERT_EQ(diagnostics_.errors.size(), 1u);
  EXPECT_THAT(diagnostics_.errors[0], HasSubstr("no messages of robot_calibration_msgs"));
}

TEST_F(RecordingTest, ReportsMessagesThatAreNotOfTheirType) {
  BagOutput bag(path("a"), Encoding::cdr);
  const BagTopic topic{
      "calibration_data", "robot_calibration_msgs/CalibrationData",
      detail::known_definition("robot_calibration_msgs/CalibrationData", Encoding::cdr),
      Encoding::cdr};
  const std::vector<std::byte> few(6);
  bag.copy(topic, 1, few);
  write_samples(bag, made_samples());
  bag.finish();
  EXPECT_EQ(read(path("a")).samples.size(), 3u);
  ASSERT_EQ(diagnostics_.errors.size(), 1u);
  EXPECT_THAT(diagnostics_.errors[0], HasSubstr("message 1 of topic 'calibration_data' is not a "
                                                "robot_calibration_msgs/CalibrationData: byte"));
}

TEST_F(RecordingTest, ReportsTheFirstOfManyMessagesThatAreNotOfTheirType) {
  BagOutput bag(path("a"), Encoding::cdr);
  const BagTopic topic{"calibration_data", "robot_calibration_msgs/CalibrationData", "int64 x\n",
                       Encoding::cdr};
  for (int i = 0; i < 1000; ++i) bag.copy(topic, 1, std::vector<std::byte>(6));
  bag.finish();
  (void)read(path("a"));
  ASSERT_EQ(diagnostics_.errors.size(), 21u);
  EXPECT_THAT(diagnostics_.errors[20], HasSubstr("more than 20 messages cannot be read"));
}

TEST_F(RecordingTest, KeepsTheVersionsOfATopicApart) {
  for (const Encoding encoding : {Encoding::ros1, Encoding::cdr}) {
    BagOutput bag(path("a"), encoding);
    for (const char* definition : {"float64 t\n", "float32 t\n"}) {
      const BagTopic topic{"temperature", "sensor_msgs/Temperature", definition, encoding};
      bag.copy(topic, 1, std::vector<std::byte>(12));
    }
    bag.finish();
    convert(path("a"), path("b"), encoding);
    std::vector<std::string> definitions;
    const auto handle = [&](const BagMessage& message) {
      definitions.push_back(message.topic.definition);
    };
    read_bag(path("b"), {[](const BagTopic&) { return true; }, handle}, diagnostics_);
    EXPECT_THAT(definitions, ElementsAre("float64 t\n", "float32 t\n"));
  }
}

TEST_F(RecordingTest, ReportsTimesThatRos1DoesNotHave) {
  BagOutput bag(path("a"), Encoding::cdr);
  const std::string urdf = detail::known_definition("std_msgs/String", Encoding::cdr);
  const BagTopic topic{"robot_description", "std_msgs/String", urdf, Encoding::cdr};
  const std::array<std::byte, 9> empty{std::byte{0}, std::byte{1}};
  for (const std::int64_t time : {std::int64_t{5'000'000'000'000'000'000}, std::int64_t{1}}) {
    bag.copy(topic, time, empty);
    bag.copy(topic, time, empty);
  }
  bag.finish();
  convert(path("a"), path("b"), Encoding::ros1);
  ASSERT_EQ(diagnostics_.errors.size(), 1u);
  EXPECT_THAT(diagnostics_.errors[0],
              HasSubstr("a: message 1 of topic 'robot_description' cannot be written: its time of "
                        "recording is not between 1970 and 2106"));
  EXPECT_EQ(bag_topics(path("b"), diagnostics_).at(0).messages, 2);
}

TEST_F(RecordingTest, LeavesOutWhatTheOtherRosDoesNotKnow) {
  {
    BagOutput bag(path("a"), Encoding::ros1);
    const BagTopic temperature{"temperature", "sensor_msgs/Temperature", "float64 t\n",
                               Encoding::ros1, "0123456789abcdef0123456789abcdef"};
    bag.copy(temperature, 1, std::vector<std::byte>(8));
    write_samples(bag, made_samples());
    bag.finish();
  }
  convert(path("a"), path("same"), Encoding::ros1);
  EXPECT_EQ(bag_topics(path("same"), diagnostics_).size(), 2u);
  EXPECT_THAT(diagnostics_.warnings, ElementsAre());
  convert(path("a"), path("other"), Encoding::cdr);
  EXPECT_EQ(bag_topics(path("other"), diagnostics_).size(), 1u);
  ASSERT_EQ(diagnostics_.warnings.size(), 1u);
  EXPECT_THAT(
      diagnostics_.warnings[0],
      HasSubstr("topic 'temperature' is left out: kinecal cannot convert messages of its type"));
}

}  // namespace
}  // namespace kinecal
