// Names that mean something to a shell, a page, a table or YAML, in each place where names are free: what the program prints
// and writes holds them as names.
#include "support/hostile_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/xml/xml_edit.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/name_list.hpp"
#include "support/arm_scene.hpp"
#include "support/run_program.hpp"
#include "support/shell_words.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

std::string with(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// A word of a shell; not by the code that is tested.
std::string quoted(const std::string& word) {
  return "'" + with(word, "'", "'\"'\"'") + "'";
}

/// A name as the name of a file.
std::string as_file(const std::string& name) {
  return with(name, "/", "_");
}

/// The arm of which everything has this name: robot, joint, link, sensor, frame, step, error block, files.
class Hostile : public test::ProgramTest {
 protected:
  void write_input(const std::string& name) const {
    const std::string escaped = detail::xml_attribute_text(name, '"');
    std::string urdf = with(test::kArmUrdf, "name=\"arm\"", "name=\"" + escaped + "\"");
    urdf = with(urdf, "\"pan\"", "\"" + escaped + "\"");
    write("arm.urdf", with(urdf, "\"tool\"", "\"" + escaped + " link\""));
    const auto word = [&](const char* what) { return detail::name_to_yaml(name + what); };
    write("c.yaml",
          "base_link: base_link\ncal_steps:\n  " + word(" step") + ":\n    models:\n    - {name: " +
              word(" sensor") + ", type: chain3d, frame: " + word(" link") +
              "}\n    - {name: tracker, type: chain3d, frame: base_link}\n    free_params: [" +
              word("") +
              ", lift, elbow, roll, flex]\n    free_frames:\n    - {name: " + word(" frame") +
              ", x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n"
              "    error_blocks:\n    - {name: " +
              word("") + ", type: chain3d_to_chain3d, model_a: " + word(" sensor") +
              ", model_b: tracker}\n");
    std::vector<Sample> samples = test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), 30);
    for (Sample& sample : samples) {
      std::replace(sample.joint_names.begin(), sample.joint_names.end(), std::string("pan"), name);
      sample.observations[0].sensor = name + " sensor";
      for (Feature& feature : sample.observations[0].features) feature.frame = name + " link";
      for (Feature& feature : sample.observations[1].features) feature.frame = name + " frame";
    }
    std::ostringstream text;
    write_samples(text, samples);
    write(as_file(name) + ".yaml", text.str());
  }
  [[nodiscard]] test::Outcome calibrate(const std::string& name) const {
    return kinecal(
        "calibrate --urdf arm.urdf --config c.yaml --samples=" + quoted(as_file(name) + ".yaml") +
        " --output=" + quoted(as_file(name) + " out") + " --report r.html --report r.json");
  }
  [[nodiscard]] std::string result(const std::string& name, const std::string& file) const {
    return read(as_file(name) + " out/" + file);
  }
};

/// The text of an element of a page, as it is copied.
std::string copied(const pugi::xml_node& element) {
  std::string text;
  for (const pugi::xpath_node& part : element.select_nodes(".//text()"))
    text += part.node().value();
  return text;
}

/// The elements of a page; its style and scripts are left out, which are not markup.
void load_page(std::string page, pugi::xml_document& document) {
  for (const std::string tag : {"style", "script"}) {
    for (std::size_t at = 0; (at = page.find("<" + tag, at)) != std::string::npos;) {
      at = page.find('>', at) + 1;
      page.erase(at, page.find("</" + tag + ">", at) - at);
    }
  }
  const auto parsed = document.load_string(page.substr(page.find('\n') + 1).c_str(),
                                           pugi::parse_default | pugi::parse_ws_pcdata);
  ASSERT_TRUE(parsed) << parsed.description();
}

class HostileNames : public Hostile, public testing::WithParamInterface<std::string> {
 protected:
  HostileNames() { write_input(name_); }

  /// A command that is to be pasted: names of ours in it, and nothing more happens.
  void expect_words(const std::string& command) const {
    const test::PastedCommand pasted = test::paste(command);
    EXPECT_FALSE(pasted.did_more) << command;
    EXPECT_THAT(pasted.words, Contains(testing::EndsWith(as_file(name_) + ".yaml"))) << command;
    EXPECT_THAT(pasted.words, Contains(testing::EndsWith(as_file(name_) + " out"))) << command;
  }

  std::string name_ = GetParam();
};

TEST_P(HostileNames, AreNamesInTheNextCommandWhichWorksWhenItIsPasted) {
  const test::Outcome outcome = calibrate(name_);
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const std::size_t at = outcome.out.find("\n  kinecal calibrate ");
  ASSERT_NE(at, std::string::npos) << outcome.out;
  const std::string command = outcome.out.substr(at + 3, outcome.out.find('\n', at + 3) - at - 3);
  expect_words(command);
  EXPECT_THAT(test::paste(command).words, Contains(HasSubstr(list_entry(name_) + " frame")))
      << "--hold";
  write("paste.sh",
        "kinecal() { " + quoted(test::kinecal_program()) + " \"$@\"; }\n" + command + "\n");
  const test::Outcome again = run("sh paste.sh < /dev/null");
  EXPECT_EQ(again.code, 0) << command << "\n" << again.err;
  EXPECT_FALSE(fs::exists(folder_ / "PWNED"));
}

TEST_P(HostileNames, AreNamesInEveryFile) {
  ASSERT_EQ(calibrate(name_).code, 0);
  const auto json = nlohmann::json::parse(read("r.json"));
  EXPECT_EQ(json.at("robot"), name_);
  EXPECT_THAT(json.at("parameters").dump(), HasSubstr(nlohmann::json(name_).dump()));
  const std::string next = json.at("next");
  expect_words(next.substr(next.find("\n  ") + 3));
  const std::string page = read("r.html");
  pugi::xml_document document;
  load_page(page, document);
  EXPECT_EQ(document.select_nodes("//script").size(), 2U);
  EXPECT_FALSE(document.select_node("//@onload"));
  EXPECT_EQ(document.select_nodes("//pre[@class='command']/code").size(), 2U);
  for (const pugi::xpath_node& code : document.select_nodes("//pre[@class='command']/code"))
    expect_words(copied(code.node()));
  const std::size_t scene = page.find("id=\"scene\">") + 11;
  const auto shown =
      nlohmann::json::parse(page.substr(scene, page.find("</script>", scene) - scene));
  EXPECT_THAT(shown.dump(), HasSubstr(nlohmann::json(name_ + " link").dump()));
  Diagnostics diagnostics;
  for (const detail::CsvRow& row :
       detail::csv_rows(result(name_, "residuals.csv"), ',', "residuals.csv", diagnostics)) {
    if (row.line == 1) continue;
    const std::string& cell = row.cells.front();
    EXPECT_EQ(std::string("=+-@").find(cell.front()), std::string::npos) << cell;
    EXPECT_EQ(cell.starts_with('\'') ? cell.substr(1) : cell, name_);
    EXPECT_THAT(row.cells.at(2), HasSubstr(as_file(name_) + ".yaml:"));
  }
  ASSERT_EQ(kinecal("study --robots 2 --output study --urdf arm.urdf --config c.yaml --samples=" +
                    quoted(as_file(name_) + ".yaml"))
                .code,
            0);
  const auto trials = detail::csv_rows(read("study/trials.csv"), ',', "trials.csv", diagnostics);
  ASSERT_GE(trials.size(), 3U);
  EXPECT_EQ(trials[0].cells.size(), trials[1].cells.size());
  for (const std::string& cell : trials[0].cells) {
    EXPECT_EQ(std::string("=+-@").find(cell.front()), std::string::npos) << cell;
  }
  EXPECT_THAT(trials[0].cells, Contains(testing::EndsWith(name_ + " frame_x")));
  const YAML::Node values = YAML::Load(result(name_, "calibration.yaml"));
  EXPECT_TRUE(values[name_]) << "the joint";
  EXPECT_TRUE(values[name_ + " frame_x"]);
  pugi::xml_document urdf;
  ASSERT_TRUE(urdf.load_string(result(name_, "calibrated.urdf").c_str()));
  EXPECT_EQ(urdf.child("robot").attribute("name").value(), name_);
  EXPECT_TRUE(urdf.child("robot").find_child_by_attribute("joint", "name", name_.c_str()));
}

/// Each means something to several readers; $( and ${ are of xacro, and refused in a URDF.
INSTANTIATE_TEST_SUITE_P(Names, HostileNames,
                         testing::Values("`touch PWNED` $HOME", "'; touch PWNED; '",
                                         "\"; touch PWNED > x & \" onload=\"alert(1)&amp;",
                                         "</script><script>alert(1)</script>",
                                         "=HYPERLINK(1), \"a\"", "-rf --force",
                                         "*&anchor: !tag #no", "null", "{a}, [b] \\n 50% ~"),
                         [](const auto& of) { return "name_" + std::to_string(of.index); });

TEST_F(Hostile, NamesThatEndALineAreRefusedAndForgeNoLine) {
  for (const std::string& name : test::kRefusedNames) {
    write_input("arm");
    write("arm.urdf", with(test::kArmUrdf, "name=\"arm\"",
                           "name=\"" + detail::xml_attribute_text(name, '"') + "\""));
    test::Outcome outcome = calibrate("arm");
    EXPECT_EQ(outcome.code, 1) << name << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("has a control character"));
    EXPECT_EQ((outcome.out + outcome.err).find("\nverdict: good"), std::string::npos);
    write_input("arm");
    write("c.yaml", with(read("c.yaml"), "{name: arm, type: chain3d_to",
                         "{name: " + detail::name_to_yaml(name) + ", type: chain3d_to"));
    outcome = calibrate("arm");
    EXPECT_EQ(outcome.code, 1) << name << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("c.yaml:"));
    EXPECT_EQ((outcome.out + outcome.err).find("\nverdict: good"), std::string::npos)
        << outcome.err;
  }
}

/// Also names that only samples and files have.
TEST_F(Hostile, LineEndsInSamplesAndNamesOfFilesForgeNoLine) {
  const std::string forged = "x\nverdict: good", yaml = detail::name_to_yaml(forged);
  write_input("arm");
  const std::string samples = read("arm.yaml");
  for (const std::string name : {"sensor_name: tracker", "frame_id: \"arm frame\"", "[arm, "}) {
    const std::string key = name.substr(0, name.find(' ') + 1);
    write("arm.yaml", with(samples, name, name[0] == '[' ? "[" + yaml + ", " : key + yaml));
    ASSERT_NE(read("arm.yaml"), samples) << name;
    for (const test::Outcome& outcome : {calibrate("arm"), kinecal("inspect arm.yaml")}) {
      EXPECT_EQ(outcome.code, 1) << name << outcome.out;
      EXPECT_THAT(outcome.err, HasSubstr("the name 'x verdict: good' has a line end")) << name;
      EXPECT_EQ(("\n" + outcome.out + outcome.err).find("\nverdict: good"), std::string::npos);
    }
  }
  write("arm.yaml", samples);
  for (const char* file : {"arm.urdf", "c.yaml", "arm.yaml"}) {
    write(forged, read(file));
    const auto path = [&](const char* of) {
      return quoted(of == std::string(file) ? forged : std::string(of));
    };
    const test::Outcome outcome =
        kinecal("calibrate --urdf " + path("arm.urdf") + " --config " + path("c.yaml") +
                " --samples " + path("arm.yaml") + " --dry-run");
    EXPECT_EQ(outcome.code, 1) << file << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("'x verdict: good': the name of a file has a line end"));
  }
  const test::Outcome folder = kinecal(
      "calibrate --urdf arm.urdf --config c.yaml --samples arm.yaml --output " + quoted(forged));
  EXPECT_EQ(folder.code, 1) << folder.out;
  EXPECT_THAT(folder.err, HasSubstr("'x verdict: good': the name of a folder has a line end"));
  const test::Outcome report =
      kinecal("calibrate --urdf arm.urdf --config c.yaml --samples arm.yaml --dry-run --report " +
              quoted(forged));
  EXPECT_EQ(report.code, 1) << report.out;
  EXPECT_THAT(report.err, HasSubstr("'x verdict: good': the name of a file has a line end"));
}

}  // namespace
}  // namespace kinecal
