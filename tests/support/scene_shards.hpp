// The samples of a scene in shards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal::test {

/// The samples of a scene, so many in a shard.
class SceneShards {
 public:
  SceneShards(const NoisyScene& scene, int size) : scene_(scene), empty_(scene.problem({})) {
    const int all = static_cast<int>(scene.samples.size());
    shards_.problem = empty_.get();
    shards_.count = (all + size - 1) / size;
    shards_.samples = all;
    shards_.num_residuals = scene.problem(scene.samples)->num_residuals();
    shards_.read = [this, size, all](int shard) {
      ++reads;
      const auto first = scene_.samples.begin() + shard * size;
      const auto last = scene_.samples.begin() + std::min(all, (shard + 1) * size);
      return scene_.problem({first, last});
    };
  }
  SceneShards(const SceneShards&) = delete;
  SceneShards& operator=(const SceneShards&) = delete;

  [[nodiscard]] Shards& shards() { return shards_; }
  int reads = 0;  ///< of shards

 private:
  const NoisyScene& scene_;
  std::unique_ptr<AnyProblem> empty_;
  Shards shards_;
};

}  // namespace kinecal::test
