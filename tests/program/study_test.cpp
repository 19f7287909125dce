// kinecal study, select-poses and plan: simulated calibrations of many robots.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "kinecal/files/poses/poses.hpp"
#include "support/paths.hpp"
#include "support/processes.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const std::string kFetchFolder = test::source_folder() + "/examples/robots/fetch/";

class Study : public test::ProgramTest {
 protected:
  Study() {
    write(
        "scene.yaml",
        "target: {type: leds, link: gripper_link, leds: [[0.05, 0.03, 0.04], [0, 0.03, 0.04], [0, "
        "-0.03, 0.04], [0.05, -0.03, 0.04]]}\n");
  }
  /// Of the example robot, with few poses.
  [[nodiscard]] test::Outcome call(const std::string& command, const std::string& arguments) const {
    return run(test::kinecal_program() + " " + command + " --urdf " + kFetchFolder +
               "fetch.urdf --target leds " + arguments);
  }
  /// Calibrations in the journal of the study in the folder "part".
  [[nodiscard]] int journal_lines() const {
    const std::string journal = read("part/journal.0.csv");
    int lines = 0;
    for (std::size_t at = 0; (at = journal.find(",end\n", at)) != std::string::npos; ++at) ++lines;
    return lines;
  }
  /// A study in the folder "part" that gets a signal once its journal has so many calibrations.
  [[nodiscard]] test::Outcome call_until(int lines, int signal,
                                         const std::string& arguments) const {
    return test::run_and_send(folder_,
                              test::kinecal_program() + " study --urdf " + kFetchFolder +
                                  "fetch.urdf --target leds " + arguments,
                              signal, [&] { return journal_lines() >= lines; });
  }
};

/// A page up to the line that repeats it.
std::string without_command(const std::string& html) {
  return html.substr(0, html.find("<pre class=\"command\">"));
}

TEST_F(Study, PrintsTheTablesOfThePaperAndWritesTrials) {
  const test::Outcome outcome = call("study", "--robots 2 --repeat 3 --poses 20,12 -o out");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Table I: variance of 3 calibrations of robot 1"));
  EXPECT_THAT(outcome.out, HasSubstr("Table II: the same of 2 robots, 20 poses"));
  EXPECT_THAT(outcome.out, HasSubstr("Table III: mean re-projection error"));
  EXPECT_THAT(outcome.out, HasSubstr("0 of 12 calibrations failed"));
  EXPECT_THAT(outcome.out, ContainsRegex("Median of the ratios 12:20: [0-9.]+; independent poses"));
  const std::string trials = read("out/trials.csv");
  EXPECT_EQ(std::count(trials.begin(), trials.end(), '\n'), 13);
  EXPECT_THAT(read("out/study.json"), HasSubstr("\"predicted_position\""));
  EXPECT_THAT(outcome.out, HasSubstr(read("out/study.txt")));
  const test::Outcome again = call("study", "--robots 2 --repeat 3 --poses 20,12 -o out");
  EXPECT_EQ(again.code, 1);
  EXPECT_THAT(again.err, HasSubstr("has a study already; use --force"));
}

TEST_F(Study, WritesAPageWithChartsAndTables) {
  const std::string what = "--robots 2 --repeat 3 --poses 20,12 ";
  const test::Outcome outcome = call("study", what + "--report page.html");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\npage.html\n"));
  const std::string page = read("page.html");
  EXPECT_THAT(page, HasSubstr("<title>fetch: 0 of 12 calibrations failed</title>"));
  EXPECT_THAT(page, HasSubstr("data-chart=\"spread\""));
  EXPECT_THAT(page, HasSubstr("data-chart=\"position-spread\""));
  EXPECT_THAT(page, HasSubstr("<h3>Table I: variance of 3 calibrations of robot 1"));
  EXPECT_THAT(page, HasSubstr("<h3>Table II: the same of 2 robots, 20 poses</h3>"));
  EXPECT_THAT(page, HasSubstr("<h3>Table III: mean re-projection error"));
  EXPECT_THAT(page, ContainsRegex("<p>(Linear|Not linear): "));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  const test::Outcome again = call("study", what + "--report page.html");
  EXPECT_EQ(again.code, 1);
  EXPECT_THAT(again.err, HasSubstr("page.html: exists; use --force"));
  EXPECT_EQ(call("study", what + "--report other.html --threads 1").code, 0);
  EXPECT_EQ(without_command(read("other.html")), without_command(page));
  const test::Outcome text = call("study", what + "--report page.txt");
  EXPECT_EQ(text.code, 1);
  EXPECT_THAT(text.err, HasSubstr("let the name end in .html"));
}

// The prior holds this parameter: what samples say of it is so little that errors of second order count.
TEST_F(Study, NamesAParameterThatVariesMoreThanPredicted) {
  ASSERT_EQ(run(test::kinecal_program() + " simulate --urdf " + kFetchFolder +
                "fetch.urdf --target leds --poses 3 -o sim")
                .code,
            0);
  std::string config = read("sim/calibrate.yaml");
  const std::string offsets = "free_params:\n";
  config.replace(config.find(offsets), offsets.size(), offsets + " - head_tilt_joint\n");
  write("calibrate.yaml",
        config +
            " - {name: restrict, type: outrageous, param: head_camera_rgb_joint, joint_scale: 0.0, "
            "position_scale: 1.0, rotation_scale: 1.0}\n");
  const test::Outcome outcome =
      call("study", "--config calibrate.yaml --robots 1 --repeat 60 --poses 15");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("\nNot as predicted: 'head_camera_rgb_joint_b' varies "
                                         "1\\.[0-9]+ times as much as predicted"));
}

TEST_F(Study, TrialsDoNotDependOnThreads) {
  const std::string what = "--robots 3 --repeat 2 --poses 12 ";
  ASSERT_EQ(call("study", what + "-o one --threads 1").code, 0);
  ASSERT_EQ(call("study", what + "-o four --threads 4").code, 0);
  EXPECT_EQ(read("one/trials.csv"), read("four/trials.csv"));
  EXPECT_EQ(read("one/study.json"), read("four/study.json"));
  ASSERT_EQ(call("study", what + "-o other --seed 2").code, 0);
  EXPECT_NE(read("one/trials.csv"), read("other/trials.csv"));
}

TEST_F(Study, CtrlCPrintsWhatIsDoneAndTheSameCommandGoesOn) {
  const std::string what = "--robots 2 --repeat 30 --poses 12 --threads 1 ";
  ASSERT_EQ(call("study", what + "-o whole").code, 0);
  const test::Outcome stopped = call_until(1, SIGINT, what + "-o part");
  EXPECT_EQ(stopped.code, 130);
  EXPECT_THAT(stopped.out, ContainsRegex("Interrupted: [0-9]+ of 60 calibrations are done"));
  EXPECT_THAT(stopped.out, HasSubstr("part: run the same command again to go on"));
  const int done = journal_lines();
  EXPECT_GE(done, 1);
  EXPECT_LT(done, 60);
  const test::Outcome rest = call("study", what + "-o part");
  EXPECT_EQ(rest.code, 0);
  EXPECT_THAT(rest.err,
              HasSubstr("note: " + std::to_string(done) + " calibrations were done before"));
  EXPECT_EQ(read("part/study.json"), read("whole/study.json"));
}

TEST_F(Study, GoesOnWhereItWasKilled) {
  const std::string what = "--robots 2 --repeat 20 --poses 12 ";
  ASSERT_EQ(call("study", what + "-o whole").code, 0);
  for (const int lines : {1, 3, 7}) {  // of 40
    EXPECT_EQ(call_until(lines, SIGKILL, what + "--threads 1 -o part").code, -1) << "not killed";
    EXPECT_GE(journal_lines(), lines);
  }
  ASSERT_EQ(call("study", what + "-o part").code, 0);
  EXPECT_EQ(read("part/trials.csv"), read("whole/trials.csv"));
  EXPECT_EQ(read("part/study.json"), read("whole/study.json"));
  for (const auto& file : fs::directory_iterator(folder_ / "part")) {
    EXPECT_FALSE(file.path().filename().string().starts_with("journal")) << file.path();
  }
}

TEST_F(Study, SeveralProcessesShareAStudy) {
  KINECAL_REQUIRE_MPIRUN();
  const std::string what = "--robots 2 --repeat 4 --poses 12 ";
  ASSERT_EQ(call("study", what + "-o one").code, 0);
  const auto in_processes = [&](int count, const std::string& options) {
    return run(test::in_processes(count, test::kinecal_program() + " study --urdf " + kFetchFolder +
                                             "fetch.urdf --target leds " + what + options));
  };
  for (const int count : {2, 4}) {
    const std::string folder = "of" + std::to_string(count);
    const test::Outcome shared = in_processes(count, "-o " + folder);
    EXPECT_EQ(shared.code, 0) << shared.err;
    EXPECT_EQ(shared.err, "");
    EXPECT_EQ(read("one/trials.csv"), read(folder + "/trials.csv"));
    EXPECT_EQ(read("one/study.json"), read(folder + "/study.json"));
    EXPECT_THAT(shared.out, HasSubstr(read("one/study.txt")));
  }
  EXPECT_EQ(in_processes(2, "-o of2 --force").code, 0);
  EXPECT_EQ(read("one/trials.csv"), read("of2/trials.csv"));
  EXPECT_THAT(in_processes(2, "").out, HasSubstr(read("one/study.txt"))) << "without files";
  const test::Outcome again = in_processes(2, "-o of2");
  EXPECT_EQ(again.code, 1);
  EXPECT_THAT(again.err, HasSubstr("of2: has a study already"));
}

TEST_F(Study, ProcessesGoOnWhereOneWasKilled) {
  KINECAL_REQUIRE_MPIRUN();
  const std::string what = "--robots 2 --repeat 20 --poses 12 ";
  ASSERT_EQ(call("study", what + "-o whole").code, 0);
  EXPECT_EQ(call_until(7, SIGKILL, what + "--threads 1 -o part").code, -1) << "not killed";
  const test::Outcome rest =
      run(test::in_processes(3, test::kinecal_program() + " study --urdf " + kFetchFolder +
                                    "fetch.urdf --target leds " + what + "-o part"));
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_THAT(rest.err, ContainsRegex("^note: [0-9]+ calibrations were done before\n$"));
  EXPECT_EQ(read("part/trials.csv"), read("whole/trials.csv"));
  EXPECT_EQ(read("part/study.json"), read("whole/study.json"));
}

TEST_F(Study, AJournalOfAnotherStudyIsRefusedAndALineThatWasCutOffIsIgnored) {
  fs::create_directories(folder_ / "out");
  write("out/journal.0.csv", "# study of another robot\n1,2,3\n");
  const test::Outcome outcome = call("study", "--robots 1 --repeat 1 --poses 12 -o out");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("out/journal.0.csv: is of another study"));
  EXPECT_EQ(call("study", "--robots 1 --repeat 1 --poses 12 -o out --force").code, 0);
}

TEST_F(Study, RuinedSamplesAreLeftOut) {
  const test::Outcome outcome = call("study", "--robots 2 --repeat 2 --poses 30 --ruined 0.1");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("\n[0-9]+ samples ruined, [0-9]+ left out\n"));
  EXPECT_THAT(outcome.out, HasSubstr("0 of 4 calibrations failed"));
}

TEST_F(Study, RecordedSamplesAreMeasuredAnew) {
  const test::Outcome outcome =
      run(test::kinecal_program() + " study --urdf " + kFetchFolder + "fetch.urdf --config " +
          kFetchFolder + "calibrate.yaml --samples missing.yaml");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("missing.yaml"));
  EXPECT_EQ(outcome.out, "");
}

TEST_F(Study, PosesInWhichNothingIsSeenAreNamed) {
  write("poses.yaml", "- {joints: [head_tilt_joint, head_pan_joint], positions: [-0.7, 1.5]}\n");
  const test::Outcome outcome = call("study", "--pose-file poses.yaml");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("warning: poses.yaml:1: the target is"));
  EXPECT_THAT(outcome.err, HasSubstr("the camera sees the target in none of the poses"));
}

TEST_F(Study, AWrongSceneIsTheOnlyError) {
  write("wrong.yaml", "errors: {joint: 3}\n");
  const test::Outcome outcome = run(test::kinecal_program() + " study --scene wrong.yaml --urdf " +
                                    kFetchFolder + "fetch.urdf");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err,
            "error: wrong.yaml:1: errors: joint is 3, not between 0 and 1 (radians, metres, or a "
            "share)\n");
}

TEST_F(Study, SelectPosesIsBetterThanRandomSetsAndWritesPoses) {
  const test::Outcome outcome =
      call("select-poses", "--candidates 30 --count 12 --random 50 --simulate 5 -o few.yaml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  double selected = 0.0, best = 0.0;
  ASSERT_EQ(std::sscanf(outcome.out.substr(outcome.out.find("known to")).c_str(), "known to %lf mm",
                        &selected),
            1);
  ASSERT_EQ(std::sscanf(outcome.out.substr(outcome.out.find("random sets:")).c_str(),
                        "random sets: %lf mm", &best),
            1);
  EXPECT_LT(selected, best);
  Diagnostics diagnostics;
  EXPECT_EQ(read_poses_yaml((folder_ / "few.yaml").string(), diagnostics).size(), 12U);
  EXPECT_TRUE(diagnostics.errors.empty());
  EXPECT_EQ(call("select-poses", "--candidates 20 --count 5 -o few.yaml").code, 1);
}

TEST_F(Study, PlanSaysHowManyPosesAnAccuracyTakes) {
  const test::Outcome outcome =
      call("plan", "--candidates 30 --accuracy 'gripper 3 mm' -o plan.yaml");
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("[0-9]+ poses give [0-2]\\.[0-9]+ mm: "));
  EXPECT_THAT(outcome.out, ContainsRegex("Knee: after |No knee within "));
  const test::Outcome more = call(
      "plan", "--candidates 30 --have plan.yaml --accuracy 'gripper 1.5 mm' -o more.yaml --force");
  EXPECT_THAT(more.out, ContainsRegex("with your [0-9]+ poses: [0-2]\\.[0-9]+ mm"));
  const test::Outcome never = call("plan", "--candidates 30 --accuracy 'gripper 0.001 mm'");
  EXPECT_EQ(never.code, 2);
  EXPECT_THAT(never.out, HasSubstr("0.001 mm cannot be reached with poses like these"));
  const test::Outcome least =
      call("plan", "--candidates 30 --accuracy 'gripper 0.0001 mm' -o best.yaml");
  EXPECT_EQ(least.code, 2);
  EXPECT_THAT(least.out, HasSubstr("0.0001 mm cannot be reached"));
  EXPECT_THAT(least.out, ContainsRegex("\nbest.yaml: the best [0-9]+ poses, which do not reach "));
  Diagnostics diagnostics;
  EXPECT_FALSE(read_poses_yaml((folder_ / "best.yaml").string(), diagnostics).empty());
  const test::Outcome angle = call("plan", "--accuracy 'gripper 1 deg'");
  EXPECT_EQ(angle.code, 1);
  EXPECT_THAT(angle.err, HasSubstr("give a length"));
  const test::Outcome unit = call("plan", "--accuracy 'gripper 1'");
  EXPECT_EQ(unit.code, 1);
  EXPECT_THAT(unit.err, AllOf(HasSubstr("'gripper 1' is not the accuracy of a position"),
                              Not(HasSubstr("deg"))));
}

TEST_F(Study, PosesThatExistAreNotChosenAgain) {
  ASSERT_EQ(call("plan", "--candidates 30 --accuracy 'gripper 3 mm' -o have.yaml").code, 0);
  const test::Outcome outcome =
      call("select-poses",
           "--candidates 30 --have have.yaml --count 10 --random 5 --simulate 0 -o more.yaml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, ContainsRegex("note: [0-9]+ poses to choose from left out"));
  Diagnostics diagnostics;
  const auto have = read_poses_yaml((folder_ / "have.yaml").string(), diagnostics);
  const auto more = read_poses_yaml((folder_ / "more.yaml").string(), diagnostics);
  ASSERT_FALSE(more.empty());
  for (const CapturePose& pose : more) {
    for (const CapturePose& other : have) EXPECT_NE(pose.positions, other.positions);
  }
  const test::Outcome all = call("select-poses", "--pose-file have.yaml --have have.yaml");
  EXPECT_EQ(all.code, 1);
  EXPECT_THAT(all.err, HasSubstr("--have: no joint of the poses to choose from is further than"));
}

TEST_F(Study, PlanAndSelectPosesSayWhatAPriorLeavesWithoutNoise) {
  // So strong that they hold the camera where the URDF has it.
  ASSERT_EQ(run("cp " + kFetchFolder + "calibrate.yaml prior.yaml").code, 0);
  ASSERT_EQ(run("sed -i 's/_scale: .*/_scale: 500.0/' prior.yaml").code, 0);
  const std::string what = "--config prior.yaml --candidates 30 ";
  const test::Outcome outcome =
      call("plan", what + "--accuracy 'gripper 3 mm' -o few.yaml --report page.html");
  EXPECT_EQ(outcome.code, 2) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out,
              ContainsRegex("^Without noise the calibrations of 3 drawn robots are "
                            "still [0-9.]+ mm off \\(RMS\\): the prior 'restrict_camera' pulls\n"));
  EXPECT_TRUE(fs::exists(folder_ / "few.yaml"));
  const std::string page = read("page.html");
  EXPECT_THAT(page, HasSubstr("<header class=\"verdict care\">"));
  EXPECT_THAT(page, ContainsRegex("but [0-9.]+ mm remain without noise</strong>"));
  EXPECT_THAT(page, Not(HasSubstr("<circle class=\"good\"")));
  EXPECT_THAT(page,
              ContainsRegex("<bdi>configuration</bdi></td><td[^>]*><bdi>prior.yaml</bdi></td>"));
  EXPECT_THAT(page, ContainsRegex("<pre class=\"command\"><code>[^<]* plan [^<]*prior.yaml"));
  const test::Outcome studied =
      call("study", "--config prior.yaml --robots 1 --repeat 2 --poses 12 --limit 0.001");
  EXPECT_THAT(studied.out, ContainsRegex("Even without noise [0-9.]+ mm remain\n"
                                         "Without noise .*: the prior 'restrict_camera' pulls\n"));
  const test::Outcome selected = call("select-poses", what + "--count 10 --random 5 --simulate 3");
  EXPECT_THAT(selected.out, ContainsRegex("but [0-9.]+ mm remain without noise\n"));
  EXPECT_THAT(selected.out,
              ContainsRegex("simulated 3 times: varies by [0-9.]+ mm, is [0-9.]+ mm"));
}

TEST_F(Study, SelectPosesOfTooFewPosesOrTooManyFailuresSaysSo) {
  const test::Outcome few =
      call("select-poses", "--candidates 30 --count 2 --random 5 --simulate 2");
  EXPECT_EQ(few.code, 0) << few.err;
  EXPECT_THAT(few.out, AllOf(HasSubstr("is not determined: they determine less than all poses do"),
                             Not(HasSubstr("random sets need"))));
  const test::Outcome none = call("select-poses", "--count 10 --failures 10");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("--failures: 10 of --count 10 poses may fail"));
}

TEST_F(Study, PlanWritesAPageWithACurve) {
  const std::string what = "--candidates 30 --accuracy 'gripper 3 mm' ";
  const test::Outcome outcome = call("plan", what + "-o plan.yaml --report page.html");
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const std::string page = read("page.html");
  EXPECT_THAT(page, ContainsRegex("<strong>[0-9]+ poses give [0-2]\\.[0-9]+ mm</strong>"));
  EXPECT_THAT(page, HasSubstr("data-chart=\"pose-curve\""));
  EXPECT_THAT(page, ContainsRegex(">knee: [0-9]+ poses<|No knee within "));
  EXPECT_THAT(page, HasSubstr("asked for: 3 mm"));
  EXPECT_THAT(page, ContainsRegex("<p>(Parameters that no number|All parameters can be had)"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_EQ(call("plan", what + "--report page.html").code, 1) << "it exists";
  ASSERT_EQ(call("plan", what + "--report again.html").code, 0);
  EXPECT_EQ(without_command(read("again.html")), without_command(page));
  const test::Outcome more = call("plan", what + "--have plan.yaml --report more.html");
  ASSERT_EQ(more.code, 0) << more.err;
  EXPECT_THAT(read("more.html"), ContainsRegex(">your [0-9]+ poses: [0-9.]+ mm<"));
  const test::Outcome never =
      call("plan", "--candidates 30 --accuracy 'gripper 0.001 mm' --report never.html");
  EXPECT_EQ(never.code, 2);
  EXPECT_THAT(read("never.html"), HasSubstr("0.001 mm cannot be reached with poses like these"));
}

}  // namespace
}  // namespace kinecal
