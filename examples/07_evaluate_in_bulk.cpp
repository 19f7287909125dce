// Evaluation in bulk: residuals, Jacobian and normal equations of 10 000 samples.
//
// An Evaluator evaluates as many samples at once as a register of the processor has lanes, on
// several threads.  It computes all that your own solver needs, without Ceres, and sums over parts
// of the samples add up to the whole.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "kinecal/core.hpp"
#include "kinecal/errors.hpp"
#include "robots/mobile_manipulator.hpp"
#include "simulation.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

using Arm = Chain3d<"arm", Chain<mobile_manipulator::Robot, "base_link", "gripper_link">>;
using Tracker = Chain3d<"tracker", Chain<mobile_manipulator::Robot, "base_link", "base_link">>;
using Tracked = Crate<Arm, Tracker, JointOffset<"shoulder_pan_joint">,
                      JointOffset<"shoulder_lift_joint">, JointOffset<"elbow_flex_joint">,
                      JointOffset<"wrist_flex_joint">, FrameOffset<"gripper_axis", Axes::xyz>,
                      Block<"tracking", PointToPoint, "arm", "tracker">>;

constexpr int kSamples = 10000;

/// A sample at a random pose; the tracker's noise is 1 mm.
Sample measure(SeededRandom& random) {
  static const Robot robot = Tracked::robot();
  Sample sample = random_pose(robot, random);
  const auto position_of = [&](std::string_view j) { return *sample.position(std::string(j)); };
  const Vector3<double> tip = forward_kinematics(Arm::Chain{}, position_of).translation;
  sample.observations = {{"arm", {{"gripper_link", Vector3<double>::Zero()}}},
                         {"tracker", {{"base_link", tip + 1e-3 * random.normal_vector()}}}};
  return sample;
}

Problem problem_of(std::span<const Sample> samples) {
  Problem problem = Tracked().problem(Tracked().table(samples));
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

/// Runs an evaluation five times and prints the best rate, samples per second.
template <class F>
void time_of(const char* name, F&& run) {
  std::chrono::duration<double> best = std::chrono::hours(1);
  for (int n = 0; n < 5; ++n) {
    const auto start = std::chrono::steady_clock::now();
    run();
    best = std::min<std::chrono::duration<double>>(best, std::chrono::steady_clock::now() - start);
  }
  std::printf("  %-40s %6.2f million samples a second\n", name, 1e-6 * kSamples / best.count());
}

bool same(const NormalEquations& a, const NormalEquations& b) {
  constexpr double kRounding = 1e-10;  // of sums in another order
  return a.gradient.isApprox(b.gradient, kRounding) && a.hessian.isApprox(b.hessian, kRounding);
}

}  // namespace

int main() {
  SeededRandom random(7);
  std::vector<Sample> samples;
  for (int n = 0; n < kSamples; ++n) samples.push_back(measure(random));
  const Problem problem = problem_of(samples);
  const FreeSet free = Tracked::free(problem.table());
  const std::vector<double> values(static_cast<std::size_t>(problem.table().size()), 0.0);
  Evaluator<Packet> packets(problem, free, 1), threads(problem, free);
  NormalEquations by_rows(free.size()), all(free.size()), shared(free.size());
  std::printf("%d samples, %d in a packet, %d parameters\n", kSamples, kLanes<Packet>, free.size());
  time_of("residuals and Jacobian, row by row", [&] {
    by_rows = NormalEquations(free.size());
    (void)packets.evaluate(values, true, [&](int, int, const TermResiduals& rows) {
      by_rows.gradient.noalias() += rows.jacobian.transpose() * rows.residual;
      by_rows.hessian.noalias() += rows.jacobian.transpose() * rows.jacobian;
    });
  });
  time_of("normal equations", [&] { all = packets.normal_equations(values); });
  time_of("the same, on all cores", [&] { shared = threads.normal_equations(values); });

  const std::span<const Sample> both(samples);
  NormalEquations halves(free.size());
  for (const auto half : {both.first(kSamples / 2), both.last(kSamples / 2)}) {
    halves += normal_equations(problem_of(half), values, &free);
  }
  const bool agree =
      same(all, by_rows) && same(all, halves) && shared.hessian == all.hessian;  // bit for bit
  std::printf("All of them, and the sums of two halves, %s.\n", agree ? "agree" : "DO NOT AGREE");
  return agree ? 0 : 1;
}
