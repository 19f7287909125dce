// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_mcap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstring>
#include <map>
#include <sstream>

#include "kinecal/files/bags/mcap/read_mcap.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Message {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;
  YAML::Node json;  // JSON is YAML
};

/// The records of an MCAP file without compression, read by the specification.
struct McapContents {
  std::map<std::uint16_t, std::array<std::string, 3>> schemas;   ///< name, encoding, text
  std::map<std::uint16_t, std::array<std::string, 2>> channels;  ///< topic, encoding
  std::map<std::string, std::uint16_t> topics, schema_of;
  std::vector<Message> messages;
  std::string profile;

  explicit McapContents(const std::string& file) {
    EXPECT_EQ(file.substr(0, 8), std::string("\x89MCAP0\r\n", 8));
    read(file.substr(8, file.size() - 16));
  }
  /// The messages of a topic.
  [[nodiscard]] std::vector<Message> of(const std::string& topic) const {
    std::vector<Message> all;
    for (const Message& message : messages) {
      if (channels.at(message.channel)[0] == topic) all.push_back(message);
    }
    return all;
  }

 private:
  template <class T>
  static T take(std::string& bytes) {
    T number{};
    std::memcpy(&number, bytes.data(), sizeof number);
    bytes.erase(0, sizeof number);
    return number;
  }
  static std::string text(std::string& bytes) {
    const auto size = take<std::uint32_t>(bytes);
    std::string taken = bytes.substr(0, size);
    bytes.erase(0, size);
    return taken;
  }
  void read(const std::string& records) {
    for (std::size_t at = 0; at + 9 <= records.size();) {
      std::uint64_t size = 0;
      std::memcpy(&size, &records[at + 1], 8);
      record(records[at], records.substr(at + 9, size));
      if (records[at] == 0x0F) return;  // the end of the data
      at += 9 + size;
    }
  }
  void record(char op, std::string content) {
    if (op == 0x01) profile = text(content);
    if (op == 0x06) {
      content.erase(0, 28);  // times, size, sum
      EXPECT_EQ(text(content), "");
      read(content.substr(8));
    }
    if (op == 0x03) {
      const auto id = take<std::uint16_t>(content);
      for (std::string& part : schemas[id]) part = text(content);
    }
    if (op == 0x04) {
      const auto id = take<std::uint16_t>(content);
      const auto schema = take<std::uint16_t>(content);
      for (std::string& part : channels[id]) part = text(content);
      schema_of[channels[id][0]] = schema;
    }
    if (op == 0x05) {
      Message message;
      message.channel = take<std::uint16_t>(content);
      (void)take<std::uint32_t>(content);
      message.time = take<std::uint64_t>(content);
      EXPECT_EQ(take<std::uint64_t>(content), message.time);
      message.json = YAML::Load(content);
      messages.push_back(message);
    }
  }
};

/// Fields of a message that its schema does not have, or has with another type.
void expect_fits(const YAML::Node& json, const YAML::Node& schema, const std::string& where) {
  const auto type = schema["type"].as<std::string>();
  if (type == "object") {
    ASSERT_TRUE(json.IsMap()) << where;
    EXPECT_EQ(json.size(), schema["properties"].size()) << where;
    for (const auto& field : json) {
      const auto name = field.first.as<std::string>();
      ASSERT_TRUE(schema["properties"][name]) << where << "." << name;
      expect_fits(field.second, schema["properties"][name], where + "." + name);
    }
  } else if (type == "array") {
    ASSERT_TRUE(json.IsSequence()) << where;
    for (const auto& item : json) expect_fits(item, schema["items"], where + "[]");
  } else if (type == "number") {
    EXPECT_NO_THROW((void)json.as<double>()) << where;
  } else if (type == "integer") {
    EXPECT_NO_THROW((void)json.as<std::int64_t>()) << where;
  } else if (type == "boolean") {
    EXPECT_NO_THROW((void)json.as<bool>()) << where;
  } else {
    EXPECT_EQ(type, "string") << where;
  }
}

Pose<double> pose_of(const YAML::Node& transform) {
  const YAML::Node t = transform["translation"], q = transform["rotation"];
  const auto number = [](const YAML::Node& node) { return node.as<double>(); };
  return {rotation_from_quaternion(
              Eigen::Vector4d(number(q["x"]), number(q["y"]), number(q["z"]), number(q["w"]))),
          Vector3<double>(number(t["x"]), number(t["y"]), number(t["z"]))};
}

/// base_T_frame by the transforms of a message, from frame to parent up to the base.
Pose<double> base_T(const std::string& frame, const YAML::Node& transforms) {
  if (frame == "base_link") return {};
  for (const auto& transform : transforms) {
    if (transform["child_frame_id"].as<std::string>() != frame) continue;
    return base_T(transform["parent_frame_id"].as<std::string>(), transforms) * pose_of(transform);
  }
  ADD_FAILURE() << "no transform to " << frame;
  return {};
}

/// A calibration of ten samples with its scene.
class SceneMcap : public testing::Test {
 protected:
  test::NoisyScene noisy_{10};
  Findings findings_;
  RobotScene scene_;

  void SetUp() override {
    noisy_.solve();
    findings_ = findings_of(test::mobile_manipulator(), noisy_.calibration,
                            judge_result(noisy_.calibration, noisy_.result, noisy_.samples),
                            noisy_.samples);
    scene_ = robot_scene(noisy_.calibration, findings_, noisy_.samples);
  }
  [[nodiscard]] std::string file() const {
    std::ostringstream out;
    write_scene(scene_, out, Compression::none);
    return out.str();
  }
};

TEST_F(SceneMcap, MessagesAreJsonThatFitsItsSchemas) {
  Visual visual;
  for (const auto shape : {VisualShape::box, VisualShape::cylinder, VisualShape::sphere}) {
    visual.shape = shape;
    scene_.links[0].visuals.push_back({visual});
  }
  visual.shape = VisualShape::mesh;
  scene_.meshes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}}};
  scene_.links[1].visuals.push_back({visual, 0});
  const McapContents mcap(file());
  EXPECT_EQ(mcap.profile, "");
  std::vector<std::string> topics;
  for (const auto& [id, channel] : mcap.channels) {
    topics.push_back(channel[0]);
    EXPECT_EQ(channel[1], "json");
  }
  EXPECT_THAT(topics,
              ElementsAre("/transforms", "/robot", "/robot_before", "/errors", "/errors_before"));
  for (const auto& [topic, schema] : mcap.schema_of) {
    const auto& [name, encoding, text] = mcap.schemas.at(schema);
    EXPECT_EQ(encoding, "jsonschema");
    EXPECT_EQ(name, topic == "/transforms" ? "foxglove.FrameTransforms" : "foxglove.SceneUpdate");
    const YAML::Node parsed = YAML::Load(text);
    EXPECT_EQ(parsed["title"].as<std::string>(), name);
    for (const Message& message : mcap.of(topic)) expect_fits(message.json, parsed, topic);
  }
  EXPECT_EQ(mcap.of("/transforms").size(), 10U);
  EXPECT_EQ(mcap.of("/robot").size(), 1U);
  const YAML::Node entities = mcap.of("/robot")[0].json["entities"];
  ASSERT_EQ(entities.size(), 2U);
  EXPECT_EQ(
      entities[0]["cubes"].size() + entities[0]["cylinders"].size() + entities[0]["spheres"].size(),
      3U);
  EXPECT_EQ(entities[1]["triangles"][0]["points"].size(), 3U);
}

TEST_F(SceneMcap, OurReaderFindsTheFileWholeAndLeavesItsTopicsAlone) {
  std::istringstream in(file());
  Diagnostics diagnostics;
  const BagReader reader{.wants = [](const BagTopic&) { return true; },
                         .handle = [](const BagMessage&) { ADD_FAILURE() << "not of ROS"; }};
  read_mcap(in, "scene.mcap", reader, diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.warnings,
              ElementsAre(HasSubstr("5 topics are not in an encoding of ROS")));
}

TEST_F(SceneMcap, TransformsAreForwardKinematicsBeforeAndAfter) {
  const McapContents mcap(file());
  const auto messages = mcap.of("/transforms");
  const auto problem = test::scene_problem();
  const Eigen::VectorXd after = noisy_.values();
  const std::vector<double> before(static_cast<std::size_t>(after.size()), 0.0);
  constexpr double kRounded = 1e-6;  // of joints one after the other, each rounded to 1e-7
  for (std::size_t n = 0; n < messages.size(); ++n) {
    const YAML::Node transforms = messages[n].json["transforms"];
    const auto expect_pose = [&](const std::string& prefix, std::span<const double> values) {
      for (const auto& [sensor, link] :
           {std::pair(0, "hand"), std::pair(1, "camera_optical_frame")}) {
        const Pose<double> expected = test::tip_pose(problem, static_cast<std::size_t>(sensor),
                                                     link, noisy_.samples[n], values);
        const Pose<double> found = base_T(prefix + link, transforms);
        EXPECT_LT((found.translation - expected.translation).norm(), kRounded);
        EXPECT_LT((found.rotation - expected.rotation).norm(), kRounded);
      }
    };
    expect_pose("", test::NoisyScene::span(after));
    expect_pose("before/", before);
  }
}

TEST_F(SceneMcap, ErrorsAreLinesBetweenMeasuredAndPredictedPoints) {
  const McapContents mcap(file());
  const auto messages = mcap.of("/errors");
  ASSERT_EQ(messages.size(), 10U);
  const YAML::Node entity = messages[3].json["entities"][0];
  EXPECT_EQ(entity["frame_id"].as<std::string>(), "base_link");
  EXPECT_EQ(entity["spheres"].size(), 8U);
  EXPECT_EQ(entity["lines"][0]["type"].as<int>(), 2);
  const YAML::Node points = entity["lines"][0]["points"];
  ASSERT_EQ(points.size(), 8U);
  const ScenePair& pair = *scene_.samples[3].features[2].after;
  EXPECT_NEAR(points[4]["y"].as<double>(), pair[0][1], 1e-7);
  EXPECT_NEAR(points[5]["z"].as<double>(), pair[1][2], 1e-7);
  EXPECT_THAT(entity["texts"][0]["text"].as<std::string>(), HasSubstr("sample 4: feature "));
}

TEST_F(SceneMcap, TimesAreStampsOrSeconds) {
  const auto first_two = [&] {
    const auto messages = McapContents(file()).of("/errors");
    return std::pair(messages[0].time, messages[1].time);
  };
  EXPECT_EQ(first_two(), std::pair(1000000000UL, 2000000000UL));
  for (std::size_t i = 0; i < scene_.samples.size(); ++i) {
    scene_.samples[i].stamp = std::chrono::nanoseconds(1700000000123456789 + 5 * std::int64_t(i));
  }
  EXPECT_EQ(first_two(), std::pair(1700000000123456789UL, 1700000000123456794UL));
  const McapContents mcap(file());
  const YAML::Node stamp = mcap.of("/transforms")[0].json["transforms"][0]["timestamp"];
  EXPECT_EQ(stamp["sec"].as<std::int64_t>(), 1700000000);
  EXPECT_EQ(stamp["nsec"].as<std::int64_t>(), 123456789);
  scene_.samples[5].stamp.reset();
  EXPECT_EQ(first_two(), std::pair(1000000000UL, 2000000000UL)) << "not all have one";
  scene_.samples[5].stamp = std::chrono::nanoseconds(3);
  EXPECT_EQ(first_two(), std::pair(1000000000UL, 2000000000UL)) << "not in their order";
}

TEST_F(SceneMcap, NamesAreEscaped) {
  const std::string evil = "a\"b\\c\n\xF0\x9F\xA6\xBE</script>";
  scene_.links[0].name = evil;
  scene_.samples[0].bad = true;
  scene_.samples[0].note = "\"quoted\"";
  const McapContents mcap(file());
  bool found = false;
  for (const auto& transform : mcap.of("/transforms")[0].json["transforms"]) {
    found = found || transform["child_frame_id"].as<std::string>() == "before/" + evil ||
            transform["parent_frame_id"].as<std::string>() == "before/" + evil;
  }
  EXPECT_TRUE(found);
  const YAML::Node texts = mcap.of("/errors")[0].json["entities"][0]["texts"];
  EXPECT_THAT(texts[0]["text"].as<std::string>(), HasSubstr("\n\"quoted\""));
}

TEST_F(SceneMcap, ARobotWithoutShapesIsLinesFromJointToJoint) {
  const McapContents mcap(file());
  const YAML::Node entities = mcap.of("/robot")[0].json["entities"];
  EXPECT_EQ(entities.size(), scene_.joints.size());
  EXPECT_EQ(entities[0]["lines"].size(), 1U);
}

TEST_F(SceneMcap, TheSameSceneIsTheSameFile) {
  EXPECT_EQ(file(), file());
}

}  // namespace
}  // namespace kinecal
