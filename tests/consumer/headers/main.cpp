// Finds the offset of a joint, in a user's own program that links nothing of kinecal.
#include <cmath>
#include <cstdio>

#include "kinecal/solve.hpp"

int main() {
  using namespace kinecal;
  const Robot robot("pendulum", {{"pivot",
                                  JointType::revolute,
                                  "world",
                                  "bob",
                                  Pose<double>{Matrix3<double>::Identity(), {0, 0, 0.75}},
                                  {0, 0, 1}}});
  ParameterTable table;
  table.add({.name = "pivot"});
  Problem problem(robot, "world", table, {});
  problem.add_sensor(ChainPoint{}, {"bob", "bob"});
  problem.add_sensor(ChainPoint{}, {"tracker", "world"});
  problem.add_block("measured", PointToPoint{}, {"bob", "tracker"});
  for (double q : {0.0, 0.5, 1.0}) {
    const double true_q = q + 0.03;
    problem.add_sample({{"pivot"},
                        {q},
                        {{"bob", {{"bob", {1, 0, 0}}}},
                         {"tracker", {{"world", {std::cos(true_q), std::sin(true_q), 0.75}}}}},
                        "sample"});
  }
  Eigen::VectorXd values = problem.table().values();
  const StepResult result = solve(problem, FreeSet({0}, 1), values);
  std::printf("offset %.6f rad, %s\n", values(0), result.termination.c_str());
  return result.converged && std::abs(values(0) - 0.03) < 1e-9 ? 0 : 1;
}
