// What the program makes of good, ruined and noisy samples: verdict, exit code, report, files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <random>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class VerdictProgram : public test::ProgramTest {
 protected:
  VerdictProgram() : samples_(test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), 60)) {
    write("arm.urdf", test::kArmUrdf);
    write("c.yaml", test::kArmConfig);
  }

  /// Calibrates the samples as they are now.
  [[nodiscard]] test::Outcome calibrate(const std::string& options = "") {
    std::ostringstream text;
    write_samples(text, samples_);
    write("s.yaml", text.str());
    return run(test::kinecal_program() +
               " calibrate --urdf arm.urdf --config c.yaml --samples s.yaml --output out --force " +
               options);
  }
  [[nodiscard]] YAML::Node report(const std::string& file = "out/report.json") const {
    return YAML::Load(read(file));
  }
  void ruin(std::size_t sample) { samples_[sample].observations[1].features[0].point.x() += 0.05; }
  /// Values of the parameters.
  [[nodiscard]] std::map<std::string, double> values() const {
    std::map<std::string, double> all;
    for (const YAML::Node& parameter : report()["parameters"]) {
      all[parameter["name"].as<std::string>()] = parameter["value"].as<double>();
    }
    return all;
  }

  std::vector<Sample> samples_;
};

TEST_F(VerdictProgram, IsGoodAndTheFirstLine) {
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("verdict: good\n"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("held out"), HasSubstr("Pose of 'tool' in 'tracker_frame'"),
                    HasSubstr("Worst samples"), HasSubstr("Next: ")));
  EXPECT_EQ(report()["verdict"].as<std::string>(), "good");
  EXPECT_EQ(report()["reasons"].size(), 0u);
  EXPECT_NEAR(report()["noise"][0]["sigma"].as<double>(), 5e-5, 5e-6);
}

TEST_F(VerdictProgram, NamesTheLikelyCauseOfASampleThatItLeavesOut) {
  std::swap(samples_[7].observations[1].features[0].point,
            samples_[7].observations[1].features[1].point);
  ruin(41);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("; likely cause: features 1 and 2 are exchanged; left out\n"));
  ASSERT_EQ(report()["left_out"].size(), 2u);
  EXPECT_THAT(report()["left_out"][0]["why"].as<std::string>(),
              testing::EndsWith("; likely cause: features 1 and 2 are exchanged"));
  EXPECT_THAT(report()["left_out"][1]["why"].as<std::string>(), Not(HasSubstr("cause")));
}

TEST_F(VerdictProgram, LeavesRuinedSamplesOutAndNamesThem) {
  ASSERT_EQ(calibrate().code, 0);
  const auto clean = values();
  ruin(7);
  ruin(41);
  const test::Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("58 samples, 2 left out"));
  EXPECT_THAT(result.out, AllOf(HasSubstr("(sample 8): error block"), HasSubstr("(sample 42): "),
                                HasSubstr("; left out")));
  ASSERT_EQ(report()["left_out"].size(), 2u);
  EXPECT_EQ(report()["left_out"][0]["sample"].as<int>(), 8);
  for (const YAML::Node& parameter : report()["parameters"]) {
    if (parameter["sigma"].IsNull()) continue;
    const std::string name = parameter["name"].as<std::string>();
    EXPECT_NEAR(parameter["value"].as<double>(), clean.at(name),
                1.2 * parameter["sigma"].as<double>())
        << name;
  }
  // Numbers stay those of the files, and what is left out is in no row.
  const std::string rows = read("out/residuals.csv");
  EXPECT_THAT(rows, StartsWith("error_block,sample,source,feature,unit,distance,residual_1,"));
  EXPECT_THAT(rows, AllOf(HasSubstr(",60,"), Not(HasSubstr(",42,s.yaml"))));
}

TEST_F(VerdictProgram, KeepsOutliersAndExcludesSamplesIfToldTo) {
  ruin(7);
  const test::Outcome kept = calibrate("--keep-outliers");
  EXPECT_THAT(kept.out, AllOf(Not(HasSubstr("left out")), HasSubstr("does not fit the others")));
  const test::Outcome excluded = calibrate("--keep-outliers --exclude 8,1");
  EXPECT_EQ(excluded.code, 0) << excluded.err;
  EXPECT_THAT(excluded.out, AllOf(HasSubstr("58 samples, 2 left out"),
                                  HasSubstr("(sample 1): --exclude; left out")));
  const test::Outcome none = calibrate("--exclude 61");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("--exclude: no sample 61; there are samples 1 to 60"));
}

TEST_F(VerdictProgram, WritesTheReportOfWhatIsNotToBeUsedAndNothingElse) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (Sample& sample : samples_) {
    Vector3<double>& p = sample.observations[1].features[0].point;
    for (int k = 0; k < 3; ++k) p(k) += noise(random);
  }
  const test::Outcome result = calibrate("--report r.json");
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.out, StartsWith("verdict: do not use\n  - "));
  EXPECT_THAT(result.err,
              HasSubstr("error: calibration of step 'calibrate' failed, no results written"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_EQ(report("r.json")["verdict"].as<std::string>(), "do not use");
  EXPECT_GE(report("r.json")["reasons"].size(), 1u);
}

TEST_F(VerdictProgram, ScalesALossWithoutASigmaByTheNoise) {
  ruin(3);
  write("c.yaml", [] {
    std::string config = test::kArmConfig;
    const std::string type = "type: chain3d_to_chain3d";
    return config.replace(config.find(type), type.size(), type + ", loss: {type: huber, scale: 2}");
  }());
  const test::Outcome result = calibrate("--keep-outliers");
  EXPECT_EQ(result.code, 0) << result.err;
  for (const YAML::Node& block : report()["error_blocks"]) {
    // Least squares would spread the 5 cm over the others.
    EXPECT_LT(block["after"]["median"].as<double>(), 1.5e-4);
  }
  EXPECT_NEAR(report()["noise"][0]["robust_sigma"].as<double>(), 5e-5, 1e-5);
}

TEST_F(VerdictProgram, DoesNotDependOnTheNumberOfFoldsButForTheHeldOutError) {
  ASSERT_EQ(calibrate().code, 0);
  const auto before = values();
  const double held_out = report()["noise"][0]["held_out"].as<double>();
  ASSERT_EQ(calibrate("--folds 0").code, 0);
  EXPECT_EQ(values(), before);
  const double one_out = report()["noise"][0]["held_out"].as<double>();
  EXPECT_NE(one_out, held_out);
  EXPECT_NEAR(one_out, held_out, 0.2 * held_out);
}

}  // namespace
}  // namespace kinecal
