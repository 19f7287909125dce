// Mistakes in recordings: what the verdict is, what is named first, and what they do to the result.  One table:
//
//   KINECAL_REPETITIONS=1 explain_tests --gtest_filter='*Mistakes*'     all robots, with and without a sigma
//
// A result is harmful if it is three times as bad as that of the right recording, on samples that are right, and is
// called good.  What a robot has whenever it moves (a joint that is eccentric or yields) it has in those, too.
// Those that nothing in the samples shows are listed with the reason.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <random>
#include <regex>

#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/solve/statistics.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "support/hand_eye_poses.hpp"
#include "support/repetitions.hpp"
#include "support/spoiled_robot.hpp"
#include "support/temporary_folder.hpp"
#include "support/wrong_recordings.hpp"

namespace kinecal {
namespace {

using test::Recording;

/// A mistake and a word of what is right to say of it.
struct Named {
  std::string name;
  test::Change change;
  std::string expected = {};  ///< regular expression; empty: anything but "good" if it is harmful
  bool is_of_robot = false;   ///< as of test::Mutation
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

/// Mistakes that a fit may absorb.
std::vector<Named> subtle_mistakes() {
  std::vector<Named> all;
  for (const test::Mutation& mutation : test::mutations()) {
    all.push_back({mutation.name, mutation.change, "", mutation.is_of_robot});
  }
  return all;
}

/// The poses of the marker in the camera, each by those of two samples.
test::Change marker_poses(
    const std::function<Pose<double>(const Pose<double>& before, const Pose<double>& right,
                                     std::size_t sample)>& change) {
  return [=](Recording& of) {
    const auto seen = [](Sample& sample) -> Feature& {
      for (Observation& observation : sample.observations) {
        if (observation.sensor == HandEyeNames::kCamera) return observation.features.at(0);
      }
      throw std::logic_error("no marker is seen");
    };
    std::vector<Pose<double>> right;
    for (Sample& sample : of.samples) {
      right.push_back({seen(sample).rotation.value(), seen(sample).point});
    }
    for (std::size_t s = 0; s < right.size(); ++s) {
      const Pose<double> wrong = change(right[s == 0 ? 0 : s - 1], right[s], s);
      seen(of.samples[s]).rotation = wrong.rotation;
      seen(of.samples[s]).point = wrong.translation;
    }
  };
}

/// Mistakes in poses of a flange and of a marker.
std::vector<Named> pose_mistakes() {
  using P = Pose<double>;
  using V = Vector3<double>;
  const auto flange = [](const std::function<P(const P&)>& change) -> test::Change {
    return each([=](Sample& sample) {
      P& pose = sample.poses.at(HandEyeNames::kFlangeJoint);
      pose = change(pose);
    });
  };
  const auto larger = [](double times) {
    return marker_poses([=](const P&, const P& right, std::size_t) {
      return P{right.rotation, times * right.translation};
    });
  };
  const auto late = [](double share) {
    return marker_poses([=](const P& before, const P& right, std::size_t) {
      const V turn = share * log(Matrix3<double>(right.rotation.transpose() * before.rotation));
      return P{Matrix3<double>(right.rotation * exp(turn)),
               V(right.translation + share * (before.translation - right.translation))};
    });
  };
  const auto moved = [](const V& by, const V& turn, std::size_t every, std::size_t from) {
    return marker_poses([=](const P&, const P& right, std::size_t s) {
      return s < from || s % every != 0 ? right : P(right * P{exp(turn), by});
    });
  };
  const V still = V::Zero();
  return {
      {"marker_a_row_late", late(1.0), "of the sample (before|after)"},
      {"flange_inverted", flange([](const P& p) { return p.inverse(); }), "inverted"},
      {"flange_transposed", flange([](const P& p) {
         return P{p.rotation.transpose(), p.translation};
       }),
       "transposed"},
      {"marker_10_percent_larger", larger(1.1)},
      {"marker_3_percent_larger", larger(1.03)},
      {"marker_half_a_row_late", late(0.5)},
      {"marker_5_percent_late", late(0.05)},
      {"marker_moved_30_mm", moved(V(0.03, 0, 0), still, 1, 30)},
      {"marker_moved_10_mm", moved(V(0.01, 0, 0), still, 1, 30)},
      {"two_markers", moved(V(0.2, 0.1, 0), V(0, 0, 1.57), 2, 0)},
      {"marker_flips_by_20_degrees", moved(still, V(0.35, 0, 0), 3, 0)},
      {"marker_turned_by_5_degrees", moved(still, V(0.087, 0, 0), 1, 30)},
  };
}

/// A recording and how it is calibrated.
struct Scene {
  Recording right;
  std::function<CalibrationSetup(const Recording&)> setup;
};

/// A simulated robot, in which nothing is wrong but noise and unknown poses.
/// @param kind  of test::robot_kinds()
Scene simulated(const std::string& name, std::size_t kind) {
  test::SpoiledRobot robot(7, test::robot_kinds()[kind]);
  robot.spoil(0);
  const CalibrationSetup made = {
      .robot = robot.robot(), .config = robot.config(), .samples = robot.samples()};
  const std::string& type = made.config->steps.front().error_blocks.front().type;
  const bool is_pixel = type.find("camera2d") != std::string::npos;
  return {{name, is_pixel ? "" : made.samples[0].observations.back().sensor, "", *made.config,
           made.samples, robot.others()},
          [made](const Recording& of) {
            CalibrationSetup setup = made;
            setup.config = of.config;
            setup.samples = of.samples;
            return setup;
          }};
}

/// A camera on a hand, and a marker that it sees to 1 mm and 5 mrad.
Scene hand_eye() {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "samples.yaml").string();
  std::ofstream(file) << test::HandEyePoses(true, 200, 5).moveit_text();
  Diagnostics diagnostics;
  std::vector<Sample> all = read_hand_eye_samples(file, true, diagnostics);
  const Config config = parse_config(hand_eye_pose_config(true), "calibrate.yaml", diagnostics);
  diagnostics.throw_if_errors();
  constexpr std::ptrdiff_t kFitted = 60;
  return {{"hand_eye",
           "",
           hand_eye_urdf(true),
           config,
           {all.begin(), all.begin() + kFitted},
           {all.begin() + kFitted, all.end()}},
          test::setup_of};
}

/// @param name  of test::recording(), "hand_eye", or "simulated_" and the number of a kind
Scene scene_of(const std::string& name) {
  if (name == "hand_eye") return hand_eye();
  const std::string_view kSimulated = "simulated_";
  if (name.starts_with(kSimulated)) {
    return simulated(name, std::stoul(name.substr(kSimulated.size())));
  }
  return {test::recording(name), test::setup_of};
}

/// What the program does with an input.
struct Outcome {
  bool refused = false;  ///< before solving
  Grade grade = Grade::do_not_use;
  std::string said;           ///< the first reason
  double error = 0.0;         ///< on samples that are right, metres or pixels
  std::vector<double> noise;  ///< of each error block
};

/// @param tried  samples in which the result is tried
Outcome outcome_of(const Scene& scene, const Recording& of, const std::vector<Sample>& tried) {
  Outcome outcome;
  try {
    const CalibratedRobot found = calibrate_robot(scene.setup(of), {.solving = {.threads = 1}});
    outcome.grade = found.judgement.verdict;
    if (!found.judgement.reasons.empty()) outcome.said = found.judgement.reasons.front();
    if (found.assessments.empty()) return outcome;
    for (const BlockNoise& noise : found.assessments.back().noise) {
      outcome.noise.push_back(noise.sigma);
    }
    const std::unique_ptr<AnyProblem> right =
        found.setup.calibration.steps.back().problem->without_samples();
    for (const Sample& sample : tried) right->add_sample(sample);
    double squares = 0.0, count = 0.0;
    for (const auto& norms : feature_norms(*right, found.result.table.values())) {
      for (const double norm : norms) squares += norm * norm, count += 1.0;
    }
    outcome.error = std::sqrt(squares / count);
  } catch (const InputError& error) {
    outcome.refused = true;
    outcome.said = error.what();
  } catch (const std::domain_error&) {  // a right point would be behind the camera
    outcome.error = std::numeric_limits<double>::infinity();
  }
  return outcome;
}

/// True if a mistake changes nothing, such as one of points in samples without points.
bool are_same(const Recording& a, const Recording& b) {
  const auto same = [](const Sample& one, const Sample& other) {
    const auto points = [](const Sample& sample) {
      std::vector<Vector3<double>> all;
      for (const Observation& seen : sample.observations) {
        for (const Feature& feature : seen.features) {
          all.push_back(feature.point);
          if (feature.rotation) all.push_back(log(*feature.rotation));
        }
      }
      return all;
    };
    const auto flanges = [](const Sample& sample) {
      std::vector<Vector3<double>> all;
      for (const auto& [joint, pose] : sample.poses) {
        all.push_back(pose.translation);
        all.push_back(log(pose.rotation));
      }
      return all;
    };
    return one.joint_positions == other.joint_positions && points(one) == points(other) &&
           flanges(one) == flanges(other);
  };
  return a.urdf == b.urdf &&
         std::equal(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(), same);
}

/// What nothing in the samples shows, and why.
const std::map<std::string, std::string>& undetectable() {
  const std::string socket_by_socket =
      "the samples are those of sockets that are elsewhere: they were recorded one after the other";
  const std::string own_errors =
      "sockets 51 in place of 50 mm apart change lengths by 2.2 mm, as the URDF's own errors do";
  static const std::map<std::string, std::string> all = {
      {"panda points_2_percent_larger", own_errors},
      {"panda x_2_percent_longer", own_errors},
      {"panda bump_of_3_mm", socket_by_socket},
      {"kuka bump_of_3_mm", socket_by_socket},
  };
  return all;
}

/// True to try everything: all robots and mistakes, with and without a sigma.
bool is_study() {
  return std::getenv("KINECAL_REPETITIONS") != nullptr;
}

/// Counts of a robot's mistakes.
struct Counts {
  int rows = 0, expected = 0, named = 0, wrong = 0, harmful = 0, listed = 0;

  Counts& operator+=(const Counts& more) {
    rows += more.rows, expected += more.expected, named += more.named;
    wrong += more.wrong, harmful += more.harmful, listed += more.listed;
    return *this;
  }
  void print(const std::string& name) const {
    std::printf(
        "%s: %d rows, %d harmful, %d of them listed; of %d mistakes %d named first, %d wrongly\n",
        name.c_str(), rows, harmful, listed, expected, named, wrong);
  }
};

/// A row of the table.
/// @param clean  the outcome of the right recording
void try_mistake(const Scene& scene, const Named& mistake, bool has_sigma, const Outcome& clean,
                 Counts& counts) {
  constexpr double kHarmful = 3.0;
  Recording of = scene.right;
  mistake.change(of);
  if (are_same(of, scene.right)) return;
  std::vector<BlockConfig>& blocks = of.config.steps.back().error_blocks;
  for (std::size_t b = 0; has_sigma && b < std::min(blocks.size(), clean.noise.size()); ++b) {
    blocks[b].sigma = clean.noise[b];
  }
  Recording tried = scene.right;
  tried.samples = tried.right;
  if (mistake.is_of_robot) mistake.change(tried);
  const Outcome outcome = outcome_of(scene, of, tried.samples);
  const double times = outcome.error / clean.error;
  const bool is_good = !outcome.refused && outcome.grade == Grade::good;
  const bool is_harmful = is_good && times >= kHarmful;
  const std::string key = scene.right.name + " " + mistake.name;
  const bool is_listed = is_harmful && undetectable().contains(key);
  const bool is_right =
      !mistake.expected.empty() && std::regex_search(outcome.said, std::regex(mistake.expected));
  const bool is_wrong = !mistake.expected.empty() && !is_right &&
                        outcome.said.find("likely cause") != std::string::npos;
  ++counts.rows;
  counts.expected += mistake.expected.empty() ? 0 : 1;
  counts.named += is_right ? 1 : 0;
  counts.wrong += is_wrong ? 1 : 0;
  counts.harmful += is_harmful ? 1 : 0;
  counts.listed += is_listed ? 1 : 0;
  std::printf("%-12s %-28s %-5s %-14s %8.1f %-8s %-6s %s\n", scene.right.name.c_str(),
              mistake.name.c_str(), has_sigma ? "sigma" : "-",
              outcome.refused ? "refused" : to_string(outcome.grade).data(), times,
              is_listed    ? "listed"
              : is_harmful ? "HARMFUL"
                           : "-",
              is_right   ? "right"
              : is_wrong ? "WRONG"
                         : "-",
              outcome.said.substr(0, is_wrong ? 900 : 150).c_str());
  std::fflush(stdout);
  EXPECT_FALSE(is_harmful && !is_listed) << key << ": " << times << " times the error, and good";
  EXPECT_FALSE(is_good && !mistake.expected.empty()) << key;
}

class Mistakes : public testing::TestWithParam<const char*> {
 protected:
  static Counts& all_robots() {
    static Counts counts;
    return counts;
  }
  static void TearDownTestSuite() { all_robots().print("all robots"); }
};

TEST_P(Mistakes, AreNamedAndNoHarmfulResultIsGood) {
  KINECAL_NEEDS_RECORDING(GetParam());
  const Scene scene = scene_of(GetParam());
  const std::string& name = scene.right.name;
  const Outcome clean = outcome_of(scene, scene.right, scene.right.right);
  EXPECT_NE(clean.grade, Grade::do_not_use) << clean.said;
  const bool are_poses = name == "hand_eye";
  std::vector<Named> all = are_poses ? pose_mistakes() : subtle_mistakes();
  const bool are_all_tried = is_study() || name == "ur5_offsets" || name == "kuka";
  if (are_all_tried && !are_poses) {
    const std::vector<Named> gross = mistakes(scene.right);
    all.insert(all.begin(), gross.begin(), gross.end());
  }
  std::printf("%-12s %-28s %-5s %-14s %8s %-8s %-6s %s\n", "robot", "mistake", "sigma", "verdict",
              "error", "harmful", "named", "first reason");
  Counts counts;
  for (const bool has_sigma : {false, true}) {
    if (has_sigma && !is_study()) continue;
    for (const Named& mistake : all) try_mistake(scene, mistake, has_sigma, clean, counts);
  }
  counts.print(name);
  all_robots() += counts;
  EXPECT_GE(10 * counts.named, 9 * counts.expected);
  EXPECT_EQ(counts.wrong, 0);
}

/// The real recordings; simulated ones, too, in the study.
std::vector<const char*> robots() {
  if (!is_study()) return {"ur5_offsets", "kuka", "ur5", "panda", "hand_eye"};
  return {"ur5_offsets", "kuka",        "ur5",         "panda",       "hand_eye",   "simulated_0",
          "simulated_1", "simulated_2", "simulated_3", "simulated_4", "simulated_5"};
}

INSTANTIATE_TEST_SUITE_P(OnRobots, Mistakes, testing::ValuesIn(robots()),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace kinecal
