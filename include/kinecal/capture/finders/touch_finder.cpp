// Definitions of touch_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/touch_finder.hpp"

namespace kinecal {

Found TouchFinder::find(const View& /*view*/) const {
  Feature touches{tip, Vector3<double>::Zero()}, touched{frame, place};
  if (has_direction) touches.rotation = touched.rotation = Matrix3<double>::Identity();
  return {{{chain_sensor, {touches}}, {touched_sensor, {touched}}}, "", {}};
}

}  // namespace kinecal
