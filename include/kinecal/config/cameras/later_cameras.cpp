// Definitions of later_cameras.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/later_cameras.hpp"

#include "kinecal/config/cameras/camera_checks.ipp"
#include "kinecal/config/cameras/known_cameras.ipp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The first sample in which a camera has an image whose size was recorded; nullptr if absent.
[[nodiscard]] const Sample* sized_sample(const std::string& camera,
                                         const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen != nullptr && seen->camera && seen->camera->width > 0) return &sample;
  }
  return nullptr;
}

/// Gives a camera the camera_info of the first file: where it has none, or where only its lens differs, which the first file
/// has decided.
void take_first(const std::string& camera, const CameraInfo& first, std::vector<Sample>& samples) {
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != camera) continue;
      const CameraInfo own = seen.camera.value_or(CameraInfo{});
      const bool is_same = own.k == first.k && own.r == first.r && own.p == first.p;
      if (is_known(&own) && !is_same) continue;
      seen.camera = first;
      seen.camera->width = own.width;
      seen.camera->height = own.height;
    }
  }
}

/// True if samples without these targets are of no use: each error block compares one of them.
[[nodiscard]] bool compares_only(const Config& config, const std::vector<TargetPair>& pairs) {
  const auto is_target = [&](const std::string& model) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const TargetPair& pair) { return pair.target->name == model; });
  };
  return std::all_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
    return std::all_of(step.error_blocks.begin(), step.error_blocks.end(),
                       [&](const BlockConfig& block) {
                         return std::any_of(block.models.begin(), block.models.end(), is_target);
                       });
  });
}

/// Finds where the targets are, by cameras that are known.
void place_targets(const Robot& robot, const Config& config, const std::vector<TargetPair>& pairs,
                   std::vector<Sample>& samples, Diagnostics& diagnostics) {
  std::vector<SeenTarget> seen;
  for (const TargetPair& pair : pairs) {
    const CameraInfo* info = info_of(pair.camera->name, samples);
    if (!is_known(info)) continue;  // the file does not have this camera
    const std::vector<TargetView> views = views_of(pair, samples);
    SeenTarget of{pair, poses_by(*info, pair.camera->image, views)};
    drop_unseen(pair, *info, views, of.poses);
    seen.push_back(std::move(of));
  }
  Config placed = config;
  (void)place(placed, robot, seen, samples);
  const bool is_placed = std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
    return std::any_of(pairs.begin(), pairs.end(), [&](const TargetPair& pair) {
      return sample.poses.contains(pair.joint) && !target_view(pair, sample).pixels.empty();
    });
  });
  if (!is_placed && !pairs.empty() && !samples.empty() && compares_only(config, pairs)) {
    diagnostics.error(place_of(samples, 0),
                      "no camera shows in any sample of this file where the target was, by four "
                      "corners or more that are not nearly on a line; leave the file out");
    return;
  }
  drop_unplaced(pairs, samples, diagnostics);
}

}  // namespace
}  // namespace detail

bool prepare_later_cameras(const Robot& robot, const Config& config,
                           const std::vector<Sample>& first, std::vector<Sample>& samples,
                           Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  const auto is_good = [&] { return diagnostics.errors.size() == before; };
  const std::vector<detail::TargetPair> pairs = detail::target_pairs(config, robot);
  for (const detail::TargetPair& pair : pairs) {
    const Sample* sized = detail::sized_sample(pair.camera->name, first);
    (void)detail::check_sizes(*pair.camera, samples, diagnostics, sized);
  }
  if (!is_good()) return false;
  for (const ModelConfig& camera : detail::models_of(config)) {
    const SensorEntry* entry = entry_of(camera);
    const CameraInfo* info = detail::info_of(camera.name, first);
    if (entry == nullptr || entry->lenses.empty() || info == nullptr) continue;
    detail::take_first(camera.name, *info, samples);
  }
  detail::place_targets(robot, config, pairs, samples, diagnostics);
  Config same = config;
  choose_lenses(same, samples, diagnostics);
  return is_good();
}

}  // namespace kinecal
