// Definitions of touch_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/touch_finder.hpp"

namespace kinecal {

Found TouchFinder::find(const View& /*view*/) const {
  Feature touched{frame, place};
  if (has_direction) touched.rotation = Matrix3<double>::Identity();
  return {{{chain_sensor, {{tip, Vector3<double>::Zero()}}}, {touched_sensor, {touched}}}, "", {}};
}

}  // namespace kinecal
