// Your own error block: a ball bar.
//
// One end of a bar of known length turns in a socket on the table; the gripper holds the other end.
// So the arm's tip is always on a sphere, and joint positions are all that is recorded.  You write
// the struct PointToSphere below; the library differentiates it.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors/error_block.hpp"
#include "kinecal/solve.hpp"
#include "simulation.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

/// Distance of a point to a sphere, metres.
struct PointToSphere {
  Vector3<double> center;  ///< metres, in the base
  double radius;           ///< metres
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
    const Vector3<S> d = p_base - center.cast<S>();
    return Eigen::Matrix<S, 1, 1>(sqrt(d.squaredNorm()) - S(radius));
  }
};
static_assert(ErrorBlock<PointToSphere>);

const std::vector<std::string> kJoints = {"pan", "lift", "elbow", "wrist"};
const PointToSphere kBar{{0.45, 0.15, 0.0}, 0.30};

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
  Problem problem(robot, "base", table, {});
  problem.add_sensor({"arm", SensorType::chain3d, "tip", ""});
  problem.add_block("ball_bar", kBar, {"arm"});
  return problem;
}

/// Distance of the true arm's tip, with its wrong zeros, from the sphere: metres.
double miss(const Problem& problem, const Sample& sample, const Eigen::VectorXd& truth) {
  const auto position = [&](const std::string& joint) {
    return *sample.position(joint) + truth(problem.table().index(joint));
  };
  return kBar(forward_kinematics(problem.sensors()[0].chains()[0], position).translation)(0);
}

/// A pose in which the bar fits: the elbow bends until it does, the other joints are random.
Sample hold_bar(const Problem& problem, const Eigen::VectorXd& truth, SeededRandom& random) {
  Sample sample{kJoints, {0, 0, 0, 0}, {{"arm", {{"tip", Vector3<double>::Zero()}}}}, "bar"};
  std::vector<double>& q = sample.joint_positions;
  for (;;) {
    q = {random.uniform(-0.6, 1.0), random.uniform(-0.8, 0.8), 0.0, random.uniform(-1.2, 1.2)};
    const auto is_outside = [&](double elbow) {
      q[2] = elbow;
      return miss(problem, sample, truth) > 0.0;
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
  const Eigen::VectorXd truth = Eigen::Vector4d(-1.5, 1.2, -0.8, 2.0) * kDegree;
  SeededRandom random(3);
  for (int n = 0; n < 40; ++n) problem.add_sample(hold_bar(problem, truth, random));

  Eigen::VectorXd values = problem.table().values();
  const StepResult result = solve(problem, FreeSet({0, 1, 2, 3}, 4), values);
  const auto rms_mm = [](double cost) { return 1e3 * std::sqrt(2.0 * cost / 40); };
  std::printf("distance to the sphere: %.3f mm before, %.3f mm after\n",
              rms_mm(result.initial_cost), rms_mm(result.final_cost));
  for (int i = 0; i < 4; ++i) {
    std::printf("  %-6s true %6.3f  found %6.3f degrees\n", problem.table()[i].name.c_str(),
                truth(i) / kDegree, values(i) / kDegree);
  }
  return result.converged && (values - truth).norm() < 0.05 * kDegree ? 0 : 1;
}
