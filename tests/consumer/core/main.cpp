// Where a lift's platform is, in a user's own program that links nothing.
#include <cmath>
#include <cstdio>

#include "kinecal/kinematics.hpp"

int main() {
  using namespace kinecal;
  const Robot robot("lift", {{"lift",
                              JointType::prismatic,
                              "base",
                              "platform",
                              Pose<double>{Matrix3<double>::Identity(), {0, 0, 0.5}},
                              {0, 0, 1}}});
  const RuntimeChain chain = make_chain(robot, "base", "platform");
  const Pose<double> base_T_platform =
      forward_kinematics(chain, [](const std::string&) { return 0.25; });
  std::printf("platform at %.2f m\n", base_T_platform.translation.z());
  return std::abs(base_T_platform.translation.z() - 0.75) < 1e-12 ? 0 : 1;
}
