// Joint positions against limits: units, exchanged names, numbers that no joint reaches.
#include "kinecal/config/doubts/joint_positions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "support/arm_scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class JointPositions : public test::ArmScene {
 protected:
  void expect_nothing() const {
    const Diagnostics diagnostics = found();
    EXPECT_THAT(diagnostics.errors, IsEmpty());
    EXPECT_THAT(diagnostics.doubts, IsEmpty());
    EXPECT_THAT(diagnostics.warnings, IsEmpty());
  }
};

TEST_F(JointPositions, WithinTheirLimitsAreRight) {
  expect_nothing();
}

TEST_F(JointPositions, InDegreesAreAnErrorThatNamesAllJoints) {
  for (Sample& sample : samples) {
    for (double& q : sample.joint_positions) q *= 180.0 / std::numbers::pi;
  }
  const Diagnostics diagnostics = found();
  ASSERT_FALSE(diagnostics.errors.empty());
  EXPECT_THAT(
      diagnostics.errors[0],
      AllOf(testing::ContainsRegex("^s.yaml:[0-9]+: positions of 'pan' reach -?1[0-9][0-9]"),
            HasSubstr("its limits are ±2.9 rad: they look like degrees"),
            HasSubstr("so do those of 'lift', 'elbow', 'roll', 'flex'"),
            HasSubstr("must be in radians")));
}

TEST_F(JointPositions, InDegreesAreAnErrorWithoutLimits) {
  while (urdf.find("revolute") != std::string::npos) replace(urdf, "revolute", "continuous");
  expect_nothing();
  for (Sample& sample : samples) {
    for (double& q : sample.joint_positions) q *= 180.0 / std::numbers::pi;
  }
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("look like degrees")));
}

TEST_F(JointPositions, OfOneJointThatIsWoundUpAreRight) {
  replace(urdf, "name=\"roll\" type=\"revolute\"", "name=\"roll\" type=\"continuous\"");
  for (Sample& sample : samples) position(sample, "roll") += 40 * std::numbers::pi;
  expect_nothing();
}

TEST_F(JointPositions, OfOneJointBeyondItsLimitsAreNotInDegrees) {
  for (Sample& sample : samples)
    position(sample, "lift") *= 2.7;  // as if they were another joint's
  EXPECT_THAT(found().errors, testing::Not(testing::Contains(HasSubstr("degrees"))));
}

TEST_F(JointPositions, AWholeTurnBeyondTheLimitsAreTheSamePose) {
  for (Sample& sample : samples) position(sample, "flex") += 2 * std::numbers::pi;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, ElementsAre(HasSubstr("'flex' is outside its limits")));
}

TEST_F(JointPositions, HalfATurnBeyondTheLimitsIsAnotherZeroAndNotDegrees) {
  for (Sample& sample : samples) position(sample, "lift") += std::numbers::pi;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("are inside: is its zero another one")));
}

TEST_F(JointPositions, AreNotInAnotherOrderIfThatOrderIsTheirOwn) {
  const auto rename = [&](const std::string& from, const std::string& to) {
    while (urdf.find('"' + from + '"') != std::string::npos) {
      replace(urdf, '"' + from + '"', '"' + to + '"');
    }
    for (Sample& sample : samples) {
      for (std::string& name : sample.joint_names) name = name == from ? to : name;
    }
  };
  rename("pan", "a_pan");  // the order of the alphabet is that of the chain
  rename("roll", "m_roll");
  rename("flex", "z_flex");
  rename("lift", "b_lift");
  replace(config_text, "- lift", "- b_lift");
  replace(config_text, "- roll", "- m_roll");
  replace(config_text, "- flex", "- z_flex");
  for (const int n : {3, 7}) position(samples[n], "b_lift") = 1.9;  // less than 2 % of all
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("'b_lift' is outside its limits")));
}

TEST_F(JointPositions, WithAnotherZeroNameTheSmallestTurnThatBringsAllInside) {
  replace(urdf, R"(lower="-1.2" upper="1.4")", R"(lower="-0.01" upper="3.7")");
  double step = 0.0;
  for (Sample& sample : samples) {  // from -0.42 to 0.91
    position(sample, "lift") = -0.42 + (step += 1.33 / static_cast<double>(samples.size()));
  }
  position(samples.front(), "lift") = -0.42;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("with +1.57 rad they are inside")));
}

TEST_F(JointPositions, ThatATurnExplainsAreNoErrorAboutTheSign) {
  for (Sample& sample : samples) position(sample, "flex") += 0.5 * std::numbers::pi;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("is its zero")));
  EXPECT_THAT(diagnostics.refutable, IsEmpty());
}

TEST_F(JointPositions, OfAZeroThatTheConfigurationHasAreRight) {
  for (Sample& sample : samples) position(sample, "flex") += 0.5 * std::numbers::pi;
  config_text += "initial_values: {flex: -1.5707963}\n";
  expect_nothing();
}

TEST_F(JointPositions, UnderExchangedNamesAreADoubtThatAFitRefutes) {
  for (Sample& sample : samples) position(sample, "roll") *= 0.3;  // inside those of lift
  for (std::size_t n = 0; n < 3; ++n) {  // inside those of roll, and no turn brings all inside
    position(samples[n], "lift") = -2.5;
    position(samples[n + 3], "lift") = 2.5;
  }
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.doubts, ElementsAre(HasSubstr("if these two names are exchanged")));
  EXPECT_EQ(diagnostics.refutable, diagnostics.doubts);
}

TEST_F(JointPositions, SlightlyBeyondTheLimitsAreAWarningThatStandsOnce) {
  position(samples[3], "pan") = 2.95;
  position(samples[7], "pan") = -2.97;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
  EXPECT_THAT(diagnostics.warnings,
              ElementsAre("s.yaml:31: position of 'pan' is outside its limits ±2.9 rad (and in 1 "
                          "more sample), by up to 0.07 rad"));
}

TEST_F(JointPositions, FarBeyondTheLimitsAreADoubt) {
  position(samples[3], "lift") = -2.5;
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts,
              ElementsAre(AllOf(HasSubstr("s.yaml:31: position of 'lift'"), HasSubstr("1.3 rad"))));
}

TEST_F(JointPositions, ThatNoJointReachesAreNamedWithTheirPlace) {
  position(samples[5], "roll") = 1e6;
  EXPECT_THAT(found().errors,
              ElementsAre(AllOf(HasSubstr("s.yaml:51: position of 'roll' is 1e+06 rad"),
                                HasSubstr("correct or remove the sample"))));
}

TEST_F(JointPositions, OfJointsThatDoNotMatterDoNotMatter) {
  for (Sample& sample : samples) {
    sample.joint_names.insert(sample.joint_names.begin(), "wheel");
    sample.joint_positions.insert(sample.joint_positions.begin(), 1e7);
  }
  expect_nothing();
}

TEST_F(JointPositions, UnderExchangedNamesNameThePair) {
  for (Sample& sample : samples) std::swap(position(sample, "elbow"), position(sample, "flex"));
  EXPECT_THAT(found().errors,
              ElementsAre(AllOf(HasSubstr("all positions of 'elbow' and 'flex' are within"),
                                HasSubstr("if these two names are exchanged"))));
}

TEST_F(JointPositions, WithTheWrongSignAreAnError) {
  for (Sample& sample : samples) position(sample, "elbow") *= -1.0;
  EXPECT_THAT(found().errors, ElementsAre(AllOf(HasSubstr("position of 'elbow' is -"),
                                                HasSubstr("within them with the other sign"))));
}

TEST_F(JointPositions, InTheOrderOfTheAlphabetAreAnError) {
  for (Sample& sample : samples) {
    std::sort(sample.joint_names.begin(), sample.joint_names.end());  // positions stay as they are
  }
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr(
                                  "all positions are within their limits if they are in the order "
                                  "of the chain and the names in that of the alphabet")));
}

TEST_F(JointPositions, IgnoreLimitsThatSayNothing) {
  replace(urdf, "lower=\"-2.9\" upper=\"2.9\"", "lower=\"0\" upper=\"0\"");
  replace(urdf, "lower=\"-1.2\" upper=\"1.4\"", "lower=\"-1e16\" upper=\"1e16\"");
  expect_nothing();
}

TEST_F(JointPositions, InMillimetresAreAnError) {
  replace(urdf, "name=\"pan\" type=\"revolute\"", "name=\"pan\" type=\"prismatic\"");
  for (Sample& sample : samples) position(sample, "pan") *= 1000.0;
  const auto errors = found().errors;
  ASSERT_FALSE(errors.empty());
  EXPECT_THAT(errors[0], HasSubstr("they look like millimetres; positions must be in metres"));
}

TEST_F(JointPositions, ThatStopWhileOtherJointsMoveAreADoubtThatAFitRefutes) {
  for (std::size_t n = 20; n < samples.size(); ++n) {
    position(samples[n], "elbow") = position(samples[19], "elbow");
  }
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.doubts,
              testing::Contains(AllOf(HasSubstr("s.yaml:191: the reading of 'elbow' is"),
                                      HasSubstr("in this and all 10 samples after it"))));
  EXPECT_EQ(diagnostics.refutable, diagnostics.doubts);
  for (Sample& sample : samples) position(sample, "elbow") = position(samples[19], "elbow");
  EXPECT_THAT(found().doubts, testing::Not(testing::Contains(HasSubstr("has its driver"))));
}

TEST_F(JointPositions, UnderAMisspeltShortNameAreAnErrorThatNamesIt) {
  replace(urdf, "\"pan\"", "\"a3\"");
  for (Sample& sample : samples) sample.joint_names[0] = "a33";
  EXPECT_THAT(
      test::thrown<InputError>([&] { (void)found(); }),
      AllOf(HasSubstr("joint 'a3' is not in the sample"), HasSubstr("; did you mean 'a33'?")));
}

TEST_F(JointPositions, OfAJointThatNeverMovesAreADoubtIfItsOffsetIsFree) {
  for (Sample& sample : samples) position(sample, "pan") = 0.3;
  EXPECT_THAT(found().doubts, testing::Not(testing::Contains(HasSubstr("never moves"))));
  for (Sample& sample : samples) position(sample, "roll") = 0.25;
  EXPECT_THAT(found().doubts,
              testing::Contains(AllOf(HasSubstr("c.yaml:8: the offset of 'roll' is free"),
                                      HasSubstr("it is at 0.25 in all 30 samples"))));
}

}  // namespace
}  // namespace kinecal
