// Point clouds that a bag has beside its samples, read when somebody wants to look at them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"

namespace kinecal {

/// Some points of a cloud.
struct RecordedCloud {
  std::string frame;          ///< link in which they are given
  std::vector<float> points;  ///< x y z, x y z ..., metres; all finite
};

/// The clouds of some samples of a bag: of each sample that of the first observation that has one.
/// @param path    bag of any format; YAML has no clouds
/// @param wanted  Sample::source of the samples
/// @param most    points of a cloud; of more, an even choice
/// @returns       by Sample::source, those that are there and can be read
[[nodiscard]] std::map<std::string, RecordedCloud> read_clouds(const std::string& path,
                                                               const std::set<std::string>& wanted,
                                                               std::size_t most);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/recordings/recorded_clouds.ipp"
#endif
