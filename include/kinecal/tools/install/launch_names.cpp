// Names in a launch file: definitions of launch_names.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/launch_names.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

LaunchNames fetch_launch_names() {
  LaunchNames names;
  for (const std::string_view key : launch_key::kAll) names.emplace(key, key);
  names["z_offset_mm"] = "head_camera/driver/z_offset_mm";
  names["z_scaling"] = "head_camera/driver/z_scaling";
  names["track_width"] = "base_controller/track_width";
  names["gyro_scale"] = "imu/gyro_scale";
  return names;
}

LaunchNames launch_names(const std::vector<std::string>& given) {
  LaunchNames own;
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw InputError("name '" + text + "': is not KEY=NAME; KEY= leaves a key out");
    }
    const std::string key = text.substr(0, equals);
    bool known = false;
    for (const std::string_view k : launch_key::kAll) {
      known = known || key == k || key.ends_with("_" + std::string(k));
    }
    if (!known) {
      throw InputError("name '" + text + "': '" + key + "' is not a key" +
                       did_you_mean(key, launch_key::kAll));
    }
    if (!own.emplace(key, text.substr(equals + 1)).second) {
      throw InputError("name '" + text + "': '" + key + "' is named twice");
    }
  }
  own.merge(fetch_launch_names());  // keeps the given names
  return own;
}

}  // namespace kinecal
