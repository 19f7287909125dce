// Definitions of frame_gaps.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/frame_gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "kinecal/config/missing_sensors.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Groups of links and virtual frames; a leading slash does not count.
class LinkGroups {
 public:
  void join(const std::string& a, const std::string& b) { above_[root(a)] = root(b); }
  [[nodiscard]] std::string root(const std::string& link) const {
    std::string name(plain_frame(link));
    for (auto at = above_.find(name); at != above_.end() && at->second != name;
         at = above_.find(name)) {
      name = at->second;
    }
    return name;
  }

 private:
  std::map<std::string, std::string> above_;
};

/// A frame of unknown pose, between two links.
struct OpenFrame {
  std::string name, parent, child;
};

/// True if two observations may show the same feature: they have an id in common, or none has ids.
[[nodiscard]] bool may_be_compared(const Observation& a, const Observation& b) {
  std::set<int> ids;
  for (const Feature& feature : a.features) {
    if (!feature.id) return true;
    ids.insert(*feature.id);
  }
  return std::any_of(b.features.begin(), b.features.end(), [&](const Feature& feature) {
    return !feature.id || ids.contains(*feature.id);
  });
}

/// Links and frames as the samples tie them.
class FrameTies {
 public:
  FrameTies(const Robot& robot, const std::string& base, const StepConfig& step,
            const std::vector<std::string>& unknown)
      : robot_(robot), step_(step), base_(base) {
    for (const FreeFrameConfig& frame : step.free_frames) {
      if (!robot.has_joint(frame.name)) virtual_.insert(frame.name);
    }
    const auto is_unknown = [&](const std::string& name) {
      return std::find(unknown.begin(), unknown.end(), name) != unknown.end();
    };
    for (const Joint& joint : robot.joints()) {
      if (is_unknown(joint.name)) {
        open_.push_back({joint.name, joint.parent, joint.child});
        continue;
      }
      tied_.join(joint.parent, joint.child);
      if (joint.type == JointType::fixed) rigid_.join(joint.parent, joint.child);
    }
    for (const std::string& name : unknown) {
      if (virtual_.contains(name)) open_virtual_.insert(name);
    }
  }

  /// What a sample compares hangs together.
  void add(const Sample& sample) {
    for (const ModelConfig& model : step_.models) {
      const Places places = places_of(model, sample);
      for (const std::string& place : places) {
        if (virtual_.contains(place)) hang(place, model.frame);
      }
      if (!places.empty()) sensors_[model.name].insert(places.begin(), places.end());
    }
    for (const BlockConfig& block : step_.error_blocks) {
      const ModelConfig *a = model_of(block, 0), *b = model_of(block, 1);
      if (a == nullptr) continue;
      if (b == nullptr) {  // with a plane of the world, or the robot's surface
        for (const std::string& place : places_of(*a, sample)) tied_.join(place, base_);
        continue;
      }
      const Observation *of_a = sample.observation(a->name), *of_b = sample.observation(b->name);
      if (of_a == nullptr || of_b == nullptr || !may_be_compared(*of_a, *of_b)) continue;
      for (const std::string& from : places_of(*a, sample)) {
        for (const std::string& to : places_of(*b, sample)) tied_.join(from, to);
      }
    }
  }

  /// What hangs on one rigid part by unknown frames only may be anywhere.
  [[nodiscard]] std::vector<FrameGap> gaps() const {
    std::set<std::string> parts;
    for (const OpenFrame& frame : open_)
      parts.insert({rigid_.root(frame.parent), rigid_.root(frame.child)});
    std::vector<FrameGap> gaps;
    for (const std::string& part : parts) {
      for (FrameGap& gap : gaps_beyond(part)) {
        const auto same = [&](const FrameGap& other) { return other.frames == gap.frames; };
        if (std::none_of(gaps.begin(), gaps.end(), same)) gaps.push_back(std::move(gap));
      }
    }
    return gaps;
  }

 private:
  using Places = std::vector<std::string>;

  [[nodiscard]] const ModelConfig* model_of(const BlockConfig& block, std::size_t index) const {
    if (index >= block.models.size()) return nullptr;
    const auto model =
        std::find_if(step_.models.begin(), step_.models.end(),
                     [&](const ModelConfig& one) { return one.name == block.models[index]; });
    return model == step_.models.end() ? nullptr : &*model;
  }

  /// Where the features of a model are in a sample: links, or virtual frames beyond its link.
  [[nodiscard]] Places places_of(const ModelConfig& model, const Sample& sample) const {
    const Observation* seen = sample.observation(model.name);
    if (seen == nullptr) return {};
    const bool is_own = sensor_entry(model).sensor->in_own_frame();
    Places places;
    for (const Feature& feature : seen->features) {
      const std::string* frame = is_own ? nullptr : frame_among(virtual_, feature.frame);
      const bool is_link = frame == nullptr && !is_own && robot_.has_link(feature.frame);
      const std::string& place = frame != nullptr ? *frame : is_link ? feature.frame : model.frame;
      if (!feature.point.allFinite()) continue;
      if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    }
    return places;
  }

  /// The groups that only the unknown frames on a rigid part join to the base.
  [[nodiscard]] std::vector<FrameGap> gaps_beyond(const std::string& part) const {
    LinkGroups joined = tied_;
    std::vector<std::pair<std::string, std::string>> beyond;  // frames, and the link behind each
    for (const OpenFrame& frame : open_) {
      const bool is_parent = rigid_.root(frame.parent) == part;
      if (!is_parent && rigid_.root(frame.child) != part) {
        joined.join(frame.parent, frame.child);
      } else {
        beyond.emplace_back(frame.name, is_parent ? frame.child : frame.parent);
      }
    }
    std::map<std::string, std::set<std::string>> frames;  // by group
    for (const auto& [name, link] : beyond) {
      const std::string group = joined.root(link);
      if (group != joined.root(base_) && group != joined.root(part)) frames[group].insert(name);
    }
    std::vector<FrameGap> gaps;
    for (const auto& of_group : frames) {
      FrameGap gap{{of_group.second.begin(), of_group.second.end()}, {}, {}};
      for (const auto& [sensor, places] : sensors_) {
        const bool is_in = std::any_of(places.begin(), places.end(), [&](const std::string& place) {
          return joined.root(place) == of_group.first;
        });
        (is_in ? gap.sensors : gap.others).push_back(sensor);
      }
      if (!gap.sensors.empty()) gaps.push_back(std::move(gap));  // else the samples have none of it
    }
    return gaps;
  }

  /// Adds a virtual frame beyond a link.
  void hang(const std::string& frame, const std::string& link) {
    if (!hung_.insert(frame).second) return;
    if (open_virtual_.contains(frame)) {
      open_.push_back({frame, link, frame});
    } else {
      tied_.join(frame, link);
      rigid_.join(frame, link);
    }
  }

  const Robot& robot_;
  const StepConfig& step_;
  std::string base_;
  std::set<std::string> virtual_, open_virtual_, hung_;
  std::vector<OpenFrame> open_;
  LinkGroups tied_, rigid_;
  std::map<std::string, std::set<std::string>> sensors_;  ///< where each one's features are
};

}  // namespace
}  // namespace detail

std::vector<FrameGap> frame_gaps(const Robot& robot, const std::string& base,
                                 const StepConfig& step, const std::vector<std::string>& unknown,
                                 std::span<const Sample> samples) {
  if (unknown.empty() || samples.empty()) return {};
  detail::FrameTies ties(robot, base, step, unknown);
  for (const Sample& sample : samples) ties.add(sample);
  return ties.gaps();
}

void check_frame_gaps(const Robot& robot, const std::string& base, const StepConfig& step,
                      const std::vector<std::string>& unknown, std::span<const Sample> samples,
                      Diagnostics& diagnostics) {
  for (const FrameGap& gap : frame_gaps(robot, base, step, unknown, samples)) {
    const auto place = std::find_if(
        step.free_frames.begin(), step.free_frames.end(),
        [&](const FreeFrameConfig& frame) { return frame.name == gap.frames.front(); });
    const bool is_one = gap.sensors.size() == 1;
    diagnostics.error(
        place == step.free_frames.end() ? step.place : place->place,
        fmt::format(
            "nothing says where {} {}: the samples {}.  Record samples in which {} sees what {}; "
            "or, if a pose is known, write it into free_frames_initial_values and do not free it",
            detail::quoted_list(gap.frames), gap.frames.size() == 1 ? "is" : "are",
            is_one
                ? fmt::format("compare '{}' with nothing", gap.sensors.front())
                : fmt::format("compare {} only with each other", detail::quoted_list(gap.sensors)),
            is_one ? "it" : "one of them",
            gap.others.empty()
                ? fmt::format("moves against link '{}'", base)
                : fmt::format("{}{} sees or holds", gap.others.size() == 1 ? "" : "one of ",
                              detail::quoted_list(gap.others))));
  }
}

}  // namespace kinecal
