// Definitions of recorded_views.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/recorded_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "kinecal/capture/finders/led_search.hpp"
#include "kinecal/files/messages/camera_message.hpp"
#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/messages/scan_message.hpp"
#include "kinecal/files/messages/view_message.hpp"
#include "kinecal/files/recordings/fixed_frames.hpp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/detect/joint_tracks.hpp"
#include "kinecal/tools/detect/listed.ipp"
#include "kinecal/tools/detect/still_view.hpp"
#include "kinecal/tools/detect/view_topics.hpp"

namespace kinecal {

namespace detail {

// First pass over a recording: joint positions, camera settings, and times of images.

/// The form of a topic's messages.
struct MessageForm {
  MessageDefinition definition;
  Encoding encoding = Encoding::ros1;
};

/// Forms of topics.
class MessageForms {
 public:
  /// @throws DefinitionError  if the bag's definition cannot be read
  [[nodiscard]] std::shared_ptr<const MessageForm> of(const BagTopic& topic) {
    auto& form = forms_[{topic.type, topic.definition, topic.encoding}];
    if (!form) {
      const std::string text = topic.definition.empty()
                                   ? known_definition(topic.type, topic.encoding)
                                   : topic.definition;
      form = std::make_shared<const MessageForm>(
          MessageForm{parse_definition(topic.type, text), topic.encoding});
    }
    return form;
  }

 private:
  std::map<std::tuple<std::string, std::string, Encoding>, std::shared_ptr<const MessageForm>>
      forms_;  ///< by type, definition and encoding
};

/// A message of images, depth or points in a recording.
struct ViewStamp {
  Stamp stamp;             ///< of the header; of recording if that is zero
  std::int64_t ahead = 0;  ///< time of recording minus stamp, nanoseconds
  std::size_t index = 0;   ///< among all messages of the topic
};

/// The stamp of a message's header, or the time of recording if that was not set.
[[nodiscard]] inline Stamp stamp_of(const MessageFields& message, std::int64_t time) {
  const Stamp stamp = header_stamp(message);
  return stamp == Stamp{} ? Stamp(time) : stamp;
}

/// The content of a recording, without its images.
struct RecordedSurvey {
  struct Topic {
    RecordedTopic topic;
    std::vector<ViewStamp> views = {};      ///< readable ones
    std::size_t messages = 0, damaged = 0;  ///< their numbers
    std::size_t unstamped = 0;              ///< messages without a stamp
    std::string damage = {};                ///< of the first one
    std::string frame = {};                 ///< of the first one that names it
    std::optional<CameraInfo> camera = {};  ///< the first one
    std::string image_part = {};            ///< the doubt about a partial image
    bool camera_changes = false;
    std::size_t timeless = 0;  ///< scans that do not say when each beam was measured
  };
  std::map<std::string, Topic> topics = {};  ///< by name
  JointTracks joints{};
  std::map<std::string, std::vector<LedCommand>> leds = {};  ///< by topic
  std::vector<std::int64_t> joints_ahead = {};               ///< as ViewStamp::ahead

  static bool wants(const BagTopic& topic) {
    constexpr std::array<std::string_view, 6> kTypes = {
        "sensor_msgs/JointState",  "sensor_msgs/Image",     "sensor_msgs/CompressedImage",
        "sensor_msgs/PointCloud2", "sensor_msgs/LaserScan", "sensor_msgs/CameraInfo"};
    return std::find(kTypes.begin(), kTypes.end(), topic.type) != kTypes.end();
  }

  void add(const BagMessage& message, MessageForms& forms) {
    Topic& topic =
        topics.try_emplace(message.topic.name, Topic{{message.topic.name, message.topic.type}})
            .first->second;
    const std::size_t index = topic.messages++;
    try {
      const auto form = forms.of(message.topic);
      const MessageFields content = decode(form->definition, form->encoding, message.data);
      if (header_stamp(content) == Stamp{}) ++topic.unstamped;
      if (topic.frame.empty()) topic.frame = plain_frame(text_at(content, "header.frame_id"));
      const Stamp stamp = stamp_of(content, message.time);
      take(topic, message.topic.type, content, {stamp, message.time - stamp.count(), index});
    } catch (const std::runtime_error& error) {  // bytes or definition
      if (topic.damaged++ == 0) topic.damage = error.what();
    }
  }

  /// Sorts the views of each topic by stamps, after all messages were added.
  void sort_views() {
    for (auto& [name, topic] : topics) {
      std::stable_sort(topic.views.begin(), topic.views.end(),
                       [](const ViewStamp& a, const ViewStamp& b) { return a.stamp < b.stamp; });
    }
  }

 private:
  void take(Topic& topic, std::string_view type, const MessageFields& content,
            const ViewStamp& view) {
    if (!wants({.name = "", .type = std::string(type)})) {
      const auto code = led_code(content);
      if (!code) throw std::runtime_error("it has no led_code and no data that is a code of LEDs");
      leds[topic.topic.name].push_back({view.stamp, *code});
    } else if (type == "sensor_msgs/JointState") {
      joints.add(topic.topic.name, joints_of(content, view.stamp));
      joints_ahead.push_back(view.ahead);
    } else if (type == "sensor_msgs/CameraInfo") {
      const CameraInfo camera = camera_of(content);
      const auto is_number = [](double x) { return std::isfinite(x); };
      if (!std::all_of(camera.k.begin(), camera.k.end(), is_number) ||
          !std::all_of(camera.p.begin(), camera.p.end(), is_number) ||
          !std::all_of(camera.d.begin(), camera.d.end(), is_number)) {
        throw std::runtime_error("its K, P or D has something that is not a number");
      }
      if (!topic.camera) {
        topic.camera = camera;
        topic.image_part = doubt_image_part(image_part_of(content), camera);
      }
      const CameraInfo& first = *topic.camera;
      topic.camera_changes |= camera.k != first.k || camera.p != first.p || camera.d != first.d ||
                              camera.width != first.width || camera.height != first.height;
    } else {
      if (topic.topic.encoding.empty()) {
        const std::string_view encoding = text_at(content, "encoding");
        topic.topic.encoding = encoding.empty() ? text_at(content, "format") : encoding;
      }
      topic.views.push_back(view);
      const bool is_scan = type == "sensor_msgs/LaserScan";
      if (is_scan && !(number_at(content, "time_increment") > 0.0)) ++topic.timeless;
    }
  }

  /// @throws std::runtime_error  if names and positions differ in number, or a joint occurs twice
  [[nodiscard]] static MeasuredJoints joints_of(const MessageFields& state, Stamp stamp) {
    MeasuredJoints joints;
    joints.stamp = stamp;
    for (const MessageValue& name : list_at(state, "name")) {
      if (const auto* text = name.as<std::string_view>()) joints.names.emplace_back(*text);
    }
    for (const MessageValue& position : list_at(state, "position")) {
      position.visit_number([&](auto x) { joints.positions.push_back(static_cast<double>(x)); });
    }
    if (!joints.positions.empty() && joints.positions.size() != joints.names.size()) {
      throw std::runtime_error("it has " + std::to_string(joints.names.size()) +
                               " names of joints and " + std::to_string(joints.positions.size()) +
                               " positions");
    }
    for (std::size_t i = 0; i < joints.positions.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (joints.names[i] != joints.names[j] || joints.positions[i] == joints.positions[j]) {
          continue;
        }
        throw std::runtime_error("joint '" + joints.names[i] + "' is in it twice, at " +
                                 std::to_string(joints.positions[j]) + " and " +
                                 std::to_string(joints.positions[i]));
      }
    }
    return joints;
  }
};

// Undecoded messages of a recording that together form a view.

/// Time between two messages of one moment, at most: as for live cameras.
inline constexpr std::chrono::milliseconds kTogether{40};
/// The same while the robot moves: 0.5 mrad of a joint at 0.1 rad/s.
inline constexpr std::chrono::milliseconds kTogetherInMotion{5};

/// One or two messages of one moment.
struct RawView {
  struct Part {
    std::string topic;
    std::size_t index = 0;                         ///< among all messages of the topic
    std::shared_ptr<const MessageForm> form = {};  ///< nullptr before it was read
    std::vector<std::byte> data = {};
  };
  Stamp stamp;
  std::vector<Part> parts;

  [[nodiscard]] bool complete() const {
    return std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.form != nullptr; });
  }
};

/// Topics of a camera's messages; the stamps of the first one count.
[[nodiscard]] inline std::vector<std::string> parts_of(const ViewTopics& topics) {
  std::vector<std::string> parts;
  for (const std::string& topic : {topics.image, topics.depth, topics.cloud}) {
    if (!topic.empty()) parts.push_back(topic);
  }
  return parts;
}

/// What a topic's images are of, by its name: image_rect, image_rect_color/compressed.
[[nodiscard]] inline ImageKind kind_of_images(const std::string& topic) {
  return topic.find("image_rect") == std::string::npos ? ImageKind::automatic
                                                       : ImageKind::rectified;
}

/// Decodes a view.
/// @param depth  the camera of its depth, if it is another one
/// @param frame  of the camera; empty: from the messages
/// @throws std::runtime_error  naming the topic, if a message cannot be read
[[nodiscard]] inline View decoded(const RawView& raw, const ViewTopics& topics,
                                  const std::optional<CameraInfo>& camera,
                                  const std::optional<RangeCamera>& depth,
                                  const std::string& frame) {
  View view;
  view.stamp = raw.stamp;
  view.camera = camera;
  view.frame = frame;
  for (const RawView::Part& part : raw.parts) {
    try {
      const MessageFields message = decode(part.form->definition, part.form->encoding, part.data);
      if (view.frame.empty()) view.frame = plain_frame(text_at(message, "header.frame_id"));
      if (part.topic == topics.image) {
        view.image = gray_image(message);
      } else if (part.topic == topics.cloud) {
        read_points(message, view);
      } else if (camera && depth) {
        view.points =
            registered_points(depth_image(message), *depth, *camera, kind_of_images(topics.image));
      } else if (camera) {
        view.points = points_of(depth_image(message), *camera);
      } else {
        throw std::runtime_error("depth becomes points only with a camera, which is not known");
      }
    } catch (const std::exception& error) {
      throw std::runtime_error("topic '" + printable(part.topic) + "': " + error.what());
    }
  }
  if (view.frame.empty()) {
    throw std::runtime_error("topic '" + printable(raw.parts.front().topic) +
                             "' has no frame_id; name the camera's frame with --frame");
  }
  return view;
}

/// Up to `most` items, evenly spread.
template <class T>
[[nodiscard]] std::vector<T> spread_out(const std::vector<T>& items, std::size_t most) {
  if (items.size() <= most) return items;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(items[i * (items.size() - 1) / (most - 1)]);
  return some;
}

/// Candidate views of a standstill, at most.
inline constexpr std::size_t kMostLooks = 8;

/// Candidate views of a standstill: a few in its middle two seconds, else the one nearest to its
/// middle.  Skips its ends, because stamps and exposures are slightly off.
/// @param views  sorted
[[nodiscard]] inline std::vector<ViewStamp> worth_a_look(const std::vector<ViewStamp>& views,
                                                         const Standstill& time) {
  constexpr std::chrono::milliseconds kEnd{100}, kHalf{1000};
  const Stamp middle = time.begin + (time.end - time.begin) / 2;
  const ViewStamp* nearest = nullptr;
  std::vector<ViewStamp> within;
  for (const ViewStamp& view : views) {
    if (view.stamp < time.begin + kEnd || view.stamp > time.end - kEnd) continue;
    const auto away = std::chrono::abs(view.stamp - middle);
    if (away <= kHalf) within.push_back(view);
    if (nearest == nullptr || away < std::chrono::abs(nearest->stamp - middle)) nearest = &view;
  }
  if (within.empty() && nearest != nullptr) within.push_back(*nearest);
  return spread_out(within, kMostLooks);
}

/// The view nearest to a moment; nullptr if absent.
/// @param views  sorted
[[nodiscard]] inline const ViewStamp* nearest_view(const std::vector<ViewStamp>& views,
                                                   Stamp stamp) {
  const auto next =
      std::lower_bound(views.begin(), views.end(), stamp,
                       [](const ViewStamp& view, Stamp moment) { return view.stamp < moment; });
  if (next == views.begin()) return views.empty() ? nullptr : &views.front();
  const auto last = next - 1;
  return next == views.end() || stamp - last->stamp <= next->stamp - stamp ? &*last : &*next;
}

/// The message of another topic nearest in time, if near enough.
/// @param views  sorted
[[nodiscard]] inline const ViewStamp* companion(const std::vector<ViewStamp>& views, Stamp stamp,
                                                Stamp most_apart) {
  const ViewStamp* nearest = nearest_view(views, stamp);
  const bool is_near = nearest != nullptr && std::chrono::abs(nearest->stamp - stamp) <= most_apart;
  return is_near ? nearest : nullptr;
}

namespace {

// Intervals of a recording that give a view each while the robot moves.

/// The view of a camera nearest to the middle of an interval; empty if the interval has no view.
/// @param views  sorted
[[nodiscard]] std::vector<ViewStamp> middle_view(const std::vector<ViewStamp>& views,
                                                 const Standstill& time) {
  const ViewStamp* nearest = nearest_view(views, time.begin + (time.end - time.begin) / 2);
  if (nearest == nullptr || nearest->stamp < time.begin || nearest->stamp >= time.end) return {};
  return {*nearest};
}

/// Intervals [begin, begin + every) from the first reading of a joint to the last, those in which a
/// camera has a view.  The last one ends with the joints.
[[nodiscard]] std::vector<Standstill> intervals_with_views(const RecordedSurvey& survey,
                                                           const std::vector<ViewTopics>& cameras,
                                                           Stamp every) {
  const auto joints = survey.joints.span();
  if (!joints) return {};
  std::set<std::int64_t> numbers;
  for (const ViewTopics& camera : cameras) {
    for (const ViewStamp& view : survey.topics.at(parts_of(camera).front()).views) {
      if (view.stamp < joints->begin || view.stamp > joints->end) continue;
      numbers.insert((view.stamp - joints->begin) / every);
    }
  }
  std::vector<Standstill> intervals;
  for (const std::int64_t number : numbers) {
    const Stamp begin = joints->begin + number * every;
    intervals.push_back({begin, std::min(begin + every, joints->end + Stamp(1))});
  }
  return intervals;
}

/// Parts of a scan during each of which no joint moves by more than half a milliradian, with the joints of its middle; a
/// view of one moment is one part.
/// @param[out] refusal  why joints are not known
/// @returns  at least one part, unless it is refused
[[nodiscard]] std::vector<View> parts_in_motion(View view, const JointTracks& tracks,
                                                std::string& refusal) {
  constexpr double kMoved = 5e-4;  // radians or metres
  const std::size_t beams = view.points.pixels.size();
  const auto after = [&](double points) {
    return view.stamp + std::chrono::duration_cast<Stamp>(
                            std::chrono::duration<double>(points * view.point_time));
  };
  const double half = 0.5 * static_cast<double>(beams);
  JointsInMotion of_middle = tracks.motion(after(half));
  refusal = std::move(of_middle.refusal);
  if (!refusal.empty()) return {};
  double fastest = 0.0;  // rad/s or m/s
  for (const double v : of_middle.joints.velocities) fastest = std::max(fastest, std::abs(v));
  const double moved = 2.0 * half * view.point_time * fastest;
  const auto count = static_cast<std::size_t>(
      std::clamp(std::ceil(moved / kMoved), 1.0, std::max(2.0 * half, 1.0)));
  if (count == 1) {
    view.joints = std::move(of_middle.joints);
    return {std::move(view)};
  }
  std::vector<View> parts;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k * beams / count, last = (k + 1) * beams / count;
    View part = view;
    part.points = PointCloud(static_cast<int>(last - first), 1, no_point());
    std::copy(view.points.pixels.begin() + static_cast<std::ptrdiff_t>(first),
              view.points.pixels.begin() + static_cast<std::ptrdiff_t>(last),
              part.points.pixels.begin());
    JointsInMotion joints = tracks.motion(after(0.5 * static_cast<double>(first + last)));
    refusal = std::move(joints.refusal);
    if (!refusal.empty()) return {};
    part.joints = std::move(joints.joints);
    part.stamp = part.joints.stamp;
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Whether joints stand where they stood in another view.  A robot that swings comes by the same
/// place at speed.
[[nodiscard]] bool stand_there(const MeasuredJoints& joints, const MeasuredJoints& before) {
  constexpr double kMoved = 1e-3;  // radians or metres
  constexpr double kMoves = 1e-2;  // rad/s or m/s
  for (std::size_t i = 0; i < joints.names.size(); ++i) {
    const auto stood = before.position(joints.names[i]);
    if (!stood || std::abs(unwrapped_step(*stood, joints.positions[i])) >= kMoved) return false;
    if (std::abs(joints.velocities[i]) >= kMoves) return false;
  }
  return true;
}

/// Leaves out intervals in which the robot rests where it was in the last view.
/// @returns  how many
std::size_t leave_out_rests(const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
                            std::vector<Standstill>& intervals) {
  MeasuredJoints last;
  return std::erase_if(intervals, [&](const Standstill& time) {
    for (const ViewTopics& camera : cameras) {
      for (const ViewStamp& view :
           middle_view(survey.topics.at(parts_of(camera).front()).views, time)) {
        JointsInMotion now = survey.joints.motion(view.stamp);
        if (!now.refusal.empty()) return false;  // the view says why it is refused
        if (!last.names.empty() && stand_there(now.joints, last)) return true;
        last = std::move(now.joints);
        return false;
      }
    }
    return false;
  });
}

/// The intervals that give views; an error without any, a note about those left out.
[[nodiscard]] std::vector<Standstill> find_intervals(const RecordedSurvey& survey,
                                                     const std::vector<ViewTopics>& cameras,
                                                     const RecordingOptions& options,
                                                     Diagnostics& diagnostics) {
  std::vector<Standstill> times = intervals_with_views(survey, cameras, options.every);
  if (times.empty()) {
    diagnostics.error({options.path, 0}, "has no image while joints are measured");
    return times;
  }
  const std::size_t rests = leave_out_rests(survey, cameras, times);
  if (rests > 0) {
    diagnostics.notes.push_back(options.path + ": left out " + counted(rests, "view") +
                                " in which the robot rests where it was in the view before");
  }
  return times;
}

// Checks a recording, and finds when the robot stood still.

/// Warnings about skipped messages; an error if a camera has no others.
/// @param in_motion  whether views are taken while the robot moves
void report_messages(const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
                     const std::string& file, bool in_motion, Diagnostics& diagnostics) {
  std::set<std::string> used;
  for (const ViewTopics& camera : cameras) {
    for (const std::string& topic : parts_of(camera)) used.insert(topic);
    if (!camera.camera_info.empty()) used.insert(camera.camera_info);
  }
  for (const auto& [name, topic] : survey.topics) {
    if (used.count(name) == 0 && topic.topic.type != "sensor_msgs/JointState") continue;
    const std::string about = "topic '" + printable(name) + "': ";
    if (topic.damaged > 0) {
      const std::string text = about + std::to_string(topic.damaged) + " of " +
                               std::to_string(topic.messages) +
                               " messages cannot be read; the first: " + topic.damage;
      if (topic.damaged == topic.messages && used.count(name) > 0) {
        diagnostics.error({file, 0}, text);
      } else {
        diagnostics.warning({file, 0}, text);
      }
    }
    if (topic.unstamped > topic.damaged) {
      diagnostics.warning({file, 0}, about + std::to_string(topic.unstamped) +
                                         " messages have no stamp; their times of recording are "
                                         "used");
    }
    if (in_motion && topic.timeless > 0) {
      diagnostics.warning({file, 0},
                          about + std::to_string(topic.timeless) +
                              " scans have no time_increment: all their beams count as measured at "
                              "the stamp, though the robot moves");
    }
    if (topic.camera_changes) {
      diagnostics.warning({file, 0}, about + "the camera's settings change; the first are used");
    }
    if (!topic.image_part.empty()) diagnostics.warning({file, 0}, about + topic.image_part);
  }
}

/// The camera_info of a topic's own camera; nullptr if it was not recorded.
[[nodiscard]] const CameraInfo* own_camera(const RecordedSurvey& survey, const std::string& topic) {
  const auto found = survey.topics.find(camera_info_beside(topic));
  return found != survey.topics.end() && found->second.camera ? &*found->second.camera : nullptr;
}

/// How the camera of depth differs from that of the image, as text; empty if it does not.
[[nodiscard]] std::string differing_settings(const CameraInfo& depth, const CameraInfo& image) {
  constexpr double kSame = 0.02;  // share of the focal length, or of the width
  const auto focal = [](const CameraInfo& c) { return c.k[0] > 0.0 ? c.k[0] : c.p[0]; };
  const auto middle = [](const CameraInfo& c) { return c.k[0] > 0.0 ? c.k[2] : c.p[2]; };
  std::ostringstream text;
  if (depth.width != image.width || depth.height != image.height) {
    text << ", images of " << depth.width << " x " << depth.height << " pixels instead of "
         << image.width << " x " << image.height;
  }
  if (std::abs(focal(depth) - focal(image)) > kSame * focal(image)) {
    text << ", focal length " << focal(depth) << " px instead of " << focal(image) << " px";
  } else if (std::abs(middle(depth) - middle(image)) > kSame * image.width) {
    text << ", cx " << middle(depth) << " px instead of " << middle(image) << " px";
  }
  return text.str();
}

/// Whether two cameras are one that delivers images of two sizes.
[[nodiscard]] bool is_same_scaled(const CameraInfo& a, const CameraInfo& b) {
  CameraInfo scaled = a;
  const double scale = static_cast<double>(b.width) / std::max(a.width, 1);
  for (double& number : scaled.k) number *= scale;
  for (double& number : scaled.p) number *= scale;
  scaled.width = b.width;
  scaled.height = static_cast<int>(std::lround(a.height * scale));
  return differing_settings(scaled, b).empty();
}

/// A camera of depth beside an image, and how it differs from that of the image.
struct DepthBeside {
  std::string frame, image_frame;
  const CameraInfo *info = nullptr, *image_info = nullptr;  ///< nullptr: not recorded
  bool other_frame = false;
  std::string settings;  ///< that differ

  DepthBeside(const RecordedSurvey& survey, const ViewTopics& camera,
              const RecordingOptions& options)
      : frame(survey.topics.at(camera.depth).frame),
        image_frame(survey.topics.at(camera.image).frame),
        info(own_camera(survey, camera.depth)),
        image_info(options.camera ? &*options.camera : own_camera(survey, camera.image)) {
    other_frame = options.frame.empty() && !frame.empty() && !image_frame.empty() &&
                  !same_frame(frame, image_frame);
    if (info != nullptr && image_info != nullptr) settings = differing_settings(*info, *image_info);
  }

  [[nodiscard]] bool is_registered() const { return !other_frame && settings.empty(); }

  [[nodiscard]] std::string differs() const {
    const std::string frames = ", frame '" + frame + "' instead of '" + image_frame + "'";
    return ((other_frame ? frames : "") + settings).substr(2);
  }

  /// The camera, if it is known where it stands.
  [[nodiscard]] std::optional<RangeCamera> camera(const FixedFrames& frames) const {
    if (info == nullptr || image_info == nullptr) return std::nullopt;
    if (other_frame) {
      const auto pose = frames.pose(image_frame, frame);
      return pose ? std::optional(RangeCamera{*info, {}, *pose}) : std::nullopt;
    }
    return is_same_scaled(*info, *image_info) ? std::optional(RangeCamera{*info}) : std::nullopt;
  }

  /// What projecting the depth into the image would need, and other remedies.
  /// @param topics  of the camera
  [[nodiscard]] std::string remedy(const ViewTopics& topics) const {
    std::string needs;
    for (const auto& [camera_info, topic] :
         {std::pair(info, topics.depth), std::pair(image_info, topics.image)}) {
      if (camera_info == nullptr) needs += ", topic '" + camera_info_beside(topic) + "'";
    }
    needs += ", where '" + frame + "' stands in '" + image_frame +
             "' (record tf and tf_static, or give the URDF with --urdf)";
    return (other_frame ? "; kinecal projects the depth into the image if it knows " +
                              printable(needs.substr(2))
                        : "") +
           (settings.empty() && other_frame
                ? "; if both are of one camera, name its frame with --frame"
                : "");
  }
};

/// The cameras of depth that is not registered to the image: it is projected into it.  An error where that is not
/// possible, because a corner of the image is at another pixel there.
[[nodiscard]] std::vector<std::optional<RangeCamera>> depth_cameras(
    const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
    const RecordingOptions& options, Diagnostics& diagnostics) {
  std::vector<std::optional<RangeCamera>> depths(cameras.size());
  std::optional<FixedFrames> frames;  // read if needed
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const ViewTopics& camera = cameras[c];
    if (camera.image.empty() || camera.depth.empty()) continue;
    const DepthBeside beside(survey, camera, options);
    if (beside.is_registered()) continue;
    if (!frames) {
      frames = recorded_frames(options.path);
      if (options.robot) frames->add(*options.robot);
    }
    depths[c] = beside.camera(*frames);
    const std::string what = "topic '" + printable(camera.depth) +
                             "': its depth is not registered to the image of topic '" +
                             printable(camera.image) +
                             "' but of another camera: " + printable(beside.differs());
    if (!depths[c]) {
      diagnostics.error({options.path, 0},
                        what +
                            "; record aligned depth (realsense2_camera: align_depth.enable; "
                            "depth_image_proc: register), or use a finder of pixels (2d)" +
                            beside.remedy(camera));
      continue;
    }
    depths[c]->image = kind_of_images(camera.depth);
    const Pose<double>& pose = depths[c]->camera_T_depth;
    diagnostics.note(
        {options.path, 0},
        fmt::format("{}; it is projected into the image, from {:.1f} mm and {:.2f} deg "
                    "away",
                    what, 1e3 * pose.translation.norm(),
                    log(pose.rotation).norm() * 180.0 / std::numbers::pi));
  }
  return depths;
}

/// Whether stamps of a camera and of joints are of different clocks.  A message may be recorded late,
/// but not before its stamp: what is ahead of its recording, and of the other stamps, is of another
/// clock.
/// @param camera, joints  time of recording minus stamp
[[nodiscard]] bool clocks_differ(Stamp camera, Stamp joints) {
  constexpr std::chrono::milliseconds kAhead{20};  // jitter, and stamps in the middle of exposures
  constexpr std::chrono::milliseconds kLatency{200};  // of images behind joints, usual
  constexpr std::chrono::seconds kLate{1};            // beyond any latency
  if (std::chrono::abs(camera - joints) > kLate) return true;
  if (camera < joints) return camera < -kAhead && joints - camera > kAhead;
  return joints < -kAhead && camera - joints > kLatency;
}

/// An error if camera and joints never overlap in time; a doubt if their clocks seem to differ.
void check_clocks(const RecordedSurvey& survey, const std::vector<ViewTopics>& cameras,
                  const std::string& file, Diagnostics& diagnostics) {
  const auto joints = survey.joints.span();
  for (const ViewTopics& camera : cameras) {
    const std::string name = parts_of(camera).front();
    const auto& views = survey.topics.at(name).views;
    if (!joints || views.empty()) continue;
    const auto [first, last] = std::minmax_element(
        views.begin(), views.end(),
        [](const ViewStamp& a, const ViewStamp& b) { return a.stamp < b.stamp; });
    if (last->stamp < joints->begin || first->stamp > joints->end) {
      diagnostics.error({file, 0}, "topic '" + printable(name) + "': its stamps are from " +
                                       stamp_text(first->stamp) + " to " + stamp_text(last->stamp) +
                                       ", those of the joint states from " +
                                       stamp_text(joints->begin) + " to " +
                                       stamp_text(joints->end) +
                                       ": they are of another clock, or recorded at another time");
      continue;
    }
    std::vector<std::int64_t> ahead;
    for (const ViewStamp& view : views) ahead.push_back(view.ahead);
    const Stamp late(median_of(ahead)), joints_late(median_of(survey.joints_ahead));
    const Stamp apart = late - joints_late;
    if (!clocks_differ(late, joints_late)) continue;
    diagnostics.doubt({file, 0}, "topic '" + printable(name) + "': its stamps are " +
                                     stamp_text(std::chrono::abs(apart)) +
                                     (apart > Stamp{} ? " behind" : " ahead of") +
                                     " those of the joint states, by the times of recording; "
                                     "synchronise the clocks (ntp, use_sim_time)");
  }
}

/// The times when the robot stood still; an error if it never did.
[[nodiscard]] std::vector<Standstill> find_standstills(const RecordedSurvey& survey,
                                                       const RecordingOptions& options,
                                                       Diagnostics& diagnostics) {
  const std::set<std::string> names = survey.joints.names();
  for (const std::string& joint : options.restless) {
    if (names.count(joint) > 0) continue;
    diagnostics.error({options.path, 0}, "has no joint '" + printable(joint) + "'" +
                                             did_you_mean(joint, std::vector<std::string>(
                                                                     names.begin(), names.end())));
  }
  std::vector<Standstill> times = survey.joints.standstills(options.restless, options.settle);
  if (!times.empty() || !diagnostics.errors.empty()) return times;
  std::string text = "the robot never stands still for " + seconds_text(options.settle.window);
  std::vector<std::string> moving = survey.joints.never_still(options.settle);
  std::erase_if(moving,
                [&](const std::string& joint) { return options.restless.count(joint) > 0; });
  std::vector<std::string> noisy = moving;
  std::erase_if(noisy, [&](const std::string& joint) {
    return survey.joints.noise(joint) <= options.settle.most_noise;
  });
  if (!noisy.empty()) {
    std::ostringstream noise;
    noise.precision(2);
    noise << survey.joints.noise(noisy.front());
    text += ": readings of joints " + listed(noisy) +
            " scatter even at rest, those of the first by " + noise.str() +
            " (radians or metres); mend them, or name them with --restless";
  } else if (moving.empty() || moving.size() + options.restless.size() == names.size()) {
    text += "; let it rest for a second in each pose";
  } else {
    text += ": joints " + listed(moving) +
            " always move; name those that need not stand still with --restless";
  }
  diagnostics.error({options.path, 0}, text);
  return times;
}

// Second pass over a recording: the messages of each standstill or interval.

/// Second pass over a recording: delivers each standstill when all its messages were read.
class StandstillReader {
 public:
  StandstillReader(std::vector<RecordedStandstill> standstills,
                   const std::function<void(RecordedStandstill)>& handle)
      : standstills_(std::move(standstills)), handle_(handle), missing_(standstills_.size(), 0) {
    for (std::size_t s = 0; s < standstills_.size(); ++s) {
      const auto want = [&](RawView& view) {
        for (RawView::Part& part : view.parts) {
          wanted_[part.topic].emplace(part.index, WantedPart{s, &part});
          ++missing_[s];
        }
      };
      for (const auto& camera : standstills_[s].views) {
        for (const auto& view : camera) want(*view);
      }
      for (const auto& camera : standstills_[s].switched) {
        for (const SwitchedView& view : camera) want(*view.raw);
      }
    }
  }

  [[nodiscard]] bool wants(const BagTopic& topic) const {
    return wanted_.count(topic.name) > 0 && RecordedSurvey::wants(topic);
  }

  void take(const BagMessage& message) {
    const std::size_t index = count_[message.topic.name]++;
    const auto [first, last] = wanted_[message.topic.name].equal_range(index);
    for (auto at = first; at != last; ++at) {
      const auto& [standstill, part] = at->second;
      part->form = forms_.of(message.topic);
      part->data.assign(message.data.begin(), message.data.end());
      standstills_[standstill].bytes += part->data.size();
      if (--missing_[standstill] == 0) give(standstill);
    }
  }

  /// Delivers the rest: those without messages, and those that the recording has only in part.
  void finish() {
    for (std::size_t s = 0; s < standstills_.size(); ++s) {
      if (!given_.count(s)) give(s);
    }
  }

 private:
  struct WantedPart {
    std::size_t standstill;
    RawView::Part* part;
  };

  void give(std::size_t s) {
    given_.insert(s);
    for (auto& camera : standstills_[s].views) {
      std::erase_if(camera, [](const auto& view) { return !view->complete(); });
    }
    for (auto& camera : standstills_[s].switched) {
      std::erase_if(camera, [](const SwitchedView& view) { return !view.raw->complete(); });
    }
    handle_(std::move(standstills_[s]));
  }

  std::vector<RecordedStandstill> standstills_;
  const std::function<void(RecordedStandstill)>& handle_;
  std::vector<std::size_t> missing_;  ///< messages of each standstill
  std::set<std::size_t> given_;
  std::map<std::string, std::multimap<std::size_t, WantedPart>> wanted_;  ///< by topic and index
  std::map<std::string, std::size_t> count_;                              ///< messages so far
  MessageForms forms_;
};

}  // namespace
}  // namespace detail

RecordedViews::RecordedViews(RecordingOptions options, const std::vector<CaptureFinder>& finders,
                             Diagnostics& diagnostics, const ProgressMeter& meter)
    : options_(std::move(options)), survey_(std::make_unique<detail::RecordedSurvey>()) {
  survey_->joints = JointTracks(options_.restless);
  detail::MessageForms forms;
  const auto handle = [&](const BagMessage& message) { survey_->add(message, forms); };
  Diagnostics own;
  const bool looks_at_leds =
      std::any_of(finders.begin(), finders.end(), [](const CaptureFinder& finder) {
        return std::holds_alternative<LedFinder>(finder.settings);
      });
  const auto wants = [&](const BagTopic& topic) {
    return detail::RecordedSurvey::wants(topic) ||
           (looks_at_leds && switches_leds(topic, options_.led));
  };
  read_bag(options_.path, {wants, handle, meter}, own);
  survey_->sort_views();
  if (own.errors.empty()) {
    survey_->joints.choose(options_.joints, options_.path, own, in_motion());
    choose_cameras(finders, own);
    detail::report_messages(*survey_, cameras_, options_.path, in_motion(), own);
  }
  if (own.errors.empty()) {
    depths_ = detail::depth_cameras(*survey_, cameras_, options_, own);
  }
  if (own.errors.empty() && looks_at_leds) choose_leds(finders, own);
  if (own.errors.empty()) detail::check_clocks(*survey_, cameras_, options_.path, own);
  if (own.errors.empty()) {
    times_ = in_motion() ? detail::find_intervals(*survey_, cameras_, options_, own)
                         : detail::find_standstills(*survey_, options_, own);
  }
  for (const auto list :
       {&Diagnostics::errors, &Diagnostics::warnings, &Diagnostics::doubts, &Diagnostics::notes}) {
    auto& all = diagnostics.*list;
    all.insert(all.end(), (own.*list).begin(), (own.*list).end());
  }
}

RecordedViews::~RecordedViews() = default;
RecordedViews::RecordedViews(RecordedViews&&) noexcept = default;
RecordedViews& RecordedViews::operator=(RecordedViews&&) noexcept = default;

void RecordedViews::choose_cameras(const std::vector<CaptureFinder>& finders,
                                   Diagnostics& diagnostics) {
  std::vector<RecordedTopic> recorded;
  for (const auto& [name, topic] : survey_->topics) recorded.push_back(topic.topic);
  const auto chosen = choose_topics(
      recorded, finders, {options_.path, options_.depth, options_.camera.has_value()}, diagnostics);
  for (const ViewTopics& topics : chosen) {
    const auto known = std::find(cameras_.begin(), cameras_.end(), topics);
    camera_of_.push_back(static_cast<std::size_t>(known - cameras_.begin()));
    if (known == cameras_.end()) cameras_.push_back(topics);
  }
  led_settle_.resize(cameras_.size());
  if (cameras_.size() > 1 && (options_.camera || !options_.frame.empty())) {
    diagnostics.error(
        {options_.path, 0},
        "--camera and --frame are for a single camera, but the finders look through " +
            std::to_string(cameras_.size()));
  }
}

void RecordedViews::choose_leds(const std::vector<CaptureFinder>& finders,
                                Diagnostics& diagnostics) {
  const CaptureFinder* named = nullptr;
  for (std::size_t f = 0; f < finders.size(); ++f) {
    const auto* leds = std::get_if<LedFinder>(&finders[f].settings);
    if (leds == nullptr) continue;
    if (named == nullptr) named = &finders[f];
    std::optional<Stamp>& settle = led_settle_[camera_of_[f]];
    settle = std::max(settle.value_or(leds->settle), leds->settle);
  }
  const std::string about = "finder '" + named->name + "': ";
  if (in_motion()) {
    diagnostics.error(named->place, about +
                                        "LEDs are switched while the robot stands still: they "
                                        "do not go with --every");
    return;
  }
  if (is_led_table(options_.led)) {
    led_commands_ = read_led_table(options_.led, diagnostics);
  } else if (!survey_->leds.empty()) {
    auto chosen = survey_->leds.find(detail::plain_topic(named->action) + "/goal");
    if (chosen == survey_->leds.end()) chosen = survey_->leds.begin();
    led_commands_ = chosen->second;
    std::stable_sort(led_commands_.begin(), led_commands_.end(),
                     [](const LedCommand& a, const LedCommand& b) { return a.time < b.time; });
  }
  if (!led_commands_.empty()) {
    if (std::none_of(led_commands_.begin(), led_commands_.end(),
                     [](const LedCommand& of) { return of.code == 0; })) {
      diagnostics.note(named->place, about + "no command switches the LEDs off in " +
                                         options_.path +
                                         "; they are taken for dark before the first one");
    }
    return;
  }
  const std::string usual =
      detail::plain_topic(named->action.empty() ? "gripper_led_action" : named->action) + "/goal";
  diagnostics.error(
      named->place,
      about + "LEDs take the times at which they were switched: " + options_.path + " has no " +
          (options_.led.empty() ? "commands to them, topic '" + printable(usual) +
                                      "' of robot_calibration_msgs/GripperLedCommandActionGoal; "
                                      "record it, or name a "
                                      "topic of codes, or a table of time and code, with --led"
                                : "codes of LEDs, led_code or data, on topic '" +
                                      printable(options_.led) + "' of --led"));
}

std::shared_ptr<detail::RawView> RecordedViews::raw_view(const detail::ViewStamp& stamp,
                                                         std::size_t camera) const {
  const std::vector<std::string> topics = detail::parts_of(cameras_[camera]);
  detail::RawView view{stamp.stamp, {}};
  view.parts.reserve(2);
  view.parts.push_back({topics.front(), stamp.index});
  if (topics.size() > 1) {
    const Stamp together = in_motion() ? detail::kTogetherInMotion : detail::kTogether;
    const auto* other =
        detail::companion(survey_->topics.at(topics[1]).views, stamp.stamp, together);
    if (other == nullptr) return nullptr;
    view.parts.push_back({topics[1], other->index});
  }
  return std::make_shared<detail::RawView>(std::move(view));
}

std::vector<std::shared_ptr<detail::RawView>> RecordedViews::planned(const Standstill& time,
                                                                     std::size_t camera) const {
  const auto& main = survey_->topics.at(detail::parts_of(cameras_[camera]).front()).views;
  std::vector<detail::ViewStamp> of_interest =
      in_motion() ? detail::middle_view(main, time) : detail::worth_a_look(main, time);
  if (led_settle_[camera]) {  // with all LEDs off, so that images change by motion only
    of_interest.clear();
    for (const LedSpan& span : led_spans(led_commands_, time, *led_settle_[camera])) {
      if (span.code != 0) continue;
      const auto dark = detail::middle_view(main, span.time);
      of_interest.insert(of_interest.end(), dark.begin(), dark.end());
    }
    of_interest = detail::spread_out(of_interest, detail::kMostLooks);
  }
  std::vector<std::shared_ptr<detail::RawView>> views;
  for (const detail::ViewStamp& stamp : of_interest) {
    if (auto view = raw_view(stamp, camera)) views.push_back(std::move(view));
  }
  return views;
}

std::vector<SwitchedView> RecordedViews::planned_switches(const Standstill& time,
                                                          std::size_t camera) const {
  constexpr int kMostPulses = 6;  // of an LED: so many views are in memory
  if (!led_settle_[camera]) return {};
  const auto& main = survey_->topics.at(detail::parts_of(cameras_[camera]).front()).views;
  std::vector<SwitchedView> all;
  std::map<int, int> pulses;
  const auto add = [&](int code, const Standstill& within) {
    for (const detail::ViewStamp& stamp : detail::middle_view(main, within)) {
      if (auto raw = raw_view(stamp, camera)) all.push_back({code, std::move(raw)});
    }
  };
  for (const LedSpan& span : led_spans(led_commands_, time, *led_settle_[camera])) {
    const Stamp middle = span.time.begin + (span.time.end - span.time.begin) / 2;
    if (span.code != 0 && ++pulses[span.code] > kMostPulses) continue;
    if (span.code == 0 && all.size() > 1 && all.back().code == 0) continue;
    const bool is_first = all.empty();  // of which there are two: what differs between them moves
    if (is_first) add(span.code, {span.time.begin, middle});
    add(span.code, is_first && !all.empty() ? Standstill{middle, span.time.end} : span.time);
  }
  return all;
}

void RecordedViews::read(const std::function<void(RecordedStandstill)>& handle,
                         const ProgressMeter& meter) const {
  std::vector<RecordedStandstill> standstills;
  const Stamp start = survey_->joints.span().value_or(Standstill{}).begin;
  for (const Standstill& time : times_) {
    RecordedStandstill standstill;
    standstill.number = standstills.size();
    standstill.time = time;
    standstill.source = options_.path + " at " +
                        detail::stamp_text(time.begin + (time.end - time.begin) / 2 - start);
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      standstill.views.push_back(planned(time, c));
      standstill.switched.push_back(planned_switches(time, c));
    }
    standstills.push_back(std::move(standstill));
  }
  detail::StandstillReader reader(std::move(standstills), handle);
  Diagnostics repeated;  // the first pass has reported them
  read_bag(options_.path,
           {[&](const BagTopic& topic) { return reader.wants(topic); },
            [&](const BagMessage& message) { reader.take(message); }, meter},
           repeated);
  reader.finish();
}

std::string RecordedViews::nothing_in(const ViewTopics& topics) const {
  const std::vector<std::string> parts = detail::parts_of(topics);
  const std::string text = "topic '" + printable(parts.front()) + "' has nothing ";
  if (!in_motion()) return text + "while the robot stands still";
  if (parts.size() < 2) return text + "in this interval";
  return text + "in this interval of which topic '" + printable(parts[1]) +
         "' has the same within " + std::to_string(detail::kTogetherInMotion.count()) + " ms";
}

View RecordedViews::decoded(const detail::RawView& raw, std::size_t camera) const {
  const ViewTopics& topics = cameras_.at(camera);
  std::optional<CameraInfo> settings = options_.camera;
  if (!settings && !topics.camera_info.empty()) {
    settings = survey_->topics.at(topics.camera_info).camera;
  }
  return detail::decoded(raw, topics, settings, depths_.at(camera), options_.frame);
}

Found RecordedViews::find_leds(const RecordedStandstill& standstill, std::size_t camera,
                               const LedFinder& finder) const {
  const std::vector<SwitchedView>& all = standstill.switched.at(camera);
  const auto view_of = [&](std::size_t i) {
    View view = decoded(*all[i].raw, camera);
    view.joints = survey_->joints.positions(view.stamp, standstill.time);
    return view;
  };
  try {
    std::size_t begin = 0;
    while (begin < all.size() && all[begin].code != 0) ++begin;
    if (begin == all.size())
      return refused("there is no view with all LEDs off in this standstill");
    const bool has_second = begin + 1 < all.size() && all[begin + 1].code == 0;
    LedSearch search(finder, view_of(begin), view_of(begin + (has_second ? 1 : 0)));
    int pulses = 0;
    for (std::size_t i = begin + 1; i + 1 < all.size(); ++i) {
      const auto led = std::find_if(finder.leds.begin(), finder.leds.end(),
                                    [&](const Led& known) { return known.code == all[i].code; });
      if (led == finder.leds.end() || all[i + 1].code != 0) continue;
      search.pulse(static_cast<std::size_t>(led - finder.leds.begin()), view_of(i), view_of(i + 1));
      ++pulses;
    }
    if (pulses == 0) {
      return refused("none of its LEDs was switched on and off again while the robot stood still");
    }
    return search.found();
  } catch (const std::runtime_error& error) {
    return refused(error.what());
  }
}

RecordedView RecordedViews::view(const RecordedStandstill& standstill, std::size_t camera) const {
  std::vector<View> views;
  std::string failure = nothing_in(cameras_.at(camera));
  for (const auto& raw : standstill.views.at(camera)) {
    try {
      views.push_back(decoded(*raw, camera));
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
  }
  if (views.empty()) return {{}, failure};
  if (in_motion()) {
    RecordedView found{{}, {}, true, true};
    std::vector<View> parts =
        detail::parts_in_motion(std::move(views.front()), survey_->joints, found.refusal);
    if (parts.empty()) return found;
    found.view = std::move(parts.front());
    found.later.assign(std::make_move_iterator(parts.begin() + 1),
                       std::make_move_iterator(parts.end()));
    return found;
  }
  const StillView chosen = still_view(views);
  if (!chosen.refusal.empty()) return {{}, chosen.refusal};
  View& view = views[chosen.index];
  view.joints = survey_->joints.positions(view.stamp, standstill.time);
  return {std::move(view), {}, views.size() > 1};
}

}  // namespace kinecal
