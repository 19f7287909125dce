// Writing a scene as MCAP.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/report/scene_entities.ipp"
#include "kinecal/report/scene_schemas.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The messages of a scene.
class SceneMessages {
 public:
  explicit SceneMessages(const RobotScene& scene) : scene_(scene) {
    set_times();
    std::vector<int> above(scene.links.size(), -1);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      above[static_cast<std::size_t>(scene.joints[j].child)] = static_cast<int>(j);
    }
    root_ = scene.base;
    for (int j = above_of(above, root_); j >= 0; j = above_of(above, root_)) {
      up_.push_back(j);
      root_ = scene.joints[static_cast<std::size_t>(j)].parent;
      if (up_.size() > scene.joints.size()) break;  // not a tree
    }
  }

  /// Recording time of a sample, nanoseconds.
  [[nodiscard]] std::int64_t time(std::size_t sample) const { return times_[sample]; }

  [[nodiscard]] std::string transforms(std::size_t sample) const {
    const std::span<const double> q = scene_.samples[sample].q;
    Json all = Json::array();
    for (const bool after : {true, false}) {
      for (const SceneJoint& joint : scene_.joints) {
        add_transform(frame(joint.parent, after), frame(joint.child, after),
                      child_in_parent(joint, q, after), times_[sample], all);
      }
    }
    Pose<double> root_T_base;
    for (auto j = up_.rbegin(); j != up_.rend(); ++j) {
      const SceneJoint& joint = scene_.joints[static_cast<std::size_t>(*j)];
      root_T_base = root_T_base * child_in_parent(joint, q, false);
    }
    add_transform(frame(scene_.base, true), frame(root_, false), root_T_base.inverse(),
                  times_[sample], all);
    return json_text({{"transforms", std::move(all)}});
  }

  /// The links; lines from joint to joint if the URDF has no shapes.
  [[nodiscard]] std::string robot(bool after) const {
    std::vector<SceneEntity> entities;
    for (std::size_t i = 0; i < scene_.links.size(); ++i) {
      const std::string name = frame(static_cast<int>(i), after);
      SceneEntity entity(name, name);
      for (const SceneVisual& visual : scene_.links[i].visuals) {
        entity.add(visual, scene_.meshes, after ? nullptr : &kGhost);
      }
      if (!entity.empty()) entities.push_back(std::move(entity));
    }
    if (entities.empty()) {
      for (const SceneJoint& joint : scene_.joints) entities.push_back(bone(joint, after));
    }
    return update_text(std::move(entities), times_.empty() ? 0 : times_.front());
  }

  /// Measured and predicted points.
  [[nodiscard]] std::string errors(std::size_t n, bool after) const {
    constexpr double kDiameter = 0.006, kThickness = 2.0;  // metres, pixels
    const SceneSample& sample = scene_.samples[n];
    const SceneColor& paint = !after ? kGhost : sample.bad ? kBad : kPredicted;
    SceneEntity entity(after ? "errors" : "errors_before", frame(scene_.base, true));
    std::vector<ScenePair> pairs;
    const SceneFeature* worst = nullptr;
    for (const SceneFeature& feature : sample.features) {
      const auto& pair = after ? feature.after : feature.before;
      if (!pair) continue;
      pairs.push_back(*pair);
      entity.add_point((*pair)[0], kDiameter, after ? kMeasured : kGhost);
      entity.add_point((*pair)[1], kDiameter, paint);
      const bool is_worse = worst == nullptr || worst->distance < feature.distance;
      if (feature.distance && feature.block == sample.features.front().block && is_worse) {
        worst = &feature;
      }
    }
    entity.add_lines(pairs, kThickness, paint);
    if (after) {
      std::string text = fmt::format("sample {}", sample.number);
      if (worst != nullptr) text += fmt::format(": {} is {} off", worst->name, worst->error);
      if (sample.bad) text += (sample.left_out ? "\nleft out: " : "\n") + sample.note;
      entity.add_text(text, Vector3<double>(0.0, 0.0, kTextHeight), paint);
    }
    return update_text({std::move(entity)}, times_[n]);
  }

 private:
  static constexpr double kTextHeight = 1.6;  ///< above the base, metres

  [[nodiscard]] static int above_of(const std::vector<int>& above, int link) {
    return above[static_cast<std::size_t>(link)];
  }

  /// The stamps of the samples if all have one, in their order.
  void set_times() {
    constexpr std::int64_t kSecond = 1000000000;
    bool recorded = true;
    for (const SceneSample& sample : scene_.samples) {
      const std::int64_t stamp = sample.stamp.value_or(std::chrono::nanoseconds(-1)).count();
      recorded = recorded && stamp >= (times_.empty() ? 0 : times_.back());
      times_.push_back(stamp);
    }
    for (std::size_t i = 0; i < times_.size() && !recorded; ++i) {
      times_[i] = static_cast<std::int64_t>(i + 1) * kSecond;
    }
  }

  [[nodiscard]] std::string frame(int link, bool after) const {
    const std::string& name = scene_.links[static_cast<std::size_t>(link)].name;
    return after ? name : "before/" + name;
  }

  static void add_transform(const std::string& parent, const std::string& child,
                            const Pose<double>& pose, std::int64_t time, Json& all) {
    const Vector3<double>& t = pose.translation;
    all.push_back({{"timestamp", time_json(time)},
                   {"parent_frame_id", parent},
                   {"child_frame_id", child},
                   {"translation", xyz_json(t.x(), t.y(), t.z())},
                   {"rotation", quaternion_json(pose.rotation)}});
  }

  [[nodiscard]] SceneEntity bone(const SceneJoint& joint, bool after) const {
    constexpr double kThickness = 4.0;  // pixels
    constexpr SceneColor kBone = {0.3, 0.5, 0.8, 1.0};
    SceneEntity entity(frame(joint.child, after), frame(joint.parent, after));
    const Vector3<double>& t = joint.origin.translation;
    entity.add_lines({{ScenePoint{}, ScenePoint{t.x(), t.y(), t.z()}}}, kThickness,
                     after ? kBone : kGhost);
    return entity;
  }

  const RobotScene& scene_;
  std::vector<std::int64_t> times_;  ///< of each sample
  int root_ = 0;                     ///< the topmost link
  std::vector<int> up_;              ///< joints from the base to it
};

}  // namespace
}  // namespace detail

void write_scene(const RobotScene& scene, std::ostream& out, Compression compression) {
  McapWriter writer(out, {.compression = compression, .json = true});
  const auto add = [&](const char* name, const char* type, const std::string& schema) {
    BagTopic topic;
    topic.name = name;
    topic.type = type;
    topic.definition = schema;
    return writer.add_topic(topic);
  };
  const auto put = [&](std::uint16_t topic, std::int64_t time, const std::string& json) {
    writer.write(topic, time, {reinterpret_cast<const std::byte*>(json.data()), json.size()});
  };
  constexpr const char* kUpdate = "foxglove.SceneUpdate";
  const std::string schema = detail::json_text(detail::scene_update_schema());
  const auto transforms = add("transforms", "foxglove.FrameTransforms",
                              detail::json_text(detail::frame_transforms_schema()));
  const auto robot = add("robot", kUpdate, schema), ghost = add("robot_before", kUpdate, schema),
             errors = add("errors", kUpdate, schema), old = add("errors_before", kUpdate, schema);
  const detail::SceneMessages messages(scene);
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    const std::int64_t time = messages.time(i);
    put(transforms, time, messages.transforms(i));
    if (i == 0) {
      put(robot, time, messages.robot(true));
      put(ghost, time, messages.robot(false));
    }
    put(errors, time, messages.errors(i, true));
    put(old, time, messages.errors(i, false));
  }
  writer.close();
}

}  // namespace kinecal
