// A calibrator of a user's own: an arm of two joints, seen by a tracker on its base.
#include <cstdio>

#include "kinecal/errors.hpp"
#include "kinecal/solve.hpp"
#include "robots/arm.hpp"

using namespace kinecal;

using Tip = Chain<arm::Robot, "base", "tip">;
using Shoulder = JointOffset<"shoulder">;
using Elbow = JointOffset<"elbow">;
using Tracked = Crate<Chain3d<"arm", Tip>, Chain3d<"tracker", Chain<arm::Robot, "base", "base">>,
                      Shoulder, Elbow, Block<"tracking", PointToPoint, "arm", "tracker">>;

int main() {
  const double shoulder = 0.02, elbow = -0.03;  // how far the zeros are off, radians
  std::vector<Sample> samples;
  for (int n = 0; n < 10; ++n) {
    const double a = 0.2 * n - 1.0, b = 1.0 - 0.1 * n;
    const auto true_position = [&](const std::string& joint) {
      return joint == "shoulder" ? a + shoulder : b + elbow;
    };
    const Vector3<double> seen = forward_kinematics(Tip{}, true_position).translation;
    samples.push_back({{"shoulder", "elbow"},
                       {a, b},
                       {{"arm", {{"tip", {0, 0, 0}}}}, {"tracker", {{"base", seen}}}},
                       "pose " + std::to_string(n)});
  }
  const CrateResult<Tracked> result = calibrate(Tracked(), samples);
  std::printf("%s\nshoulder %.6f rad, elbow %.6f rad\n", result.termination.c_str(),
              result.value<Shoulder>(), result.value<Elbow>());
  const double wrong =
      std::abs(result.value<Shoulder>() - shoulder) + std::abs(result.value<Elbow>() - elbow);
  return result.converged && wrong < 1e-9 ? 0 : 1;
}
