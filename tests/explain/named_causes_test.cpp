// Mistakes in real recordings and what is named first: a table, and limits on it.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <random>
#include <regex>

#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/repetitions.hpp"
#include "support/spoiled_robot.hpp"
#include "support/wrong_recordings.hpp"

namespace kinecal {
namespace {

using test::Recording;

/// A mistake and a word of what is right to say of it.
struct Named {
  std::string name;
  test::Change change;
  std::string expected;  ///< regular expression
};

/// Numbers of the joints whose positions reach over more than half a radian: those of arms.
std::vector<std::size_t> swinging(const Recording& of) {
  constexpr double kWide = 0.5;
  std::vector<std::size_t> numbers;
  for (std::size_t j = 0; j < of.samples[0].joint_positions.size(); ++j) {
    const auto [least, most] = std::minmax_element(
        of.samples.begin(), of.samples.end(), [&](const Sample& a, const Sample& b) {
          return a.joint_positions[j] < b.joint_positions[j];
        });
    if (most->joint_positions[j] - least->joint_positions[j] > kWide) numbers.push_back(j);
  }
  return numbers;
}

test::Change each(const std::function<void(Sample&)>& change) {
  return [=](Recording& of) { std::for_each(of.samples.begin(), of.samples.end(), change); };
}

/// The positions of other samples in the order of these.
test::Change rows(const std::function<std::size_t(std::size_t i, std::size_t count)>& from) {
  return [=](Recording& of) {
    const std::vector<Sample> right = of.samples;
    for (std::size_t i = 0; i < right.size(); ++i)
      of.samples[i].joint_positions =
          right[std::min(from(i, right.size()), right.size() - 1)].joint_positions;
  };
}

/// Mistakes that leave no good fit.
std::vector<Named> mistakes(const Recording& of) {
  const std::vector<std::size_t> joint = swinging(of);
  const auto name = [&](std::size_t j) { return "'" + of.samples[0].joint_names[joint[j]] + "'"; };
  std::vector<Named> all;
  const auto signs = [&](std::vector<std::size_t> joints) {
    std::string label = "signs", expected;
    for (const std::size_t j : joints) label += "_" + std::to_string(j + 1);
    do {  // named in the order of the robot
      expected += expected.empty() ? "" : "|";
      for (const std::size_t j : joints) expected += name(j) + ".*";
      expected += "negated";
    } while (std::next_permutation(joints.begin(), joints.end()));
    for (std::size_t& j : joints) j = joint[j];
    // Limits show one sign alone, too.
    if (joints.size() == 1)
      expected += "|'" + of.samples[0].joint_names[joints[0]] + "' is .*other sign";
    all.push_back({label, each([joints](Sample& s) {
                     for (const std::size_t j : joints) s.joint_positions[j] *= -1.0;
                   }),
                   expected});
  };
  const auto exchanged = [&](std::size_t a, std::size_t b) {
    return name(a) + " and " + name(b) + " exchanged|" + name(b) + " and " + name(a) + " exchanged";
  };
  const auto swapped = [joint](std::size_t a, std::size_t b) {
    return each([a = joint[a], b = joint[b]](Sample& s) {
      std::swap(s.joint_positions[a], s.joint_positions[b]);
    });
  };
  signs({1});
  signs({3});
  signs({1, 2});
  signs({1, 2, 3});
  all.push_back({"names_2_3", swapped(1, 2), exchanged(1, 2)});
  all.push_back({"names_3_5", swapped(2, 4), exchanged(2, 4)});
  all.push_back({"reverse_order", each([](Sample& s) {
                   std::reverse(s.joint_positions.begin(), s.joint_positions.end());
                 }),
                 "all joints in reverse order|limits in reverse order|limits"});
  all.push_back({"degrees", each([](Sample& s) {
                   for (double& q : s.joint_positions) q *= 180.0 / std::numbers::pi;
                 }),
                 "degrees"});
  all.push_back({"coupled_3", each([joint](Sample& s) {
                   s.joint_positions[joint[2]] -= s.joint_positions[joint[1]];
                 }),
                 name(2) + ".*" + name(1) + " are added"});
  all.push_back({"sign_and_names", each([joint](Sample& s) {
                   std::swap(s.joint_positions[joint[1]], s.joint_positions[joint[2]]);
                   s.joint_positions[joint[3]] *= -1.0;
                 }),
                 name(3) + " negated.*exchanged|exchanged.*" + name(3) + " negated"});
  all.push_back({"row_late", rows([](std::size_t i, std::size_t) { return i == 0 ? 0 : i - 1; }),
                 "of the sample after"});
  all.push_back({"row_early", rows([](std::size_t i, std::size_t) { return i + 1; }),
                 "of the sample before"});
  all.push_back({"neighbours", rows([](std::size_t i, std::size_t) { return i ^ 1u; }),
                 "neighbouring samples"});
  all.push_back({"sign_in_a_third",
                 [joint](Recording& r) {
                   for (std::size_t s = 0; s < r.samples.size(); s += 3)
                     r.samples[s].joint_positions[joint[1]] *= -1.0;
                 },
                 name(1) + " negated in [0-9]+ of"});
  all.push_back(
      {"millimetres", test::points([](Vector3<double>& p, double) { p *= 1e3; }), "millimetres"});
  all.push_back({"left_handed", test::points([](Vector3<double>& p, double) { p.x() *= -1.0; }),
                 "left-handed|mirrored"});
  all.push_back({"twice_as_large", test::scaled(1.9), "multiplied by 0.5[0-9]"});
  all.push_back({"middle_third",
                 test::joint(joint[1],
                             [](double, double, double part) {
                               return part > 0.33 && part < 0.67 ? 1.5 * test::kOneDegree : 0.0;
                             }),
                 "changed.*from .* until|elsewhere.* samples"});
  all.push_back({"two_robots",
                 [joint](Recording& r) {
                   std::mt19937 random(8);
                   const double apart[] = {0.9, -1.2, 1.4, -0.8, 1.1};
                   for (Sample& s : r.samples) {
                     if (random() % 2 == 0) continue;
                     for (std::size_t j = 1; j < 6; ++j)
                       s.joint_positions[joint[j]] += apart[j - 1] * test::kOneDegree;
                   }
                 },
                 "elsewhere.* in [0-9]+ of"});
  // Recorded socket by socket: the row of a neighbour is one of the same socket.  All are in a plane, which is the same
  // when it is mirrored and turned.
  if (of.sensor == "fixture") {
    std::erase_if(all, [](const Named& mistake) {
      return mistake.name.starts_with("row") || mistake.name == "neighbours" ||
             mistake.name == "left_handed";
    });
  }
  if (of.name.starts_with("simulated")) {  // joints in the order of the file: not of a chain
    std::erase_if(all, [](const Named& mistake) { return mistake.name == "coupled_3"; });
  }
  if (of.sensor.empty()) {  // pixels have no scale
    std::erase_if(all, [](const Named& mistake) {
      return mistake.name == "millimetres" || mistake.name == "left_handed" ||
             mistake.name == "twice_as_large";
    });
  }
  return all;
}

/// A simulated robot, in which nothing is wrong but noise and unknown poses.
/// @param kind  of test::robot_kinds()
CalibrationSetup simulated(std::size_t kind) {
  test::SpoiledRobot robot(7, test::robot_kinds()[kind]);
  robot.spoil(0);
  return {.robot = robot.robot(), .config = robot.config(), .samples = robot.samples()};
}

/// A recording and how it is calibrated.
struct Scene {
  Recording right;
  std::function<CalibrationSetup(const Recording&)> setup;
};

/// @param name  of test::recording(), or "simulated_" and the number of a kind
Scene scene_of(const std::string& name) {
  const std::string_view kSimulated = "simulated_";
  if (!name.starts_with(kSimulated)) return {test::recording(name), test::setup_of};
  const CalibrationSetup made = simulated(std::stoul(name.substr(kSimulated.size())));
  const std::string& type = made.config->steps.front().error_blocks.front().type;
  const bool is_pixel = type.find("camera2d") != std::string::npos;
  return {{name,
           is_pixel ? "" : made.samples[0].observations.back().sensor,
           "",
           *made.config,
           made.samples,
           {}},
          [made](const Recording& of) {
            CalibrationSetup setup = made;
            setup.samples = of.samples;
            return setup;
          }};
}

class NamedCauses : public testing::TestWithParam<const char*> {};

TEST_P(NamedCauses, AreTheRightOnes) {
  KINECAL_NEEDS_RECORDING(GetParam());
  const Scene scene = scene_of(GetParam());
  const Recording& right = scene.right;
  int named = 0, wrong = 0, shown = 0;
  for (const Named& mistake : mistakes(right)) {
    Recording of = right;
    mistake.change(of);
    std::string said;
    Grade grade = Grade::do_not_use;
    try {
      const CalibratedRobot found = calibrate_robot(scene.setup(of));
      grade = found.judgement.verdict;
      if (!found.judgement.reasons.empty()) said = found.judgement.reasons.front();
    } catch (const InputError& error) {
      said = error.what();
    }
    ++shown;
    const bool is_right = std::regex_search(said, std::regex(mistake.expected));
    const bool is_wrong = !is_right && said.find("likely cause") != std::string::npos;
    named += is_right ? 1 : 0;
    wrong += is_wrong ? 1 : 0;
    std::printf("%-12s %-16s %-6s %-14s %s\n", right.name.c_str(), mistake.name.c_str(),
                is_right   ? "right"
                : is_wrong ? "WRONG"
                           : "-",
                to_string(grade).data(), said.substr(0, is_wrong ? 900 : 150).c_str());
    EXPECT_NE(grade, Grade::good) << mistake.name;
  }
  std::printf("%s: of %d mistakes %d named first, %d wrongly\n", right.name.c_str(), shown, named,
              wrong);
  EXPECT_GE(10 * named, 9 * shown);
  EXPECT_EQ(wrong, 0);
}

/// Two of the recordings; all, and simulated ones, with KINECAL_REPETITIONS.
std::vector<const char*> recordings() {
  if (std::getenv("KINECAL_REPETITIONS") == nullptr) return {"ur5_offsets", "kuka"};
  return {"ur5_offsets", "kuka",        "ur5",         "panda",       "simulated_0",
          "simulated_1", "simulated_2", "simulated_3", "simulated_4", "simulated_5"};
}

INSTANTIATE_TEST_SUITE_P(OnRobots, NamedCauses, testing::ValuesIn(recordings()),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace kinecal
