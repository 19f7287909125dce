// kinecal calibrate-log: the result of kinecal calibrate, from recordings that are read one by one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <csignal>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/paths.hpp"
#include "support/processes.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;

const std::string kInput = " --urdf arm.urdf --config c.yaml --samples ";

int count_of(const std::string& what, const std::string& text) {
  int count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

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
  /// Calibrates the three parts, judged on a third of the samples.
  [[nodiscard]] Outcome log(const std::string& options) const {
    return run(test::kinecal_program() + " calibrate-log --draw 20" + kInput +
               "a.yaml b.yaml c_.yaml " + options);
  }
  /// The call for the three parts.
  [[nodiscard]] static std::string call(const std::string& output) {
    return test::kinecal_program() + " calibrate-log --draw 20" + kInput +
           "a.yaml b.yaml c_.yaml --threads 1 --output " + output;
  }
  /// Calibrates the three parts in so many processes.
  [[nodiscard]] Outcome processes(int count, const std::string& output) const {
    return run(test::in_processes(count, call(output)));
  }
  [[nodiscard]] bool has_checkpoints() const {
    return fs::exists(folder_ / "out/sums") && !fs::is_empty(folder_ / "out/sums");
  }
  /// What a calibration to "out" said that a signal ended before it was done. On a busy machine a signal may come when
  /// all is done: then once more.
  template <class Run>
  [[nodiscard]] Outcome ended_early(const Run& run) const {
    constexpr int kAttempts = 20;
    Outcome outcome{};
    for (int k = 0; k < kAttempts; ++k) {
      fs::remove_all(folder_ / "out");
      outcome = run();
      if (!fs::exists(folder_ / "out/calibration.yaml")) break;
    }
    return outcome;
  }
  /// Sends the calibration of one process a signal as soon as it has a checkpoint.
  [[nodiscard]] Outcome stopped_by(int signal) const {
    return ended_early([&] {
      return test::run_and_send(folder_, call("out"), signal, [&] { return has_checkpoints(); });
    });
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
  EXPECT_EQ(few.code, 1) << "two samples are too few, as for calibrate";
  EXPECT_FALSE(fs::exists(folder_ / "few"));
}

TEST_F(CalibrateLog, IsTheSameInSeveralProcesses) {
  KINECAL_REQUIRE_MPIRUN();
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  for (const int count : {2, 4}) {  // of three files, one of which has nothing to do
    const std::string output = "of" + std::to_string(count);
    const Outcome done = processes(count, output);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    EXPECT_EQ(count_of("verdict:", done.out), 1) << done.out;
    expect_same_files("one", output);
    EXPECT_FALSE(fs::exists(folder_ / output / "sums"));
  }
}

TEST_F(CalibrateLog, AnErrorOfAllProcessesIsToldOnce) {
  KINECAL_REQUIRE_MPIRUN();
  write("a.yaml", "joint_states: {name: [shoulder], position: [0.1]}\nobservations: 7\n---\n");
  const Outcome wrong = processes(3, "out");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_EQ(count_of("error: ", wrong.err), 1) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("error: a.yaml:"));
}

TEST_F(CalibrateLog, AnErrorOfOneProcessEndsAllWithinASecondAndNothingFinishedIsLost) {
  KINECAL_REQUIRE_MPIRUN();
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  const std::string part = read("b.yaml");
  write("b.yaml", "joint_states: {name: [shoulder], position: [0.1]}\nobservations: 7\n---\n");
  const Outcome wrong = processes(3, "out");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_EQ(count_of("error: ", wrong.err), 1) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("error: b.yaml:"));
  write("b.yaml", part);
  EXPECT_EQ(processes(2, "out").code, 0);
  expect_same_files("one", "out");
}

TEST_F(CalibrateLog, AnotherVersionInOneProcessIsNamed) {
  KINECAL_REQUIRE_MPIRUN();
  // A copy of the program that says it is another version, where it finds the libraries of this one.
  std::string program = read(test::kinecal_program());
  const std::size_t at = program.find(" samples at a time)");
  if (at == std::string::npos) GTEST_SKIP() << "the version is in a shared library";
  program[at + 1] = '?';
  fs::create_directories(folder_ / "bin");
  fs::create_symlink(fs::path(test::kinecal_program()).parent_path().parent_path() / "lib",
                     folder_ / "lib");
  write("bin/other", program);
  fs::permissions(folder_ / "bin/other", fs::perms::owner_all);
  const std::string arguments = call("out").substr(test::kinecal_program().size());
  const Outcome done = run(test::in_processes(1, call("out") + " : -n 1 bin/other" + arguments));
  EXPECT_EQ(done.code, 1);
  EXPECT_EQ(count_of("error: ", done.err), 1) << done.err;
  EXPECT_THAT(done.err,
              testing::ContainsRegex("error: process 1 on .* is kinecal .*\\?amples.*, but "
                                     "process 0 on .* is kinecal "));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CalibrateLog, GoesOnWhereAProcessWasKilled) {
  KINECAL_REQUIRE_MPIRUN();
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  // The second of two processes is killed as soon as one of them has finished something.
  write("kill.sh",
        "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then\n"
        "  (until [ -n \"$(ls out/sums 2>/dev/null)\" ]; do :; done; kill -KILL $$) &\n"
        "fi\nexec " +
            call("out") + "\n");
  const Outcome killed = ended_early([&] { return run(test::in_processes(2, "sh kill.sh")); });
  EXPECT_NE(killed.code, 0);
  EXPECT_THAT(killed.err, HasSubstr("Killed"));
  ASSERT_TRUE(has_checkpoints());
  EXPECT_FALSE(fs::exists(folder_ / "out/calibration.yaml"));
  EXPECT_EQ(processes(4, "out").code, 0);
  expect_same_files("one", "out");
}

TEST_F(CalibrateLog, OneOfSeveralProcessesWithoutMpirunIsAnError) {
  const Outcome done = run("SLURM_STEP_NUM_TASKS=3 " + call("out"));
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.err, HasSubstr("error: this is one of 3 processes, "));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CalibrateLog, CtrlCEndsItAndTheSameCommandGoesOn) {
  const Outcome stopped = stopped_by(SIGINT);
  EXPECT_THAT(stopped.err, HasSubstr("out: run the same command again to go on"));
  EXPECT_EQ(log("--threads 1 --output out").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/calibration.yaml"));
}

TEST_F(CalibrateLog, ACheckpointThatIsDamagedIsComputedAgain) {
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  ASSERT_NE(stopped_by(SIGKILL).code, 0);
  bool cut = true;
  for (const auto& file : fs::directory_iterator(folder_ / "out/sums")) {
    const auto size = fs::file_size(file);
    fs::resize_file(file, size / 2);
    if (!cut) fs::resize_file(file, size);  // zeros, as after a power failure
    cut = !cut;
  }
  EXPECT_EQ(log("--threads 1 --output out").code, 0);
  expect_same_files("one", "out");
}

TEST_F(CalibrateLog, ChangedCamerasAndFilesAreNotTakenForTheOldOnes) {
  ASSERT_EQ(log("--threads 1 --output one").code, 0);
  ASSERT_NE(stopped_by(SIGKILL).code, 0);
  std::string text = read("c_.yaml");
  text.replace(text.find("position: [") + 11, 1, "0");  // the size and the ends stay the same
  write("c_.yaml", text);
  const Outcome edited = log("--threads 1 --output out");
  EXPECT_EQ(log("--threads 1 --output fresh").code, edited.code);
  if (edited.code == 0) expect_same_files("fresh", "out");
}

TEST_F(CalibrateLog, WhatIsNotItsOwnIsLeftAlone) {
  fs::create_directories(folder_ / "mine/sums");
  write("mine/sums/thesis.txt", "precious");
  EXPECT_EQ(
      run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml no.yaml --output mine")
          .code,
      1);
  EXPECT_EQ(read("mine/sums/thesis.txt"), "precious");
  fs::create_directories(folder_ / "empty");
  EXPECT_EQ(
      run(test::kinecal_program() + " calibrate-log" + kInput + "a.yaml no.yaml --output empty")
          .code,
      1);
  EXPECT_TRUE(fs::exists(folder_ / "empty"));
  EXPECT_FALSE(fs::exists(folder_ / "empty/sums"));
  ASSERT_EQ(log("--threads 1 --output mine").code, 0);
  EXPECT_EQ(read("mine/sums/thesis.txt"), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "mine/sums"), {}), 1);
}

TEST_F(CalibrateLog, AMissingFileDoesNotRemoveWhatWasFinished) {
  ASSERT_NE(stopped_by(SIGKILL).code, 0);
  const auto count = [&] {
    return std::distance(fs::directory_iterator(folder_ / "out/sums"), fs::directory_iterator());
  };
  const auto before = count();
  fs::rename(folder_ / "b.yaml", folder_ / "elsewhere.yaml");
  EXPECT_EQ(log("--threads 1 --output out").code, 1);
  EXPECT_EQ(count(), before);
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
  const Outcome killed = stopped_by(SIGKILL);
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
