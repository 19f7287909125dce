// Definitions of error_sizes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/error_sizes.hpp"

#include "kinecal/sensors/depth/depth_polynomial.hpp"

namespace kinecal {

double error_size(const Robot& robot, const std::string& parameter, const ErrorSizes& sizes) {
  if (robot.has_joint(parameter)) {
    return turns(robot.joint(parameter).type) ? sizes.joint : sizes.sliding;
  }
  if (parameter.ends_with("_z_offset")) return sizes.z_offset;
  if (parameter.ends_with("_z_scaling")) return sizes.z_scaling;
  const std::string owner = parameter.substr(0, parameter.find_last_of('_'));
  for (const ParameterInfo& bend : kDepthPolynomial) {
    const bool has_name = parameter.ends_with("_" + std::string(bend.name));
    if (has_name && !robot.has_joint(owner)) return sizes.z_bend;
  }
  const std::string part = parameter.substr(parameter.find_last_of('_') + 1);
  if (part == "x" || part == "y" || part == "z") return sizes.position;
  if (part == "a" || part == "b" || part == "c") return sizes.rotation;
  const bool is_intrinsic = part == "fx" || part == "fy" || part == "cx" || part == "cy";
  return is_intrinsic ? sizes.intrinsics : 0.0;
}

}  // namespace kinecal
