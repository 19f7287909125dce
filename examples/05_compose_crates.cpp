// Composing crates: two calibrations together determine what neither does alone.
//
// LEDs in the gripper determine the pose of head and arm relative to each other, but not the tilt
// of both against the base.  The floor determines the camera's pose on the base, but not whether
// the head or the torso is tilted.  A crate of both crates has the parameters of each, once, and
// determines them all.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors.hpp"
#include "kinecal/solve.hpp"
#include "kinecal/trust.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

template <FixedString Tip>
using FromBase = Chain<mobile_manipulator::Robot, "base_link", Tip>;
using Arm = Chain3d<"arm", FromBase<"gripper_link">>;
using Camera = Camera3d<"camera", FromBase<"head_camera_rgb_optical_frame">>;
using Elbow = JointOffset<"elbow_flex_joint">;
using Tilt = JointOffset<"head_tilt_joint">;
using Head = FrameOffset<"head_pan_joint">;  // how the head is mounted on the torso
using Torso =
    FrameOffset<"torso_lift_joint",
                Axes{.z = true, .a = true, .b = true}>;  // how the torso leans on the base

using HandEye =
    Crate<Arm, Camera, Elbow, Head, Torso, Block<"hand_eye", PointToPoint, "camera", "arm">>;
using Ground = Crate<Camera, Tilt, Head, Torso, Block<"ground", PointToPlane, "camera">>;
using Both = Crate<HandEye, Ground>;
static_assert(Both::Free::kSize == 1 + 6 + 3 + 1, "each once");

/// A sample of a pose in which the camera sees at least four of these points of a link.
Sample see(const std::string& link, const std::vector<Vector3<double>>& points,
           const ParameterTable& truth, SeededRandom& random) {
  static const Robot robot = Both::robot();
  const std::string eye(Camera::Chain::kTip);
  for (;;) {
    Sample sample = random_pose(robot, random);
    const Pose<double> eye_T_link = true_pose(robot, truth, eye, link, sample);
    const Look look = look_at(points, link, "camera", eye, eye_T_link, random);
    if (look.seen.features.size() < 4) continue;
    sample.observations = {look.seen};
    if (link == Arm::Chain::kTip) sample.observations.push_back({"arm", look.known.features});
    return sample;
  }
}

/// Number of parameter combinations of a crate that are observable from these samples; prints it,
/// and those that are not.
template <class C>
int rank_of(const char* name, const std::vector<Sample>& samples) {
  C crate;
  if constexpr (!std::is_same_v<C, HandEye>)
    crate.template block<"ground">().options.exclusive = true;
  const ParameterTable table = C().table(samples);
  Problem problem = crate.problem(table);
  for (const Sample& sample : samples) problem.add_sample(sample);
  const std::vector<double> drawn(static_cast<std::size_t>(table.size()), 0.0);
  const Observability seen = observability(problem, C::free(table), drawn);
  std::printf("%-8s %d of %zu observable\n", name, seen.rank, C::Free::kSize);
  for (const Combination& combination : seen.unobservable) {
    std::printf("   not");
    for (const auto& [i, factor] : combination) {
      std::printf(" %+.3g %s", factor, table[i].name.c_str());
    }
    std::printf("\n");
  }
  return seen.rank;
}

}  // namespace

int main() {
  ParameterTable truth = Both().table({});
  truth["head_tilt_joint"].value = -1.5 * kDegree;
  truth["head_pan_joint_b"].value = 0.5 * kDegree;
  truth["torso_lift_joint_b"].value = -1.0 * kDegree;
  const std::vector<Vector3<double>> leds = {
      {-0.06, 0.04, 0.04}, {-0.12, 0.04, 0.04}, {-0.12, -0.04, 0.04}, {-0.06, -0.04, 0.04}};
  std::vector<Vector3<double>> floor;
  for (int i = 0; i < 50; ++i) floor.emplace_back(0.5 + 0.2 * (i % 10), 0.4 * (i / 10) - 0.8, 0.0);
  SeededRandom random(5);
  std::vector<Sample> samples;
  for (int n = 0; n < 40; ++n) samples.push_back(see("gripper_link", leds, truth, random));
  for (int n = 0; n < 20; ++n) samples.push_back(see("base_link", floor, truth, random));

  bool as_expected = rank_of<HandEye>("hand_eye", samples) == 7;
  as_expected = rank_of<Ground>("ground", samples) == 4 && as_expected;
  as_expected = rank_of<Both>("both", samples) == 11 && as_expected;

  Both both;
  both.block<"ground">().options.exclusive = true;  // LEDs are not on the floor
  const CrateResult<Both> result = calibrate(both, samples);
  const double lean = result.value<Torso>()(2), of_head = result.value<Head>()(4);
  std::printf("\ntorso leans by %.3f, head by %.3f degrees\n", lean / kDegree, of_head / kDegree);
  const bool found = std::abs(lean + kDegree) < 1e-3 && std::abs(of_head - 0.5 * kDegree) < 2e-3;
  return result.converged && found && as_expected ? 0 : 1;
}
