// What strangers' robots showed: results that were wrong with exit code 0, and right ones that were refused.
// The inputs lie beside the data; each test says what is right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "support/data.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class TrustCases : public test::ProgramTest {
 protected:
  /// The folder of a case; empty if the cases are not there.
  [[nodiscard]] static fs::path folder(const std::string& name) {
    const fs::path all = test::data_folder().parent_path() / "cases";
    return fs::exists(all / name) ? all / name : fs::path{};
  }
  [[nodiscard]] test::Outcome calibrate(const fs::path& of, const std::string& suffix = "",
                                        const std::string& samples = "samples") const {
    return run(test::kinecal_program() + " calibrate --urdf " + (of / ("robot" + suffix)).string() +
               ".urdf --config " + (of / ("config" + suffix)).string() + ".yaml --samples " +
               (of / (samples + suffix)).string() + ".yaml --output out" + suffix);
  }
  [[nodiscard]] static std::string verdict(const test::Outcome& outcome) {
    std::smatch found;
    const std::regex line("verdict: ([^\n]*)");
    return std::regex_search(outcome.out, found, line) ? found[1].str() : "none: " + outcome.err;
  }
  /// The +- of the pose in question, millimetres.
  [[nodiscard]] static double position(const test::Outcome& outcome) {
    std::smatch found;
    const std::regex line("Pose of [^\n]*: \\+- ([0-9.e-]+) mm");
    return std::regex_search(outcome.out, found, line) ? std::stod(found[1].str()) : -1.0;
  }
};

#define KINECAL_NEEDS_CASE(variable, name) \
  const fs::path variable = folder(name);  \
  if (variable.empty()) GTEST_SKIP() << "case '" << (name) << "' is not beside the data"

TEST_F(TrustCases, SocketsTenPercentTooFarApartAreNamed) {
  KINECAL_NEEDS_CASE(of, "trust-01-scale-10-percent-good");
  const test::Outcome found = calibrate(of, "_kuka");
  EXPECT_EQ(verdict(found), "use with care");
  EXPECT_THAT(found.out, HasSubstr("with the points of 'fixture' multiplied by 0.90"));
}

TEST_F(TrustCases, ADriftIsNamedWithItsSize) {
  KINECAL_NEEDS_CASE(of, "trust-02-drift-10-mm-good");
  const test::Outcome found = calibrate(of);
  EXPECT_NE(verdict(found), "good");
  EXPECT_THAT(found.out, HasSubstr("'fixture_frame' drifts by 11"));
}

TEST_F(TrustCases, FiveReadingsOfEachPoseAreNoBetterThanOne) {
  KINECAL_NEEDS_CASE(of, "trust-04-repeated-readings-halve-plusminus");
  const test::Outcome once = calibrate(of, "_once"), five = calibrate(of, "_five");
  EXPECT_EQ(verdict(once), "use with care");
  EXPECT_EQ(verdict(five), "use with care");
  EXPECT_GT(position(five), 0.85 * position(once));
}

TEST_F(TrustCases, VerifyHoldsWhereOneSampleIsBad) {
  KINECAL_NEEDS_CASE(of, "trust-06-verify-fails-at-39-percent");
  ASSERT_EQ(calibrate(of, "", "half").code, 0);
  const test::Outcome found =
      run(test::kinecal_program() + " verify out " + (of / "new.yaml").string());
  EXPECT_EQ(found.code, 0) << found.out;
  EXPECT_THAT(found.out, HasSubstr("sample 2"));
}

TEST_F(TrustCases, VerifyNamesAReflectorThatWasBumped) {
  KINECAL_NEEDS_CASE(of, "trust-07-verify-prints-1e14-degrees");
  ASSERT_EQ(calibrate(of, "", "half").code, 0);
  for (const char* samples : {"new.yaml", "new_y.yaml"}) {
    const test::Outcome found =
        run(test::kinecal_program() + " verify out " + (of / samples).string());
    EXPECT_EQ(found.code, 2);
    const std::size_t at = found.out.find("Most likely moved");
    ASSERT_NE(at, std::string::npos) << found.out;
    const std::string first = found.out.substr(at, found.out.find('\n', at + 20) - at);
    EXPECT_THAT(first, HasSubstr("frame 'smr': 0.99")) << samples;
    EXPECT_THAT(first, Not(HasSubstr("deg")));
  }
}

TEST_F(TrustCases, AChangeThatLetsTheArmShrinkIsNoEvidence) {
  KINECAL_NEEDS_CASE(of, "trust-09-noise-falls-to-0-percent");
  const test::Outcome found = calibrate(of);
  EXPECT_NE(verdict(found), "good");
  EXPECT_THAT(found.out, Not(HasSubstr("'fixture_frame' seems to have changed")));
}

TEST_F(TrustCases, FewSamplesOfOneRegionAreNotGoodEverywhere) {
  KINECAL_NEEDS_CASE(of, "trust-10-gen3lite-good-if-limits-right");
  const test::Outcome found = calibrate(of);
  EXPECT_EQ(verdict(found), "use with care");
  EXPECT_THAT(found.out, HasSubstr("use it near these samples only"));
}

TEST_F(TrustCases, ASensorBetterThanTheModelIsNotRefused) {
  KINECAL_NEEDS_CASE(of, "trust-12-tracker-accuracy-as-sigma-refused");
  const test::Outcome found = calibrate(of);
  EXPECT_EQ(found.code, 0);
  EXPECT_EQ(verdict(found), "use with care");
}

TEST_F(TrustCases, SamplesOfTwoRobotsAreNamed) {
  KINECAL_NEEDS_CASE(of, "trust-14-two-robots-interleaved");
  const test::Outcome found = calibrate(of);
  EXPECT_NE(verdict(found), "good");
  EXPECT_THAT(found.out, HasSubstr("the zeros of all joints are elsewhere by "));
  EXPECT_THAT(found.out, testing::ContainsRegex("in (49|50|51) of 100 samples"));
}

TEST_F(TrustCases, AToolThatIsHeldAndWrongIsNamed) {
  KINECAL_NEEDS_CASE(of, "trust-15-mount-5-mm-not-found");
  fs::copy_file(of / "fixture.yaml", folder_ / "config.yaml");
  for (const char* file : {"robot.urdf", "samples.yaml"}) {
    fs::copy_file(of / file, folder_ / file);
  }
  const test::Outcome found = calibrate(folder_);
  EXPECT_EQ(verdict(found), "use with care");
  EXPECT_THAT(found.out,
              testing::ContainsRegex("freeing frame of ball_joint: x y z lowers the error on "
                                     "held-out poses from 4.7[0-9]* mm to 0.2"));
}

TEST_F(TrustCases, AToolFiveMillimetresOffIsFreedInTheAxesThatABallDetermines) {
  KINECAL_NEEDS_CASE(of, "trust-15-mount-5-mm-not-found");
  const std::string files = " --urdf " + (of / "robot.urdf").string() + " --samples " +
                            (of / "samples.yaml").string() + " --config ";
  const test::Outcome found =
      run(test::kinecal_program() + " identify" + files + (of / "fixture.yaml").string());
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("106 parameters may be wrong, 1 of them these samples support"));
  EXPECT_THAT(found.out, testing::ContainsRegex("\n  frame of ball_joint: x y z +5 mm +0.202 "));
  EXPECT_THAT(found.out,
              testing::ContainsRegex("\neither frame of ball_joint: x y z or [^\n]*frame "
                                     "of panda_hand_joint: x y z"));
  const test::Outcome done =
      run(test::kinecal_program() + " calibrate" + files + "identified.yaml --output out");
  EXPECT_EQ(verdict(done), "good");
  EXPECT_THAT(done.out, testing::ContainsRegex("\n  ball_joint_x +0.000 +-(4.9|5.0)[0-9]* "));
}

TEST_F(TrustCases, ALeftHandedTrackerIsNamedFirst) {
  KINECAL_NEEDS_CASE(of, "trust-18-left-handed-named-as-scale");
  const test::Outcome found = calibrate(of);
  EXPECT_EQ(verdict(found), "do not use");
  EXPECT_THAT(found.out, HasSubstr("verdict: do not use\n  - likely cause: with the points of "
                                   "'tracker' mirrored, as if its axes were left-handed"));
}

TEST_F(TrustCases, AScaleOfSixStandardErrorsIsNamedThoughNoiseStays) {
  KINECAL_NEEDS_CASE(of, "trust-19-scale-of-10-percent-good");
  const test::Outcome found = calibrate(of);
  EXPECT_EQ(verdict(found), "use with care");
  EXPECT_THAT(found.out,
              testing::ContainsRegex("with the points of 'tracker' multiplied by 0\\.8"));
}

}  // namespace
}  // namespace kinecal
