#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

std::vector<Sample> samples(int count = 3) {
  const Problem problem = test::scene_problem();
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  return test::exact_samples(problem, zero, count);
}

TEST(Problem, NamesTheNearestSensorForAMisspeltOne) {
  Problem problem = test::scene_problem();
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] {
              problem.add_block("b", PointToPoint{}, {"camra", "arm"});
            }),
            "no sensor 'camra'; did you mean 'camera'?");
}

TEST(Problem, TakesTypeAndUnitOfABlockUnlessOthersAreGiven) {
  Problem problem = test::scene_problem();
  const int first = problem.num_terms();
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"});
  problem.add_block("named", PointToPixel{}, {"arm", "eye"}, {.type = "mine", .unit = "1"});
  EXPECT_EQ(problem.term(first).options.unit, "px");
  EXPECT_EQ(problem.term(first).options.type, PointToPixel::kType);
  EXPECT_EQ(problem.term(first + 1).options.unit, "1");
  EXPECT_EQ(problem.term(first + 1).options.type, "mine");
}

/// A block that does not say what its residual is measured in.
struct WithoutUnit {
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p) const {
    return p;
  }
};

TEST(Problem, AsksForTheUnitOfABlock) {
  Problem problem = test::scene_problem();
  EXPECT_THAT(
      test::thrown<std::invalid_argument>(
          [&] { problem.add_block("b", WithoutUnit{}, {"camera"}); }),
      HasSubstr("error block 'b': its residual has no unit; write in it, for metres: static "
                "constexpr const char* kUnit = \"m\";"));
  problem.add_block("b", WithoutUnit{}, {"camera"}, {.unit = "m"});
  EXPECT_EQ(problem.term(problem.num_terms() - 1).options.type, "b");
}

TEST(Problem, RefusesTheWrongNumberOrKindOfSensors) {
  Problem problem = test::scene_problem();
  EXPECT_THAT(
      test::thrown<std::invalid_argument>([&] { problem.add_block("b", PointToPoint{}, {"arm"}); }),
      HasSubstr("takes 2 sensors, not 1"));
  EXPECT_THAT(test::thrown<std::invalid_argument>([&] {
                problem.add_block("b", PointToPoint{}, {"arm", "eye"});
              }),
              HasSubstr("sensor 'eye', a camera2d, does not deliver points"));
  EXPECT_THAT(test::thrown<std::invalid_argument>([&] {
                problem.add_block("b", PointToPixel{}, {"arm", "camera"});
              }),
              HasSubstr("sensor 'camera', a camera3d, does not deliver pixels"));
}

/// A block of 21 parameters of its own.
struct Many {
  static constexpr const char* kUnit = "m";
  static constexpr std::array<ParameterInfo, 21> kParameters = [] {
    std::array<ParameterInfo, 21> all;
    all.fill({"p"});
    return all;
  }();
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p, const std::array<S, 21>& own) const {
    return p * own[0];
  }
};

TEST(Problem, RefusesMoreParametersThanABlockCanHave) {
  Problem problem = test::scene_problem();
  EXPECT_THAT(
      test::thrown<std::invalid_argument>([&] { problem.add_block("b", Many{}, {"camera"}); }),
      HasSubstr("have 33 parameters; 32 are possible"));
}

TEST(Problem, NamesTheNearestParameterForAMisspeltPrior) {
  Problem problem = test::scene_problem();
  problem.add_prior("board", {"board", 1.0, 1.0, 1.0});
  problem.add_prior("elbow", {"elbow", 1.0, 1.0, 1.0});
  problem.add_prior("focus", {"camera_fx"});
  const auto message = [&](const char* param) {
    return test::thrown<std::invalid_argument>([&] { problem.add_prior("keep", {param}); });
  };
  EXPECT_EQ(
      message("elbw"),
      "error block 'keep': param 'elbw' is not a free joint, a free frame or a parameter; did "
      "you mean 'elbow'?");
  EXPECT_THAT(message("bord"), HasSubstr("did you mean 'board'?"));
  EXPECT_THAT(message("camera_z_ofset"), HasSubstr("did you mean 'camera_z_offset'?"));
  EXPECT_THAT(message("camera"), HasSubstr("'camera' is not a free joint"));  // which of them?
}

TEST(Problem, RefusesAMeanOfWhatAPriorIsNotOn) {
  Problem problem = test::scene_problem();
  Prior of_joint{"elbow"}, of_frame{"board"};
  of_joint.mean[0] = of_frame.mean[1] = of_frame.mean[6] = 0.1;
  problem.add_prior("elbow", of_joint);
  problem.add_prior("board", of_frame);
  of_joint.mean[1] = of_frame.mean[0] = 0.1;
  const auto message = [&](const Prior& prior) {
    return test::thrown<std::invalid_argument>([&] { problem.add_prior("keep", prior); });
  };
  EXPECT_EQ(message(of_joint),
            "error block 'keep': a mean_x is given, but 'elbow' has no such parameter");
  EXPECT_EQ(message(of_frame),
            "error block 'keep': a mean is given, but 'board' has no such parameter");
  EXPECT_EQ(problem.priors().size(), 2U);
}

TEST(Problem, NamesTheNearestParameterForAMisspeltFreeOne) {
  ParameterTable table = test::scene_table();
  table.add({.name = "elbw"});
  table.add({.name = "camera_fz"});
  Problem problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  const auto free = [&](const char* name) { return FreeSet({table.index(name)}, table.size()); };
  for (const char* name : {"elbow", "camera_fx", "board_c"}) {
    EXPECT_NO_THROW((void)problem.evaluator(free(name))) << name;
  }
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] { (void)problem.evaluator(free("elbw")); }),
            "free parameter 'elbw' belongs to no joint that moves, free frame, sensor or error "
            "block; did you "
            "mean 'elbow'?");
  EXPECT_THAT(
      test::thrown<std::invalid_argument>([&] { (void)problem.evaluator(free("camera_fz")); }),
      HasSubstr("free parameter 'camera_fz' belongs to no"));
  EXPECT_THAT(
      test::thrown<std::invalid_argument>([&] { (void)problem.evaluator(FreeSet({0}, 3)); }),
      HasSubstr("a free set of a table of 3 parameters; the problem's has"));
}

TEST(Problem, RefusesFewerPositionsThanJoints) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  Sample sample = samples()[0];
  sample.source = "s.yaml:3";
  sample.joint_positions.pop_back();
  EXPECT_THAT(
      test::thrown<SampleError>([&] { problem.add_sample(sample); }),
      testing::MatchesRegex("s.yaml:3: it has [0-9]+ joint names, but positions of [0-9]+"));
  EXPECT_EQ(sample.position(sample.joint_names.back()), std::nullopt);
}

TEST(Problem, TakesSensorsAndBlocksBeforeSamplesOnly) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  problem.add_sample(samples()[0]);
  EXPECT_THROW(problem.add_block("c", PointToPoint{}, {"camera", "arm"}), std::logic_error);
  EXPECT_THROW(problem.add_sensor(ChainPoint{}, {"again", "hand"}), std::logic_error);
}

TEST(Problem, ARefusedSampleIsNotAdded) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  Sample sample = samples()[0];
  sample.source = "s.yaml:3";
  sample.observations[0].features.pop_back();
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(sample); }),
              testing::AllOf(HasSubstr("s.yaml:3"), HasSubstr("sensor 'camera' has 4 features"),
                             HasSubstr("sensor 'arm' has 3")));
  EXPECT_EQ(problem.num_samples(), 0);
}

TEST(Problem, RefusesPointsThatSpanNoPlane) {
  Problem problem = test::scene_problem();
  problem.add_block("floor", PlaneToPlane{}, {"camera", "arm"});
  Sample line = samples()[0], few = samples()[1];
  line.source = "s.yaml:9";
  for (std::size_t i = 0; i < 4; ++i) {
    line.observations[1].features[i].point =
        Vector3<double>(0.1, 0.2, 1.0) * (1.0 + 0.1 * double(i));
  }
  EXPECT_EQ(test::thrown<SampleError>([&] { problem.add_sample(line); }),
            "s.yaml:9: error block 'floor': its points span no plane");
  few.observations[0].features.resize(2);
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(few); }),
              HasSubstr("a plane takes three points or more"));
  problem.add_sample(samples()[2]);
  EXPECT_EQ(problem.samples_of(0), 1);
}

TEST(Problem, ABlockAppliesToTheSamplesThatHaveItsSensors) {
  Problem problem = test::scene_problem();
  TermOptions alone;
  alone.exclusive = true;
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("floor", PointToPlane(0, 0, 1, 0), {"camera"});
  problem.add_block("floor_alone", PointToPlane(0, 0, 1, 0), {"camera"}, alone);
  auto all = samples(4);
  all[1].observations.erase(all[1].observations.begin());  // the arm
  all[2].observations = {all[2].observations[1]};          // the camera alone
  for (const Sample& sample : all) problem.add_sample(sample);
  EXPECT_EQ(problem.samples_of(0), 2);
  EXPECT_EQ(problem.samples_of(1), 4);
  EXPECT_EQ(problem.samples_of(2), 1);
  EXPECT_EQ(problem.shared_samples(1), 3);
}

TEST(Problem, KnowsWhichParametersItsSamplesTouch) {
  Problem problem = test::scene_problem();
  problem.add_block("floor", PointToPlane(0, 0, 1, 0), {"camera"});
  for (const Sample& sample : samples()) problem.add_sample(sample);
  std::vector<std::string> names;
  for (int i : problem.touched_parameters()) names.push_back(problem.table()[i].name);
  EXPECT_THAT(names, testing::Contains("head_tilt"));
  EXPECT_THAT(names, testing::Contains("camera_z_offset"));
  EXPECT_THAT(names, testing::Not(testing::Contains("elbow")));
  EXPECT_THAT(names, testing::Not(testing::Contains("board_x")));
}

TEST(Problem, FeaturesThatAreNoNumbersAreLeftOutEverywhere) {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  Sample sample = samples()[0];
  sample.observations[1].features[2].point.z() = std::nan("");
  problem.add_sample(sample);
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  Eigen::Index rows = 0;
  (void)evaluate(problem, zero, nullptr, [&](int, int, const TermResiduals& out) {
    rows = out.residual.size();
    EXPECT_TRUE(out.residual.allFinite());
  });
  EXPECT_EQ(rows, 9);
}

/// Camera against arm, the arm in the image, planes through both, the camera on the ground.
Problem four_blocks() {
  Problem problem = test::scene_problem();
  problem.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"});
  problem.add_block("ground", PointToPlane(0, 0, 1, 0), {"camera"});
  problem.add_prior("restrict", {"camera_joint", 0.0, 1.0, 1.0});
  return problem;
}

TEST(Problem, CountsResidualsAndSamplesOfMixedShapesWithMissingFeatures) {
  const double nan = std::nan("");
  Problem problem = four_blocks();
  auto all = samples(6);
  // Samples: as they are; a feature missing in camera and another in the arm; no arm; no camera;
  // no feature that camera and arm share; nothing but no-numbers in the eye.
  all[1].observations[1].features[0].point.x() = nan;
  all[1].observations[0].features[3].point.z() = nan;
  all[2].observations.erase(all[2].observations.begin());
  all[3].observations.erase(all[3].observations.begin() + 1);
  for (std::size_t i = 0; i < 2; ++i) {
    all[4].observations[0].features[i].point.setConstant(nan);
    all[4].observations[1].features[i + 2].point.setConstant(nan);
  }
  for (Feature& f : all[5].observations[2].features) f.point.setConstant(nan);
  for (const Sample& sample : all) problem.add_sample(sample);
  const int hand_eye = 3 * (4 + 2 + 0 + 0 + 0 + 4);
  const int reprojection = 2 * (4 + 3 + 0 + 4 + 2 + 0);
  const int ground = 1 * (4 + 3 + 4 + 0 + 2 + 4);
  EXPECT_EQ(problem.num_residuals(), hand_eye + reprojection + ground + Prior::kRows);
  EXPECT_EQ(problem.samples_of(0), 3);
  EXPECT_EQ(problem.samples_of(1), 4);
  EXPECT_EQ(problem.samples_of(2), 5);
  // With another block: hand_eye always; reprojection but for the sample without a camera; ground
  // but for the one without an arm.
  EXPECT_EQ(problem.shared_samples(0), 3);
  EXPECT_EQ(problem.shared_samples(1), 3);
  EXPECT_EQ(problem.shared_samples(2), 4);
  EXPECT_EQ(problem.num_samples(), 6);

  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  std::array<Eigen::Index, 3> rows = {};
  EXPECT_EQ(evaluate(problem, zero, nullptr,
                     [&](int t, int, const TermResiduals& out) {
                       rows[static_cast<std::size_t>(t)] += out.residual.size();
                     }),
            std::nullopt);
  EXPECT_EQ(rows, (std::array<Eigen::Index, 3>{hand_eye, reprojection, ground}));
}

TEST(Problem, CountsTheSameInPacketsAndInDoubles) {
  Problem packets = test::scene_problem();
  BasicProblem<double> numbers = test::scene_problem<double>();
  packets.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  numbers.add_block("hand_eye", PointToPoint{}, {"camera", "arm"});
  auto all = samples(7);
  all[2].observations.pop_back();
  all[3].observations.erase(all[3].observations.begin());
  all[5].observations[1].features[2].point.x() = std::nan("");
  for (const Sample& sample : all) {
    packets.add_sample(sample);
    numbers.add_sample(sample);
  }
  EXPECT_EQ(packets.num_residuals(), 3 * (6 * 4 - 1));
  EXPECT_EQ(packets.num_residuals(), numbers.num_residuals());
  EXPECT_EQ(packets.samples_of(0), numbers.samples_of(0));
  EXPECT_EQ(packets.touched_parameters(), numbers.touched_parameters());
  EXPECT_EQ(test::count_batches(numbers), 6);  // none for the sample that no block takes
}

/// What points into the problem goes where it goes.
TEST(Problem, RefusesTwoBlocksOrPriorsOfOneName) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  problem.add_prior("b", {.param = "elbow"});
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] {
              problem.add_block("b", PointToPixel{}, {"arm", "eye"});
            }),
            "two error blocks have the name 'b'; rename one of them");
  EXPECT_EQ(
      test::thrown<std::invalid_argument>([&] { problem.add_prior("b", {.param = "wrist"}); }),
      "two priors have the name 'b'; rename one of them");
}

TEST(Problem, RefusesNumbersThatCannotBeUsed) {
  Problem problem = test::scene_problem();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [&](const TermOptions& options) {
    return test::thrown<std::invalid_argument>([&] {
      problem.add_block("b", PointToPoint{}, {"camera", "arm"}, options);
    });
  };
  EXPECT_EQ(message({.scale = nan}),
            "error block 'b': scale is nan; it must be finite and not negative");
  EXPECT_EQ(message({.sigma = nan}), "error block 'b': sigma is nan; it must be positive");
  EXPECT_EQ(message({.sigma = 0.0}), "error block 'b': sigma is 0; it must be positive");
  EXPECT_EQ(message({.loss = {LossType::huber, -1.0}}),
            "error block 'b': the scale of its loss is -1; it must be positive");
  EXPECT_EQ(test::thrown<std::invalid_argument>(
                [&] { problem.add_prior("p", {.param = "elbow", .joint_scale = nan}); }),
            "error block 'p': a scale is nan; it must be finite");
  EXPECT_EQ(problem.num_terms(), 0);
  ParameterTable table = test::scene_table();
  table["elbow"].value = nan;
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] {
              Problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
            }),
            "parameter 'elbow': its value is not a finite number");
}

TEST(Problem, RefusesAFreeFrameThatNothingMoves) {
  EXPECT_EQ(test::thrown<std::invalid_argument>([&] {
              Problem(test::mobile_manipulator(), "base_link", test::scene_table(),
                      {"camra_joint"});
            }),
            "free frame 'camra_joint' is not a joint of the robot, and no parameter of it "
            "(camra_joint_x ... camra_joint_c) is in the table; did you mean 'camera_joint'?");
}

TEST(Problem, NamesASampleWithoutASourceByItsNumber) {
  Problem problem = test::scene_problem();
  problem.add_block("b", PointToPoint{}, {"camera", "arm"});
  Sample sample = samples(1)[0];
  sample.source.clear();
  problem.add_sample(sample);
  EXPECT_EQ(problem.source(0), "sample 0");
  Sample twice = sample;
  twice.observations.push_back(twice.observations[0]);
  EXPECT_EQ(test::thrown<SampleError>([&] { problem.add_sample(twice); }),
            "sample 1: it has two observations of sensor '" + twice.observations[0].sensor + "'");
  sample.joint_names.pop_back();
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(sample); }),
              testing::StartsWith("sample 1: it has "));
}

TEST(Problem, MayBeMoved) {
  Problem problem = four_blocks();
  for (const Sample& sample : samples(5)) problem.add_sample(sample);
  const std::vector<double> x = test::random_values(problem.table(), 0.01, 3);
  const double cost = normal_equations(problem, x, nullptr).cost;
  Problem moved = std::move(problem);
  EXPECT_EQ(normal_equations(moved, x, nullptr).cost, cost);
  for (const Sample& sample : samples(5)) moved.add_sample(sample);  // its packs take more
  constexpr double kSums = 1e-13;
  EXPECT_NEAR(normal_equations(moved, x, nullptr).cost, 2.0 * cost, kSums * cost);
}

}  // namespace
}  // namespace kinecal
