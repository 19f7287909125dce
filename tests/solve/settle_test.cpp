#include "kinecal/solve/settle.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(HoldUndetermined, KeepsTheCostAndGoesBackToTheStart) {
  test::NoisyScene scene(20);
  scene.names.push_back("shoulder_pan");
  scene.names.push_back("head_pan_c");
  const auto problem = scene.problem(scene.samples);
  const FreeSet free = scene.free();
  const Eigen::VectorXd start = test::scene_table().values();
  Eigen::VectorXd values = start;
  ASSERT_TRUE(solve(*problem, free, values).converged);
  const auto cost = [&] { return normal_equations(*problem, scene.span(values), nullptr).cost; };
  const double before = cost();
  const int pan = problem->table().index("shoulder_pan"),
            head = problem->table().index("head_pan_c");
  values(pan) += 0.3;  // along what nothing determines: both turn together
  values(head) += 0.3;
  const double after = hold_undetermined(*problem, free, start, values);
  EXPECT_NEAR(after, before, 1e-9 * before);
  EXPECT_NEAR(cost(), before, 1e-9 * before);
  EXPECT_LT(std::abs(values(pan) + values(head)), 0.05);
  Eigen::VectorXd again = values;
  (void)hold_undetermined(*problem, free, start, again);
  EXPECT_LT((again - values).norm(), 1e-8);
}

TEST(HoldUndetermined, LeavesWhatIsDeterminedAlone) {
  test::NoisyScene scene(20);
  scene.solve();
  const Eigen::VectorXd before = scene.values();
  Eigen::VectorXd values = before;
  (void)hold_undetermined(scene.solved(), scene.free(), test::scene_table().values(), values);
  EXPECT_EQ((values - before).norm(), 0.0);
}

TEST(WrapAngles, BringsOffsetsAndFramesWithinHalfATurn) {
  test::NoisyScene scene(1);
  const auto problem = scene.problem(scene.samples);
  const ParameterTable& table = problem->table();
  Eigen::VectorXd values = table.values();
  constexpr double kTurn = 2.0 * std::numbers::pi;
  values(table.index("elbow")) = 0.1 + 3.0 * kTurn;
  values(table.index("torso_joint")) = 7.0;  // metres
  const Vector3<double> axis = Vector3<double>(1.0, 2.0, -2.0) / 3.0;
  for (int k = 0; k < 3; ++k) {
    values(table.index(parameter_name("board", kFrameAxes[static_cast<std::size_t>(k) + 3]))) =
        (0.2 + kTurn) * axis(k);
  }
  std::vector<std::string> names = {"elbow", "torso_joint", "board_a", "board_b", "board_c"};
  wrap_angles(*problem, test::free_of(table, names), values);
  EXPECT_NEAR(values(table.index("elbow")), 0.1, 1e-12);
  EXPECT_EQ(values(table.index("torso_joint")), 7.0);
  EXPECT_NEAR(values(table.index("board_b")), 0.2 * axis.y(), 1e-12);
}

}  // namespace
}  // namespace kinecal
