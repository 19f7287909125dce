// How the program behaves towards its user: help, completion, wrong letters, files that are there,
// pipes, progress, and what reaches the terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/stat.h>
#include <unistd.h>

#include <regex>
#include <set>
#include <vector>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Manners : public test::TrackerExampleTest {
 protected:
  /// Writes samples.yaml and calibrate.yaml.
  void prepare() const {
    ASSERT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml").code, 0);
    ASSERT_EQ(kinecal("init --urdf ur5e.urdf --target tracker --arm tool0").code, 0);
  }
  /// Replaces every occurrence of a text in a file.
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read(file);
    ASSERT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
    write(file, text);
  }
  /// What the program prints on a terminal.
  [[nodiscard]] std::string on_a_terminal(const std::string& arguments,
                                          const std::string& kind = "xterm") const {
    int terminal = -1;
    const std::string call = "cd " + folder_.string() + " && TERM=" + kind + " exec timeout 60 " +
                             test::kinecal_program() + " " + arguments;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      execl("/bin/sh", "sh", "-c", call.c_str(), nullptr);
      _exit(127);
    }
    std::string printed;
    pollfd readable{terminal, POLLIN, 0};
    char buffer[4096];
    ssize_t size = 0;
    while (poll(&readable, 1, 60000) > 0 && (size = ::read(terminal, buffer, sizeof buffer)) > 0) {
      printed.append(buffer, static_cast<std::size_t>(size));
    }
    close(terminal);
    int status = 0;
    waitpid(child, &status, 0);
    return printed;
  }
};

const std::string kCalibrate =
    "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out ";

TEST_F(Manners, IdentifyWritesAConfigurationThatCalibrates) {
  prepare();
  const std::string files = "--urdf ur5e.urdf --samples samples.yaml";
  const Outcome found = kinecal("identify " + files);
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, AllOf(HasSubstr("wrist_1_joint"), HasSubstr("\ngood · measured "),
                               HasSubstr("next: kinecal calibrate "
                                         "--urdf ur5e.urdf --config identified.yaml")));
  EXPECT_EQ(kinecal("check --config identified.yaml " + files).code, 0);
  const Outcome again = kinecal("identify " + files);
  EXPECT_EQ(again.code, 1);
  EXPECT_THAT(again.err, HasSubstr("identified.yaml: exists; use --force"));
}

TEST_F(Manners, ADashIsTheStandardInputOrOutput) {
  prepare();
  const std::string program = test::kinecal_program();
  const Outcome piped =
      run(program + " convert - - --columns columns.yaml < tracker.csv | " + program +
          " calibrate --urdf ur5e.urdf --config calibrate.yaml --samples - --dry-run --quiet");
  EXPECT_EQ(piped.code, 0) << piped.err;
  EXPECT_THAT(piped.out, testing::StartsWith("good · "));
  const Outcome plain = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --dry-run "
      "--quiet");
  EXPECT_EQ(piped.out, plain.out);
  const Outcome out = run(program + " convert tracker.csv - --columns columns.yaml");
  EXPECT_EQ(out.out, read("samples.yaml")) << "nothing else is printed there";
  EXPECT_THAT(out.err, HasSubstr("wrote -: 60 samples"));
  ASSERT_EQ(kinecal("convert samples.yaml samples.mcap").code, 0);
  const Outcome bag = run(
      program +
      " calibrate --urdf ur5e.urdf --config calibrate.yaml --samples - --dry-run < samples.mcap");
  EXPECT_EQ(bag.code, 1);
  EXPECT_THAT(bag.err, HasSubstr("-: is a bag, which can be read from a file only; give its name"));
  EXPECT_EQ(
      kinecal("calibrate --urdf - --config calibrate.yaml --samples samples.yaml --dry-run").code,
      1);
}

TEST_F(Manners, ResultsAreReplacedOnlyIfForcedAndBeforeAnyWork) {
  prepare();
  ASSERT_EQ(kinecal(kCalibrate).code, 0);
  write("out/calibration.yaml", "mine");
  EXPECT_EQ(kinecal(kCalibrate).code, 1);
  EXPECT_EQ(read("out/calibration.yaml"), "mine");
  for (const std::string file : {"calibrated.urdf", "calibration.yaml", "report.json"}) {
    fs::remove_all(folder_ / "other");
    fs::create_directory(folder_ / "other");
    write("other/" + file, "mine");
    const Outcome refused =
        kinecal("calibrate --urdf none --config none --samples none --output other");
    EXPECT_EQ(refused.code, 1);
    EXPECT_EQ(refused.err, "error: other/" + file +
                               ": exists; use --force to replace it, or choose another --output\n");
  }
  EXPECT_EQ(kinecal(kCalibrate + "--dry-run").code, 0);
  EXPECT_EQ(kinecal(kCalibrate + "--force").code, 0);
  EXPECT_THAT(read("out/calibration.yaml"), HasSubstr("urdf: calibrated.urdf"));
}

TEST_F(Manners, HelpOfACommandIsItsHelp) {
  EXPECT_EQ(kinecal("help").out, kinecal("--help").out);
  EXPECT_EQ(kinecal("help calibrate").out, kinecal("calibrate --help").out);
  EXPECT_THAT(kinecal("help").out, HasSubstr("  help  "));
  EXPECT_THAT(kinecal("help").out, Not(HasSubstr("describe"))) << "for those who make packages";
  const Outcome wrong = kinecal("help calibrat");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("'calibrat' is not a command; did you mean 'calibrate'?"));
}

TEST_F(Manners, ProposesTheOptionThatWasMeant) {
  const Outcome samples = kinecal("calibrate --urdf a --config b --smples c --output d");
  EXPECT_EQ(samples.code, 1);
  EXPECT_THAT(samples.err, HasSubstr("error: '--smples' is not an option of 'calibrate'; did you "
                                     "mean '--samples'?"));
  EXPECT_THAT(kinecal("check --conifg=b").err, HasSubstr("did you mean '--config'?"));
  EXPECT_THAT(kinecal("rpy 1 2 3 --xyz").err, HasSubstr("'--xyz' is not an option of 'rpy'; "));
  for (const std::string command : {"plan --urdf r.urdf", "simulate r.urdf -o sim"}) {
    EXPECT_THAT(
        kinecal(command + " --target chekerboard").err,
        HasSubstr("--target: 'chekerboard' is not one of checkerboard, apriltag, aprilgrid, "));
    EXPECT_THAT(kinecal(command + " --target chekerboard").err,
                HasSubstr("; did you mean 'checkerboard'? "));
  }
  EXPECT_THAT(kinecal("check --urdf a").err, HasSubstr("--config is required"));
}

/// The words of --help that are commands, or options of a command.
std::set<std::string> words_of(const std::string& help, const std::string& pattern) {
  std::set<std::string> words;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(help.begin(), help.end(), expression), end; it != end; ++it) {
    words.insert((*it)[1]);
  }
  return words;
}

TEST_F(Manners, ManualAndCompletionHaveAllCommandsAndOptions) {
  const std::string help = kinecal("help").out;
  const auto commands = words_of(help.substr(help.find("Subcommands:")), "\n  ([a-z_-]+) ");
  ASSERT_EQ(commands.size(), 24u);
  const std::string man = kinecal("describe man").out, bash = kinecal("describe bash").out,
                    zsh = kinecal("describe zsh").out, fish = kinecal("describe fish").out;
  for (const std::string& command : commands) {
    const std::string title = std::regex_replace(command, std::regex("-"), "\\-");
    EXPECT_THAT(man, HasSubstr("\n.SS " + title + "\n"));
    EXPECT_THAT(bash, HasSubstr("\n    " + command + ") words="));
    EXPECT_THAT(zsh, HasSubstr("\n    " + command + ")\n"));
    const auto options = words_of(kinecal("help " + command).out, "  (?:-h,)?(--[a-z-]+)");
    EXPECT_THAT(options, testing::Contains("--help"));
    const auto part = [&](const std::string& text, const std::string& begin,
                          const std::string& end) {
      const std::size_t from = text.find(begin);
      return text.substr(from, text.find(end, from + begin.size()) - from);
    };
    for (const std::string& option : options) {
      EXPECT_THAT(part(bash, "\n    " + command + ") words=", ";;") + " ",
                  testing::ContainsRegex(option + "[ \"]"));
      EXPECT_THAT(part(zsh, "\n    " + command + ")\n", ";;"), HasSubstr("'*" + option + "["));
      EXPECT_THAT(fish, HasSubstr("from " + command + "' -l " + option.substr(2) + " "));
      if (option == "--help") continue;
      EXPECT_THAT(part(man, "\n.SS " + title + "\n", "\n.S"),
                  HasSubstr("\\fB" + std::regex_replace(option, std::regex("-"), "\\-") + "\\fR"));
    }
  }
}

TEST_F(Manners, BashCompletesCommandsOptionsAndValues) {
  ASSERT_EQ(kinecal("describe bash --output c.bash").code, 0);
  const auto completed = [&](const std::string& words, int at) {
    write("ask.sh", "source ./c.bash\nCOMP_WORDS=(kinecal " + words + ")\nCOMP_CWORD=" +
                        std::to_string(at) + "\n_kinecal\necho \"${COMPREPLY[*]}\"\n");
    const Outcome outcome = run("bash ask.sh");
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  };
  EXPECT_EQ(completed("cal", 1), "calibrate calibrate-log\n");
  EXPECT_EQ(completed("calibrate --thr", 2), "--threads\n");
  EXPECT_EQ(completed("calibrate --offsets o", 3), "origin\n");
  EXPECT_EQ(completed("help ins", 2), "install inspect\n");
  EXPECT_EQ(completed("init --target world_a", 3), "world_apriltag\n");
  EXPECT_EQ(completed("init --form ku", 3), "kuka\n");
  EXPECT_EQ(completed("calibrate --offsets = o", 4), "origin\n") << "as bash splits --offsets=o";
  EXPECT_EQ(completed("calibrate --offsets =", 3), "rising origin ros2_control\n");
  EXPECT_EQ(completed("calibrate --urdf x", 3), "\n") << "files, which bash completes";
}

/// What is quoted ends nothing: the texts are those of --help.
TEST_F(Manners, CompletionOfZshAndFishQuotesTexts) {
  EXPECT_THAT(kinecal("describe zsh").out, HasSubstr("where joint offsets go\\: rising adds"));
  EXPECT_THAT(kinecal("describe fish").out, HasSubstr("the joints\\' <origin>"));
  if (run("zsh --version").code == 0) {
    ASSERT_EQ(kinecal("describe zsh --output _kinecal").code, 0);
    EXPECT_EQ(run("zsh -n _kinecal").err, "");
  }
}

TEST_F(Manners, TheManualIsFormattedWithoutWarnings) {
  ASSERT_EQ(kinecal("describe man --output kinecal.1").code, 0);
  if (run("groff --version").code != 0) GTEST_SKIP() << "there is no groff";
  const Outcome formatted = run("groff -man -Tascii -ww kinecal.1");
  EXPECT_EQ(formatted.code, 0);
  EXPECT_EQ(formatted.err, "");
  EXPECT_THAT(formatted.out, HasSubstr("calibrate"));
}

TEST_F(Manners, ACameraWithoutASizeIsShownButNotWritten) {
  write("camera.yaml", "K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n");
  EXPECT_EQ(kinecal("camera camera.yaml").code, 0);
  const Outcome written = kinecal("camera camera.yaml --output out.yaml");
  EXPECT_EQ(written.code, 1);
  EXPECT_THAT(written.err, HasSubstr("camera.yaml: the size of the image is missing, and "
                                     "camera_info needs it; add image_width and image_height"));
  EXPECT_FALSE(fs::exists(folder_ / "out.yaml"));
}

TEST_F(Manners, APipeWithoutAWriterNeverBlocks) {
  prepare();
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  for (const std::string call :
       {"check --urdf pipe --config calibrate.yaml", "check --urdf ur5e.urdf --config pipe",
        "check --urdf ur5e.urdf --config calibrate.yaml --samples pipe", "inspect pipe",
        "convert pipe a.yaml", "convert pipe a.bag", "convert pipe a.yaml --columns columns.yaml",
        "convert tracker.csv a.yaml --columns pipe", "camera pipe", "plot pipe --list",
        "init --urdf pipe --force"}) {
    const Outcome outcome = kinecal(call);
    EXPECT_EQ(outcome.code, 1) << call;  // 124: it had to be stopped
    EXPECT_THAT(outcome.err, HasSubstr("pipe: is a pipe, not a file; write")) << call;
  }
}

TEST_F(Manners, NoControlCharacterOfAFileReachesTheTerminal) {
  prepare();
  replace("samples.yaml", "elbow_joint", "\"\\eelbow_joint\\r\"");
  for (const std::string call :
       {"check --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml",
        "inspect samples.yaml"}) {
    const Outcome outcome = kinecal(call);
    EXPECT_THAT(outcome.out + outcome.err, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\r"))));
    EXPECT_THAT(outcome.out + outcome.err, HasSubstr("\\x1belbow_joint\\x0d")) << call;
  }
  write("odd.yaml", "base_link: \"\\e[31mbase\"\n");
  EXPECT_THAT(kinecal("check --urdf ur5e.urdf --config odd.yaml").err,
              AllOf(HasSubstr("\\x1b[31mbase"), Not(HasSubstr("\x1b"))));
  replace("ur5e.urdf", "elbow_joint", "elbow&#27;[0m");
  EXPECT_THAT(kinecal("init --urdf ur5e.urdf --target tracker --force").err,
              AllOf(HasSubstr("has a control character"), Not(HasSubstr("\x1b"))));
}

TEST_F(Manners, NoMarkThatTurnsTheDirectionOfWritingReachesTheTerminal) {
  prepare();
  const std::string odd = "elbow\u202Etnioj";
  for (const char* file : {"ur5e.urdf", "samples.yaml", "calibrate.yaml"}) {
    replace(file, "elbow_joint", odd);
  }
  const std::string input = "--urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml ";
  ASSERT_EQ(kinecal(kCalibrate + "--force --report report.html").code, 0);
  write("wrong.yaml", "base_link: base_link\ncalibration_steps: [" + odd + "]\n");
  for (const std::string& call : std::vector<std::string>{
           "calibrate " + input + "--dry-run", "calibrate " + input + "--dry-run --verbose",
           "calibrate " + input + "--dry-run --json", "check " + input, "inspect samples.yaml",
           "verify out samples.yaml", "evaluate out samples.yaml", "compare out out",
           "grade samples.yaml --result out",
           "init --force --urdf ur5e.urdf --target tracker --arm " + odd,
           "init --force --urdf ur5e.urdf --target tracker", "plot report.html --list",
           "plot report.html " + odd + " -o figures", "check --urdf ur5e.urdf --config wrong.yaml",
           "inspect " + odd, odd, "calibrate --" + odd, "calibrate-log " + input + "--output log",
           "select-poses " + input + "--poses 5 --output few.yaml"}) {
    const Outcome outcome = kinecal(call);
    EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("\u202E"))) << call;
    EXPECT_FALSE((outcome.out + outcome.err).empty()) << call;
  }
  EXPECT_THAT(kinecal("inspect samples.yaml").out, HasSubstr("elbow\\u202etnioj"));
  EXPECT_THAT(kinecal("calibrate " + input + "--dry-run --json").out, HasSubstr("\\u202e"));
  EXPECT_THAT(read("report.html"), Not(HasSubstr("\u202E")));
}

TEST(Sources, OfTheProgramPrintWithoutControlCharacters) {
  for (const auto& file : fs::directory_iterator(test::source_folder() + "/examples/cli")) {
    if (file.path().stem() == "terminal") continue;
    std::ifstream in(file.path());
    for (std::string line; std::getline(in, line);) {
      const bool prints = line.find("fmt::print(") != std::string::npos ||
                          line.find("printf(") != std::string::npos ||
                          line.find("std::cout") != std::string::npos ||
                          line.find("std::cerr") != std::string::npos;
      const bool is_safe = line.find("\\033[K") != std::string::npos ||  // a line of progress
                           line.find("printable(") != std::string::npos ||
                           line.find("cannot write to the standard output") != std::string::npos;
      EXPECT_TRUE(!prints || is_safe) << file.path() << ": use say(): " << line;
    }
  }
}

TEST_F(Manners, CountsAgreeInNumber) {
  prepare();
  const std::string text = read("samples.yaml");
  write("one.yaml", text.substr(0, text.find("---\n") + 4));
  EXPECT_THAT(kinecal("inspect one.yaml").out, testing::StartsWith("1 sample\n"));
  EXPECT_THAT(kinecal("inspect samples.yaml").out, testing::StartsWith("60 samples\n"));
  EXPECT_THAT(kinecal("convert one.yaml again.yaml").out, HasSubstr("again.yaml: 1 sample\n"));
}

TEST_F(Manners, AFeatureInAnUnknownFrameGetsTheRemediesAndAFixedFrameIsOne) {
  prepare();
  replace("samples.yaml", "frame_id: smr", "frame_id: ball");
  const Outcome refused = kinecal(kCalibrate);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("samples.yaml:1: sensor 'arm': a feature is in frame 'ball'"),
                    HasSubstr("declare it under fixed_frames, if its pose in 'tool0' is known"),
                    HasSubstr("or correct the frame_id of the feature")));
  const std::string config = read("calibrate.yaml");
  const auto with_fixed = [&](const std::string& frame) {
    write("calibrate.yaml", config);
    replace("calibrate.yaml",
            "\nerror_blocks:", "\nfixed_frames:\n - " + frame + "\nerror_blocks:");
  };
  with_fixed("{name: ball, x: 0.012, y: -0.031, z: 0.087}");
  const Outcome done =
      kinecal("check --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml");
  EXPECT_EQ(done.code, 0) << done.err;
  // A reflector that is elsewhere does not fit.
  const Outcome elsewhere = kinecal(kCalibrate + "--report r.json");
  EXPECT_EQ(elsewhere.code, 2) << elsewhere.err;
  EXPECT_THAT(elsewhere.out, HasSubstr("residuals show distances of"));
  with_fixed("{name: elbow_joint}");
  EXPECT_THAT(kinecal(kCalibrate + "--force").err,
              HasSubstr("fixed frame 'elbow_joint' is a joint of the robot, whose URDF says"));
}

TEST_F(Manners, ShowsHowFarReadingIsOnATerminalOnly) {
  prepare();
  const std::string once = read("samples.yaml");
  std::string text;
  while (text.size() < 30'000'000) text += once;
  write("large.yaml", text);
  const std::string printed = on_a_terminal("inspect large.yaml");
  EXPECT_THAT(printed, testing::ContainsRegex("\rreading large.yaml: [0-9]+ %, [0-9]+ s left"));
  EXPECT_LT(printed.rfind(" left\x1b[K"), printed.find("\r\x1b[K")) << "the line is erased";
  const Outcome silent = kinecal("inspect large.yaml");
  EXPECT_EQ(silent.err, "");
  EXPECT_THAT(on_a_terminal("inspect large.yaml", "dumb"),
              AllOf(HasSubstr(" samples\r\n"), Not(HasSubstr("\x1b")), Not(HasSubstr("reading"))));
  EXPECT_THAT(on_a_terminal(kCalibrate + "--dry-run", "dumb"),
              AllOf(HasSubstr("\nverdict: good"), Not(HasSubstr("\x1b")), Not(HasSubstr("\r\r"))));
  EXPECT_THAT(on_a_terminal(kCalibrate + "--dry-run"), HasSubstr("\x1b[1;32mgood"));
}

/// Whatever is printed: a program that reads it must not take half of it for all.
TEST_F(Manners, AFullDiskIsAnExitCodeOfEveryCommand) {
  prepare();
  const std::string input = " --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml ";
  ASSERT_EQ(kinecal(kCalibrate + "--report r.html").code, 0);
  for (const std::string& arguments :
       {std::string(),
        std::string("--help"),
        std::string("--version"),
        std::string("help plan"),
        "calibrate" + input + "--dry-run",
        "calibrate" + input + "--dry-run --quiet",
        "calibrate" + input + "--dry-run --json",
        "check" + input,
        "identify" + input + "--force",
        "plan" + input,
        "select-poses --count 5" + input,
        "study --robots 2" + input,
        std::string("calibrate") + input + "--force --output other",
        std::string("calibrate-log") + input + "--output log",
        std::string("init --urdf ur5e.urdf --target tracker --arm tool0 --force"),
        std::string("verify out samples.yaml"),
        std::string("evaluate out samples.yaml"),
        std::string("compare out out"),
        std::string("inspect samples.yaml"),
        std::string("convert samples.yaml - "),
        std::string("convert samples.yaml again.yaml"),
        std::string("plot r.html --list"),
        std::string("plot r.html --output charts"),
        "simulate " + test::source_folder() +
            "/examples/mobile_manipulator/mobile_manipulator.urdf --target leds --poses 3 -o sim",
        std::string("rpy 0.1 0.2 0.3"),
        std::string("describe bash")}) {
    const Outcome outcome = run("(timeout 60 " + test::kinecal_program() + " " + arguments +
                                " < /dev/null > /dev/full; echo $?)");
    EXPECT_EQ(outcome.out, "1\n") << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("error: ")) << arguments;
  }
}

/// A file that somebody writes while the program waits for its samples.
TEST_F(Manners, AFileThatAppearsDuringTheRunIsKept) {
  prepare();
  const auto meanwhile = [&](const std::string& arguments, const std::string& file) {
    return run("(sleep 1; printf precious > " + file + "; cat samples.yaml) | " +
               test::kinecal_program() + " " + arguments);
  };
  const std::string calibrate =
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples - --output out "
      "--report r.html --scene s.mcap";
  for (const std::string file : {"r.html", "s.mcap", "out/calibrated.urdf"}) {
    for (const char* other : {"r.html", "s.mcap", "out"}) fs::remove_all(folder_ / other);
    const Outcome kept = meanwhile(calibrate, file);
    EXPECT_EQ(kept.code, 1) << file;
    EXPECT_THAT(kept.err, testing::ContainsRegex(file + ": (has appeared meanwhile|exists)"));
    EXPECT_EQ(read(file), "precious");
    EXPECT_FALSE(fs::exists(folder_ / "out/report.json")) << "all results or none";
  }
  fs::remove_all(folder_ / "out");
  fs::remove(folder_ / "s.mcap");
  write("r.html", "of an earlier run");  // which a report replaces
  EXPECT_EQ(meanwhile(calibrate + " --force", "s.mcap").code, 0);
  EXPECT_NE(read("r.html"), "of an earlier run");
  EXPECT_NE(read("s.mcap"), "precious") << "forced";
  for (const std::string file : {"c.yaml", "c.mcap", "c.bag"}) {
    EXPECT_EQ(meanwhile("convert - " + file, file).code, 1);
    EXPECT_EQ(read(file), "precious");
  }
}

TEST_F(Manners, NoArgumentIsTheHelp) {
  const Outcome bare = kinecal("");
  EXPECT_EQ(bare.code, 0);
  EXPECT_EQ(bare.err, "");
  EXPECT_EQ(bare.out, kinecal("--help").out);
  EXPECT_THAT(bare.out, AllOf(HasSubstr("calibrate the robot"), Not(HasSubstr("describe"))));
}

TEST_F(Manners, TheVersionSaysWhatThisProgramFindsAndInitNotesWhatItDoesNot) {
  for (const std::string& plugins : {std::string(), "KINECAL_PLUGINS=" + folder_.string() + " "}) {
    const std::string program = plugins + test::kinecal_program();
    const std::string version = run(program + " --version").out;
    const auto others = version.find("does not find ");
    EXPECT_THAT(version, AllOf(testing::StartsWith("kinecal "), HasSubstr("OpenCV"),
                               HasSubstr("AprilTags (libapriltag)")));
    for (const auto& [target, name] : {std::pair("checkerboard", "checkerboards (OpenCV)"),
                                       std::pair("charuco", "ChArUco boards (OpenCV)"),
                                       std::pair("apriltag", "AprilTags (libapriltag)")}) {
      const bool is_missing = version.find(name) > others;
      EXPECT_TRUE(is_missing || plugins.empty() || target == std::string("apriltag")) << version;
      const Outcome made = run(program + " init --cameras c --force --target " + target);
      EXPECT_EQ(made.code, 0) << made.err;
      EXPECT_EQ(made.err.find("note: ") != std::string::npos, is_missing) << target << made.err;
    }
  }
}

TEST_F(Manners, APlugInThatCannotBeLoadedIsNamed) {
  write("kinecal_opencv.so", "no library");
  const Outcome made = run("KINECAL_PLUGINS=" + folder_.string() + " " + test::kinecal_program() +
                           " init --cameras c --target checkerboard");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, AllOf(HasSubstr("kinecal_opencv.so cannot be loaded: "),
                              HasSubstr("install the package kinecal-opencv again")));
}

TEST_F(Manners, WhatAHostileFileRepeatsIsCounted) {
  prepare();
  std::string keys;
  for (int i = 0; i < 20'000; ++i) keys += "zz" + std::to_string(i) + "_q: 1\n";
  write("calibrate.yaml", read("calibrate.yaml") + keys);
  const Outcome warned = kinecal("check --urdf ur5e.urdf --config calibrate.yaml");
  EXPECT_EQ(warned.code, 0) << warned.out;
  EXPECT_THAT(warned.err, AllOf(HasSubstr("unknown key 'zz49_q' is ignored\n"),
                                HasSubstr("warning: and 19950 more warnings\n")));
  EXPECT_LT(warned.err.size(), 10'000U);
  write("long.yaml", std::string(1000, 'k') + ": " + std::string(1'000'000, 'x') + "\n");
  const Outcome refused = kinecal("check --urdf ur5e.urdf --config long.yaml");
  EXPECT_EQ(refused.code, 1);
  EXPECT_LT(refused.err.size(), 10'000U) << refused.err.size();
}

TEST_F(Manners, ANameThatIsTooLongForAFileIsRefusedBeforeSolving) {
  prepare();
  const Outcome path = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output " +
      std::string(300, 'd'));
  EXPECT_EQ(path.code, 1);
  EXPECT_THAT(path.err, AllOf(testing::StartsWith("error: ddd"), HasSubstr("File name too long\n"),
                              Not(HasSubstr("symlink_status"))));
  EXPECT_EQ(path.out, "");
}

TEST_F(Manners, AnAccuracyOfSomethingElseIsProposedWithTheNameThatIsCalibrated) {
  prepare();
  const std::string plan =
      "plan --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --accuracy ";
  EXPECT_THAT(kinecal(plan + "'tool0 0.03 mm'").err, HasSubstr("write 'smr 0.03 mm'"));
  EXPECT_THAT(kinecal(plan + "'  wrist 2 cm'").err, HasSubstr("write '  smr 2 cm'"));
}

}  // namespace
}  // namespace kinecal
