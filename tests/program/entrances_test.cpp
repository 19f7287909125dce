// One verdict whichever way you come in: mistakes in real recordings, each given to the program, to a log of three files
// in another order, to a crate, to a capture session and to the library from texts in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/procedure/calibrate_crate.hpp"
#include "kinecal/procedure/session_follower.hpp"
#include "robots/ur5_dh.hpp"
#include "support/repetitions.hpp"
#include "support/run_program.hpp"
#include "support/wrong_recordings.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Mutation;
using test::Recording;

template <FixedString Tip>
using To = Chain<ur5_dh::Robot, "base_link", Tip>;
/// The models and unknown poses of the UR5's configurations.
using Tracked = Crate<Chain3d<"arm", To<"tool0">>, Chain3d<"tracker", To<"base_link">>,
                      VirtualFrame<"tracker_frame">, VirtualFrame<"smr", Axes::xyz>,
                      Block<"measured", PointToPoint, "arm", "tracker">>;
inline constexpr Axes kXa = {.x = true, .a = true}, kXy = {.x = true, .y = true},
                      kXya = {.x = true, .y = true, .a = true},
                      kXabc = {.x = true, .a = true, .b = true, .c = true};
using Full =
    Crate<JointOffset<"shoulder_lift_joint">, Tracked, FrameOffset<"shoulder_lift_joint", kXa>,
          FrameOffset<"elbow_joint", kXabc>, FrameOffset<"wrist_1_joint", kXabc>,
          FrameOffset<"wrist_2_joint", kXya>, FrameOffset<"wrist_3_joint", kXy>>;
using Offsets = Crate<JointOffset<"shoulder_lift_joint">, JointOffset<"elbow_joint">,
                      JointOffset<"wrist_1_joint">, JointOffset<"wrist_2_joint">, Tracked>;

/// What an entrance says.
struct Said {
  std::string grade, reason;  ///< the first reason

  bool operator==(const Said&) const = default;
};

/// A reason without the places of samples, which are in other files; without the name of the step, which a crate does not
/// have; and without the numbers of a problem that samples leave open, which are those of rounding.
std::string reason_of(const std::string& sentence) {
  if (sentence.find("it ran off") != std::string::npos) return "these samples do not determine it";
  const std::string of_step = std::regex_replace(sentence, std::regex("step '[a-z]+'"), "STEP");
  return std::regex_replace(of_step, std::regex("[^ ]+[.]yaml:[0-9]+"), "FILE");
}

Said said(const CalibratedRobot& calibrated) {
  const Judgement& judgement = calibrated.judgement;
  return {std::string(to_string(judgement.verdict)),
          judgement.reasons.empty() ? "" : reason_of(judgement.reasons.front())};
}

/// What a calibration in this process says, or why it is refused.
template <class Calibrate>
Said said_by(const Calibrate& calibrate) {
  try {
    return said(calibrate());
  } catch (const InputError& error) {
    const std::string what = error.what();
    return {"refused", what.substr(0, what.find('\n'))};
  }
}

/// A recording's samples with the sources that they have in a file.
std::vector<Sample> written_and_read(const std::vector<Sample>& samples, const fs::path& file) {
  std::ofstream(file) << [&] {
    std::ostringstream text;
    write_samples(text, samples);
    return text.str();
  }();
  Diagnostics diagnostics;
  std::vector<Sample> read = read_samples(file.string(), diagnostics);
  diagnostics.throw_if_errors();
  return read;
}

class Entrances : public test::ProgramTest {
 protected:
  /// Files of a recording: robot.urdf, calibrate.yaml, samples.yaml, and the samples in a.yaml, b.yaml, c.yaml.
  void write(const Recording& of) {
    std::ofstream(folder_ / "robot.urdf") << of.urdf;
    std::ofstream(folder_ / "calibrate.yaml") << of.config_text;
    samples_ = written_and_read(of.samples, folder_ / "samples.yaml");
    const auto third = static_cast<std::ptrdiff_t>(of.samples.size() / 3);
    const auto begin = of.samples.begin();
    (void)written_and_read({begin, begin + third}, folder_ / "a.yaml");
    (void)written_and_read({begin + third, begin + 2 * third}, folder_ / "b.yaml");
    (void)written_and_read({begin + 2 * third, of.samples.end()}, folder_ / "c.yaml");
  }

  [[nodiscard]] Said of_report(const test::Outcome& run) const {
    std::ifstream file(folder_ / "report.json");
    if (!file) return {"refused", run.err.substr(0, run.err.find('\n'))};
    const nlohmann::json report = nlohmann::json::parse(file);
    const auto& reasons = report["reasons"];
    return {report["verdict"], reasons.empty() ? "" : reason_of(reasons[0].get<std::string>())};
  }
  [[nodiscard]] Said by_program(const std::string& arguments) const {
    fs::remove(folder_ / "report.json");
    return of_report(
        kinecal(arguments + " --urdf robot.urdf --config calibrate.yaml --report report.json"));
  }
  [[nodiscard]] CalibrationSetup setup(const Recording& of) const {
    CalibrationSetup setup = test::setup_of(of);
    setup.samples = samples_;
    return setup;
  }

  [[nodiscard]] Said by_session(const Recording& of) const {
    SessionFollower follower(of.config, parse_urdf(of.urdf, "robot.urdf"), "", of.urdf);
    for (const Sample& sample : samples_) (void)follower.add(sample);
    return said_by([&] { return follower.calibrate_all(); });
  }
  template <class Of>
  [[nodiscard]] Said by_crate(const Recording& of) const {
    return said_by(
        [&]() -> CalibratedRobot { return calibrate_and_judge(Of(), samples_, {}, of.urdf); });
  }

  std::vector<Sample> samples_;
};

/// Compares the entrances on a recording; prints one line.
#define KINECAL_SAME(name, a, b)                                                         \
  EXPECT_TRUE((a) == (b)) << name << "\n  " << (a).grade << ": " << (a).reason << "\n  " \
                          << (b).grade << ": " << (b).reason

constexpr const char* kRecorded[] = {"ur5_offsets", "ur5", "panda", "kuka"};

/// All mistakes of all recordings with KINECAL_REPETITIONS; else every second one, each of one recording, and two where
/// tests are slow.
bool is_tried(std::size_t mistake, std::size_t recording) {
  if (std::getenv("KINECAL_REPETITIONS") != nullptr) return true;
  if (test::kIsSlow) return mistake < 2 && recording == 0;
  return mistake == 0 || mistake % (2 * std::size(kRecorded)) == 2 * recording + 1;
}

TEST_F(Entrances, SayTheSame) {
  KINECAL_NEEDS_RECORDING("kuka");
  std::vector<Mutation> all = test::mutations();
  all.insert(all.begin(), {"nothing_is_wrong", [](Recording&) {}});
  for (std::size_t number = 0; number < std::size(kRecorded); ++number) {
    const Recording right = test::recording(kRecorded[number]);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!is_tried(i, number)) continue;
      Recording wrong = right;
      all[i].change(wrong);
      write(wrong);
      const std::string what = right.name + " " + all[i].name;
      const Said program = by_program("calibrate --dry-run --samples samples.yaml");
      std::printf("%-40s %-14s %s\n", what.c_str(), program.grade.c_str(),
                  program.reason.substr(0, 110).c_str());
      const Said log =
          by_program("calibrate-log --force --output out --samples c.yaml a.yaml b.yaml");
      KINECAL_SAME(what + ", log", program, log);
      KINECAL_SAME(what + ", library", program,
                   said_by([&] { return calibrate_robot(setup(wrong)); }));
      KINECAL_SAME(what + ", session", program, by_session(wrong));
      const bool is_drawn = wrong.urdf == right.urdf;  // the crate has the robot as it is drawn
      if (is_drawn && right.name == "ur5") {
        KINECAL_SAME(what + ", crate", program, by_crate<Full>(wrong));
      }
      if (is_drawn && right.name == "ur5_offsets") {
        KINECAL_SAME(what + ", crate", program, by_crate<Offsets>(wrong));
      }
    }
  }
}

}  // namespace
}  // namespace kinecal
