// Measured poses of a floating joint in a problem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/scene.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

Joint joint(const char* name, JointType type, const char* parent, const char* child) {
  return {name, type, parent, child};
}

/// A camera beside a flange that carries a board: the flange floats, or slides and turns.
Robot stage(bool floats) {
  Joint camera = joint("camera_joint", JointType::fixed, "base", "camera");
  camera.origin = {exp(Vector3<double>(-1.2, 0.1, 0.3)), {0.2, -1.0, 0.4}};
  if (floats)
    return {"stage", {joint("flange_joint", JointType::floating, "base", "flange"), camera}};
  std::vector<Joint> joints;
  std::string parent = "base";
  for (int i = 0; i < 6; ++i) {
    const std::string name(kFloatingCoordinates[static_cast<std::size_t>(i)]);
    Joint one{name, i < 3 ? JointType::prismatic : JointType::continuous, parent,
              i < 5 ? "after_" + name : "flange"};
    one.axis = Vector3<double>::Unit(i < 3 ? i : 5 - i);
    parent = one.child;
    joints.push_back(one);
  }
  joints.push_back(camera);
  return {"stage", joints};
}

Problem problem_of(bool floats) {
  ParameterTable table;
  for (const char* frame : {"camera_joint", "board"}) {
    for (const auto axis : kFrameAxes) table.add({.name = parameter_name(frame, axis)});
  }
  Problem problem(stage(floats), "base", table, {"camera_joint", "board"});
  problem.add_sensor(ChainPoint{}, {"arm", "flange"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera"});
  problem.add_block("pixels", PointToPixel{}, {"arm", "eye"});
  return problem;
}

std::vector<Sample> samples(bool floats) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 0.2);
  std::vector<Sample> all;
  for (int n = 0; n < 11; ++n) {
    std::array<double, 6> at;
    for (double& number : at) number = normal(random);
    Sample& sample = all.emplace_back();
    Observation arm{"arm", {}, {}}, eye{"eye", {}, test::camera_info()};
    for (int f = 0; f < 5; ++f) {
      arm.features.push_back({"board", {normal(random), normal(random), 0.0}});
      eye.features.push_back({"camera", {320.0 + f, 240.0 - f, 0.0}});
    }
    sample.observations = {arm, eye};
    for (std::size_t i = 0; i < 6 && !floats; ++i) {
      sample.joint_names.emplace_back(kFloatingCoordinates[i]);
      sample.joint_positions.push_back(at[i]);
    }
    if (floats) sample.poses["flange_joint"] = floating_pose(at);
  }
  return all;
}

TEST(FloatingJointInAProblem, IsEvaluatedAsSlidersAndHingesAre) {
  std::vector<NormalEquations> found;
  for (const bool floats : {true, false}) {
    Problem problem = problem_of(floats);
    for (const Sample& sample : samples(floats)) problem.add_sample(sample);
    std::vector<int> all(static_cast<std::size_t>(problem.table().size()));
    std::iota(all.begin(), all.end(), 0);
    const FreeSet free(all, problem.table().size());
    std::vector<double> values(static_cast<std::size_t>(problem.table().size()), 0.02);
    found.push_back(problem.evaluator(free, 1)->normal_equations(values));
  }
  ASSERT_TRUE(std::isfinite(found[1].cost));
  EXPECT_NEAR(found[0].cost, found[1].cost, 1e-12 * found[1].cost);
  EXPECT_LE((found[0].hessian - found[1].hessian).norm(), 1e-11 * found[1].hessian.norm());
  EXPECT_LE((found[0].gradient - found[1].gradient).norm(), 1e-11 * found[1].gradient.norm());
}

TEST(FloatingJointInAProblem, AMissingPoseIsNamedByItsJoint) {
  Problem problem = problem_of(true);
  Sample sample = samples(true).front();
  sample.poses = {{"flange_jont", sample.poses.begin()->second}};
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(sample); }),
              HasSubstr("the pose of floating joint 'flange_joint' is not in the "
                        "sample; sensor 'arm' needs it; did you mean 'flange_jont'?"));
}

TEST(FloatingJointInAProblem, APoseThatIsNotANumberIsNamedByItsJoint) {
  Problem problem = problem_of(true);
  Sample sample = samples(true).front();
  sample.poses["flange_joint"].translation.y() = std::nan("");
  EXPECT_THAT(test::thrown<SampleError>([&] { problem.add_sample(sample); }),
              HasSubstr("the pose of floating joint 'flange_joint' is not a number"));
}

TEST(FloatingJointInAProblem, ALagNeedsVelocitiesThatAPoseDoesNotHave) {
  const Robot robot = stage(true);
  const ParameterTable table;
  EXPECT_THROW(SampledChain(robot, make_chain(robot, "base", "flange"), table, 0), RobotError);
}

}  // namespace
}  // namespace kinecal
