// What init leaves out does not bias a calibration: generated robots with rails, lifts, slides,
// mimic joints and tilted shoulders, followed by a tracker.  Every zero of such a robot is wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "support/repetitions.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

/// Writes URDFs of robots that are joints in a row.
class RobotGenerator {
 public:
  explicit RobotGenerator(unsigned seed) : random_(seed) {}

  double number(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  bool chance(double probability) { return number(0.0, 1.0) < probability; }

  std::string urdf() {
    text_ = "<robot name='generated'>\n";
    link("base");
    if (chance(0.3)) side_ = "crank", crank();
    if (chance(0.4)) slide(chance(0.5) ? "1 0 0" : "0 1 0", number(0.05, 2.0), 0.0);
    if (chance(0.3)) slide("0 1 0", number(0.05, 1.0), 0.0);
    if (chance(0.5)) slide("0 0 1", number(0.05, 0.6), 0.0);
    turn("0 0 1", chance(0.5) ? 0.0 : number(0.05, 1.0), true);
    turn("0 1 0", 0.0, false);
    if (chance(0.4)) {
      mimic("revolute", "0 1 0", chance(0.5) ? last_turn_ : first_turn_, chance(0.5) ? -1.0 : 0.5);
    } else {
      turn(chance(0.7) ? "0 1 0" : "1 0 0", 0.0, false);
    }
    if (!side_.empty()) mimic("revolute", "0 0 1", side_, 0.7);
    if (chance(0.3)) telescope();
    turn("1 0 0", 0.0, true);
    turn("0 1 0", chance(0.3) ? number(0.1, 0.8) : 0.0, false);
    if (chance(0.7)) turn("1 0 0", 0.0, true);
    if (chance(0.15)) slide("1 0 0", 0.1, 0.0);
    return text_ + "</robot>\n";
  }
  [[nodiscard]] std::string tip() const { return fmt::format("link_{}", count_); }

 private:
  void link(const std::string& name) { text_ += fmt::format("<link name='{}'/>\n", name); }

  void joint(const std::string& type, const std::string& axis, double tilt, double lower,
             double upper, const std::string& more = "") {
    const std::string parent = count_ == 0 ? "base" : tip();
    ++count_;
    link(tip());
    text_ += fmt::format(
        "<joint name='joint_{}' type='{}'><parent link='{}'/><child link='{}'/>"
        "<origin xyz='{} {} {}' rpy='{} 0 0'/><axis xyz='{}'/>"
        "<limit lower='{}' upper='{}' effort='1' velocity='1'/>{}</joint>\n",
        count_, type, parent, tip(), number(0.0, 0.3), number(-0.05, 0.05), number(0.1, 0.4), tilt,
        axis, lower, upper, more);
  }
  void turn(const std::string& axis, double tilt, bool is_wide) {
    const double range = number(0.6, is_wide ? 2.8 : 1.6);
    joint("revolute", axis, tilt, -range, range);
    last_turn_ = fmt::format("joint_{}", count_);
    if (first_turn_.empty()) first_turn_ = last_turn_;
  }
  void slide(const std::string& axis, double length, double tilt) {
    joint("prismatic", axis, tilt, 0.0, length);
  }
  void mimic(const std::string& type, const std::string& axis, const std::string& of,
             double multiplier) {
    joint(type, axis, 0.0, -3.0, 3.0,
          fmt::format("<mimic joint='{}' multiplier='{}'/>", of, multiplier));
  }
  void telescope() {
    slide("1 0 0", number(0.05, 0.3), 0.0);
    const std::string first = fmt::format("joint_{}", count_);
    for (int more = chance(0.5) ? 1 : 3; more > 0; --more) mimic("prismatic", "1 0 0", first, 1.0);
  }
  /// A motor beside the chain, which a joint of the chain follows.
  void crank() {
    link("crank_link");
    text_ +=
        "<joint name='crank' type='revolute'><parent link='base'/><child link='crank_link'/>"
        "<axis xyz='0 0 1'/><limit lower='-1.2' upper='1.2' effort='1' velocity='1'/></joint>\n";
  }

  std::mt19937 random_;
  std::string text_, side_, first_turn_, last_turn_;
  int count_ = 0;
};

/// A generated robot that is not as its URDF says, and a tracker.
class GeneratedRobot {
 public:
  explicit GeneratedRobot(unsigned seed) : generator_(seed) {
    urdf_ = generator_.urdf();
    robot_ = parse_urdf(urdf_, "generated.urdf");
    to_tip_ = make_chain(robot_, "base", generator_.tip());
    const auto either = [&](double size) { return generator_.chance(0.5) ? size : -size; };
    for (const Joint& joint : robot_.joints()) {
      if (moves(joint.type) && !joint.mimic) {
        truth_.emplace_back(joint.name, either(turns(joint.type) ? 0.02 : 0.003));
      }
    }
    base_T_tracker_ = {exp(Vector3<double>(0.3, -0.2, 1.0)), {3.0, -2.0, 0.5}};
  }

  [[nodiscard]] const Robot& robot() const { return robot_; }
  [[nodiscard]] const std::string& urdf() const { return urdf_; }
  [[nodiscard]] InitAnswers answers() const {
    InitAnswers answers;
    answers.target = InitTarget::tracker;
    answers.arm = generator_.tip();
    return answers;
  }

  std::vector<Sample> samples(int count) {
    std::vector<Sample> all(static_cast<std::size_t>(count));
    for (Sample& sample : all) {
      std::map<std::string, double> at;
      for (const auto& [name, offset] : truth_) {
        const JointLimits limits = *robot_.joint(name).limits;
        sample.joint_names.push_back(name);
        sample.joint_positions.push_back(generator_.number(limits.lower, limits.upper));
        at[name] = sample.joint_positions.back() + offset;
      }
      const Pose<double> base_T_tip =
          forward_kinematics(to_tip_, [&](const std::string& name) { return at.at(name); });
      const Vector3<double> seen =
          base_T_tracker_.inverse() * (base_T_tip * Vector3<double>(0.05, 0.02, 0.08));
      sample.observations = {{"arm", {{"smr", {0.0, 0.0, 0.0}}}},
                             {"tracker", {{"tracker_frame", seen}}}};
    }
    return all;
  }

  /// The largest distance between where a result has the reflector and where it is, metres.
  [[nodiscard]] double worst(const ParameterTable& table, const std::vector<Sample>& where) const {
    const Eigen::VectorXd values = table.values();
    const auto value = [&](const std::string& name) {
      const int index = table.find(name);
      return index < 0 ? 0.0 : values(index);
    };
    const auto part = [&](const std::string& frame, const char* axes) {
      return Vector3<double>(value(frame + "_" + axes[0]), value(frame + "_" + axes[1]),
                             value(frame + "_" + axes[2]));
    };
    const Pose<double> base_T_tracker{exp(part("tracker_frame", "abc")),
                                      part("tracker_frame", "xyz")};
    double most = 0.0;
    for (const Sample& sample : where) {
      const Pose<double> base_T_tip = forward_kinematics(
          to_tip_, [&](const std::string& name) { return *sample.position(name) + value(name); });
      const Vector3<double> seen = sample.observations[1].features[0].point;
      most = std::max(most, (base_T_tip * part("smr", "xyz") - base_T_tracker * seen).norm());
    }
    return most;
  }

 private:
  RobotGenerator generator_;
  std::string urdf_;
  Robot robot_;
  RuntimeChain to_tip_;
  std::vector<std::pair<std::string, double>> truth_;
  Pose<double> base_T_tracker_;
};

/// The calibration that init writes for a robot.
Calibration initial_calibration(const std::string& text, const Robot& robot,
                                const std::vector<Sample>& samples) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "calibrate.yaml";
  std::ofstream(path) << text;
  Diagnostics diagnostics;
  Calibration calibration =
      assemble(read_config(path.string(), diagnostics), robot, samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
  return calibration;
}

TEST(GeneratedRobots, AreNotBiasedByWhatInitLeavesOut) {
  // An offset that init leaves out may move points by 0.01 mm for each degree; these have more than
  // one.  What is left of an offset of 0.02 rad that should have been freed is 20 times as much.
  constexpr double kUnbiased = 5e-5;
  const int count = test::repetitions(300, 12);
  for (int seed = 1; seed <= count; ++seed) {
    GeneratedRobot generated(static_cast<unsigned>(seed));
    const std::string text = initial_config(generated.robot(), generated.answers());
    const std::vector<Sample> samples = generated.samples(80), others = generated.samples(40);
    const Calibration calibration = initial_calibration(text, generated.robot(), samples);
    const CalibrationResult result = calibrate(calibration);
    ASSERT_LE(generated.worst(result.table, samples), kUnbiased) << "robot " << seed << "\n"
                                                                 << generated.urdf() << text;
    ASSERT_LE(generated.worst(result.table, others), kUnbiased) << "robot " << seed << "\n"
                                                                << generated.urdf() << text;
    const CalibrationStep& step = calibration.steps.front();
    const Eigen::VectorXd values = result.table.values();
    const Observability found = observability(
        *step.problem, step.free, std::span(values.data(), values.data() + values.size()));
    if (text.find("restrict_smr") == std::string::npos) {
      EXPECT_EQ(found.unobservable.size(), 0u) << "robot " << seed << "\n"
                                               << generated.urdf() << text;
    }
  }
}

}  // namespace
}  // namespace kinecal
