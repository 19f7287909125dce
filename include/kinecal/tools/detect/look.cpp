// Definitions of look.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/look.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <span>
#include <utility>

#include "kinecal/evaluation/parallel.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Finders of each camera.
using CameraFinders = std::vector<std::vector<ViewFinder>>;

/// Finders of each thread, made when it needs them.
class ThreadFinders {
 public:
  /// @param camera_of  camera of a finder, by its place in the list
  ThreadFinders(const LookOptions& options, std::size_t cameras,
                std::function<std::size_t(std::size_t)> camera_of)
      : make_(options.finders),
        camera_of_(std::move(camera_of)),
        cameras_(cameras),
        finders_(static_cast<std::size_t>(number_of_threads(options.threads))) {}

  [[nodiscard]] const CameraFinders& of(int thread) {
    CameraFinders& own = finders_[static_cast<std::size_t>(thread)];
    if (!own.empty()) return own;
    own.resize(cameras_);
    const std::vector<ViewFinder> all = make_();
    for (std::size_t f = 0; f < all.size(); ++f) own[camera_of_(f)].push_back(all[f]);
    return own;
  }

 private:
  const MakeFinders& make_;
  std::function<std::size_t(std::size_t)> camera_of_;
  std::size_t cameras_;
  std::vector<CameraFinders> finders_;  ///< of each thread
};

/// Whether two samples are of one moment: within 0.1 ms, as cameras on one trigger are.
[[nodiscard]] bool are_together(const Sample& a, const Sample& b) {
  constexpr std::chrono::microseconds kTrigger{100};
  return a.stamp == b.stamp ||
         (a.stamp && b.stamp && std::chrono::abs(*a.stamp - *b.stamp) <= kTrigger);
}

/// Adds observations of another camera: to samples of the same moment, or as more samples.
void join_observations(std::vector<Sample>& all, std::vector<Sample> more) {
  for (Sample& sample : more) {
    const auto is_free = [&](const Sample& other) {
      return are_together(other, sample) &&
             std::none_of(
                 sample.observations.begin(), sample.observations.end(),
                 [&](const Observation& o) { return other.observation(o.sensor) != nullptr; });
    };
    const auto to = std::find_if(all.begin(), all.end(), is_free);
    if (to == all.end()) {
      all.push_back(std::move(sample));
    } else {
      to->observations.insert(to->observations.end(), sample.observations.begin(),
                              sample.observations.end());
    }
  }
}

/// Adds what a later part of the same scan shows.  What finds nothing in any part is refused.
void add_part(Detection& scan, Detection part) {
  scan.features += part.features;
  std::move(part.samples.begin(), part.samples.end(), std::back_inserter(scan.samples));
  if (scan.samples.empty()) return;
  std::erase_if(scan.refused, [&](const std::string& why) {
    return std::find(part.refused.begin(), part.refused.end(), why) == part.refused.end();
  });
}

/// The picture of a view; of none, a gray one.
[[nodiscard]] Thumbnail view_picture(const std::optional<View>& view, Detection& found,
                                     const std::string& name, const std::string& reasons) {
  constexpr std::uint8_t kGray = 200;
  if (view && !view->image.empty()) {
    return thumbnail(view->image, std::move(found.marks), name, reasons, std::move(found.grid));
  }
  return thumbnail(GrayImage(kThumbnailWidth, kThumbnailWidth * 3 / 4, kGray), {}, name, reasons);
}

/// Looks at all views of one moment; the joints are those of the first, unless they move.
/// @param source  of the samples, for messages
/// @param find_leds  of each camera; empty: of none
[[nodiscard]] Look look_once(std::vector<RecordedView> views, const CameraFinders& finders,
                             const std::string& source, const std::string& name, bool thumbnails,
                             const std::vector<FindLeds>& find_leds = {}) {
  Look all;
  all.source = name;
  const std::string title = std::filesystem::path(name).filename().string();
  const MeasuredJoints* joints = nullptr;
  for (std::size_t c = 0; c < views.size(); ++c) {
    all.compared = all.compared && views[c].compared;
    Detection found;
    if (views[c].view) {
      View& view = *views[c].view;
      if (joints != nullptr && !views[c].in_motion) view.joints = *joints;
      joints = &view.joints;
      const FindLeds leds = c < find_leds.size() ? find_leds[c] : FindLeds();
      found = detect(view, finders[c], source, leds);
      for (const View& part : views[c].later) {
        add_part(found, detect(part, finders[c], source, leds));
      }
    } else {
      found.refused.push_back(views[c].refusal);
    }
    std::string reasons;
    for (const std::string& refused : found.refused) {
      all.refused.push_back(refused);
      if (found.samples.empty()) reasons += (reasons.empty() ? "" : "; ") + refused;
    }
    all.features += found.features;
    std::move(found.notes.begin(), found.notes.end(), std::back_inserter(all.notes));
    if (thumbnails) {
      all.thumbnails.push_back(view_picture(views[c].view, found, title, reasons));
    }
    join_observations(all.samples, std::move(found.samples));
  }
  return all;
}

}  // namespace
}  // namespace detail

std::vector<Look> look_at(const std::vector<PosedImage>& images,
                          const std::optional<CameraInfo>& camera, const std::string& frame,
                          const LookOptions& options) {
  const int count = static_cast<int>(images.size());
  detail::ThreadFinders finders(options, 1, [](std::size_t) { return 0; });
  std::mutex metering;
  int done = 0;
  std::vector<Look> looks(images.size());
  detail::for_each_piece(count, detail::number_of_threads(options.threads), [&](int i, int thread) {
    const PosedImage& image = images[static_cast<std::size_t>(i)];
    RecordedView view;
    try {
      view.view = read_view(image, camera, frame);
    } catch (const InputError& error) {
      const std::string text = error.what();
      const std::string name = image.path + ": ";
      view.refusal = text.starts_with(name) ? text.substr(name.size()) : text;
    }
    looks[static_cast<std::size_t>(i)] = detail::look_once(
        {std::move(view)}, finders.of(thread), image.source, image.path, options.thumbnails);
    const std::scoped_lock lock(metering);
    if (options.meter) options.meter(static_cast<double>(++done) / count, "detecting");
  });
  return looks;
}

std::vector<Look> look_at(const RecordedViews& recording, const LookOptions& options) {
  const std::size_t cameras = recording.cameras().size();
  detail::ThreadFinders finders(options, cameras,
                                [&](std::size_t f) { return recording.camera_of(f); });
  std::vector<Look> looks(recording.standstills());
  std::vector<RecordedStandstill> batch;  // those in memory
  std::size_t bytes = 0;                  // of their messages
  const int threads = detail::number_of_threads(options.threads);
  const auto finish_batch = [&] {
    detail::for_each_piece(static_cast<int>(batch.size()), threads, [&](int i, int thread) {
      RecordedStandstill& standstill = batch[static_cast<std::size_t>(i)];
      std::vector<RecordedView> views;
      std::vector<FindLeds> find_leds;
      for (std::size_t c = 0; c < cameras; ++c) {
        views.push_back(recording.view(standstill, c));
        find_leds.emplace_back([&recording, &standstill, c](const LedFinder& finder) {
          return recording.find_leds(standstill, c, finder);
        });
      }
      looks[standstill.number] =
          detail::look_once(std::move(views), finders.of(thread), standstill.source,
                            standstill.source, options.thumbnails, find_leds);
      standstill.views.clear();
      standstill.switched.clear();
    });
    batch.clear();
    bytes = 0;
  };
  recording.read(
      [&](RecordedStandstill standstill) {
        constexpr std::size_t kMost = std::size_t{1} << 29;
        bytes += standstill.bytes;
        batch.push_back(std::move(standstill));
        if (static_cast<int>(batch.size()) >= threads || bytes > kMost) finish_batch();
      },
      options.meter);
  finish_batch();
  return looks;
}

}  // namespace kinecal
