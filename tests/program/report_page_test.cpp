// The HTML report as its users meet it: written by the program, opened in a browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;
using testing::Not;

class ReportPage : public test::ProgramTest {
 protected:
  ReportPage() {
    const fs::path robot = fs::path(test::source_folder()) / "examples/mobile_manipulator";
    for (const char* file : {"mobile_manipulator.urdf", "calibrate.yaml"}) {
      fs::copy(robot / file, folder_);
    }
    const Outcome made =
        run(test::program("generate_example_samples") + " mobile_manipulator.urdf . < /dev/null");
    EXPECT_EQ(made.code, 0) << made.err;
  }
  [[nodiscard]] Outcome calibrate(const std::string& arguments) const {
    return run("SOURCE_DATE_EPOCH=1760000000 " + test::kinecal_program() +
               " calibrate --urdf mobile_manipulator.urdf --config calibrate.yaml "
               "--samples samples.yaml " +
               arguments + " < /dev/null");
  }
  /// Runs a script of tests/program/ with an interpreter.
  [[nodiscard]] Outcome script(const std::string& interpreter, const std::string& call) const {
    const fs::path folder = fs::path(test::source_folder()) / "tests/program";
    return run(interpreter + " " + (folder / call).string());
  }
};

/// Ten lines that free two joint zeros and a camera.
TEST_F(ReportPage, TheConfigurationInReadmeCalibratesTheExampleRobot) {
  std::ifstream file(fs::path(test::source_folder()) / "README.md");
  const std::string readme{std::istreambuf_iterator<char>(file), {}};
  const std::string begin = "```yaml\n";
  const std::size_t at = readme.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t from = at + begin.size();
  write("calibrate.yaml", readme.substr(from, readme.find("```", from) - from));
  const Outcome made = calibrate("--dry-run");
  EXPECT_EQ(made.code, 0) << made.out << made.err;
  EXPECT_THAT(
      made.out,
      testing::AllOf(HasSubstr("\n  shoulder_lift_joint "), HasSubstr("\n  elbow_flex_joint "),
                     HasSubstr("\n  head_camera_rgb_joint_c "),
                     HasSubstr("_a _b _c turn it about its x, y, z (rotation vector)\n"),
                     Not(HasSubstr("\n  shoulder_pan_joint "))));
}

/// The same figure is the same in table and chart, and poses that nobody knew have no value before.
TEST_F(ReportPage, ChartsHaveTheFiguresOfTheTables) {
  ASSERT_EQ(calibrate("--dry-run --report a.html --report a.json").code, 0);
  const std::string page = read("a.html");
  const std::regex row("<bdi>elbow_flex_joint</bdi></td><td>([^<]+)</td><td>([^<]+)</td>");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(page, found, row));
  EXPECT_THAT(page, HasSubstr(">" + std::regex_replace(found.str(1), std::regex("-"), "\u2212") +
                              " ± " + found.str(2) + "°<"));
}

TEST_F(ReportPage, NamesInputsCommandAndDay) {
  ASSERT_EQ(calibrate("--dry-run --report 'my report.html'").code, 0);
  const std::string page = read("my report.html");
  EXPECT_THAT(page, HasSubstr("<title>mobile_manipulator: good"));
  EXPECT_THAT(page, HasSubstr("calibrated 2025-10-09"));
  EXPECT_THAT(page, HasSubstr("--report &#39;my report.html&#39;"));
  const Outcome sum = run("sha256sum samples.yaml");
  EXPECT_THAT(page, HasSubstr(sum.out.substr(0, 64)));
  EXPECT_LT(page.size(), 3'000'000u);
}

TEST_F(ReportPage, IsTheSameBytesFromTheSameInput) {
  ASSERT_EQ(calibrate("--dry-run --report a.html").code, 0);
  fs::rename(folder_ / "a.html", folder_ / "b.html");
  ASSERT_EQ(calibrate("--dry-run --report a.html").code, 0);
  EXPECT_EQ(read("a.html"), read("b.html"));
}

TEST_F(ReportPage, IsWrittenWhateverTheVerdictAndBesideJson) {
  ASSERT_EQ(run("sed -i 's/sigma: 0.001/sigma: 0.00001/' calibrate.yaml").code, 0);
  const Outcome bad = calibrate("--output out --report out.html --report out.json");
  EXPECT_EQ(bad.code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "out/calibrated.urdf"));
  EXPECT_THAT(read("out.json"), HasSubstr("\"verdict\": \"do not use\""));
  EXPECT_THAT(read("out.html"), HasSubstr("<header class=\"verdict bad\">"));
  EXPECT_THAT(read("out.html"), HasSubstr("sigma"));
}

TEST_F(ReportPage, HasTheSamplesThatWereLeftOutInItsSceneAndCharts) {
  ASSERT_EQ(calibrate("--dry-run --exclude 5,11 --report page.html").code, 0);
  const std::string page = read("page.html");
  for (const std::string number : {"5", "11"}) {
    EXPECT_THAT(page, testing::ContainsRegex("<circle class=\"target\"[^>]* data-sample=\"" +
                                             number + "\""));
    EXPECT_THAT(page, testing::ContainsRegex("\"number\":" + number + ",[^{]*\"left_out\":true"));
  }
}

TEST_F(ReportPage, ReplacesNoInput) {
  const std::string before = read("samples.yaml");
  for (const std::string input : {"samples.yaml", "./calibrate.yaml", "mobile_manipulator.urdf"}) {
    const Outcome refused = calibrate("--dry-run --report " + input);
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err, HasSubstr("would replace an input"));
  }
  EXPECT_EQ(read("samples.yaml"), before);
}

TEST_F(ReportPage, WorksInABrowserWithoutARequest) {
  if (std::system("command -v chromium > /dev/null && command -v node > /dev/null") != 0) {
    if (std::getenv("KINECAL_REQUIRE_DATA") != nullptr) FAIL() << "there is no chromium or no node";
    GTEST_SKIP() << "there is no chromium or no node";
  }
  ASSERT_EQ(calibrate("--dry-run --report page.html").code, 0);
  const Outcome seen = script("node", "browser/check_report.mjs page.html");
  EXPECT_EQ(seen.code, 0) << seen.out << seen.err;
}

TEST_F(ReportPage, ReportAndResidualsAreAsTheirSchemasSay) {
  if (std::system("python3 -c 'import jsonschema' 2> /dev/null") != 0) {
    if (std::getenv("KINECAL_REQUIRE_DATA") != nullptr) FAIL() << "there is no python3-jsonschema";
    GTEST_SKIP() << "there is no python3-jsonschema";
  }
  ASSERT_EQ(calibrate("--output out").code, 0);
  const std::string schemas = test::source_folder() + "/include/kinecal/report/schema";
  const Outcome valid = script("python3", "validate.py " + schemas + " out");
  EXPECT_EQ(valid.code, 0) << valid.out << valid.err;
  std::string broken = read("out/report.json");
  broken.replace(broken.find("\"iterations\""), 12, "\"iterashuns\"");
  std::ofstream(folder_ / "out/report.json") << broken;
  const Outcome invalid = script("python3", "validate.py " + schemas + " out");
  EXPECT_EQ(invalid.code, 1);
  EXPECT_THAT(invalid.err, HasSubstr("iterashuns"));
}

}  // namespace
}  // namespace kinecal
