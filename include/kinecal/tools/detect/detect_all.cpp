// Definitions of detect_all.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/detect_all.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "kinecal/capture/session/settling.hpp"
#include "kinecal/evaluation/parallel.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/rig_views.hpp"

namespace kinecal {

std::vector<ViewFinder> make_finders(const DetectionInput& input,
                                     std::vector<std::string>& errors) {
  std::vector<ViewFinder> finders;
  for (const CaptureFinder& finder : input.config.finders) {
    try {
      if (const std::string frame = region_frame(finder.settings); !frame.empty() && !input.robot) {
        throw InputError(finder.place.str() + ": finder '" + finder.name +
                         "' has a region in frame '" + frame + "'; give the robot with --urdf");
      }
      const FinderSettings settings =
          input.robot ? on_robot(finder, *input.robot) : finder.settings;
      const auto* leds = std::get_if<LedFinder>(&settings);
      finders.push_back(leds != nullptr ? ViewFinder{finder.name, {}, *leds}
                                        : view_finder(finder, settings));
    } catch (const InputError& error) {
      errors.emplace_back(error.what());
    }
  }
  return finders;
}

namespace detail {
namespace {

/// Adds each note of a finder once, with the number of views in which it was made.
void add_finder_notes(const std::vector<Look>& looks, Diagnostics& diagnostics) {
  std::map<std::string, std::size_t> counts;
  for (const Look& look : looks) {
    for (const std::string& note : look.notes) ++counts[note];
  }
  for (const auto& [note, count] : counts) {
    diagnostics.notes.push_back(note + " (in " + counted(count, "view") + " of " +
                                std::to_string(looks.size()) + ")");
  }
}

/// The joint that has moved between two samples; empty if none has.
[[nodiscard]] std::string moved_joint(const Sample& a, const Sample& b) {
  constexpr double kMoved = 0.03;  // radians or metres
  for (std::size_t i = 0; i < a.joint_names.size() && i < a.joint_positions.size(); ++i) {
    const auto there = b.position(a.joint_names[i]);
    if (there && std::abs(unwrapped_step(a.joint_positions[i], *there)) > kMoved) {
      return a.joint_names[i];
    }
  }
  return {};
}

/// Refuses views with the very features of another one, although a joint has moved: the camera was
/// frozen.  Two images of a real camera differ by noise.
void refuse_frozen(std::vector<Look>& looks) {
  std::map<std::vector<double>, std::size_t> firsts;  // looks, by all coordinates
  std::map<std::size_t, std::string> frozen;          // what is said of the first look
  std::vector<std::size_t> first_of(looks.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    std::vector<double> all;
    for (const Sample& sample : looks[i].samples) {
      for (const Observation& observation : sample.observations) {
        for (const Feature& feature : observation.features) {
          all.insert(all.end(), feature.point.begin(), feature.point.end());
        }
      }
    }
    first_of[i] = i;
    if (all.empty()) continue;
    const std::size_t first = firsts.try_emplace(std::move(all), i).first->second;
    first_of[i] = first;
    const std::string joint = moved_joint(looks[first].samples.front(), looks[i].samples.front());
    if (joint.empty()) continue;
    frozen.try_emplace(first, "the image is that of " + looks[first].source + ", although joint '" +
                                  printable(joint) +
                                  "' has moved: the camera was frozen, or one file is there twice");
  }
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto why = frozen.find(first_of[i]);
    if (why == frozen.end()) continue;
    looks[i].samples.clear();
    looks[i].features = 0;
    looks[i].refused.push_back(why->second);
  }
}

}  // namespace
}  // namespace detail

DetectedSamples detect_all(const DetectionInput& input, const DetectionOptions& options,
                           Diagnostics& diagnostics) {
  const auto finders = [&input] {
    std::vector<std::string> errors;  // already reported
    return make_finders(input, errors);
  };
  const LookOptions how{finders, detail::number_of_threads(options.threads), options.thumbnails,
                        options.meter};
  DetectedSamples found;
  const auto add = [&](std::vector<Look> looks) {
    detail::refuse_frozen(looks);
    for (Look& look : looks) {
      found.features += look.features;
      found.used += look.samples.empty() ? 0 : 1;
      std::move(look.samples.begin(), look.samples.end(), std::back_inserter(found.samples));
      look.samples.clear();
      found.looks.push_back(std::move(look));
    }
  };
  std::vector<CameraLooks> rig;
  for (const CameraImages& camera : input.rig) {
    rig.push_back({camera.camera, look_at(camera.images, CameraInfo{}, camera.camera, how)});
  }
  for (const CameraLooks& camera : rig) {
    found.used += static_cast<std::size_t>(
        std::count_if(camera.looks.begin(), camera.looks.end(),
                      [](const Look& look) { return !look.samples.empty(); }));
  }
  std::vector<Sample> of_rig = joined_views(rig);
  std::move(of_rig.begin(), of_rig.end(), std::back_inserter(found.samples));
  for (CameraLooks& camera : rig) add(std::move(camera.looks));
  if (!input.images.empty()) add(look_at(input.images, input.camera, input.frame, how));
  for (const RecordedViews& recording : input.recordings) add(look_at(recording, how));
  detail::add_finder_notes(found.looks, diagnostics);
  turn_boards(input.config.finders, input.robot, input.links, found.samples, diagnostics);
  return found;
}

}  // namespace kinecal
