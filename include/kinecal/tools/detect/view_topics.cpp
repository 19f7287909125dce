// Definitions of view_topics.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/view_topics.hpp"

#include <algorithm>
#include <string_view>
#include <variant>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {
namespace detail {
namespace {

/// The raw topic of an image_transport topic.
[[nodiscard]] std::string raw_topic(const std::string& name) {
  for (const std::string_view ending : {"/compressed", "/compressedDepth"}) {
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  }
  return name;
}

enum class TopicKind { image, depth, cloud, scan, camera_info, other };

[[nodiscard]] TopicKind kind_of(const RecordedTopic& topic) {
  if (topic.type == "sensor_msgs/PointCloud2") return TopicKind::cloud;
  if (topic.type == "sensor_msgs/LaserScan") return TopicKind::scan;
  if (topic.type == "sensor_msgs/CameraInfo") return TopicKind::camera_info;
  if (topic.type != "sensor_msgs/Image" && topic.type != "sensor_msgs/CompressedImage") {
    return TopicKind::other;
  }
  // Of 16-bit gray, the name says whether it is depth or infrared.
  const bool is_named_so =
      topic.encoding.starts_with("mono16") && topic.name.find("depth") != std::string::npos;
  return is_depth(topic.encoding) || is_named_so ? TopicKind::depth : TopicKind::image;
}

/// Chooses the topics of one finder.
class TopicChoice {
 public:
  TopicChoice(const std::vector<RecordedTopic>& recorded, const CaptureFinder& finder,
              const ViewWishes& wishes, Diagnostics& diagnostics)
      : recorded_(recorded), finder_(finder), wishes_(wishes), diagnostics_(diagnostics) {}

  /// An error if the recording lacks the requested depth.
  void check_depth() const {
    if (wishes_.depth.empty()) return;
    const RecordedTopic* named = find(wishes_.depth);
    if (named != nullptr && kind_of(*named) == TopicKind::depth) return;
    std::string there;
    std::vector<std::string> names;
    for (const RecordedTopic* topic : candidates(TopicKind::depth)) {
      there += (there.empty() ? "it has '" : ", '") + printable(topic->name) + "'";
      names.push_back(topic->name);
    }
    const std::string plain = plain_topic(wishes_.depth);
    diagnostics_.error({wishes_.file, 0},
                       "--depth: has no topic '" + printable(plain) + "' of depth; " +
                           (there.empty() ? "it has none" : there) + did_you_mean(plain, names));
  }

  [[nodiscard]] ViewTopics choose() {
    ViewTopics topics;
    const RecordedTopic* main = find(finder_.topic);
    if (main == nullptr || kind_of(*main) == TopicKind::camera_info) main = only_main();
    if (main == nullptr) return topics;
    const TopicKind kind = kind_of(*main);
    if (kind == TopicKind::scan) {
      topics.cloud = main->name;
      return topics;
    }
    if (kind == TopicKind::cloud) {
      topics.cloud = main->name;
    } else if (!wants_points()) {
      topics.image = main->name;
    } else if (kind == TopicKind::depth) {
      topics.depth = main->name;
      const auto images = candidates(TopicKind::image);
      if (images.size() == 1) topics.image = images.front()->name;
    } else {
      topics.image = main->name;
      topics.depth = depth_topic(*main);
      if (topics.depth.empty()) return {};
    }
    if (!wishes_.has_camera) topics.camera_info = camera_info(main->name);
    return topics;
  }

 private:
  [[nodiscard]] bool wants_points() const { return !finder_.type.ends_with("2d"); }

  /// The topic of this name; else its image_transport variant.
  [[nodiscard]] const RecordedTopic* find(const std::string& name) const {
    const std::string plain = plain_topic(name);
    const RecordedTopic* made = nullptr;
    for (const RecordedTopic& topic : recorded_) {
      if (kind_of(topic) == TopicKind::other) continue;
      if (topic.name == plain) return &topic;
      if (raw_topic(topic.name) == plain) made = &topic;
    }
    return made;
  }

  /// All topics of a kind; the raw one instead of its image_transport variants.
  [[nodiscard]] std::vector<const RecordedTopic*> candidates(TopicKind kind) const {
    std::vector<const RecordedTopic*> all;
    for (const RecordedTopic& topic : recorded_) {
      if (kind_of(topic) != kind) continue;
      const auto same = std::find_if(all.begin(), all.end(), [&](const RecordedTopic* other) {
        return raw_topic(other->name) == raw_topic(topic.name);
      });
      if (same == all.end()) {
        all.push_back(&topic);
      } else if (raw_topic(topic.name) == topic.name) {
        *same = &topic;
      }
    }
    return all;
  }

  [[nodiscard]] std::string about() const { return "finder '" + finder_.name + "': "; }

  /// The only candidate; an error and nullptr if there are several.
  [[nodiscard]] const RecordedTopic* only(const std::vector<const RecordedTopic*>& all,
                                          const std::string& what, const std::string& remedy) {
    if (all.size() == 1) {
      diagnostics_.note(finder_.place, about() + "takes " + what + " from topic '" +
                                           printable(all.front()->name) + "' of " + wishes_.file +
                                           ", the only one");
      return all.front();
    }
    std::string text;
    for (const RecordedTopic* topic : all) {
      text += (text.empty() ? "'" : ", '") + printable(topic->name) + "'";
    }
    diagnostics_.error(finder_.place, about() + wishes_.file + " has " + what +
                                          (text.empty() ? " on no topic" : " on topics " + text) +
                                          "; " + remedy);
    return nullptr;
  }

  [[nodiscard]] const RecordedTopic* only_main() {
    const bool wants_scan = std::holds_alternative<ScanFinder>(finder_.settings);
    auto all = candidates(wants_scan       ? TopicKind::scan
                          : wants_points() ? TopicKind::cloud
                                           : TopicKind::image);
    std::string what = wants_scan ? "scans" : wants_points() ? "clouds" : "images";
    if (all.empty() && wants_scan) {
      all = candidates(TopicKind::cloud);
      what = "scans or clouds";
    } else if (all.empty() && wants_points()) {
      all = candidates(TopicKind::depth);
      what = "clouds or depth";
    }
    const std::string named = "'" + printable(plain_topic(finder_.topic)) + "'";
    return only(all, what,
                all.empty() ? "record " + named + " of the configuration"
                            : "name one as the finder's topic, which is " + named);
  }

  [[nodiscard]] std::string depth_topic(const RecordedTopic& image) {
    if (!wishes_.depth.empty()) {
      const RecordedTopic* depth = find(wishes_.depth);
      return depth == nullptr ? "" : depth->name;  // check_depth() reports it
    }
    const auto* depth = only(candidates(TopicKind::depth), "depth for '" + image.name + "'",
                             "name one with --depth, or use a finder of pixels (2d)");
    return depth == nullptr ? "" : depth->name;
  }

  [[nodiscard]] std::string camera_info(const std::string& topic) {
    for (const std::string& name : {finder_.camera_info, camera_info_beside(topic)}) {
      const RecordedTopic* found = find(name);
      if (found != nullptr && kind_of(*found) == TopicKind::camera_info) return found->name;
    }
    const auto all = candidates(TopicKind::camera_info);
    if (all.empty()) {
      diagnostics_.warning(finder_.place, about() + wishes_.file +
                                              " has no camera_info; give the camera with --camera");
      return {};
    }
    const auto* found = only(all, "camera_info", "name one as camera_info_topic");
    return found == nullptr ? "" : found->name;
  }

  const std::vector<RecordedTopic>& recorded_;
  const CaptureFinder& finder_;
  const ViewWishes& wishes_;
  Diagnostics& diagnostics_;
};

}  // namespace
}  // namespace detail

std::string camera_info_beside(const std::string& topic) {
  const std::string raw = detail::raw_topic(topic);
  return raw.substr(0, raw.find_last_of('/') + 1) + "camera_info";
}

std::vector<ViewTopics> choose_topics(const std::vector<RecordedTopic>& recorded,
                                      const std::vector<CaptureFinder>& finders,
                                      const ViewWishes& wishes, Diagnostics& diagnostics) {
  std::vector<ViewTopics> all;
  if (!finders.empty()) {
    detail::TopicChoice(recorded, finders.front(), wishes, diagnostics).check_depth();
  }
  for (const CaptureFinder& finder : finders) {
    all.push_back(detail::TopicChoice(recorded, finder, wishes, diagnostics).choose());
  }
  return all;
}

}  // namespace kinecal
