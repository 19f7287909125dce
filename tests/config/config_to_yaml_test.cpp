#include "kinecal/config/config_to_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "support/hostile_names.hpp"

namespace kinecal {
namespace {

/// A configuration in which everything has this name.
std::string text_of(const std::string& name) {
  const auto word = [&](const char* what) { return detail::name_to_yaml(name + what); };
  return "base_link: " + word(" base") + "\nmodels:\n- {name: " + word(" arm") +
         ", type: chain3d, frame: " + word(" link") + "}\n- {name: " + word(" camera") +
         ", type: camera3d, frame: " + word(" optical") + "}\nfree_params: [" + word("") +
         "]\nfree_frames:\n- {name: " + word(" frame") +
         ", x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\nbounds:\n  " +
         word("") + ": [-0.1, 0.1]\nerror_blocks:\n- {name: " + word("") +
         ", type: chain3d_to_chain3d, model_a: " + word(" camera") + ", model_b: " + word(" arm") +
         "}\n";
}

TEST(ConfigToYaml, HasTheNamesThatWereReadWhateverTheyAre) {
  for (const std::string& name : test::kHostileNames) {
    Diagnostics diagnostics;
    const Config config = parse_config(text_of(name), "c.yaml", diagnostics);
    ASSERT_THAT(diagnostics.errors, testing::IsEmpty()) << name;
    const std::string text = config_to_yaml(config, "of " + name, {{name, "because of " + name}});
    const YAML::Node written = YAML::Load(text);
    EXPECT_EQ(written["base_link"].as<std::string>(), name + " base");
    EXPECT_EQ(written["models"][1]["frame"].as<std::string>(), name + " optical");
    EXPECT_EQ(written["free_params"][0].as<std::string>(), name);
    EXPECT_EQ(written["free_frames"][0]["name"].as<std::string>(), name + " frame");
    EXPECT_TRUE(written["bounds"][name]);
    EXPECT_EQ(written["error_blocks"][0]["name"].as<std::string>(), name);
    const Config read = parse_config(text, "c.yaml", diagnostics);
    ASSERT_THAT(diagnostics.errors, testing::IsEmpty()) << text;
    EXPECT_EQ(config_to_yaml(read, "of " + name, {{name, "because of " + name}}), text);
  }
}

TEST(ReadConfig, RefusesNamesThatEndALine) {
  for (const std::string& name : test::kRefusedNames) {
    Diagnostics diagnostics;
    (void)parse_config(text_of(name), "c.yaml", diagnostics);
    EXPECT_THAT(diagnostics.errors, testing::Not(testing::IsEmpty())) << name;
  }
}

}  // namespace
}  // namespace kinecal
