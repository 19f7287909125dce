// Views of a recording, one for each standstill of the robot, or one every few seconds while it
// moves.
//
// The recording is read twice: first for joints and image times, which show when the robot stood
// still; then for a few images of each standstill.  So memory holds the images of only a few
// standstills, for any length of recording.
//
// While the robot moves, each interval gives the image nearest to its middle, with the positions and
// velocities of the joints at its stamp: samples for the lag of a camera behind the joints.  An
// interval in which nothing has moved since the last view gives no image.
//
// LEDs that were switched while the robot stood still are found in a view of each switch (led_commands.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/capture/registered_points.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/tools/detect/joint_tracks.hpp"
#include "kinecal/tools/detect/led_commands.hpp"
#include "kinecal/tools/detect/view_topics.hpp"

namespace kinecal {

/// Options for reading a recording.
struct RecordingOptions {
  std::string path;                       ///< ROS 1 bag, ROS 2 bag or MCAP
  std::vector<std::string> joints = {};   ///< topics of joint states, without slash; empty: all
  std::set<std::string> restless = {};    ///< joints that need not stand still
  std::string depth = {};                 ///< topic of the depth for images
  std::string led = {};                   ///< topic or table of the codes of LEDs; empty: by type
  std::string frame = {};                 ///< of the camera; empty: from the messages
  std::optional<CameraInfo> camera = {};  ///< replaces camera_info, of the only camera
  std::optional<Robot> robot = {};        ///< its fixed joints are where frames are that tf lacks
  SettleOptions settle = {};              ///< when joints stand still
  Stamp every = {};  ///< length of the intervals that give a view each, whether the robot moves or
                     ///< not; zero: each standstill gives one
};

namespace detail {
struct RecordedSurvey;
struct RawView;
struct ViewStamp;
}  // namespace detail

/// A view, and the LEDs that are on in it.
struct SwitchedView {
  int code = 0;
  std::shared_ptr<detail::RawView> raw;
};

/// A standstill or an interval, and messages of its views.
struct RecordedStandstill {
  std::size_t number = 0;  ///< from 0, in the order of time
  std::string source;      ///< "drive.bag at 12.300 s": since the first joint states
  Standstill time;         ///< begin and end
  std::size_t bytes = 0;   ///< of the messages
  std::vector<std::vector<std::shared_ptr<detail::RawView>>> views;  ///< a few of each camera
  std::vector<std::vector<SwitchedView>> switched;  ///< of each camera, in the order of time
};

/// The view of a camera in a standstill, or why it is missing.
struct RecordedView {
  std::optional<View> view = {};  ///< with the joints of its moment
  std::string refusal = {};       ///< empty if there is one
  bool compared = true;           ///< false: from a single image, which may have moved
  bool in_motion = false;         ///< true: the robot may move, and other views see it elsewhere
  /// Of a scan during a motion: its later parts, each with joints of its own; `view` is the first.
  std::vector<View> later = {};
};

/// A recording: see above.
class RecordedViews {
 public:
  /// Reads the recording for the first time.
  /// @param diagnostics  receives why nothing is usable (no joint states or another clock, missing
  ///                     or ambiguous topics, no standstill) and what was skipped
  RecordedViews(RecordingOptions options, const std::vector<CaptureFinder>& finders,
                Diagnostics& diagnostics, const ProgressMeter& meter = {});
  ~RecordedViews();
  RecordedViews(RecordedViews&&) noexcept;
  RecordedViews& operator=(RecordedViews&&) noexcept;

  /// Number of standstills, or of intervals.
  [[nodiscard]] std::size_t standstills() const { return times_.size(); }
  /// Topics of each camera; finders that look through the same ones share it.
  [[nodiscard]] const std::vector<ViewTopics>& cameras() const { return cameras_; }
  /// The camera of a finder, by its place in the list.
  [[nodiscard]] std::size_t camera_of(std::size_t finder) const { return camera_of_.at(finder); }

  /// Reads the recording again.
  /// @param handle  receives each standstill after its last message
  void read(const std::function<void(RecordedStandstill)>& handle,
            const ProgressMeter& meter = {}) const;

  /// The best view of a camera in a standstill or interval.  Several threads may call it.
  [[nodiscard]] RecordedView view(const RecordedStandstill& standstill, std::size_t camera) const;

  /// LEDs, by the views of their switches in a standstill.  Several threads may call it.
  [[nodiscard]] Found find_leds(const RecordedStandstill& standstill, std::size_t camera,
                                const LedFinder& finder) const;

 private:
  void choose_leds(const std::vector<CaptureFinder>& finders, Diagnostics& diagnostics);
  /// Views of all switches of LEDs in a standstill, two of the first darkness.
  [[nodiscard]] std::vector<SwitchedView> planned_switches(const Standstill& time,
                                                           std::size_t camera) const;
  /// The view of a message; nullptr if a part of it is missing.
  [[nodiscard]] std::shared_ptr<detail::RawView> raw_view(const detail::ViewStamp& stamp,
                                                          std::size_t camera) const;
  [[nodiscard]] View decoded(const detail::RawView& raw, std::size_t camera) const;
  void choose_cameras(const std::vector<CaptureFinder>& finders, Diagnostics& diagnostics);
  [[nodiscard]] bool in_motion() const { return options_.every > Stamp{}; }
  /// Why a camera has no view in a standstill or interval.
  [[nodiscard]] std::string nothing_in(const ViewTopics& topics) const;
  /// A few candidate messages of a camera in a standstill, spread over its middle; of an interval,
  /// the one nearest to its middle.
  [[nodiscard]] std::vector<std::shared_ptr<detail::RawView>> planned(const Standstill& time,
                                                                      std::size_t camera) const;

  RecordingOptions options_;
  std::unique_ptr<detail::RecordedSurvey> survey_;
  std::vector<ViewTopics> cameras_;
  std::vector<std::optional<RangeCamera>>
      depths_;                          ///< of each camera: its depth, if of another one
  std::vector<std::size_t> camera_of_;  ///< of each finder
  std::vector<Standstill> times_;
  std::vector<LedCommand> led_commands_;          ///< sorted by time
  std::vector<std::optional<Stamp>> led_settle_;  ///< of each camera that looks at LEDs
};

}  // namespace kinecal
