// Where a lift's platform is, and a check of a block, in a user's own program that links nothing.
#include <cmath>
#include <cstdio>

#include "kinecal/kinematics.hpp"
#include "kinecal/testing.hpp"

/// The floor is at z = 0.
struct Height {
  static constexpr const char* kUnit = "m";
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const kinecal::Vector3<S>& p_base) const {
    return Eigen::Matrix<S, 1, 1>(p_base.z());
  }
};

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
  if (check_block(Height{}, Vector3<double>(1.0, 2.0, 0.0)) != kLawsHold) return 1;
  return std::abs(base_T_platform.translation.z() - 0.75) < 1e-12 ? 0 : 1;
}
