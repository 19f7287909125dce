// Your own error block with its own parameters: a ball bar in a socket at an unknown position.
//
// One end of the bar turns in a socket on the table; the gripper holds the other end.  So the tip
// is on a sphere, and joint positions are all you record.  Socket and length are known only to a
// centimetre, so they are free, too.  You write the struct BallBar; the library differentiates it.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/solve.hpp"
#include "simulation.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

/// Distance of a point to a sphere, metres.
struct BallBar {
  static constexpr const char* kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"x", "m"}, ParameterInfo{"y", "m"},
                                             ParameterInfo{"z", "m"}, ParameterInfo{"length", "m"}};
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base, const std::array<S, 4>& own) const {
    const Vector3<S> socket(own[0], own[1], own[2]);
    return Eigen::Matrix<S, 1, 1>((p_base - socket).norm() - own[3]);
  }
};

const std::vector<std::string> kJoints = {"pan", "lift", "elbow", "wrist"};
const std::array<double, 4> kBar = {0.45, 0.15, 0.0, 0.30};  // the true one, metres

/// The arm, its zeros and the bar.
Problem make_problem() {
  using enum JointType;
  const auto at = [](double x, double z) {
    return Pose<double>{Matrix3<double>::Identity(), {x, 0.0, z}};
  };
  const Robot robot("arm", {{"pan", revolute, "base", "shoulder", at(0, 0.25), {0, 0, 1}},
                            {"lift", revolute, "shoulder", "upper", at(0.1, 0.1), {0, 1, 0}},
                            {"elbow", revolute, "upper", "forearm", at(0.35, 0), {0, 1, 0}},
                            {"wrist", revolute, "forearm", "hand", at(0.3, 0), {0, 1, 0}},
                            {"mount", fixed, "hand", "tip", at(0.15, 0.05)}});
  ParameterTable table;
  for (const std::string& joint : kJoints) table.add({.name = joint});
  add_parameters(table, "bar", BallBar::kParameters);
  Problem problem(robot, "base", table, {});
  problem.add_sensor(ChainPoint{}, {"arm", "tip"});
  problem.add_block("bar", BallBar{}, {"arm"});
  return problem;
}

/// Distance of the true arm's tip from the true sphere, metres.
double miss(const Problem& problem, const Sample& sample, const Eigen::VectorXd& truth) {
  const auto position_of = [&](const std::string& joint) {
    return *sample.position(joint) + truth(problem.table().index(joint));
  };
  const auto& arm = problem.sensors()[0].chains()[0].chain();
  return BallBar{}(forward_kinematics(arm, position_of).translation, kBar)(0);
}

/// A pose in which the bar fits: the elbow bends until it does, the other joints are random.
Sample hold_bar(const Problem& problem, const Eigen::VectorXd& truth, SeededRandom& random) {
  Sample sample{kJoints, {0, 0, 0, 0}, {{"arm", {{"tip", Vector3<double>::Zero()}}}}, "bar"};
  std::vector<double>& q = sample.joint_positions;
  for (;;) {
    q = {random.uniform(-0.6, 1.0), random.uniform(-0.8, 0.8), 0.0, random.uniform(-1.2, 1.2)};
    const auto is_outside = [&](double elbow) {
      return q[2] = elbow, miss(problem, sample, truth) > 0.0;
    };
    double low = 0.2, high = 2.4;
    const bool low_is_outside = is_outside(low);
    if (is_outside(high) == low_is_outside) continue;
    for (int n = 0; n < 50; ++n) {  // bisection
      const double middle = 0.5 * (low + high);
      (is_outside(middle) == low_is_outside ? low : high) = middle;
    }
    for (double& position : q) position += 5e-5 * random.normal();  // encoders: 0.05 mrad
    return sample;
  }
}

}  // namespace

int main() {
  Problem problem = make_problem();
  Eigen::VectorXd truth(8), values(8);
  truth << 0.0, 1.2 * kDegree, -0.8 * kDegree, 2.0 * kDegree, kBar[0], kBar[1], kBar[2], kBar[3];
  values << 0.0, 0.0, 0.0, 0.0, 0.44, 0.16, 0.01, 0.29;
  SeededRandom random(3);
  for (int n = 0; n < 100; ++n) problem.add_sample(hold_bar(problem, truth, random));

  // A zero of the pan joint turns with the socket: no sample determines it, so it is not free.
  const StepResult result = solve(problem, FreeSet({1, 2, 3, 4, 5, 6, 7}, 8), values);
  std::printf("distance: %.3f mm RMS\n", 1e3 * std::sqrt(2.0 * result.final_cost / 100));
  for (int i = 1; i < 8; ++i) {
    std::printf("  %-10s true %7.4f  found %7.4f %s\n", problem.table()[i].name.c_str(), truth(i),
                values(i), i < 4 ? "rad" : "m");
  }
  return result.converged && (values - truth).cwiseAbs().maxCoeff() < 1e-3 ? 0 : 1;
}
