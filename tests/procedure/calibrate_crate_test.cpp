#include "kinecal/procedure/calibrate_crate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/errors.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/trust/plain_equations.hpp"
#include "support/mesh_robot_test.hpp"
#include "support/oracle.hpp"
#include "support/static_robot.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::StaticRobot;
using testing::HasSubstr;

template <FixedString Tip>
using FromBase = Chain<StaticRobot, "base", Tip>;
using Elbow = JointOffset<"elbow">;
using Moved = FrameOffset<"mount", Axes::xyz>;
using Tracked = Crate<Chain3d<"arm", FromBase<"tip">>, Chain3d<"tracker", FromBase<"base">>, Elbow,
                      Moved, Block<"tracking", PointToPoint, "arm", "tracker">>;

TEST(CalibrateAndJudge, GivesACrateValuesWithTheirDeviationsAndTheVerdict) {
  constexpr double kElbow = 0.02, kNoise = 1e-4;
  ParameterTable truth = Tracked().table({});
  truth["elbow"].value = kElbow;
  const test::OracleValues<double> of_robot(truth, truth.values());
  test::Chance chance(5);
  std::vector<Sample> samples;
  for (int n = 0; n < 40; ++n) {
    Sample& sample = samples.emplace_back();
    sample.source = "sample " + std::to_string(n);
    for (const char* joint : {"lift", "pan", "elbow", "wrist"}) {
      sample.joint_names.emplace_back(joint);
      sample.joint_positions.push_back(chance(-1.0, 1.0));
    }
    const auto tip =
        test::oracle_pose(robot_from<StaticRobot>(), "base", "tip", "", sample, of_robot);
    sample.observations = {{"arm", {}, {}}, {"tracker", {}, {}}};
    for (int i = 0; i < 3; ++i) {
      const Vector3<double> p(0.1 * i, 0.05, 0.02 * i * i);
      const Vector3<double> noise(chance.normal(), chance.normal(), chance.normal());
      sample.observations[0].features.push_back({"tip", p});
      sample.observations[1].features.push_back({"base", Vector3<double>(tip(p) + kNoise * noise)});
    }
  }
  samples[11].joint_positions[2] += 0.3;
  const JudgedCrate<Tracked> judged = calibrate_and_judge(Tracked(), samples);
  EXPECT_EQ(judged.judgement.verdict, Grade::good) << judged.judgement.reasons.front();
  const double deviation = judged.deviation<Elbow>();
  EXPECT_GT(deviation, 0.0);
  EXPECT_LT(deviation, 1e-3);
  EXPECT_NEAR(judged.value<Elbow>(), kElbow, 4.0 * deviation);
  const Vector3<double> of_mount = judged.deviation<Moved>();
  EXPECT_TRUE((of_mount.array() > 0.0).all());
  ASSERT_EQ(judged.left_out.size(), 1u);
  EXPECT_EQ(judged.left_out[0].number, 12);
  EXPECT_THAT(judged.left_out[0].why, HasSubstr("likely cause: 'elbow' reads"));
}

/// The arm of mesh_robot.hpp as the compiler knows it.
struct MeshArm {
  static constexpr std::string_view kName = "arm";
  static constexpr std::array<JointData, 4> kJoints = {{
      {.name = "camera_joint", .parent = "base", .child = "camera"},
      {.name = "pan",
       .type = JointType::revolute,
       .parent = "base",
       .child = "upper",
       .origin = test::shifted(0, 0, 0.27),
       .axis = {0, 0, 1}},
      {.name = "lift",
       .type = JointType::revolute,
       .parent = "upper",
       .child = "fore",
       .origin = test::shifted(0, 0, 0.40),
       .axis = {0, 1, 0}},
      {.name = "elbow",
       .type = JointType::revolute,
       .parent = "fore",
       .child = "hand",
       .origin = test::shifted(0, 0, 0.33),
       .axis = {0, 1, 0}},
  }};
};
template <FixedString Tip>
using ToLink = Chain<MeshArm, "base", Tip>;
using OwnSurface =
    Surface3d<"surface", ToLink<"base">, ToLink<"upper">, ToLink<"fore">, ToLink<"hand">>;
using CameraFrame = FrameOffset<"camera_joint", Axes::all>;
using LooksAtItself =
    Crate<Camera3d<"camera", ToLink<"camera">>, OwnSurface, CameraFrame, JointOffset<"lift">,
          JointOffset<"elbow">, Block<"mesh", PointToMesh, "camera", "surface">>;

/// Crates of several links, associated as configurations are.
class CrateOfASurface : public test::MeshRobotTest {
 protected:
  [[nodiscard]] std::vector<Sample> clouds(const test::CloudPlan& plan) const {
    return test::mesh_robot_samples(robot_from<MeshArm>(), plan);
  }
  [[nodiscard]] PreparedCalibration prepared(std::span<const Sample> samples) const {
    return prepare(LooksAtItself(), LooksAtItself().table(samples), samples, {}, urdf_, file());
  }
  [[nodiscard]] std::string file() const { return (folder_ / "arm.urdf").string(); }
  /// The true camera, with offsets of joints.
  [[nodiscard]] static Eigen::VectorXd truth(ParameterTable table, double lift, double elbow) {
    const Pose<double> pose = test::true_camera();
    const Vector3<double> turn = log(pose.rotation);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto axis = [&](Eigen::Index i) {
        return parameter_name("camera_joint", kFrameAxes[static_cast<std::size_t>(i)]);
      };
      table[axis(k)].value = pose.translation[k];
      table[axis(k + 3)].value = turn[k];
    }
    table["lift"].value = lift;
    table["elbow"].value = elbow;
    return table.values();
  }
};

TEST_F(CrateOfASurface, IsZeroAtTheTruth) {
  const PreparedCalibration at = prepared(clouds({.samples = 4, .offsets = {{"lift", 0.02}}}));
  ASSERT_THAT(at.diagnostics.errors, testing::IsEmpty());
  const AnyProblem& problem = *at.calibration.steps.front().problem;
  const Eigen::VectorXd values = truth(at.calibration.table, 0.02, 0.0);
  double most = 0.0;
  std::set<std::string> links;
  for (const Sample& sample : at.samples) {
    for (const Feature& feature : sample.observation("surface")->features) {
      links.insert(feature.frame);
    }
  }
  EXPECT_EQ(links.size(), 4U) << "points lie on all links";
  const auto undefined = evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())},
                                  nullptr, [&](int, int, const TermResiduals& rows) {
                                    most = std::max(most, rows.residual.cwiseAbs().maxCoeff());
                                  });
  EXPECT_FALSE(undefined);
  EXPECT_LT(most, 1e-6) << "vertices of files are floats";
}

/// Compiled walks to each link do what the walks of configurations do.
TEST_F(CrateOfASurface, HasTheSumsOfAConfiguration) {
  const std::vector<Sample> samples = clouds({.samples = 4, .pixels = 30, .noise = 0.001});
  const PreparedCalibration crate = prepared(samples);
  ASSERT_THAT(crate.diagnostics.errors, testing::IsEmpty());
  Diagnostics found;
  const Calibration config = assemble(*crate.config, crate.robot, crate.samples, found);
  ASSERT_THAT(found.errors, testing::IsEmpty());
  const auto sums = [](const Calibration& of, const std::vector<std::string>& names) {
    std::vector<int> free;
    for (const std::string& name : names) free.push_back(of.table.index(name));
    const Eigen::VectorXd values = truth(of.table, 0.01, -0.02);
    return plain_equations(*of.steps.front().problem, FreeSet(free, of.table.size()),
                           {values.data(), static_cast<std::size_t>(values.size())})
        .hessian.matrix();
  };
  const std::vector<std::string> names = {"camera_joint_x", "camera_joint_b", "lift", "elbow"};
  const Eigen::MatrixXd by_crate = sums(crate.calibration, names), by_config = sums(config, names);
  const double sigma = crate.config->steps[0].error_blocks[0].sigma.value_or(1.0);
  EXPECT_LT((by_crate - sigma * sigma * by_config).norm(), 1e-9 * by_crate.norm());
}

TEST_F(CrateOfASurface, FindsTheCameraAndOffsetsOfJoints) {
  const std::vector<Sample> samples =
      clouds({.noise = 0.001, .offsets = {{"lift", 0.02}, {"elbow", -0.03}}});
  const JudgedCrate<LooksAtItself> judged =
      calibrate_and_judge(LooksAtItself(), samples, {}, urdf_, file());
  ASSERT_TRUE(judged.is_usable()) << judged.judgement.reasons.front();
  EXPECT_NEAR(judged.value<JointOffset<"lift">>(), 0.02, 1e-3);
  EXPECT_NEAR(judged.value<JointOffset<"elbow">>(), -0.03, 1e-3);
  EXPECT_LT(judged.deviation<JointOffset<"lift">>(), 5e-3);
  EXPECT_LT(test::distance_of(test::camera_in(judged.result.table), test::true_camera()), 2e-3);
}

TEST_F(CrateOfASurface, NeedsTheMeshesOfItsRobot) {
  const std::vector<Sample> samples = clouds({.samples = 3});
  EXPECT_THAT(prepare(LooksAtItself(), LooksAtItself().table(samples), samples).diagnostics.errors,
              testing::ElementsAre(HasSubstr("without its URDF there are no meshes")));
}

}  // namespace
}  // namespace kinecal
