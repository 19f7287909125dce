#include "kinecal/crate/crate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "kinecal/errors.hpp"
#include "support/static_robot.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

using test::StaticRobot;
template <FixedString Tip>
using FromBase = Chain<StaticRobot, "base", Tip>;

using Arm = Chain3d<"arm", FromBase<"tip">>;
using Camera = Camera3d<"camera", FromBase<"camera_frame">>;
using Eye = Camera2d<"eye", FromBase<"base">>;  // looks up
using HandEye =
    Crate<Arm, Camera, JointOffset<"pan">, JointOffset<"elbow">, JointOffset<"wrist">,
          FrameOffset<"camera_joint">, FrameOffset<"mount", Axes::xyz>, DepthIntrinsics<"camera">,
          VirtualFrame<"board">, Block<"hand_eye", PointToPoint, "camera", "arm">>;
using Floor = Crate<Camera, JointOffset<"lift">, JointOffset<"head_tilt">,
                    FrameOffset<"camera_joint">, DepthIntrinsics<"camera">,
                    Block<"floor", PointToPlane, "camera">, PriorOn<"keep", "camera_joint">>;
using Counterweight = Crate<Chain3d<"weight", FromBase<"counterweight">>, Arm, JointOffset<"wrist">,
                            JointModelParameters<"wrist", "gear_ratio", "eccentric_cos">,
                            FrameOffset<"weight", Axes{.z = true, .a = true}>,
                            Block<"weight", PointToPoint, "weight", "arm">>;
using Pixels =
    Crate<Arm, Eye, CameraIntrinsics<"eye">, Block<"pixels", PointToPixel, "arm", "eye">>;
using All = Crate<HandEye, Floor, Counterweight, Pixels>;

// What several crates share needs no sensor or block of its own, even where it is completed.
using Joints = Crate<JointOffset<"pan">, JointOffset<"elbow">>;
static_assert(!std::is_empty_v<Joints>);
static_assert(Crate<Joints, HandEye>::Free::kSize == HandEye::Free::kSize);

static_assert(All::Sensors::kSize == 4 && All::Blocks::kSize == 4 && All::Priors::kSize == 1);
static_assert(All::Free::kSize == 3 + 6 + 3 + 6 + 6 + 1 + 2 + 2 + 4 + 1, "each once");
using Bent = Crate<HandEye, DepthPolynomial<"camera">>;
static_assert(Bent::Free::kSize == HandEye::Free::kSize + kDepthTerms);
static_assert(std::is_same_v<Crate<HandEye, HandEye>::Parameters, HandEye::Parameters>);

/// The same calibration put together at run time.
template <class S>
BasicProblem<S> by_hand() {
  ParameterTable table = All().table({});
  BasicProblem<S> problem(robot_from<StaticRobot>(), "base", table,
                          {"camera_joint", "mount", "board", "weight"});
  problem.add_sensor(ChainPoint{}, {"arm", "tip"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_frame"});
  problem.add_sensor(ChainPoint{}, {"weight", "counterweight"});
  problem.add_sensor(PinholeCamera{}, {"eye", "base"});
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("floor", PointToPlane(0, 0, 1, 0), {"camera"});
  problem.add_block("weight", PointToPoint{}, {"weight", "arm"});
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"}, {.scale = 0.01, .unit = "px"});
  problem.add_prior("keep", {"camera_joint", 1.0, 2.0, 3.0}, {.type = "outrageous", .unit = "1"});
  return problem;
}

All crate() {
  All crate;
  crate.block<"pixels">().options.scale = 0.01;
  crate.prior<"keep">().position_scale = 2.0;
  crate.prior<"keep">().rotation_scale = 3.0;
  return crate;
}

/// Samples anywhere, in some of which the arm's features are on the board.
std::vector<Sample> some_samples(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-0.4, 0.4), side(-0.3, 0.3), depth(0.5, 1.2);
  const auto points = [&](const std::string& frame, double size = 1.0) {
    std::vector<Feature> features;
    for (int i = 0; i < 4; ++i) {
      features.push_back(
          {frame, size * Vector3<double>(side(random), side(random), depth(random))});
    }
    return features;
  };
  std::vector<Sample> samples;
  for (int n = 0; n < count; ++n) {
    Sample& sample = samples.emplace_back();
    for (const JointData& joint : StaticRobot::kJoints) {
      if (!moves(joint.type) || joint.mimic) continue;
      sample.joint_names.emplace_back(joint.name);
      sample.joint_positions.push_back(angle(random));
    }
    CameraInfo info;
    info.k = {550, 0, 320, 0, 560, 240, 0, 0, 1};
    info.p = {550, 0, 320, 0, 0, 560, 240, 0, 0, 0, 1, 0};
    info.z_offset = 0.01;
    info.z_scaling = 1.02;
    sample.observations = {{"arm", points(n % 3 == 2 ? "board" : "tip", 0.1), {}},
                           {"camera", points("camera_frame"), info},
                           {"weight", points("counterweight"), {}}};
    if (n % 2 == 0) {
      sample.observations.push_back({"eye", points("base", 300.0), info});
    }
  }
  return samples;
}

template <class S>
void expect_the_same(const FreeSet& free) {
  BasicProblem<S> expected = by_hand<S>(), found = crate().problem<S>(All().table({}));
  for (const Sample& sample : some_samples(3 * kLanes<S> + 2)) {
    expected.add_sample(sample);
    found.add_sample(sample);
  }
  ASSERT_EQ(found.num_terms(), expected.num_terms());
  for (int t = 0; t < 4; ++t) EXPECT_GT(found.samples_of(t), 0);
  const std::vector<double> x = test::random_values(expected.table(), 0.05, 3);
  test::expect_same(normal_equations(found, x, &free), normal_equations(expected, x, &free), 1e-12);
  const double cost = normal_equations(expected, x, nullptr).cost;
  EXPECT_NEAR(normal_equations(found, x, nullptr).cost, cost, 1e-13 * cost);
  const auto rows = test::rows_of(found, x, &free),
             expected_rows = test::rows_of(expected, x, &free);
  ASSERT_GT(expected_rows.size(), 0u);
  ASSERT_EQ(rows.size(), expected_rows.size());
  for (const auto& [key, of_term] : expected_rows) {
    const TermResiduals& same = rows.at(key);
    ASSERT_EQ(same.residual.size(), of_term.residual.size());
    EXPECT_LE((same.residual - of_term.residual).norm(), 1e-13 * (1 + of_term.residual.norm()));
    EXPECT_LE((same.jacobian - of_term.jacobian).norm(), 1e-13 * (1 + of_term.jacobian.norm()));
  }
}

template <class S>
void expect_the_same() {
  const ParameterTable table = All().table({});
  expect_the_same<S>(All::free(table));
  // Not what its walks are compiled for: they give way.
  expect_the_same<S>(test::all_free(table));
  expect_the_same<S>(test::free_of(table, {"elbow", "camera_joint_a", "camera_z_offset"}));
  expect_the_same<S>(FreeSet({}, table.size()));
}

TEST(Crate, ADepthCameraMayBendDepth) {
  const ParameterTable table = Bent().table({});
  EXPECT_EQ(table["camera_z_quadratic"].unit, "1/m");
  EXPECT_EQ(table["camera_z_yy"].unit, "1");
  EXPECT_EQ(table["camera_z_yy"].value, 0.0);
}

TEST(Crate, EvaluatesAsTheSameProblemOfRunTime) {
  expect_the_same<double>();
}

TEST(Crate, EvaluatesAsTheSameProblemOfRunTimeInPackets) {
  expect_the_same<Packet>();
}

template <FixedString Tip>
using FromCamera = Chain<StaticRobot, "camera_frame", Tip>;
using UpAndDown =
    Crate<Chain3d<"arm", FromCamera<"tip">>, Chain3d<"weight", FromCamera<"counterweight">>,
          JointOffset<"pan">, JointOffset<"head_tilt">, JointOffset<"wrist">,
          JointModelParameters<"head_tilt", "gear_ratio">, FrameOffset<"camera_joint", Axes::abc>,
          Block<"weight", PointToPoint, "weight", "arm">>;

TEST(Crate, HasChainsThatLeadUpAndDown) {
  static_assert(FromCamera<"tip">::kJoints[0].reversed);
  const ParameterTable table = UpAndDown().table({});
  BasicProblem<Packet> found = UpAndDown().problem<Packet>(table),
                       expected(robot_from<StaticRobot>(), "camera_frame", table, {"camera_joint"});
  expected.add_sensor(ChainPoint{}, {"arm", "tip"});
  expected.add_sensor(ChainPoint{}, {"weight", "counterweight"});
  expected.add_block("weight", PointToPoint{}, {"weight", "arm"});
  for (Sample& sample : some_samples(5)) {
    for (Feature& feature : sample.observations[0].features) feature.frame = "tip";
    expected.add_sample(sample);
    found.add_sample(sample);
  }
  const std::vector<double> x = test::random_values(table, 0.05, 3);
  const FreeSet free = UpAndDown::free(table);
  const NormalEquations sums = normal_equations(expected, x, &free);
  EXPECT_GT(sums.hessian.diagonal().minCoeff(), 0.0) << "a parameter moves nothing";
  test::expect_same(normal_equations(found, x, &free), sums, 1e-12);
}

TEST(Crate, NamesItsParametersAsAConfigurationDoes) {
  const ParameterTable table = All().table({});
  std::vector<std::string> names;
  const FreeSet free = All::free(table);
  for (const int i : free.parameters()) names.push_back(table[i].name);
  EXPECT_THAT(names,
              testing::ElementsAre(
                  "pan", "elbow", "wrist", "camera_joint_x", "camera_joint_y", "camera_joint_z",
                  "camera_joint_a", "camera_joint_b", "camera_joint_c", "mount_x", "mount_y",
                  "mount_z", "camera_fx", "camera_fy", "camera_cx", "camera_cy", "camera_z_offset",
                  "camera_z_scaling", "board_x", "board_y", "board_z", "board_a", "board_b",
                  "board_c", "lift", "head_tilt", "wrist_gear_ratio", "wrist_eccentric_cos",
                  "weight_z", "weight_a", "eye_fx", "eye_fy", "eye_cx", "eye_cy"));
  EXPECT_EQ(table["lift"].unit, "m");
  EXPECT_EQ(table["pan"].unit, "rad");
  EXPECT_EQ(table["mount_a"].unit, "rad");
  EXPECT_EQ(table["camera_z_offset"].unit, "m");
  EXPECT_EQ(table["camera_fx"].unit, "1");
}

/// Ten times a turn.
struct Worm {
  static constexpr std::array<ParameterInfo, 2> kParameters = {
      {{"worm_sin", "rad"}, {"worm_cos", "rad"}}};
  std::array<double, 2> operator()(const JointReading& joint) const {
    return {std::sin(10.0 * joint.position()), std::cos(10.0 * joint.position()) - 1.0};
  }
};

TEST(Crate, FreesJointModelsOfItsOwnCouplingsAndLags) {
  using Modelled =
      Crate<Arm, Camera, OwnJointModel<"elbow", Worm>, SensorParameters<"camera", "lag">,
            JointModelParameters<"elbow", "coupling_pan", "backlash">,
            Block<"hand_eye", PointToPoint, "camera", "arm">>;
  const ParameterTable table = Modelled().table({});
  EXPECT_EQ(table["elbow_worm_sin"].unit, "rad");
  EXPECT_EQ(table["elbow_coupling_pan"].unit, "1");
  EXPECT_EQ(table["camera_lag"].unit, "s");
  const Problem problem = Modelled().problem<Packet>(table);
  EXPECT_EQ(problem.owners()[static_cast<std::size_t>(table.index("elbow_worm_cos"))], "elbow");
  EXPECT_EQ(problem.owners()[static_cast<std::size_t>(table.index("camera_lag"))], "camera");
  std::set<std::string> moved;
  for (const SampledChain& chain : problem.sensors()[0].chains()) {
    for (const JointIndices& joint : chain.parameters()) {
      for (const int p : joint.model) moved.insert(table[p].name);
    }
  }
  EXPECT_THAT(moved, testing::IsSupersetOf({"elbow_worm_sin", "elbow_worm_cos", "elbow_backlash",
                                            "elbow_coupling_pan"}));
}

TEST(Crate, StartsCamerasWhereTheirDriversWere) {
  const std::vector<Sample> samples = some_samples(1);
  const ParameterTable table = All().table(samples);
  EXPECT_EQ(table["camera_z_offset"].value, 0.01);
  EXPECT_EQ(table["camera_z_scaling"].initial, 1.02 - 1.0);
}

TEST(Crate, SaysWhatKindItsBlocksAre) {
  const Problem problem = crate().problem(All().table({}));
  std::vector<std::string> kinds;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    kinds.push_back(term.name + " " + term.options.type + " " + term.options.unit);
  }
  EXPECT_THAT(kinds,
              testing::ElementsAre("hand_eye chain3d_to_chain3d m", "floor chain3d_to_plane m",
                                   "weight chain3d_to_chain3d m", "pixels chain3d_to_camera2d px"));
}

/// Stands in for a compiled walk and counts its calls.
struct CountedWalk {
  detail::CompiledWalk<Packet> real;
  int pose_only = 0, with_twists = 0;
};

constexpr std::size_t kMostWalks = 8;
std::array<CountedWalk, kMostWalks> counted;

/// A compiled walk is a plain function, so there is one for each place in the list.
template <std::size_t I>
detail::CompiledWalk<Packet> counting(const detail::CompiledWalk<Packet>& walk) {
  counted[I] = {walk};
  detail::CompiledWalk<Packet> stand_in = walk;
  stand_in.pose_only = [](const auto& start, auto joints, auto& tip) {
    ++counted[I].pose_only;
    counted[I].real.pose_only(start, joints, tip);
  };
  stand_in.with_twists = [](const auto& start, auto joints, auto& tip) {
    ++counted[I].with_twists;
    counted[I].real.with_twists(start, joints, tip);
  };
  return stand_in;
}

detail::CompiledWalk<Packet> counting(std::size_t i, const detail::CompiledWalk<Packet>& walk) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    detail::CompiledWalk<Packet> stand_in;
    (void)((I == i ? (stand_in = counting<I>(walk), true) : false) || ...);
    return stand_in;
  }
  (std::make_index_sequence<kMostWalks>{});
}

/// How often each walk is called: by its sensor and tip, "arm board".
std::map<std::string, int> calls(const std::vector<std::string>& names, int CountedWalk::*which) {
  std::map<std::string, int> calls;
  for (std::size_t i = 0; i < names.size(); ++i) calls[names[i]] = counted[i].*which;
  return calls;
}

/// In each lane of a sample's pack the arm's features are in the hand or on the board: a sensor's
/// walk to either is taken once for each pack with a feature at its end.
TEST(Crate, WalksAreUsedWhereTheyFit) {
  const Problem of_crate = crate().problem(All().table({}));
  Problem problem(All::robot(), All::base(), All().table({}),
                  {"camera_joint", "mount", "board", "weight"});
  std::vector<std::string> names;
  for (std::size_t s = 0; s < of_crate.sensors().size(); ++s) {
    const MountedSensor& sensor = of_crate.sensors()[s];
    std::vector<detail::CompiledWalk<Packet>> walks;
    for (const detail::CompiledWalk<Packet>& walk : of_crate.evaluation_of(s).walks) {
      ASSERT_LT(names.size(), kMostWalks);
      walks.push_back(counting(names.size(), walk));
      names.push_back(sensor.mount().name + " " + walk.tip);
    }
    if (sensor.sensor().type() == ChainPoint::kType) {
      problem.add_sensor(ChainPoint{}, sensor.mount(), std::move(walks));
    } else if (sensor.sensor().type() == DepthCamera::kType) {
      problem.add_sensor(DepthCamera{}, sensor.mount(), std::move(walks));
    } else {
      problem.add_sensor(PinholeCamera{}, sensor.mount(), std::move(walks));
    }
  }
  EXPECT_THAT(names, testing::ElementsAre("arm tip", "arm board", "camera camera_frame",
                                          "weight counterweight", "weight board", "eye base"));
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("weight", PointToPoint{}, {"weight", "arm"});
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"});
  const int count = 6 * kLanes<Packet>;
  for (const Sample& sample : some_samples(count)) problem.add_sample(sample);
  // A sixth of the samples are on the board with an eye, a sixth without; a third each in the hand.
  ASSERT_EQ(test::count_batches(problem), 6);
  // The arm and the weight have a wrist with joint models, so they walk at run time.
  const std::map<std::string, int> fit = {{"arm tip", 0},
                                          {"arm board", 0},
                                          {"camera camera_frame", 6},
                                          {"weight counterweight", 0},
                                          {"weight board", 0},
                                          {"eye base", 3}};
  std::map<std::string, int> none = fit;
  for (auto& [name, n] : none) n = 0;
  const std::vector<double> x = test::random_values(problem.table(), 0.05, 3);
  const FreeSet free = All::free(problem.table()), all = test::all_free(problem.table());

  (void)normal_equations(problem, x, &free);
  EXPECT_EQ(calls(names, &CountedWalk::with_twists), fit);
  EXPECT_EQ(calls(names, &CountedWalk::pose_only), none);
  for (CountedWalk& walk : counted) walk.with_twists = 0;
  (void)normal_equations(problem, x, nullptr);  // the cost alone
  EXPECT_EQ(calls(names, &CountedWalk::with_twists), none);
  EXPECT_EQ(calls(names, &CountedWalk::pose_only), fit);
  for (CountedWalk& walk : counted) walk.pose_only = 0;
  // Not what they are compiled for: only chains without free parameters are the same.
  (void)normal_equations(problem, x, &all);
  std::map<std::string, int> same = none;
  same["eye base"] = 3;
  EXPECT_EQ(calls(names, &CountedWalk::with_twists), same);
  EXPECT_EQ(calls(names, &CountedWalk::pose_only), none);
}

}  // namespace
}  // namespace kinecal
