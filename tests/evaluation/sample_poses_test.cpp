// Poses that samples have of their own: eliminated as if they were parameters of one large problem.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "kinecal/evaluation/problem.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {
namespace {

/// Two cameras on a body; a board of 12 corners is held before them.
struct Rig {
  static constexpr std::array kFree = {"left_fx", "left_cx", "left_k1", "right_joint_x",
                                       "right_joint_b"};

  explicit Rig(int samples, double noise = 0.3) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto uniform = [&](double reach) {
      return std::uniform_real_distribution<double>(-reach, reach)(random);
    };
    CameraInfo info;
    info.width = 640;
    info.height = 480;
    info.distortion_model = "plumb_bob";
    info.d = {-0.1, 0.02, 0, 0, 0};
    info.k = {400, 0, 320, 0, 400, 240, 0, 0, 1};
    const auto lens = any_built_in(lens_camera("plumb_bob"));
    for (int n = 0; n < samples; ++n) {
      Sample sample;
      const Pose<double> body_T_board{exp(Vector3<double>(uniform(0.5), uniform(0.5), uniform(2))),
                                      {uniform(0.1), uniform(0.1), 0.6 + uniform(0.1)}};
      Observation board{"board", {}, {}}, left{"left", {}, info}, right{"right", {}, info};
      for (int i = 0; i < 12; ++i) {
        const Vector3<double> corner(0.08 * (i % 4) - 0.12, 0.08 * (i / 4) - 0.08, 0.0);
        const Vector3<double> p = body_T_board * corner;
        const auto see = [&](Observation& eye, double x) {
          const Eigen::Vector2d pixel =
              lens->predict(p - Vector3<double>(x, 0, 0), lens->settings(eye));
          eye.features.push_back(
              {eye.sensor,
               {pixel.x() + noise * normal(random), pixel.y() + noise * normal(random), 0}});
        };
        board.features.push_back({"board", corner});
        see(left, 0.0);
        see(right, 0.1);
      }
      sample.observations = {board, left, right};
      sample.poses["board"] =
          body_T_board *
          Pose<double>{exp(Vector3<double>(uniform(0.1), uniform(0.1), 0.05)), {0.01, -0.02, 0.03}};
      list.push_back(sample);
    }
  }

  /// @param own  the board has a pose of its own in each sample; else it stands where the sample says, corrected by
  ///             parameters that all share
  [[nodiscard]] std::unique_ptr<Problem> problem(bool own, Loss loss = {}) const {
    ParameterTable table;
    for (const char* name : {"left", "right"}) {
      add_parameters(table, name, LensCamera<PlumbBob>::kParameters);
    }
    for (const char* name : {"right_joint", "board"}) add_parameters(table, name, kFrameParameters);
    const Joint right{"right_joint",
                      JointType::fixed,
                      "left",
                      "right",
                      {Matrix3<double>::Identity(), {0.101, 0, 0}},
                      {},
                      {},
                      {}},
        board{"board", JointType::floating, "left", "board", {}, {}, {}, {}};
    auto made = std::make_unique<Problem>(Robot("rig", {right, board}), "left", table,
                                          std::set<std::string>{"right_joint", "board"});
    if (own) made->give_sample_poses({"board"});
    made->add_sensor(ChainPoint{}, {"board", "board"});
    made->add_sensor(LensCamera<PlumbBob>{}, {"left", "left"});
    made->add_sensor(LensCamera<PlumbBob>{}, {"right", "right"});
    made->add_block("left", PointToPixel{}, {"board", "left"}, {.loss = loss});
    made->add_block("right", PointToPixel{}, {"board", "right"}, {.sigma = 0.5, .loss = loss});
    for (const Sample& sample : list) made->add_sample(sample);
    return made;
  }
  [[nodiscard]] static FreeSet free_of(const AnyProblem& problem, bool with_board = false) {
    std::vector<int> all;
    for (const char* name : kFree) all.push_back(problem.table().find(name));
    if (with_board) {
      for (const auto axis : kFrameAxes) {
        all.push_back(problem.table().find(parameter_name("board", axis)));
      }
    }
    return {all, problem.table().size()};
  }

  std::vector<Sample> list;
};

std::vector<double> values_of(const AnyProblem& problem, double size) {
  std::vector<double> values(static_cast<std::size_t>(problem.table().size()), 0.0);
  int i = 0;
  for (const char* name : Rig::kFree) {
    values[static_cast<std::size_t>(problem.table().find(name))] =
        size * (++i % 2 == 0 ? 1.0 : -0.5);
  }
  return values;
}

/// The normal equations of each sample alone, with its board as parameters, at the fitted poses: their Schur
/// complements add up to those of the whole.
TEST(SamplePoses, AreTheSchurComplementOfTheLargeProblem) {
  for (const Loss loss : {Loss{}, Loss{LossType::huber, 0.8}}) {
    const Rig rig(5);
    const auto own = rig.problem(true, loss);
    const FreeSet free = Rig::free_of(*own);
    const std::vector<double> values = values_of(*own, 0.01);
    const auto evaluator = own->evaluator(free);
    const NormalEquations whole = evaluator->normal_equations(values);
    const auto poses = evaluator->sample_poses(values);
    double cost = 0.0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(5);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(5, 5);
    for (std::size_t s = 0; s < rig.list.size(); ++s) {
      Rig one(0);
      one.list = {rig.list[s]};
      one.list[0].poses["board"] = poses[s][0];
      const auto measured = one.problem(false, loss);
      const FreeSet both = Rig::free_of(*measured, true);
      const NormalEquations of = measured->evaluator(both)->normal_equations(values);
      const Eigen::MatrixXd by_board = of.hessian.bottomRightCorner(6, 6);
      EXPECT_LE(of.gradient.tail(6).norm(), 1e-6 * by_board.norm()) << "the pose is the best one";
      const Eigen::MatrixXd across = of.hessian.topRightCorner(5, 6) * by_board.inverse();
      cost += of.cost;
      gradient += of.gradient.head(5) - across * of.gradient.tail(6);
      hessian += of.hessian.topLeftCorner<5, 5>() - across * of.hessian.bottomLeftCorner(6, 5);
    }
    EXPECT_NEAR(whole.cost, cost, 1e-9 * cost);
    EXPECT_LE((whole.gradient - gradient).norm(), 1e-6 * gradient.norm());
    // As well as the poses are found.
    EXPECT_LE((whole.hessian - hessian).norm(), 1e-6 * hessian.norm());
  }
}

/// The gradient is that of the cost at the best poses.
TEST(SamplePoses, TheGradientIsThatOfTheBestCost) {
  const Rig rig(6);
  const auto problem = rig.problem(true);
  const FreeSet free = Rig::free_of(*problem);
  std::vector<double> values = values_of(*problem, 0.01);
  const auto evaluator = problem->evaluator(free);
  const NormalEquations at = evaluator->normal_equations(values);
  for (int c = 0; c < free.size(); ++c) {
    double& value =
        values[static_cast<std::size_t>(free.parameters()[static_cast<std::size_t>(c)])];
    const double before = value, step = 1e-6;
    value = before + step;
    const double above = evaluator->normal_equations(values, false).cost;
    value = before - step;
    const double below = evaluator->normal_equations(values, false).cost;
    value = before;
    EXPECT_NEAR((above - below) / (2.0 * step), at.gradient(c), 1e-5 * at.gradient.norm()) << c;
  }
}

TEST(SamplePoses, RowsSayHowMuchThePosesUseUp) {
  const Rig rig(4);
  const auto problem = rig.problem(true);
  double used = 0.0;
  int rows = 0;
  const std::vector<double> values = values_of(*problem, 0.0);
  const FreeSet free = Rig::free_of(*problem);
  (void)problem->evaluator(free)->evaluate(values, true, [&](int, int, const TermResiduals& of) {
    used += of.used.sum();
    rows += static_cast<int>(of.residual.size());
  });
  EXPECT_NEAR(used, 4 * 6, 1e-9);
  EXPECT_EQ(rows, 4 * 2 * 24);
  EXPECT_EQ(rows, problem->num_residuals());
}

TEST(SamplePoses, SamplesCanBeLeftOut) {
  const Rig rig(6);
  const auto all = rig.problem(true);
  Rig few(0);
  few.list = {rig.list[0], rig.list[2], rig.list[5]};
  const auto some = few.problem(true);
  all->exclude({1, 3, 4});
  const FreeSet free = Rig::free_of(*all);
  const std::vector<double> values = values_of(*all, 0.01);
  EXPECT_NEAR(all->evaluator(free)->normal_equations(values).cost,
              some->evaluator(free)->normal_equations(values).cost, 1e-9);
}

TEST(SamplePoses, WhatCannotBeIsRefused) {
  const Rig rig(1);
  const auto problem = rig.problem(true);
  EXPECT_THROW((void)problem->evaluator(Rig::free_of(*problem, true)), std::invalid_argument)
      << "the pose is free as well";
  ParameterTable table;
  add_parameters(table, "right_joint", kFrameParameters);
  Problem other(problem->robot(), "left", table, {"right_joint"});
  EXPECT_THROW(other.give_sample_poses({"right_joint"}), std::invalid_argument) << "it is fixed";
  EXPECT_THROW(other.give_sample_poses({"bord"}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
