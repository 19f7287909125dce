// kinecal calibrate-log: the result of kinecal calibrate, from recordings that are read one by one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;

const std::string kInput = " --urdf arm.urdf --config c.yaml --samples ";

class CalibrateLog : public test::ProgramTest {
 protected:
  CalibrateLog() {
    samples_ = test::arm_samples(parse_urdf(test::kArmUrdf, "arm.urdf"), 60);
    write("arm.urdf", test::kArmUrdf);
    write("c.yaml", test::kArmConfig);
    write_parts();
  }
  void write_part(const std::string& file, std::size_t first, std::size_t last) {
    std::ostringstream text;
    write_samples(text, {samples_.data() + first, samples_.data() + last});
    write(file, text.str());
  }
  void write_parts() {
    write_part("all.yaml", 0, 60);
    write_part("a.yaml", 0, 25);
    write_part("b.yaml", 25, 31);
    write_part("c_.yaml", 31, 60);
  }
  /// Calibrates the three parts.
  [[nodiscard]] Outcome log(const std::string& options) const {
    return run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml b.yaml c_.yaml " +
               options);
  }
  /// Starts the first of two processes, and stops it while it waits for the second.
  [[nodiscard]] Outcome stopped_by(const std::string& signal) const {
    write("start.sh", "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0 " + test::kinecal_program() +
                          " calibrate-log" + kInput +
                          "a.yaml b.yaml c_.yaml --threads 1 --output out &\n" +
                          "until ls out/sums/* > /dev/null 2>&1; do sleep 0.05; done; sleep 0.3\n" +
                          "kill -" + signal + " $!; wait $!\n");
    return run("sh start.sh");
  }
  /// Starts so many processes as mpirun does, and stops those that wait for minutes.
  [[nodiscard]] Outcome processes(int count, const std::string& output) const {
    std::string all;
    for (int rank = 0; rank < count; ++rank) {
      all += "OMPI_COMM_WORLD_SIZE=" + std::to_string(count) +
             " OMPI_COMM_WORLD_RANK=" + std::to_string(rank) + " timeout 300 " +
             test::kinecal_program() + " calibrate-log" + kInput +
             "a.yaml b.yaml c_.yaml --threads 1 --output " + output + " & all=\"$all $!\"; ";
    }
    return run("(" + all + "for one in $all; do wait $one || exit; done)");
  }
  void expect_same_files(const std::string& one, const std::string& other) const {
    for (const char* file : {"calibrated.urdf", "calibration.yaml"}) {
      EXPECT_EQ(read(one + "/" + file), read(other + "/" + file)) << file;
      EXPECT_NE(read(one + "/" + file), "") << file;
    }
  }

  std::vector<Sample> samples_;
};

TEST_F(CalibrateLog, FindsWhatCalibrateFinds) {
  const Outcome done = log("--output out");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("60 samples of 3 files"));
  ASSERT_EQ(run(test::kinecal_program() + " calibrate" + kInput + "all.yaml --output one").code, 0);
  const YAML::Node report = YAML::Load(read("out/report.json")),
                   expected = YAML::Load(read("one/report.json"));
  ASSERT_EQ(report["parameters"].size(), expected["parameters"].size());
  for (std::size_t i = 0; i < report["parameters"].size(); ++i) {
    const YAML::Node &of = report["parameters"][i], &all = expected["parameters"][i];
    EXPECT_EQ(of["name"].as<std::string>(), all["name"].as<std::string>());
    EXPECT_NEAR(of["value"].as<double>(), all["value"].as<double>(), 1e-8);
    EXPECT_NEAR(of["sigma"].as<double>() / all["sigma"].as<double>(), 1.0, 0.5);
  }
  EXPECT_FALSE(fs::exists(folder_ / "out/sums"));
  EXPECT_FALSE(fs::exists(folder_ / "out/residuals.csv")) << "of all samples there are none";
  // The result is like any other.
  const Outcome verified = run(test::kinecal_program() + " evaluate out all.yaml");
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  EXPECT_EQ(log("--output out").code, 1) << "exists";
}

TEST_F(CalibrateLog, AFileMayHaveFewSamples) {
  write_part("a.yaml", 0, 1);
  write_part("b.yaml", 1, 59);
  write_part("c_.yaml", 59, 60);
  ASSERT_EQ(log("--output out").code, 0);
  const Outcome few =
      run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml c_.yaml --output few");
  EXPECT_EQ(few.code, 2) << "two samples are too few";
  EXPECT_FALSE(fs::exists(folder_ / "few"));
}

TEST_F(CalibrateLog, IsTheSameInSeveralProcesses) {
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  for (const int count : {2, 3, 5}) {
    const std::string output = "of" + std::to_string(count);
    const Outcome done = processes(count, output);
    EXPECT_EQ(done.code, 0) << done.err;
    expect_same_files("one", output);
    EXPECT_FALSE(fs::exists(folder_ / output / "sums"));
  }
}

TEST_F(CalibrateLog, GoesOnWhereAProcessWasKilled) {
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  // The second of two processes never comes: the first waits for it, and is killed.
  const Outcome killed = stopped_by("KILL");
  EXPECT_NE(killed.code, 0);
  ASSERT_TRUE(fs::exists(folder_ / "out/sums"));
  EXPECT_FALSE(fs::is_empty(folder_ / "out/sums"));
  EXPECT_FALSE(fs::exists(folder_ / "out/calibration.yaml"));
  EXPECT_EQ(processes(3, "out").code, 0);
  expect_same_files("one", "out");
}

TEST_F(CalibrateLog, CtrlCEndsItAndTheSameCommandGoesOn) {
  const Outcome stopped = stopped_by("INT");
  EXPECT_THAT(stopped.err, HasSubstr("out: run the same command again to go on"));
  EXPECT_EQ(log("--threads 1 --output out").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/calibration.yaml"));
}

TEST_F(CalibrateLog, NamesWhatIsWrongWithAFileAndWritesNothing) {
  write("b.yaml", "joint_states: {name: [shoulder], position: [0.1]}\nobservations: 7\n---\n");
  const Outcome wrong = log("--output out");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("error: b.yaml:"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  const Outcome missing =
      run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml no.yaml --output out2");
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.err, HasSubstr("no.yaml"));
  const Outcome twice =
      run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml ./a.yaml --output out3");
  EXPECT_EQ(twice.code, 1);
  EXPECT_THAT(twice.err, HasSubstr("./a.yaml: is given twice"));
}

TEST_F(CalibrateLog, SumsOfOtherFilesAreNotTaken) {
  const Outcome killed = stopped_by("KILL");
  ASSERT_NE(killed.code, 0);
  samples_[3].joint_positions[0] += 0.001;
  samples_[3].source = "another sample";
  write_part("a.yaml", 0, 24);
  ASSERT_EQ(log("--threads 1 --output out").code, 0);
  ASSERT_EQ(log("--threads 1 --output new").code, 0);
  expect_same_files("out", "new");
}

TEST_F(CalibrateLog, AFileThatDoesNotFitTheOthersIsNamed) {
  for (std::size_t i = 31; i < 60; ++i) {
    for (Feature& feature : samples_[i].observations[0].features) feature.point.x() += 0.05;
  }
  write_parts();
  const Outcome done = log("--output out");
  EXPECT_THAT(done.out, testing::Not(HasSubstr("verdict: good"))) << done.out;
}

}  // namespace
}  // namespace kinecal
