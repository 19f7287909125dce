// Targets that the tip of an arm touches: which zeros they show, and that a calibration finds these with ± that cover.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/tools/init/determined_offsets.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/several_answers.hpp"
#include "support/paths.hpp"
#include "support/repetitions.hpp"
#include "support/two_arms.hpp"

namespace kinecal {
namespace {

constexpr InitTarget kTouched[] = {InitTarget::point,    InitTarget::sockets, InitTarget::plane,
                                   InitTarget::line,     InitTarget::sphere,  InitTarget::bar,
                                   InitTarget::distance, InitTarget::gravity};
constexpr double kTipNoise = 2e-4;  // of the tip's place, metres

/// An arm of the examples, whose zeros are wrong, with a tip that is not in its URDF.
class TouchingArm {
 public:
  /// @param carrier  link of what is touched, or the other hand; empty: the base
  /// @param at       a known place on it, metres
  TouchingArm(Robot robot, std::string arm, std::string carrier = {},
              std::optional<Vector3<double>> at = {})
      : robot_(std::move(robot)), arm_(std::move(arm)), carrier_(std::move(carrier)), at_(at) {}

  [[nodiscard]] const Robot& robot() const { return robot_; }
  [[nodiscard]] InitAnswers answers(InitTarget target) const {
    InitAnswers answers;
    answers.target = target;
    answers.arm = arm_;
    answers.carrier = carrier_;
    answers.at = at_;
    if (target == InitTarget::bar) answers.length = 0.2;
    std::vector<std::string> arms = {arm_};
    if (!more_.empty()) arms.push_back(more_);
    return with_proposals(robot_, answers_of_all(robot_, answers, arms, {}).front());
  }
  [[nodiscard]] MeasuredTarget measured(InitTarget target) const {
    MeasuredTarget touched{answers(target).base, arm_, answers(target).carrier};
    const bool is_grip = target == InitTarget::grip;
    touched.target_frame = is_grip ? "" : "tip";
    touched.is_point = target != InitTarget::distance && !is_grip;
    touched.sensor_frame = at_ ? "" : "place";
    if (at_) touched.layout = {*at_};
    if (!more_.empty()) touched.more_tips = {{more_, "other_tip"}};
    touched.contact = target == InitTarget::plane      ? Contact::plane
                      : target == InitTarget::distance ? Contact::plane
                      : target == InitTarget::gravity  ? Contact::gravity
                      : target == InitTarget::grip     ? Contact::grip
                      : target == InitTarget::line     ? Contact::line
                      : target == InitTarget::sphere   ? Contact::sphere
                      : target == InitTarget::bar      ? Contact::sphere
                                                       : Contact::point;
    touched.places = target == InitTarget::sockets ? 2 : 1;
    touched.radius_known = target == InitTarget::bar;
    return touched;
  }
  /// Joints whose zeros a target shows, of all that move the arm: "01111 0".
  [[nodiscard]] std::string shown(InitTarget target) const {
    const MeasuredTarget touched = measured(target);
    std::string text;
    for (const OffsetEffect& effect :
         offset_effects(robot_, touched, {}, driven_joints(robot_, touched)).offsets) {
      text += effect.determined ? 'x' : '-';
    }
    return text;
  }

  /// Samples as an arm records them whose joints are off by wrong().
  /// @param noise  of the tip's place, metres
  [[nodiscard]] std::vector<Sample> samples(InitTarget target, unsigned seed, double noise) {
    std::mt19937 random(seed);
    const MeasuredTarget touched = measured(target);
    const InitAnswers named = answers(target);
    std::vector<Sample> all;
    wrong_.clear();
    for (const std::string& joint : driven_joints(robot_, touched)) {
      wrong_[joint] = std::uniform_real_distribution<double>(-0.03, 0.03)(random);
    }
    std::normal_distribution<double> jitter(0.0, noise / 0.5);  // radians, half a metre away
    std::size_t number = 0;
    const auto [known, is_new] = poses_.try_emplace(target);
    if (is_new)
      known->second = touching_poses(near_ ? *near_ : robot_, patch_ ? *patch_ : touched, 60, 1);
    const TouchingPoses& poses = known->second;
    for (const auto& pose : poses.positions) {
      const double distance = poses.distances.empty() ? 0.0 : poses.distances.at(number);
      Sample& sample = all.emplace_back();
      for (const auto& [joint, position] : pose) {
        sample.joint_names.push_back(joint);
        sample.joint_positions.push_back(position - wrong_.at(joint) + jitter(random));
      }
      if (target == InitTarget::gravity) {
        const Pose<double> hand = forward_kinematics(
            make_chain(robot_, named.base, arm_), [&](const std::string& j) { return pose.at(j); });
        const Matrix3<double> turned = hand.rotation * exp(Vector3<double>(0.4, -0.9, 1.3));
        // A base that leans, and a scale that is 1 % off.
        const Vector3<double> read = turned.transpose() * Vector3<double>(0.2, -0.1, 9.9);
        for (int k = 0; k < 3; ++k) {
          sample.conditions[std::string("a") + "xyz"[k]] = read(k) + 20.0 * jitter(random);
        }
        sample.observations = {
            {"arm", {{named.target_frame, Vector3<double>::Zero(), Matrix3<double>::Identity()}}}};
        continue;
      }
      const std::size_t tip_number = poses.tips.at(number);
      const FurtherArm more = tip_number > 0 ? named.more_arms.at(tip_number - 1)
                                             : FurtherArm{holder_of(named), named.target_frame};
      const std::string& place = named.places.at(number++ % named.places.size());
      Feature held{place, Vector3<double>::Zero()};
      Feature tip{more.target_frame, Vector3<double>(0.0, 0.0, distance)};
      if (touched.contact == Contact::plane || touched.contact == Contact::line ||
          touched.contact == Contact::grip) {
        held.rotation = tip.rotation = Matrix3<double>::Identity();
      }
      sample.observations = {{more.arm, {tip}}, {"touched", {held}}};
    }
    return all;
  }
  [[nodiscard]] const std::map<std::string, double>& wrong() const { return wrong_; }
  /// Where what is touched is in its link in these samples.
  [[nodiscard]] const Pose<double>& place(InitTarget target) const {
    return poses_.at(target).sensor_T_touched;
  }

  /// From now on, the tip of another arm touches the same in every second pose.
  void touch_with(const std::string& more) { more_ = more; }

  /// From now on, all joints stay near the middle of their ranges.
  /// @param most  radians from there
  void stay_near_one_pose(double most) {
    std::vector<Joint> joints = robot_.joints();
    for (Joint& joint : joints) {
      if (!moves(joint.type) || !joint.limits) continue;
      const double middle = 0.5 * (joint.limits->lower + joint.limits->upper);
      joint.limits->lower = middle - most;
      joint.limits->upper = middle + most;
    }
    near_ = Robot(robot_.name(), joints);
    poses_.clear();
  }

  /// From now on, the tip stays in a square on the plane that it touches.
  /// @param side  metres
  void stay_within(double side) {
    patch_ = measured(InitTarget::plane);
    patch_->contact = Contact::point;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> within(0.0, side);
    for (int i = 0; i < 60; ++i) {
      const double x = within(random);
      patch_->layout.emplace_back(x, within(random), 0.0);
    }
    poses_.clear();
  }

  [[nodiscard]] CalibratedRobot calibrated(InitTarget target, std::vector<Sample> samples) const {
    Diagnostics diagnostics;
    const std::string text = initial_config(robot_, answers(target));
    return calibrate_robot({.robot = robot_,
                            .config = parse_config(text, "calibrate.yaml", diagnostics),
                            .samples = std::move(samples)});
  }

 private:
  Robot robot_;
  std::string arm_, carrier_, more_;
  std::optional<Vector3<double>> at_;
  std::optional<Robot> near_;            ///< with narrower limits, for the poses
  std::optional<MeasuredTarget> patch_;  ///< instead of a whole plane
  std::map<InitTarget, TouchingPoses> poses_;
  std::map<std::string, double> wrong_;  ///< by joint: true minus recorded position
};

Robot shipped(const std::string& name) {
  return read_urdf(test::source_folder() + "/examples/robots/" + name + "/" + name + ".urdf");
}
TouchingArm six_joints() {
  return {shipped("ur5e"), "tool0"};
}
TouchingArm seven_joints() {
  return {shipped("panda"), "panda_hand"};
}

TouchingArm two_arms(std::size_t joints) {
  return {parse_urdf(test::TwoArms::urdf(joints), "two_arms.urdf"), "left_hand", "right_hand"};
}

/// The largest error of a zero, in its ±, and the sum of squares.
struct Errors {
  double worst = 0.0, sum = 0.0;
  int count = 0;
};
Errors errors_of(const TouchingArm& arm, const CalibratedRobot& found) {
  Errors errors;
  for (const auto& [joint, wrong] : arm.wrong()) {
    const int parameter = found.result.table.find(joint);
    const auto deviation = found.assessments.back().deviation(parameter);
    if (!deviation) continue;
    const double off = (found.result.table[parameter].value - wrong) / *deviation;
    errors.worst = std::max(errors.worst, std::abs(off));
    errors.sum += off * off;
    ++errors.count;
  }
  return errors;
}

TEST(TouchedTargets, ShowAllZerosButTheFirstAndTheLast) {
  std::cout << "zeros shown (x) by what the tip touches\n";
  for (const InitTarget target : kTouched) {
    const std::string six = six_joints().shown(target), seven = seven_joints().shown(target);
    std::cout << fmt::format("  {:8} {:8} {:8}\n", to_string(target), six, seven);
    // Three axes of a UR5e are parallel: gravity shows the sum of their zeros.
    EXPECT_EQ(six, target == InitTarget::gravity ? "-x--x-" : "-xxxx-") << to_string(target);
    EXPECT_EQ(seven, "-xxxxx-") << to_string(target);
  }
}

TEST(TouchedTargets, AreConfigurationsWithoutAWarning) {
  for (const InitTargetWord& word : kInitTargets) {
    if (!is_touched(word.target)) continue;
    const bool is_grip = word.target == InitTarget::grip;
    for (const TouchingArm& arm :
         {is_grip ? two_arms(6) : six_joints(), is_grip ? two_arms(7) : seven_joints()}) {
      Diagnostics diagnostics;
      (void)parse_config(initial_config(arm.robot(), arm.answers(word.target)), "calibrate.yaml",
                         diagnostics);
      EXPECT_THAT(diagnostics.errors, testing::IsEmpty()) << word.word;
      EXPECT_THAT(diagnostics.warnings, testing::IsEmpty()) << word.word;
    }
  }
}

class TouchedTarget : public testing::TestWithParam<InitTarget> {};

TEST_P(TouchedTarget, FindsTheZerosWithPlusMinusThatCover) {
  double sum = 0.0;
  int count = 0;
  // Gravity shows the sum of three zeros of a UR5e.
  std::vector<TouchingArm> arms = {seven_joints()};
  if (GetParam() != InitTarget::gravity) arms.push_back(six_joints());
  for (TouchingArm& arm : arms) {
    for (unsigned seed = 1; seed <= static_cast<unsigned>(test::repetitions(4, 2)); ++seed) {
      const std::vector<Sample> samples = arm.samples(GetParam(), seed, kTipNoise);
      ASSERT_GE(samples.size(), 20u);
      const CalibratedRobot found = arm.calibrated(GetParam(), samples);
      EXPECT_TRUE(found.is_usable()) << found.judgement.reasons.front();
      const Errors errors = errors_of(arm, found);
      EXPECT_LE(errors.worst, 6.0) << "seed " << seed;
      sum += errors.sum;
      count += errors.count;
    }
  }
  ASSERT_GT(count, 0);
  std::cout << fmt::format("{}: error over its ±, rms {:.2f} of {}\n", to_string(GetParam()),
                           std::sqrt(sum / count), count);
  EXPECT_LE(sum / count, 2.5);
}

/// One hand's tip in a cone in the other hand: the zeros of both arms but those of the shoulders' first axes, which turn the
/// robot as a whole, or the last ones.
TEST(TouchedTargets, TwoHandsThatTouchShowTheZerosOfBothArms) {
  double sum = 0.0;
  int count = 0;
  TouchingArm arms = two_arms(6);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<Sample> samples = arms.samples(InitTarget::point, seed, kTipNoise);
    const CalibratedRobot found = arms.calibrated(InitTarget::point, samples);
    EXPECT_TRUE(found.is_usable()) << found.judgement.reasons.front();
    const Errors errors = errors_of(arms, found);
    EXPECT_GE(errors.count, 8);
    EXPECT_LE(errors.worst, 6.0) << "seed " << seed;
    sum += errors.sum;
    count += errors.count;
  }
  std::cout << fmt::format("two hands: error over its ±, rms {:.2f} of {}\n",
                           std::sqrt(sum / count), count);
  EXPECT_LE(sum / count, 2.5);
}

/// Two arms of one torso, each with a tip, in the same two sockets of the world: the first zeros, too, as the width of the torso
/// is known.
TEST(TouchedTargets, TwoArmsInTheSameSocketsAreOneCalibration) {
  TouchingArm arms(parse_urdf(test::TwoArms::urdf(7), "two_arms.urdf"), "left_hand");
  arms.touch_with("right_hand");
  EXPECT_EQ(arms.shown(InitTarget::sockets), "xxxxxx-xxxxxx-");
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(test::repetitions(6, 3)); ++seed) {
    const std::vector<Sample> samples = arms.samples(InitTarget::sockets, seed, kTipNoise);
    ASSERT_GE(samples.size(), 40u);
    const CalibratedRobot found = arms.calibrated(InitTarget::sockets, samples);
    EXPECT_TRUE(found.is_usable()) << found.judgement.reasons.front();
    const Errors errors = errors_of(arms, found);
    EXPECT_EQ(errors.count, 12);
    EXPECT_LE(errors.worst, 6.0) << "seed " << seed;
    sum += errors.sum;
    count += errors.count;
  }
  ASSERT_GT(count, 0);
  std::cout << fmt::format("two arms in the same sockets: error over its ±, rms {:.2f} of {}\n",
                           std::sqrt(sum / count), count);
  EXPECT_LE(sum / count, 2.5);
}

/// Both hands hold one board, which nobody sees: the zeros of both arms but the last ones, which turn the board in the hand.
TEST(TouchedTargets, OneThingInBothHandsShowsTheZerosOfBothArms) {
  std::cout << "zeros shown (x) by one thing in both hands\n";
  for (const std::size_t joints : {6u, 7u}) {
    const std::string shown = two_arms(joints).shown(InitTarget::grip);
    std::cout << fmt::format("  {} joints each: {}\n", joints, shown);
    const std::string arm = std::string(joints - 1, 'x') + '-';
    EXPECT_EQ(shown, arm + arm);
  }
}

TEST(TouchedTargets, OneThingInBothHandsFindsTheZerosWithPlusMinusThatCover) {
  for (const std::size_t joints : {6u, 7u}) {
    TouchingArm arms = two_arms(joints);
    double sum = 0.0, off = 0.0, apart = 0.0;
    int count = 0;
    const int draws = test::repetitions(5, 2);
    for (int seed = 1; seed <= draws; ++seed) {
      const std::vector<Sample> samples =
          arms.samples(InitTarget::grip, static_cast<unsigned>(seed), kTipNoise);
      ASSERT_GE(samples.size(), 20u);
      const CalibratedRobot found = arms.calibrated(InitTarget::grip, samples);
      EXPECT_TRUE(found.is_usable()) << found.judgement.reasons.front();
      const Errors errors = errors_of(arms, found);
      EXPECT_EQ(errors.count, static_cast<int>(2 * joints - 2));
      EXPECT_LE(errors.worst, 6.0) << "seed " << seed;
      sum += errors.sum;
      count += errors.count;
      for (const auto& [joint, wrong] : arms.wrong()) {
        const int parameter = found.result.table.find(joint);
        if (!found.assessments.back().deviation(parameter)) continue;
        off += std::pow(found.result.table[parameter].value - wrong, 2);
      }
      // The last joints, which are held, turn the pose of one hand in the other; their axes are the x axes of the hands.
      const Pose<double>& truth = arms.place(InitTarget::grip);
      const ParameterTable& table = found.result.table;
      const Vector3<double> at(table["grip_x"].value, table["grip_y"].value, table["grip_z"].value);
      apart += std::pow(at.norm() - truth.translation.norm(), 2);
    }
    ASSERT_GT(count, 0);
    std::cout << fmt::format(
        "one thing in both hands, {} joints each: error over its ±, rms {:.2f} of {}; zeros {:.3f} "
        "deg rms; distance of the hands {:.3f} mm rms\n",
        joints, std::sqrt(sum / count), count, std::sqrt(off / count) * 180.0 / std::numbers::pi,
        1e3 * std::sqrt(apart / draws));
    EXPECT_LE(sum / count, 2.5);
  }
}

/// A bore of the robot's own base, whose place is known: the first joint, too, as nothing turns with it.
TEST(TouchedTargets, AKnownPlaceOnTheOwnBodyShowsTheFirstZeroToo) {
  const Vector3<double> at(0.35, 0.2, 0.1);
  double sum = 0.0;
  int count = 0;
  for (TouchingArm arm : {TouchingArm(shipped("ur5e"), "tool0", "", at),
                          TouchingArm(shipped("panda"), "panda_hand", "", at)}) {
    const std::string shown = arm.shown(InitTarget::point);
    EXPECT_EQ(shown, std::string(shown.size() - 1, 'x') + '-');
    for (unsigned seed = 1; seed <= static_cast<unsigned>(test::repetitions(4, 2)); ++seed) {
      const std::vector<Sample> samples = arm.samples(InitTarget::point, seed, kTipNoise);
      ASSERT_GE(samples.size(), 20u);
      const CalibratedRobot found = arm.calibrated(InitTarget::point, samples);
      EXPECT_TRUE(found.is_usable()) << found.judgement.reasons.front();
      const Errors errors = errors_of(arm, found);
      EXPECT_EQ(errors.count, static_cast<int>(shown.size()) - 1);
      EXPECT_LE(errors.worst, 6.0) << "seed " << seed;
      sum += errors.sum;
      count += errors.count;
    }
  }
  std::cout << fmt::format("a known place on the base: error over its ±, rms {:.2f} of {}\n",
                           std::sqrt(sum / count), count);
  EXPECT_LE(sum / count, 2.5);
}

/// What a plane shows is by how far the joints move, not by its size: a square of 10 cm with the tool turned all ways shows
/// nearly what a whole plane does; joints that stay near one pose do not, and ± say so.
TEST(TouchedTargets, APlaneTouchedFromOnePoseHasLargePlusMinus) {
  const auto uncertain = [](const char* where, TouchingArm arm) {
    const CalibratedRobot found =
        arm.calibrated(InitTarget::plane, arm.samples(InitTarget::plane, 1, kTipNoise));
    double sum = 0.0;
    int count = 0;
    for (const auto& [joint, wrong] : arm.wrong()) {
      const auto deviation = found.assessments.back().deviation(found.result.table.find(joint));
      if (!deviation) continue;
      sum += *deviation * *deviation;
      ++count;
    }
    const double root = count > 0 ? std::sqrt(sum / count) : 0.0;
    std::cout << fmt::format(
        "  {:24} ± of {} zeros {:.4f} deg; {}{}\n", where, count, root * 180.0 / std::numbers::pi,
        to_string(found.judgement.verdict),
        found.judgement.reasons.empty() ? "" : ": " + found.judgement.reasons.front());
    EXPECT_LE(errors_of(arm, found).worst, 6.0) << where;
    return std::pair(root, count);
  };
  TouchingArm square = seven_joints(), near = seven_joints();
  square.stay_within(0.1);
  constexpr double kNear = 0.3;  // radians
  near.stay_near_one_pose(kNear);
  std::cout << "a plane, touched\n";
  const auto [whole, all] = uncertain("anywhere", seven_joints());
  const auto [in_square, all_in_square] = uncertain("in a square of 10 cm", square);
  const auto [near_one, shown] = uncertain("with joints within 17 deg", near);
  EXPECT_EQ(all, 5);
  EXPECT_EQ(all_in_square, 5);
  EXPECT_GT(in_square, whole);
  EXPECT_TRUE(shown < all || near_one > 5.0 * whole);
}

/// The tool's centre point from few poses: ± that cover; beside it the formula of pendants, the least-squares solution of
/// R t - c = -p, which gives no ±.
TEST(TouchedTargets, TheToolsCenterPointHasPlusMinusThatCover) {
  std::cout << "poses  error (mm)  pendant's (mm)  error / ±\n";
  TouchingArm arm = six_joints();
  const MeasuredTarget touched = arm.measured(InitTarget::tool);
  const RuntimeChain to_hand = make_chain(arm.robot(), touched.base, touched.target);
  for (const std::size_t poses : {4u, 10u, 40u}) {
    double sum = 0.0, off = 0.0, of_pendant = 0.0;
    const int count = test::repetitions(30, 10);
    for (int seed = 1; seed <= count; ++seed) {
      std::vector<Sample> samples =
          arm.samples(InitTarget::tool, static_cast<unsigned>(seed), kTipNoise);
      samples.resize(poses);
      Eigen::MatrixXd left(3 * poses, 6);
      Eigen::VectorXd right(3 * poses);
      for (std::size_t i = 0; i < poses; ++i) {
        for (std::size_t j = 0; j < samples[i].joint_names.size();
             ++j) {  // the joints are right here
          samples[i].joint_positions[j] += arm.wrong().at(samples[i].joint_names[j]);
        }
        const Pose<double> hand = forward_kinematics(
            to_hand, [&](const std::string& joint) { return *samples[i].position(joint); });
        const auto row = static_cast<Eigen::Index>(3 * i);
        left.block<3, 3>(row, 0) = hand.rotation;
        left.block<3, 3>(row, 3) = -Matrix3<double>::Identity();
        right.segment<3>(row) = -hand.translation;
      }
      const Vector3<double> pendant = left.householderQr().solve(right).head<3>();
      const CalibratedRobot found = arm.calibrated(InitTarget::tool, samples);
      const ParameterTable& table = found.result.table;
      const Vector3<double> truth = 0.1 * Vector3<double>(0.5, -0.6, 0.7);
      of_pendant += (pendant - truth).squaredNorm();
      for (int k = 0; k < 3; ++k) {
        const std::string name = std::string("tip_") + "xyz"[k];
        const double error = table[name].value - truth(k);
        const auto deviation = found.assessments.back().deviation(table.find(name));
        ASSERT_TRUE(deviation.has_value());
        off += error * error;
        sum += error * error / (*deviation * *deviation);
      }
    }
    std::cout << fmt::format("{:5}  {:10.3f}  {:14.3f}  {:9.2f}\n", poses,
                             1e3 * std::sqrt(off / count), 1e3 * std::sqrt(of_pendant / count),
                             std::sqrt(sum / (3.0 * count)));
    EXPECT_LE(std::sqrt(off), 1.1 * std::sqrt(of_pendant));
    EXPECT_LE(sum / (3.0 * count), poses == 4 ? 4.0 : 2.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, TouchedTarget, testing::ValuesIn(kTouched),
                         [](const auto& of) { return std::string(to_string(of.param)); });

}  // namespace
}  // namespace kinecal
