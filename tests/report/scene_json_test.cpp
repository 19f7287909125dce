// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/text/characters.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::vector<T> numbers_of(const std::string& base64) {
  const std::string bytes = from_base64(base64).value();
  std::vector<T> numbers(bytes.size() / sizeof(T));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(T));
  return numbers;
}

/// A scene with one of everything.
RobotScene one_of_everything() {
  RobotScene scene;
  scene.links = {{"base"}, {"arm"}, {"board"}};
  Visual box;
  box.size = {0.1, 0.2, 0.3};
  Visual mesh;
  mesh.shape = VisualShape::mesh;
  mesh.scale = {0.001, 0.001, -0.001};
  scene.links[0].visuals = {{box}, {mesh, 0}, {mesh}};
  SceneJoint joint;
  joint.name = "elbow";
  joint.type = JointType::revolute;
  joint.child = 1;
  joint.origin.translation = Vector3<double>(0.1, 0.0, -0.25);
  joint.drive = 0;
  joint.multiplier = -2.0;
  joint.before.emplace();
  joint.after = SceneCorrection{.t = {1e-3, 0.0, 0.0}, .offset = 0.0123456};
  SceneJoint board;
  board.name = "board";
  board.parent = 1;
  board.child = 2;
  board.is_virtual = true;
  scene.joints = {joint, board};
  scene.meshes = {{{0.0F, 0.5F, -1.25F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}, {0, 1, 2, 2, 1, 0}}};
  scene.names = {"elbow"};
  scene.blocks = {"points"};
  SceneFeature feature;
  feature.name = "feature 1";
  feature.after = {{{1.0, 2.0, 3.0}, {1.0, 2.0, 3.00123456}}};
  feature.error = "1.23 mm";
  SceneSample sample;
  sample.number = 7;
  sample.source = "s.yaml:12";
  sample.bad = true;
  sample.note = "5 mm off";
  sample.q = {0.25};
  sample.features = {feature};
  scene.samples = {sample};
  scene.cameras = {{"camera", 1, 640, 480, 525.5, 525, 320, 240}};
  scene.workspace = {{0.5, 0.0, 0.25, 0.0015}};
  scene.thinned = "1 of 10 samples";
  return scene;
}

TEST(SceneJson, SaysWhichSampleIsLeftOutAndHidesNoText) {
  RobotScene scene = one_of_everything();
  EXPECT_FALSE(YAML::Load(scene_json(scene))["samples"][0]["left_out"]);
  scene.samples[0].left_out = true;
  const std::string hidden = "a\u202Eb\x1b";
  scene.samples[0].source = scene.samples[0].note = scene.blocks[0] = scene.joints[0].name = hidden;
  scene.links[0].name = scene.cameras[0].name = scene.samples[0].features[0].name = hidden;
  const std::string text = scene_json(scene);
  EXPECT_TRUE(YAML::Load(text)["samples"][0]["left_out"].as<bool>());
  EXPECT_EQ(text.find("\u202E"), std::string::npos);
  EXPECT_EQ(text.find("u001b"), std::string::npos);
}

TEST(SceneJson, HasOneOfEverything) {
  const std::string text = scene_json(one_of_everything());
  const YAML::Node json = YAML::Load(text);  // JSON is YAML
  EXPECT_EQ(json["base"].as<int>(), 0);
  EXPECT_EQ(json["links"].size(), 3U);
  EXPECT_EQ(json["links"][0]["visuals"].size(), 2U) << "a mesh that was not found is left out";
  EXPECT_EQ(json["links"][0]["visuals"][0]["size"][2].as<double>(), 0.3);
  EXPECT_EQ(json["links"][0]["visuals"][1]["scale"][2].as<double>(), -0.001);
  EXPECT_FALSE(json["links"][1]["visuals"]);
  const YAML::Node elbow = json["joints"][0];
  EXPECT_EQ(elbow["type"].as<std::string>(), "revolute");
  EXPECT_EQ(elbow["origin"].as<std::vector<double>>(),
            (std::vector<double>{0.1, 0.0, -0.25, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(elbow["drive"].as<std::vector<double>>(), (std::vector<double>{0.0, -2.0, 0.0}));
  EXPECT_EQ(elbow["after"]["offset"].as<double>(), 0.012346);
  EXPECT_EQ(elbow["before"]["t"][0].as<double>(), 0.0);
  EXPECT_FALSE(json["joints"][1]["after"]);
  EXPECT_TRUE(json["joints"][1]["virtual"].as<bool>());
  const YAML::Node sample = json["samples"][0];
  EXPECT_EQ(sample["number"].as<int>(), 7);
  EXPECT_EQ(sample["note"].as<std::string>(), "5 mm off");
  EXPECT_FALSE(sample["features"][0]["before"]);
  EXPECT_EQ(sample["features"][0]["after"][1][2].as<double>(), 3.00123);
  EXPECT_EQ(json["cameras"][0]["fx"].as<double>(), 525.5);
  EXPECT_EQ(json["workspace"]["points"][0][3].as<double>(), 1.5);
  EXPECT_EQ(json["thinned"].as<std::string>(), "1 of 10 samples");
}

TEST(SceneJson, MeshesReadBackBitForBit) {
  const RobotScene scene = one_of_everything();
  const YAML::Node mesh = YAML::Load(scene_json(scene))["meshes"][0];
  EXPECT_EQ(numbers_of<float>(mesh["vertices"].as<std::string>()), scene.meshes[0].vertices);
  EXPECT_EQ(numbers_of<std::uint32_t>(mesh["triangles"].as<std::string>()),
            scene.meshes[0].triangles);
}

TEST(SceneJson, NamesCannotEndAScriptNorBreakTheText) {
  RobotScene scene = one_of_everything();
  const std::string evil =
      "</script><img src=x onerror=\"alert('1')\">&\\\n\xE2\x80\xA8\xE2\x80\xA9";
  scene.links[1].name = evil;
  scene.names[0] = "\xF0\x9F\xA6\xBE \xD7\xA2";
  scene.samples[0].source = "bad \xFF\xC0\xAF\xED\xA0\x80 bytes\xF0\x9F";
  scene.samples[0].note = std::string(5000, 'x');
  const std::string text = scene_json(scene);
  for (const char* forbidden : {"<", ">", "&", "\n", "\xE2\x80\xA8", "\xE2\x80\xA9", "\xFF"}) {
    EXPECT_THAT(text, Not(HasSubstr(forbidden)));
  }
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["links"][1]["name"], detail::one_line(evil));
  EXPECT_EQ(json["names"][0], scene.names[0]);
  EXPECT_THAT(json["samples"][0]["source"].get<std::string>(),
              AllOf(StartsWith("bad \xEF\xBF\xBD"), HasSubstr("\xEF\xBF\xBD bytes\xEF\xBF\xBD")));
}

TEST(SceneJson, NumbersAreShortAndAlwaysNumbers) {
  const auto text = [](double value, int digits) {
    return detail::json_text(detail::rounded(value, digits));
  };
  EXPECT_EQ(text(0.1234567, 5), "0.12346");
  EXPECT_EQ(text(-0.000001, 5), "0");
  EXPECT_EQ(text(100.0, 5), "100");
  EXPECT_EQ(text(1500.0, 0), "1500");
  EXPECT_EQ(text(kNaN, 5), "0");
  EXPECT_EQ(text(std::numeric_limits<double>::infinity(), 5), "0");
  RobotScene scene = one_of_everything();
  scene.joints[0].origin.translation.setConstant(kNaN);
  scene.samples[0].q[0] = kNaN;
  EXPECT_EQ(YAML::Load(scene_json(scene))["samples"][0]["q"][0].as<double>(), 0.0);
}

TEST(SceneJson, AnEmptySceneIsAnObject) {
  const YAML::Node json = YAML::Load(scene_json({}));
  EXPECT_EQ(json["samples"].size(), 0U);
  EXPECT_FALSE(json["workspace"]);
}

TEST(SceneJson, CloudsOnTheSurfaceAreStepsFromACorner) {
  RobotScene scene = one_of_everything();
  EXPECT_FALSE(YAML::Load(scene_json(scene))["samples"][0]["matched"]);
  SceneCloud& cloud = scene.samples[0].matched_after;
  cloud.points = {{-1.0, 0.25, 2.0}, {0.5, -0.75, 2.5}};
  cloud.distances = {0.0123, 0.0004};
  const YAML::Node matched = YAML::Load(scene_json(scene))["samples"][0]["matched"];
  EXPECT_FALSE(matched["before"]);
  const YAML::Node after = matched["after"];
  EXPECT_EQ(after["low"].as<std::vector<double>>(), (std::vector{-1.0, -0.75, 2.0}));
  EXPECT_EQ(after["step"].as<double>(), 1e-4);
  EXPECT_EQ(numbers_of<std::uint16_t>(after["points"].as<std::string>()),
            (std::vector<std::uint16_t>{0, 10000, 0, 123, 15000, 0, 5000, 4}));
}

TEST(SceneJson, CloudsOfLargeRobotsHaveLargerSteps) {
  RobotScene scene = one_of_everything();
  scene.samples[0].matched_before = {{{0.0, 0.0, 0.0}, {65.535, 0.0, 0.0}}, {0.01, 0.0}};
  const YAML::Node before = YAML::Load(scene_json(scene))["samples"][0]["matched"]["before"];
  EXPECT_NEAR(before["step"].as<double>(), 1e-3, 1e-9);
  EXPECT_EQ(numbers_of<std::uint16_t>(before["points"].as<std::string>()),
            (std::vector<std::uint16_t>{0, 0, 0, 10, 65535, 0, 0, 0}));
}

}  // namespace
}  // namespace kinecal
