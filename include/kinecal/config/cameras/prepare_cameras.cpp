// Definitions of prepare_cameras.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/prepare_cameras.hpp"

#include "kinecal/config/cameras/camera_checks.ipp"
#include "kinecal/config/cameras/find_lenses.hpp"
#include "kinecal/config/cameras/start_cameras.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/own_frames.hpp"

namespace kinecal {

bool prepare_cameras(Robot& robot, Config& config, std::vector<Sample>& samples,
                     Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  const auto is_good = [&] { return diagnostics.errors.size() == before; };
  robot = with_own_frames(robot, config, samples, diagnostics);
  if (is_good()) detail::check_cameras(config, robot, samples, diagnostics);
  if (is_good()) find_lenses(config, robot, samples, diagnostics);
  if (is_good()) start_cameras(config, robot, samples, diagnostics);
  if (!is_good()) return false;
  choose_lenses(config, samples, diagnostics);
  choose_images(config, robot, samples, diagnostics);
  return true;
}

}  // namespace kinecal
