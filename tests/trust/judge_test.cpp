#include "kinecal/trust/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "kinecal/trust/judge_places.ipp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

/// A calibration that is good, to be spoiled in one point.
struct Judged {
  test::NoisyScene scene{40};
  std::vector<Assessment> assessments;

  Judged() { assessments = {scene.solve_and_assess()}; }
  [[nodiscard]] Judgement judgement(const std::vector<std::string>& doubts = {}) const {
    return judge(scene.calibration, scene.result, assessments, doubts);
  }
  [[nodiscard]] BlockNoise& noise() { return assessments[0].noise[0]; }
  void set(const char* parameter, double value) { scene.result.table[parameter].value = value; }
};

void expect(const Judgement& judgement, Grade verdict, const char* reason) {
  EXPECT_EQ(judgement.verdict, verdict) << to_string(judgement.verdict);
  if (verdict == Grade::good) {
    EXPECT_THAT(judgement.reasons, testing::IsEmpty());
  } else {
    ASSERT_FALSE(judgement.reasons.empty());
    EXPECT_THAT(judgement.reasons.front(), HasSubstr(reason));
  }
}

TEST(Judge, IsGoodWhereEverythingIsAsItWasSaid) {
  expect(Judged().judgement(), Grade::good, "");
}

TEST(Judge, HasCausesBeforeWhatTheyExplain) {
  Judgement judgement;
  judgement.add(Grade::use_with_care, "large residuals");
  judgement.add_causes(Grade::use_with_care, {"backlash"});
  judgement.add(Grade::do_not_use, "huge residuals");
  judgement.add_causes(Grade::do_not_use, {"degrees", "a sign"});
  EXPECT_THAT(judgement.reasons, testing::ElementsAre("degrees", "a sign", "backlash",
                                                      "huge residuals", "large residuals"));
  EXPECT_EQ(judgement.causes, 3);
  EXPECT_EQ(judgement.remedies.size(), judgement.reasons.size());
  EXPECT_EQ(judgement.verdict, Grade::do_not_use);
}

TEST(Judge, NamesTheWorstOfManyChanges) {
  Judged judged;
  for (const char* name : {"elbow", "wrist", "head_tilt"}) judged.set(name, 0.5);
  judged.set("shoulder_lift", 0.7);
  const Judgement judgement = judged.judgement();
  expect(judgement, Grade::use_with_care, "'shoulder_lift' changed by 40.1 deg, and 3 more");
  EXPECT_EQ(judgement.reasons.size(), 1u);
}

/// Joints under wrong names do not fit to the noise of the sensor.
TEST(Judge, DropsDoubtsThatTheFitRefutes) {
  Judged judged;
  const std::vector<std::string> doubts = {"names are exchanged", "it is in millimetres"};
  const auto of = [&] {
    return judge(judged.scene.calibration, judged.scene.result, judged.assessments, doubts,
                 {doubts[0]});
  };
  EXPECT_THAT(of().reasons, testing::ElementsAre(doubts[1]));
  judged.noise().sigma = judged.noise().robust = 3.1 * judged.noise().given;
  EXPECT_THAT(of().reasons, testing::IsSupersetOf(doubts));
}

TEST(Judge, RefusesWhatDidNotConverge) {
  Judged judged;
  judged.scene.result.converged = false;
  judged.scene.result.termination = "did not converge: no way down";
  expect(judged.judgement(), Grade::do_not_use, "no way down");
}

TEST(Judge, ComparesTheNoiseWithTheSigmaThatWasGiven) {
  for (const auto& [times, verdict] : {std::pair(2.9, Grade::good),
                                       {3.1, Grade::use_with_care},
                                       {9.9, Grade::use_with_care},
                                       {10.1, Grade::do_not_use}}) {
    Judged judged;
    judged.noise().sigma = judged.noise().robust = times * judged.noise().given;
    judged.assessments[0].held_out.clear();
    expect(judged.judgement(), verdict, "sigma 1 mm given, residuals show");
  }
}

/// A sensor better than the model, a tracker of 20 um, is no reason to refuse.
TEST(Judge, TakesASigmaAsAClaimAboutResiduals) {
  Judged judged;
  judged.noise().given = 2e-5;
  judged.noise().sigma = judged.noise().robust = 3.5e-4;
  judged.assessments[0].held_out.clear();
  expect(judged.judgement(), Grade::use_with_care, "sigma is that of a residual");
}

TEST(Judge, ExpectsSmallerResidualsOfASmallRobot) {
  for (const auto& [size, verdict] : {std::pair(2.0, Grade::good), {0.3, Grade::use_with_care}}) {
    Judged judged;
    judged.noise().given = 0.0;
    judged.noise().sigma = judged.noise().robust = 2.5e-3;
    judged.assessments[0].held_out.clear();
    judged.assessments[0].size = size;
    expect(judged.judgement(), verdict, "residuals show distances of");
  }
}

/// Poses have neither metres nor pixels: they are judged by their distances and angles.
TEST(Judge, ComparesPosesByDistanceAndAngle) {
  constexpr double kDegree = 0.017453292519943295;
  struct Case {
    double distance, degrees, size;
    Grade verdict;
    const char* reason;
  };
  for (const Case& of : {Case{7e-3, 1.8, 2.0, Grade::good, ""},
                         {9e-3, 0.1, 2.0, Grade::use_with_care, "poses differ by 9 mm"},
                         {9e-3, 0.1, 0.4, Grade::do_not_use, "poses differ by 9 mm"},
                         {1e-3, 2.1, 2.0, Grade::use_with_care, "and 2.1 deg"},
                         {0.026, 0.1, 2.0, Grade::do_not_use, "the model does not fit"},
                         {1e-3, 6.1, 2.0, Grade::do_not_use, "the model does not fit"}}) {
    Judged judged;
    judged.noise().unit = "1";
    judged.noise().given = 0.0;
    judged.noise().sigma = judged.noise().robust = 5.0;
    judged.noise().distance = of.distance;
    judged.noise().angle = of.degrees * kDegree;
    judged.assessments[0].held_out.clear();
    judged.assessments[0].size = of.size;
    expect(judged.judgement(), of.verdict, of.reason);
    judged.noise().given = 5.0;  // a sigma is compared with the residuals alone
    expect(judged.judgement(), Grade::good, "");
  }
}

TEST(Judge, NamesWhatExplainsTheResiduals) {
  Judged judged;
  SystematicError& error = judged.assessments[0].systematic.emplace(
      SystematicError{.owner = "elbow", .course = ErrorCourse::backlash, .noise_left = 0.4});
  error.text = "with a backlash of 'elbow' of 1 deg";
  error.advice = "the model does not contain that";
  expect(judged.judgement(), Grade::use_with_care,
         "with a backlash of 'elbow' of 1 deg, the noise falls to 40 %; the model does not");
  error.refuse = true;
  expect(judged.judgement(), Grade::do_not_use, "with a backlash");
}

TEST(Judge, NamesASigmaInAnotherUnit) {
  Judged judged;
  judged.noise().given = 1.0;
  judged.assessments[0].held_out.clear();
  expect(judged.judgement(), Grade::do_not_use, "residuals show 1.0");
  EXPECT_THAT(judged.judgement().reasons.front(), HasSubstr("sigma must be in metres"));
  judged.noise().given = 0.04;  // too large, but it may be meant
  expect(judged.judgement(), Grade::good, "");
}

TEST(Judge, NamesPriorsThatTheSamplesContradict) {
  Judged judged;
  judged.assessments[0].pulls = {
      {"keep", judged.scene.result.table.index("head_pan_x"), 0.0087, 9.0}};
  expect(judged.judgement(), Grade::use_with_care,
         "prior 'keep' contradicts the samples: it shifts 'head_pan_x' by 8.7 mm, 9 "
         "times");
}

TEST(Judge, ComparesTheNoiseWithWhatRobotsReachWhereNoSigmaWasGiven) {
  for (const auto& [metres, verdict] : {std::pair(0.0079, Grade::good),
                                        {0.0081, Grade::use_with_care},
                                        {0.019, Grade::use_with_care},
                                        {0.021, Grade::do_not_use}}) {
    Judged judged;
    judged.noise().given = 0.0;
    judged.noise().sigma = judged.noise().robust = metres / std::sqrt(3.0);
    judged.assessments[0].held_out.clear();
    expect(judged.judgement(), verdict, "the model does not fit these samples");
  }
  for (const auto& [pixels, verdict] :
       {std::pair(3.9, Grade::good), {4.1, Grade::use_with_care}, {12.1, Grade::do_not_use}}) {
    Judged judged;
    judged.noise().unit = "px";
    judged.noise().given = 0.0;
    judged.noise().sigma = judged.noise().robust = pixels / std::sqrt(3.0);
    judged.assessments[0].held_out.clear();
    expect(judged.judgement(), verdict, "px");
  }
}

/// What a prior shifts is in the +-, and no sample takes it out.
TEST(Judge, AsksForSamplesOrForAnotherPrior) {
  Judged judged;
  ASSERT_TRUE(!judged.assessments[0].compared.empty());
  judged.assessments[0].compared[0].position = 0.008;
  judged.assessments[0].compared[0].elsewhere = 0.0;
  expect(judged.judgement(), Grade::use_with_care, "is known to 8 mm only; record more samples");
  EXPECT_EQ(judged.judgement().remedies.front().kind, Remedy::Kind::record);
  judged.assessments[0].pulls = {
      {.prior = "camera_mount", .parameter = 0, .shift = 0.1, .times = 3.0}};
  expect(judged.judgement(), Grade::use_with_care,
         "is known to 8 mm only, as the samples disagree with prior 'camera_mount'");
  EXPECT_EQ(judged.judgement().remedies.front().how, "loosen or remove prior 'camera_mount'");
}

TEST(Judge, RefusesWhatDeterminesNothing) {
  Judged judged;
  judged.assessments[0].uncertainty.determined = 1;
  expect(judged.judgement(), Grade::good, "");
  judged.assessments[0].uncertainty.determined = 0;
  expect(judged.judgement(), Grade::do_not_use, "determine none of its 10 free parameters");
  judged.assessments[0].parameters.clear();  // all of them ended at bounds
  expect(judged.judgement(), Grade::good, "");
}

TEST(Judge, RefusesFramesThatMayBeAnywhere) {
  ParameterTable table;
  Assessment step;
  for (const char* name : {"board_x", "board_y", "board_z"}) {
    step.parameters.push_back(table.add({.name = name, .unit = "m"}));
  }
  step.uncertainty.covariance = Eigen::MatrixXd(Eigen::Matrix3d::Zero());
  step.uncertainty.deviation =
      Eigen::VectorXd(Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()));
  const auto judged = [&](std::vector<Combination> open) {
    step.observability.unobservable = std::move(open);
    Judgement judgement;
    detail::judge_places(step, table, judgement);
    return judgement;
  };
  expect(judged({{{0, 1.0}, {1, 0.5}}, {{1, 1.0}}, {{2, 1.0}, {0, -2.0}}}), Grade::do_not_use,
         "in all directions where 'board' is");
  expect(judged({{{0, 1.0}, {1, 0.5}, {2, 1.0}}}), Grade::good, "");  // along a line only
}

TEST(Judge, WantsMoreResidualsThanParameters) {
  for (const auto& [rows, verdict] : {std::pair(20, Grade::good),
                                      {19, Grade::use_with_care},
                                      {15, Grade::use_with_care},
                                      {14, Grade::do_not_use}}) {
    Judged judged;
    judged.assessments[0].rows = rows;  // 10 parameters
    expect(judged.judgement(), verdict, "residuals are too few to check 10 parameters");
  }
}

TEST(Judge, ComparesTheHeldOutErrorWithTheNoise) {
  for (const auto& [times, verdict] :
       {std::pair(1.45, Grade::good), {1.55, Grade::use_with_care}, {3.05, Grade::do_not_use}}) {
    Judged judged;
    judged.assessments[0].held_out[0].held_out = times * std::sqrt(3.0) * judged.noise().sigma;
    expect(judged.judgement(), verdict, "on samples held out");
  }
}

TEST(Judge, CountsSamplesThatDoNotFitTheOthers) {
  for (const auto& [bad, verdict] : {std::pair(4, Grade::good),
                                     {5, Grade::use_with_care},
                                     {10, Grade::use_with_care},
                                     {11, Grade::do_not_use}}) {
    Judged judged;
    for (int i = 0; i < bad; ++i) {
      judged.assessments[0].captures[static_cast<std::size_t>(i)].bad = true;
    }
    expect(judged.judgement(), verdict, "of 40 samples do not fit the others");
  }
}

TEST(Judge, CountsSamplesThatWereLeftOutAsTheyDoNotFit) {
  for (const auto& [left_out, verdict] : {std::pair(0, Grade::good),
                                          {10, Grade::good},
                                          {11, Grade::use_with_care},
                                          {25, Grade::use_with_care},
                                          {26, Grade::do_not_use}}) {
    Judgement judgement;
    judge_left_out(left_out, 100, judgement);
    expect(judgement, verdict, "of 100 samples do not fit the others and were left out");
  }
}

TEST(Judge, DoubtsJointsThatAreFarOff) {
  constexpr double kDegree = 0.017453292519943295;
  for (const auto& [degrees, verdict] : {std::pair(14.0, Grade::good),
                                         {-16.0, Grade::use_with_care},
                                         {44.0, Grade::use_with_care},
                                         {46.0, Grade::do_not_use}}) {
    Judged judged;
    judged.set("elbow", degrees * kDegree);
    expect(judged.judgement(), verdict, "'elbow' changed by");
  }
}

TEST(Judge, AValueThatRanOffIsOneThatSamplesDoNotDetermine) {
  Judged judged;
  for (const char* name : {"elbow", "wrist"}) judged.set(name, 135.0);
  judged.assessments[0].size = 1.5;
  expect(judged.judgement(), Grade::do_not_use,
         "these samples do not determine 'elbow' (it ran off, by 7.73e+03 deg) and 1 more; record "
         "more poses");
  for (const char* name : {"elbow", "wrist"}) judged.set(name, 0.0);
  judged.set("head_pan_x", 1100.0);
  const Judgement judgement = judged.judgement();
  expect(judgement, Grade::do_not_use, "do not determine 'head_pan_x' (it ran off, by 1.1e+03 m);");
  EXPECT_EQ(judgement.remedies.front().kind, Remedy::Kind::record);
}

TEST(Judge, DoubtsIntrinsicsAndDepthThatAreFarOff) {
  for (const auto& [name, value] :
       {std::pair("camera_fx", 0.1), {"camera_z_offset", -0.11}, {"head_pan_x", 0.06}}) {
    Judged judged;
    judged.set(name, 0.8 * value);
    expect(judged.judgement(), Grade::good, "");
    judged.set(name, value);
    expect(judged.judgement(), Grade::use_with_care, name);
  }
  for (const auto& [name, value] : {std::pair("camera_fx", -0.31), {"head_pan_x", 0.31}}) {
    Judged judged;
    judged.set(name, value);
    expect(judged.judgement(), Grade::do_not_use, name);
  }
}

/// Of views that have poses of their own: the +- of the focal length is a share of the length that was found.
TEST(Judge, WantsViewsThatTellTheFocalLength) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  for (const auto& [value, deviation, reason] :
       {std::tuple(0.0, 0.04, ""),
        {0.0, 0.06, "these views do not tell the focal length of 'camera' (+- 6 %): tilt"},
        {-0.8, 0.02, "these views do not tell the focal length of 'camera' (+- 10 %): tilt"},
        {0.0, kNever, "these views do not tell the focal length of 'camera': tilt"}}) {
    Judged judged;
    judged.set("camera_fx", value);
    Assessment& step = judged.assessments[0];
    step.used = 6.0 * static_cast<double>(step.samples);
    const auto fx = std::find(step.parameters.begin(), step.parameters.end(),
                              judged.scene.result.table.find("camera_fx"));
    ASSERT_NE(fx, step.parameters.end());
    Eigen::VectorXd deviations = step.uncertainty.deviation.matrix();
    deviations(fx - step.parameters.begin()) = deviation;
    step.uncertainty.deviation = deviations;
    const auto told = testing::Contains(HasSubstr("tell the focal length"));
    const std::vector<std::string> reasons = judged.judgement().reasons;
    if (*reason == '\0') {
      EXPECT_THAT(reasons, testing::Not(told));
    } else {
      EXPECT_THAT(reasons, testing::Contains(HasSubstr(reason)));
    }
  }
}

TEST(Judge, WantsThePoseThatMattersToBeKnown) {
  for (const auto& [metres, verdict] : {std::pair(0.0049, Grade::good),
                                        {0.0051, Grade::use_with_care},
                                        {0.021, Grade::do_not_use}}) {
    Judged judged;
    judged.assessments[0].compared[0].position = metres;
    expect(judged.judgement(), verdict, "the position of 'hand' in 'camera_optical_frame'");
  }
  Judged further;
  PoseUncertainty second = further.assessments[0].compared[0];
  second.in = "second_camera";
  second.position = 0.008;
  further.assessments[0].compared.push_back(second);
  expect(further.judgement(), Grade::use_with_care, "the position of 'hand' in 'second_camera'");
  Judged judged;
  judged.assessments[0].compared[0].determined = false;
  expect(judged.judgement(), Grade::use_with_care, "do not determine");
}

TEST(Judge, NamesParametersAtTheirBounds) {
  Judged judged;
  judged.assessments[0].at_bound = {judged.scene.result.table.index("wrist")};
  expect(judged.judgement(), Grade::use_with_care, "'wrist' ended at its bound");
}

TEST(Judge, PassesDoubtsOnAndPutsTheGravestReasonFirst) {
  Judged judged;
  expect(judged.judgement({"positions look like degrees"}), Grade::use_with_care, "degrees");
  judged.scene.result.converged = false;
  judged.scene.result.termination = "failed";
  const Judgement both = judged.judgement({"positions look like degrees"});
  EXPECT_THAT(both.reasons, testing::ElementsAre("failed", "positions look like degrees"));
}

TEST(Reading, IsInTheUnitThatPeopleRead) {
  EXPECT_EQ(reading(0.0034, "m"), "3.4 mm");
  EXPECT_EQ(reading(-2.0, "m"), "-2 m");
  EXPECT_EQ(reading(0.01, "rad"), "0.573 deg");
  EXPECT_EQ(reading(1.25, "px"), "1.25 px");
  EXPECT_EQ(reading(0.5, "1"), "0.5");
}

}  // namespace
}  // namespace kinecal
