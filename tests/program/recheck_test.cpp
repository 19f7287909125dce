// What a result is worth later: evaluate, verify and compare.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <random>
#include <regex>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::size_t kCalibrated = 60, kNew = 6;

class Recheck : public test::ProgramTest {
 protected:
  Recheck() {
    const std::vector<Sample> all =
        test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), kCalibrated + kNew);
    old_.assign(all.begin(), all.begin() + kCalibrated);
    new_.assign(all.begin() + kCalibrated, all.end());
    write("arm.urdf", test::kArmUrdf);
    write("c.yaml", test::kArmConfig);
  }
  void write_as(const std::string& file, const std::vector<Sample>& samples) {
    std::ostringstream text;
    write_samples(text, samples);
    write(file, text.str());
  }
  /// Calibrates the old samples into a folder.
  void calibrate(const std::string& folder = "out", const std::string& options = "") {
    write_as("s.yaml", old_);
    const Outcome done =
        run(test::kinecal_program() +
            " calibrate --urdf arm.urdf --config c.yaml --samples s.yaml --output " + folder + " " +
            options);
    ASSERT_EQ(done.code, 0) << done.out << done.err;
  }
  /// Runs a command with the result and the new samples.
  [[nodiscard]] Outcome with_new(const std::string& command, const std::string& options = "") {
    write_as("new.yaml", new_);
    return run(test::kinecal_program() + " " + command + " out new.yaml " + options);
  }
  /// Encoders read less from now on: the joint's offset has grown.
  static void slip(std::vector<Sample>& samples, const std::string& joint, double by) {
    for (Sample& sample : samples) {
      for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
        if (sample.joint_names[i] == joint) sample.joint_positions[i] -= by;
      }
    }
  }
  void replace_in(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = read(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << " has no " << from;
    write(file, text.replace(at, from.size(), to));
  }
  [[nodiscard]] YAML::Node json(const std::string& file) const { return YAML::Load(read(file)); }

  std::vector<Sample> old_, new_;
};

TEST_F(Recheck, HoldsIfNothingMoved) {
  calibrate();
  const Outcome result = with_new("verify", "--report v.json");
  EXPECT_EQ(result.code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, StartsWith("verdict: holds\n  - 6 of 6 samples fit: residuals are "));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("Fit: distances"), HasSubstr("Worst samples\n  new.yaml:"),
                    HasSubstr("Next: nothing to do"), Not(HasSubstr("moved"))));
  EXPECT_THAT(result.out, testing::ContainsRegex("would have found, 9 times of 10: joints off by "
                                                 "0\\.[0-9]+ deg \\('[a-z]+'\\) to 0\\.[0-9]+ "
                                                 "deg .*, frames shifted by 0\\.[0-9]+ mm"));
  EXPECT_TRUE(json("v.json")["holds"].as<bool>());
  EXPECT_GT(json("v.json")["probability"].as<double>(), 0.01);
  EXPECT_EQ(json("v.json")["freedom"].as<int>(), 36);
  EXPECT_EQ(json("v.json")["moved"].size(), 0u);
  const YAML::Node visible = json("v.json")["visible"];
  ASSERT_GT(visible.size(), 4u);
  EXPECT_GT(visible[0]["size"].as<double>(), 1e-5);
}

TEST_F(Recheck, SaysThatAnOlderReportDoesNotKnowNoiseOfPoses) {
  calibrate();
  EXPECT_THAT(with_new("verify").out, Not(HasSubstr("common_noise")));
  replace_in("out/report.json", "\"common_noise\"", "\"uncommon_noise\"");
  EXPECT_THAT(with_new("verify").out,
              HasSubstr("report.json does not say what noise the features of a pose share"));
}

TEST_F(Recheck, SaysWhatToRecordIfAChangeOfADegreeWouldNotBeFound) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.003);
  for (std::vector<Sample>* samples : {&old_, &new_}) {
    for (Sample& sample : *samples) {
      for (Feature& feature : sample.observations[1].features) {
        for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
      }
    }
  }
  calibrate();
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 0) << result.out;
  EXPECT_THAT(result.out, testing::ContainsRegex("Next: verify [0-9]+ or more new poses; these "
                                                 "would not show 1 deg of joint '[a-z]+'"));
}

TEST_F(Recheck, ReadsAReportWithoutTheNoiseOfGeometry) {
  calibrate();
  std::string text = read("out/report.json");
  for (const char* key : {"shifts", "turns"}) {
    text = std::regex_replace(text, std::regex("\\s*\"" + std::string(key) + "\": [^,]*,"), "");
  }
  write("out/report.json", text);
  EXPECT_THAT(text, Not(HasSubstr("\"shifts\"")));
  EXPECT_EQ(with_new("verify").code, 0);
}

TEST_F(Recheck, NamesTheJointThatSlipped) {
  calibrate();
  slip(new_, "elbow", 0.004);
  const Outcome result = with_new("verify", "--report v.json");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.out, StartsWith("verdict: does not hold\n"));
  EXPECT_THAT(result.out, AllOf(HasSubstr("Most likely moved\n  joint 'elbow': 0.2"),
                                HasSubstr("So 'tool' in 'tracker_frame' is off by "),
                                HasSubstr("Next: see whether joint 'elbow' is loose")));
  const YAML::Node first = json("v.json")["moved"][0];
  EXPECT_EQ(first["owner"].as<std::string>(), "elbow");
  EXPECT_NEAR(first["parameters"][0]["change"].as<double>(), 0.004,
              4.0 * first["parameters"][0]["sigma"].as<double>());
  EXPECT_GT(first["pose_position"].as<double>(), 5e-4);
}

TEST_F(Recheck, NamesAJointThatWasHeld) {
  calibrate();
  slip(new_, "pan", 0.004);
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.out, HasSubstr("Most likely moved\n  joint 'pan': 0.2"));
}

TEST_F(Recheck, NamesTheToolThatWasBumpedThoughItsJointWasHeld) {
  calibrate();
  for (Sample& sample : new_) {  // the tool and its reflectors, in the last link
    for (Feature& feature : sample.observations[0].features) feature.point.y() -= 1e-3;
  }
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("taken as recorded before the result was installed"),
                    HasSubstr("Most likely moved\n  frame 'flange': "), HasSubstr(" mm +- ")));
}

TEST_F(Recheck, NamesTheTrackerThatWasMoved) {
  calibrate();
  for (Sample& sample : new_) {
    for (Feature& feature : sample.observations[1].features) {
      feature.point = rotation_from_rpy(Vector3<double>(0.0, 0.01, 0.02)) * feature.point +
                      Vector3<double>(0.01, 0.0, -0.02);
    }
  }
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.out, HasSubstr("Most likely moved\n  frame 'tracker_frame': "));
}

TEST_F(Recheck, SaysThatNoSingleOneExplainsIt) {
  calibrate();
  slip(new_, "elbow", 0.02);
  slip(new_, "flex", -0.03);
  slip(new_, "roll", 0.05);
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.out, AllOf(HasSubstr("No single joint, frame or sensor explains it"),
                                HasSubstr("Next: calibrate again")));
}

TEST_F(Recheck, NamesABadCaptureAndHolds) {
  calibrate();
  new_[2].observations[1].features[0].point.x() += 0.02;
  const Outcome result = with_new("verify");
  EXPECT_EQ(result.code, 0) << result.out;
  EXPECT_THAT(result.out, HasSubstr("5 of 6 samples fit"));
  EXPECT_THAT(result.out, HasSubstr("(sample 3) does not fit the others"));
}

TEST_F(Recheck, FindsOutWhetherTheResultWasInForce) {
  calibrate();
  const YAML::Node values = YAML::Load(read("out/calibration.yaml"));
  for (const std::string joint : {"lift", "elbow", "roll", "flex"}) {
    slip(new_, joint, -values[joint].as<double>());  // a driver that adds <calibration rising>
  }
  const Outcome found = with_new("verify");
  EXPECT_EQ(found.code, 0) << found.out;
  EXPECT_THAT(found.out, HasSubstr("taken as recorded after the result was installed"));
  EXPECT_EQ(with_new("verify", "--samples-recorded after").code, 0);
  EXPECT_EQ(with_new("verify", "--samples-recorded before").code, 2);
}

TEST_F(Recheck, KnowsOffsetsThatRos2ControlAdds) {
  std::string joints;
  for (const char* joint : {"lift", "elbow", "roll", "flex"}) {
    joints +=
        std::string("<joint name=\"") + joint + "\"><param name=\"offset\">0.1</param></joint>";
  }
  replace_in("arm.urdf", "</robot>",
             "<ros2_control name=\"arm\" type=\"system\">" + joints + "</ros2_control></robot>");
  calibrate();
  EXPECT_THAT(read("out/calibrated.urdf"), Not(HasSubstr("rising")));
  const YAML::Node values = YAML::Load(read("out/calibration.yaml"));
  for (const char* joint : {"lift", "elbow", "roll", "flex"}) {
    slip(new_, joint, -values[joint].as<double>());
  }
  const Outcome found = with_new("verify");
  EXPECT_EQ(found.code, 0) << found.out;
  EXPECT_THAT(found.out, HasSubstr("taken as recorded after the result was installed"));
}

TEST_F(Recheck, JsonIsNotWrittenIntoAPage) {
  calibrate();
  for (const char* command : {"verify", "evaluate"}) {
    const Outcome result = with_new(command, "--report page.html");
    EXPECT_NE(result.code, 0);
    EXPECT_THAT(result.err, HasSubstr("page.html: is written as JSON; let the name end in .json"));
    EXPECT_FALSE(std::filesystem::exists("page.html"));
  }
}

TEST_F(Recheck, EvaluatesOtherSamplesBesideTheCalibration) {
  calibrate();
  slip(new_, "elbow", 0.004);
  const Outcome result = with_new("evaluate", "--report e.json");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("Result out (good) on 6 samples; nothing is solved\n"));
  EXPECT_THAT(result.out, AllOf(HasSubstr("measured"), HasSubstr("noise then"),
                                HasSubstr("(sample 1): error block 'measured': feature ")));
  const YAML::Node block = json("e.json")["error_blocks"][0];
  EXPECT_EQ(block["features"].as<int>(), 12);
  EXPECT_GT(block["distance"].as<double>(), 1e-3);
  EXPECT_NEAR(block["calibration"].as<double>(), 5e-5 * std::sqrt(3.0), 1e-5);
  // The samples of the calibration have its distances.
  const Outcome same = run(test::kinecal_program() + " evaluate out s.yaml --report e.json");
  EXPECT_EQ(same.code, 0) << same.err;
  const YAML::Node of_same = json("e.json")["error_blocks"][0];
  EXPECT_NEAR(of_same["distance"].as<double>(), of_same["calibration"].as<double>(), 1e-9);
}

TEST_F(Recheck, ComparesTwoResults) {
  calibrate("a");
  slip(old_, "elbow", 0.004);
  calibrate("b");
  const Outcome result = run(test::kinecal_program() + " compare a b --report c.json");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out,
              StartsWith("1 of 10 parameters moved by more than 3 standard deviations"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("  elbow "), HasSubstr("'tool' in 'tracker_frame' moved by ")));
  const YAML::Node first = json("c.json")["parameters"][0];
  EXPECT_EQ(first["name"].as<std::string>(), "elbow");
  EXPECT_NEAR(first["b"].as<double>() - first["a"].as<double>(), 0.004, 1e-9);
  EXPECT_EQ(json("c.json")["pose"]["poses"].as<int>(), 60);
  EXPECT_GT(json("c.json")["pose"]["position"].as<double>(), 5e-4);
  const Outcome same = run(test::kinecal_program() + " compare a a");
  EXPECT_THAT(same.out, AllOf(StartsWith("0 of 10 parameters moved"), HasSubstr("moved by 0 mm")));
}

TEST_F(Recheck, DifferencesStandBeforeWhatIsNotCompared) {
  calibrate("a");
  slip(old_, "elbow", 0.004);
  calibrate("b", "--hold lift");
  const Outcome result = run(test::kinecal_program() + " compare a b --report c.html");
  EXPECT_EQ(result.code, 0) << result.err;
  for (const std::string& text : {result.out, read("c.html")}) {
    const auto difference = text.find("at the worst of "), heading = text.find("Not compared"),
               held = text.rfind("lift");
    ASSERT_NE(heading, std::string::npos) << text;
    EXPECT_LT(difference, heading);
    EXPECT_LT(heading, held);
  }
}

TEST_F(Recheck, ComparesAResultWithOneThatBeganFromIt) {
  calibrate("a");
  const YAML::Node values = YAML::Load(read("a/calibration.yaml"));
  for (const std::string joint : {"lift", "elbow", "roll", "flex"}) {
    slip(old_, joint, -values[joint].as<double>());
  }
  write("arm.urdf", read("a/calibrated.urdf"));
  calibrate("b");
  const Outcome result = run(test::kinecal_program() + " compare a b --report c.json");
  EXPECT_THAT(result.out, StartsWith("0 of 10 parameters moved")) << result.err;
  EXPECT_LT(json("c.json")["pose"]["worst_position"].as<double>(), 1e-8);
}

TEST_F(Recheck, RefusesWhatIsNotAResult) {
  calibrate();
  write_as("new.yaml", new_);
  const auto refused = [&](const std::string& call, const auto& message) {
    const Outcome result = run(test::kinecal_program() + " " + call);
    EXPECT_EQ(result.code, 1) << result.out;
    EXPECT_THAT(result.err, AllOf(StartsWith("error: "), message));
  };
  refused("verify none new.yaml", HasSubstr("none: does not exist; give the folder that"));
  refused("verify arm.urdf new.yaml", HasSubstr("arm.urdf: is not a folder"));
  refused("verify . new.yaml", HasSubstr("has no calibration.yaml"));
  refused("verify out none.yaml", HasSubstr("none.yaml"));
  refused("compare out none", HasSubstr("none: does not exist"));
  for (const std::string file : {"original.urdf", "config.yaml", "report.json"}) {
    fs::rename(folder_ / "out" / file, folder_ / "away");
    refused("evaluate out new.yaml", HasSubstr("out: has no " + file));
    fs::rename(folder_ / "away", folder_ / "out" / file);
  }
}

TEST_F(Recheck, RefusesAResultThatWasChanged) {
  calibrate();
  const auto refused = [&](const std::string& file, const std::string& from, const std::string& to,
                           const std::string& message) {
    const std::string before = read("out/" + file);
    replace_in("out/" + file, from, to);
    const Outcome result = with_new("verify");
    EXPECT_EQ(result.code, 1) << result.out;
    EXPECT_THAT(result.err, AllOf(HasSubstr(message), HasSubstr("calibrate again")));
    write("out/" + file, before);
  };
  refused("calibration.yaml", "elbow: -0.0", "elbow: -0.1",
          "out/calibration.yaml: is not the file that report.json was written with");
  replace_in("out/report.json", "\"files\"", "\"none\"");  // as of an older version
  refused("calibration.yaml", "elbow: -0.0", "elbow: -0.1", "'elbow' is -0.1");
  refused("report.json", "\"covariance\"", "\"variance\"",
          "report.json: it has no field 'covariance'");
  refused("report.json", "\"verdict\": \"good\"", "\"verdict\": \"do not use\"",
          "was judged 'do not use'");
  refused("report.json", "\"lower\": [\n      [", "\"lower\": [\n      [1.0, ",
          "not a lower triangle");
  replace_in("out/config.yaml", " - elbow\n", "");
  const Outcome compared = run(test::kinecal_program() + " compare out out");
  EXPECT_EQ(compared.code, 1) << compared.out;
  EXPECT_THAT(compared.err,
              HasSubstr("out/report.json: 'elbow' was calibrated, but out/config.yaml "
                        "does not have it"));
}

TEST_F(Recheck, RefusesSamplesOfAnotherRobotAndDoubtsDegrees) {
  calibrate();
  for (Sample& sample : new_) {
    for (std::string& joint : sample.joint_names) joint = "other_" + joint;
  }
  const Outcome other = with_new("verify");
  EXPECT_EQ(other.code, 1) << other.out;
  EXPECT_THAT(other.err, HasSubstr("are they of another robot?"));
  for (Sample& sample : new_) {
    for (std::string& joint : sample.joint_names) joint = joint.substr(6);
    for (double& position : sample.joint_positions) position *= 57.3;
  }
  const Outcome degrees = with_new("evaluate");
  EXPECT_EQ(degrees.code, 1) << degrees.out;
  EXPECT_THAT(degrees.err, HasSubstr("degrees"));
}

/// Files are replaced one after the other; a run that is killed leaves the first of them new.
TEST_F(Recheck, FilesOfTwoRunsAreRefusedWhateverReadsThem) {
  calibrate("whole");
  slip(old_, "elbow", 0.02);
  replace_in("c.yaml", " - elbow\n", " - elbow\n # again\n");
  replace_in("arm.urdf", "<robot", "<!-- again --><robot");
  calibrate("later");
  const std::string launch =
      "<launch><param name=\"calibration_date\" value=\"x\"/>"
      "<param name=\"robot_description\" textfile=\"y\"/></launch>";
  const auto run_all = [&](int code) {
    for (const char* command : {"verify", "evaluate"}) {
      const Outcome outcome = with_new(command);
      EXPECT_EQ(outcome.code, code) << command << outcome.out << outcome.err;
      if (code != 0) {
        EXPECT_THAT(outcome.err, HasSubstr("a run was interrupted while it replaced"));
      }
    }
    fs::remove_all(folder_ / "robot");
    fs::create_directory(folder_ / "robot");
    write("robot/robot.launch", launch);
    EXPECT_EQ(kinecal("install out --to robot").code, code);
    EXPECT_EQ(kinecal("compare out whole").code, code);
    if (code != 0) {
      EXPECT_EQ(read("robot/robot.launch"), launch);
    }
  };
  for (const char* replaced :
       {"calibrated.urdf", "calibration.yaml", "original.urdf", "config.yaml", "report.json"}) {
    fs::remove_all(folder_ / "out");
    fs::copy(folder_ / "whole", folder_ / "out");
    SCOPED_TRACE(replaced);
    run_all(0);
    write(std::string("out/") + replaced, read(std::string("later/") + replaced));
    run_all(1);
  }
}

TEST_F(Recheck, KeepsCopiesOfTheInputUnlessTheyAreTheInput) {
  calibrate();
  EXPECT_EQ(read("out/original.urdf"), read("arm.urdf"));
  EXPECT_EQ(read("out/config.yaml"), read("c.yaml"));
  fs::rename(folder_ / "c.yaml", folder_ / "config.yaml");
  const std::string config = read("config.yaml");
  const Outcome here =
      run(test::kinecal_program() +
          " calibrate --urdf arm.urdf --config config.yaml --samples s.yaml --output .");
  EXPECT_EQ(here.code, 0) << here.err;
  EXPECT_EQ(read("config.yaml"), config);
  EXPECT_EQ(read("original.urdf"), read("arm.urdf"));
}

}  // namespace
}  // namespace kinecal
