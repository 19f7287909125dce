// Adding clouds to a scene.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_clouds.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "kinecal/files/recordings/recorded_clouds.hpp"

namespace kinecal {

void add_clouds(const std::vector<std::string>& files, RobotScene& scene) {
  constexpr std::size_t kAll = 60'000, kLeast = 300, kMost = 5'000, kNumbers = 3;
  std::set<std::string> wanted;
  for (const SceneSample& sample : scene.samples) {
    if (sample.matched_after.points.empty()) wanted.insert(sample.source);
  }
  if (wanted.empty()) return;
  const std::size_t each = std::clamp(kAll / wanted.size(), kLeast, kMost);
  std::size_t left = kAll;
  for (const std::string& file : files) {
    auto clouds = read_clouds(file, wanted, each);
    for (SceneSample& sample : scene.samples) {
      const auto cloud = clouds.find(sample.source);
      if (cloud == clouds.end()) continue;
      const auto link =
          std::find_if(scene.links.begin(), scene.links.end(),
                       [&](const SceneLink& of) { return of.name == cloud->second.frame; });
      const std::size_t points = cloud->second.points.size() / kNumbers;
      if (link == scene.links.end() || points > left) continue;
      left -= points;
      sample.cloud = std::move(cloud->second.points);
      sample.cloud_link = static_cast<int>(link - scene.links.begin());
    }
  }
}

}  // namespace kinecal
