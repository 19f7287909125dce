// kinecal watch and grade: robots over months, episodes of a data set.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "kinecal/files/samples/write_samples.hpp"
#include "support/arm_scene.hpp"
#include "support/paths.hpp"
#include "support/repetitions.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kDegree = 0.017453292519943295;
constexpr int kSamples = 8;

class Watched : public test::ProgramTest {
 protected:
  Watched() {
    write("arm.urdf", test::kArmUrdf);
    write("c.yaml", test::kArmConfig);
  }
  /// Encoders read less: the joint's offset has grown.
  static void slip(std::vector<Sample>& samples, const std::string& joint, double by) {
    for (Sample& sample : samples) sample.add_to_position(joint, -by);
  }
  void write_as(const std::string& file, const std::vector<Sample>& samples) const {
    std::ostringstream text;
    write_samples(text, samples);
    fs::create_directories((folder_ / file).parent_path());
    write(file, text.str());
  }
  [[nodiscard]] std::vector<Sample> samples(int count, unsigned seed) const {
    return test::arm_samples(robot_, count, seed);
  }
  /// A robot with its result.
  void add_robot(const std::string& name, unsigned seed) const {
    write_as("s.yaml", samples(40, seed));
    const Outcome done =
        kinecal("calibrate --urdf arm.urdf --config c.yaml --samples s.yaml --force --output " +
                name + "/result");
    ASSERT_EQ(done.code, 0) << done.out << done.err;
  }
  /// The recording of a night, that many days ago.
  void add_night(const std::string& name, int days_ago, unsigned seed, double elbow = 0.0) const {
    std::vector<Sample> recorded = samples(kSamples, seed);
    slip(recorded, "elbow", elbow);
    const auto now = std::chrono::system_clock::now().time_since_epoch() - std::chrono::hours(1);
    for (Sample& sample : recorded) sample.stamp = now - std::chrono::hours(24 * days_ago);
    write_as(name + "/recordings/night_" + std::to_string(100 - days_ago) + ".yaml", recorded);
  }
  [[nodiscard]] Outcome watch(const std::string& options = "") const {
    return kinecal("watch fleet --once --settle 0 " + options);
  }
  [[nodiscard]] YAML::Node json(const std::string& file) const { return YAML::Load(read(file)); }

  const Robot robot_ = parse_urdf(test::kArmUrdf, "arm.urdf");
};

/// KINECAL_REPETITIONS=50: fifty robots by a hundred recordings.  One robot drifts, so there are two at least.
TEST_F(Watched, NamesTheOneRobotThatDriftsAndNoOther) {
  const int robots = std::max(2, test::repetitions_of_study(50, 2)),
            nights = robots == 50 ? 100 : 20;
  for (int robot = 0; robot < robots; ++robot) {
    const std::string name = "fleet/arm_" + std::to_string(robot);
    add_robot(name, 100 + static_cast<unsigned>(robot));
    for (int night = 0; night < nights; ++night) {
      const double weeks = night / 7.0;
      add_night(name, nights - night, 1000 + static_cast<unsigned>(robot * nights + night),
                robot == 1 ? 0.05 * kDegree * weeks : 0.0);
    }
  }
  const auto before = std::chrono::steady_clock::now();
  const Outcome found = watch("--report fleet.html --limit 0.3mm");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - before;
  std::printf("%d robots, %d recordings: %.1f s\n%s", robots, robots * nights, seconds.count(),
              found.out.c_str());
  EXPECT_EQ(found.code, 2) << found.out << found.err;
  EXPECT_THAT(found.out,
              AllOf(HasSubstr("arm_1: recalibrate: joint 'elbow' drifts by 0.0"),
                    HasSubstr("deg a week +- "), HasSubstr("'tool' in 'tracker_frame' is off by "),
                    HasSubstr("limit 0.3 mm")));
  EXPECT_THAT(found.out, HasSubstr(std::to_string(robots - 1) + " of " + std::to_string(robots) +
                                   (robots == 2 ? " robots holds" : " robots hold") +
                                   "; recalibrate arm_1\n"));
  EXPECT_THAT(read("fleet.html"), HasSubstr("change since the calibration"));

  const auto again = std::chrono::steady_clock::now();  // nothing is verified again
  EXPECT_EQ(watch("--json --report fleet.json --limit 0.3mm").code, 2);
  std::printf("again: %.1f s\n",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - again).count());
  const YAML::Node report = json("fleet.json")["robots"][1];
  EXPECT_EQ(report["state"].as<std::string>(), "recalibrate");
  EXPECT_EQ(report["recordings"].as<int>(), nights);
  const YAML::Node drift = report["drift"];
  EXPECT_EQ(drift["owner"].as<std::string>(), "elbow");
  EXPECT_NEAR(drift["parameters"][0]["per_week"].as<double>(), 0.05 * kDegree,
              4.0 * drift["parameters"][0]["sigma"].as<double>());
}

TEST_F(Watched, ReadsOnlyWhatIsNewAndWhole) {
  add_robot("fleet/arm", 100);
  EXPECT_THAT(watch().out, AllOf(HasSubstr("arm: not known: no recording yet"),
                                 HasSubstr("\n0 of 1 robot holds; not known: arm\n")));
  add_night("fleet/arm", 3, 1);
  add_night("fleet/arm", 2, 2);
  write("fleet/arm/recordings/night_99.yaml",
        read("fleet/arm/recordings/night_98.yaml").substr(0, 900));
  const Outcome cut = watch();
  EXPECT_EQ(cut.code, 1) << "the newest is refused: " << cut.out;
  EXPECT_THAT(cut.out, HasSubstr("arm: holds: 2 recordings, the last on "));
  EXPECT_THAT(cut.out, HasSubstr("; 1 recording refused, the last 'night_99.yaml': "));
  EXPECT_THAT(watch("--json").out, HasSubstr("\"name\": \"night_99.yaml\""));
  add_night("fleet/arm", 1, 3);
  const Outcome whole = watch();
  EXPECT_EQ(whole.code, 0) << whole.out << whole.err;
  EXPECT_THAT(whole.out, AllOf(HasSubstr("arm: holds: 3 recordings"), Not(HasSubstr("refused"))));
  add_night("fleet/arm", 0, 4);
  EXPECT_THAT(kinecal("watch fleet --once --settle 1000").out,
              HasSubstr("3 recordings, the last on"));
  EXPECT_THAT(kinecal("watch fleet --once --settle 1000").out,
              HasSubstr("; 1 still being written"));
  fs::remove_all(folder_ / "fleet/arm/recordings");
  EXPECT_THAT(watch().out, HasSubstr("arm: holds: 3 recordings")) << "the history has them";

  fs::create_directories(folder_ / "fleet/broken/result");
  EXPECT_THAT(watch().out, HasSubstr("\n1 of 2 robots holds; cannot be checked: broken\n"));

  fs::rename(folder_ / "fleet/broken", folder_ / "fleet/z\nz: holds: all is well");
  EXPECT_THAT(watch().out, Not(HasSubstr("\nz: holds"))) << "a line is of one robot";
  EXPECT_THAT(watch("--limit mm").err, HasSubstr("'mm' has no number"));
  EXPECT_THAT(watch("--limit 0").err, HasSubstr("is no number above 0"));

  write("fleet/history.sqlite",
        "something else, which is certainly not a data base of SQLite, but long enough");
  const Outcome other = watch();
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err,
              HasSubstr("error: fleet/history.sqlite: is not a history of 'kinecal watch'"));
}

TEST_F(Watched, WatchesUntilItIsAskedToEnd) {
  add_robot("fleet/arm", 100);
  add_night("fleet/arm", 1, 1);
  const Outcome asked = test::run_and_send(
      folder_, test::kinecal_program() + " watch fleet --settle 0 --interval 0.1 --json", SIGTERM,
      [&] {
        if (read("out.txt").find("1 recording,") == std::string::npos) return false;
        if (!fs::exists(folder_ / "fleet/arm/recordings/night_100.yaml"))
          add_night("fleet/arm", 0, 2);
        return read("out.txt").find("2 recordings,") != std::string::npos;
      });
  EXPECT_EQ(asked.code, 130) << asked.out << asked.err;
  EXPECT_EQ(std::count(asked.out.begin(), asked.out.end(), '\n'), 2)
      << "a line when something is new: " << asked.out;
}

TEST_F(Watched, SaysWhatMovedUntilTheRobotIsCalibratedAgain) {
  add_robot("fleet/arm", 100);
  add_night("fleet/arm", 5, 1);
  add_night("fleet/arm", 4, 2, 0.004);
  const Outcome moved = watch();
  EXPECT_EQ(moved.code, 2) << moved.out << moved.err;
  EXPECT_THAT(moved.out, HasSubstr("arm: recalibrate: joint 'elbow' has moved by 0.2"));
  fs::create_directories(folder_ / "fleet/copy");
  fs::copy(folder_ / "fleet/arm", folder_ / "fleet/copy", fs::copy_options::recursive);
  EXPECT_THAT(watch().out, HasSubstr("is the same file as 'night_9"));
  fs::remove_all(folder_ / "fleet/copy");
  std::vector<Sample> since = samples(40, 77);
  slip(since, "elbow", 0.004);
  write_as("s.yaml", since);
  ASSERT_EQ(kinecal("calibrate --urdf arm.urdf --config c.yaml --samples s.yaml --force --output "
                    "fleet/arm/result")
                .code,
            0);
  add_night("fleet/arm", 3, 3);
  EXPECT_THAT(watch().out, HasSubstr("was recorded before the result in force"));
  add_night("fleet/arm", -1, 4, 0.004);
  const Outcome now = watch();
  EXPECT_EQ(now.code, 0) << now.out << now.err;
  EXPECT_THAT(now.out, HasSubstr("arm: holds: 1 recording, "));
}

TEST_F(Watched, GradesEpisodes) {
  for (unsigned i = 0; i < 7; ++i) {
    std::vector<Sample> episode = samples(10, 50 + i);
    if (i == 4) slip(episode, "flex", 0.01);
    if (i == 5) {
      for (Sample& sample : episode) {  // the tracker was bumped
        for (Feature& feature : sample.observations[1].features) feature.point.x() += 0.004;
      }
    }
    write_as("episodes/e" + std::to_string(i) + ".yaml", episode);
  }
  const Outcome alone = kinecal("grade episodes --urdf arm.urdf --config c.yaml --report g.json");
  EXPECT_EQ(alone.code, 2) << alone.out << alone.err;
  EXPECT_THAT(alone.out, AllOf(HasSubstr("e3.yaml: consistent"),
                               HasSubstr("e4.yaml: not consistent: joint 'flex' by 0.5"),
                               HasSubstr("e5.yaml: not consistent: frame 'tracker_frame' by "),
                               HasSubstr("5 of 7 episodes consistent\n")));
  EXPECT_EQ(json("g.json")["not_consistent"].as<int>(), 2);
  const std::string bad = read("episodes/e4.yaml");
  for (const char* copy : {"f0", "f1", "f2", "f3", "f4", "f5", "f6", "f7"}) {
    write(std::string("episodes/") + copy + ".yaml", bad);
  }
  const Outcome copies = kinecal("grade episodes --urdf arm.urdf --config c.yaml");
  EXPECT_THAT(copies.err, HasSubstr("f7.yaml is a copy of episodes/e4.yaml: it counts once"));
  EXPECT_THAT(copies.out,
              AllOf(HasSubstr("e3.yaml: consistent"), HasSubstr("f7.yaml: not consistent"),
                    HasSubstr("5 of 15 episodes consistent\n")));
  for (const char* copy : {"f0", "f1", "f2", "f3", "f4", "f5", "f6", "f7"}) {
    fs::remove(folder_ / "episodes" / (std::string(copy) + ".yaml"));
  }
  EXPECT_THAT(kinecal("grade episodes/e1.yaml --urdf arm.urdf --config c.yaml").err,
              HasSubstr("one episode, and none to be compared with others"));
  add_robot("robot", 100);
  fs::remove(folder_ / "episodes/e4.yaml");
  write("episodes/e5.yaml", "[");
  const Outcome given = kinecal("grade episodes --result robot/result");
  EXPECT_EQ(given.code, 1) << given.out << given.err;
  EXPECT_THAT(given.out, HasSubstr("5 of 6 episodes consistent, 1 refused\n"));
  EXPECT_EQ(kinecal("grade episodes").code, 1);
}

}  // namespace
}  // namespace kinecal
