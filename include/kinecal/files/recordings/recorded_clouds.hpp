// Point clouds recorded with samples, read only for display.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace kinecal {

/// Some points of a cloud.
struct RecordedCloud {
  std::string frame;          ///< link in which points are given
  std::vector<float> points;  ///< x y z, x y z ..., metres; all finite
};

/// The clouds of some samples of a bag: for each sample, that of the first observation with one.
/// @param path    bag of any format; YAML has no clouds
/// @param wanted  Sample::source of the samples
/// @param most    largest number of points per cloud; larger clouds are thinned evenly
/// @returns       by Sample::source, those that exist and are readable
[[nodiscard]] std::map<std::string, RecordedCloud> read_clouds(const std::string& path,
                                                               const std::set<std::string>& wanted,
                                                               std::size_t most);

}  // namespace kinecal
