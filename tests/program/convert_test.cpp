// kinecal convert as its users meet it: a laboratory's table becomes samples that calibrate.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;

using Convert = test::TrackerExampleTest;

TEST_F(Convert, TheExampleCalibratesAsTheReadmeSays) {
  const Outcome made = kinecal("convert tracker.csv samples.yaml --columns columns.yaml");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("wrote samples.yaml: 60 samples"));
  EXPECT_EQ(kinecal("init --urdf ur5e.urdf --target tracker --arm tool0").code, 0);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("1 feature is not a number"));
}

TEST_F(Convert, ReportsErrorsAndWritesNothing) {
  std::string table = read("tracker.csv");
  write("tracker.csv", table.replace(table.find("dif_x"), 5, "dif_xx"));
  const Outcome made = kinecal("convert tracker.csv samples.yaml --columns columns.yaml");
  EXPECT_EQ(made.code, 1);
  EXPECT_THAT(made.err,
              AllOf(HasSubstr("columns.yaml:32: column 'dif_x'"), HasSubstr("'dif_xx'?")));
  EXPECT_FALSE(fs::exists(folder_ / "samples.yaml"));
}

TEST_F(Convert, ATableIsReadByTheColumnsBesideItOrAsksForThem) {
  const Outcome made = kinecal("convert tracker.csv samples.yaml");
  EXPECT_EQ(made.code, 0);
  EXPECT_THAT(made.err, HasSubstr("tracker.csv: is a table, read by columns.yaml"));
  EXPECT_THAT(kinecal("inspect tracker.csv").out, HasSubstr("60 samples"));
  fs::remove(folder_ / "columns.yaml");
  for (const char* words : {"convert tracker.csv again.yaml", "inspect tracker.csv"}) {
    const Outcome refused = kinecal(words);
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(
        refused.err,
        AllOf(HasSubstr("kinecal init --urdf robot.urdf --from tracker.csv"),
              HasSubstr("kinecal convert tracker.csv samples.yaml --columns columns.yaml")));
  }
}

TEST_F(Convert, TakesSamplesForWhatTheyAreWhateverTheirName) {
  ASSERT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml").code, 0);
  fs::rename(folder_ / "samples.yaml", folder_ / "samples.csv");
  const Outcome made = kinecal("convert samples.csv again.yaml");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(read("again.yaml"), read("samples.csv"));
}

TEST_F(Convert, MakesTheFolderOfItsOutput) {
  for (const char* name : {"one/a.yaml", "two/a.bag", "three/a.mcap"}) {
    const std::string output = name;
    const Outcome made = kinecal("convert tracker.csv " + output + " --columns columns.yaml");
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_TRUE(fs::exists(folder_ / output));
  }
}

TEST_F(Convert, AFullDiskIsReportedWithTheNameOfTheOutput) {
  for (const std::string output : {"full.yaml", "full.bag", "full.mcap"}) {
    // The greatest file that may be written, in blocks of 512 or 1024 bytes: 2.
    const Outcome made =
        run("bash -c \"trap '' XFSZ; ulimit -f 2; " + test::kinecal_program() +
            " convert tracker.csv " + output + " --columns columns.yaml 2>&1 | cat\"");
    EXPECT_THAT(made.out, HasSubstr(output + ": "));
    EXPECT_THAT(made.out, HasSubstr(": File too large"));
    EXPECT_THAT(made.out, testing::Not(HasSubstr(".kinecal-")));
    EXPECT_FALSE(fs::exists(folder_ / output));
  }
}

TEST_F(Convert, ReplacesNothingUnlessForcedAndNeverItsInput) {
  write("samples.yaml", "mine");
  EXPECT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml").code, 1);
  EXPECT_EQ(read("samples.yaml"), "mine");
  EXPECT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml --force").code, 0);
  const Outcome itself = kinecal("convert tracker.csv tracker.csv --columns columns.yaml --force");
  EXPECT_EQ(itself.code, 1);
  EXPECT_THAT(itself.err, HasSubstr("would replace an input"));
}

}  // namespace
}  // namespace kinecal
