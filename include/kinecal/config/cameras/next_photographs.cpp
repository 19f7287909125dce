// Says which photographs to take next.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/next_photographs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/config/cameras/target_view.ipp"
#include "kinecal/text/image_region.hpp"

namespace kinecal {

namespace detail {
namespace {

/// What the views of a camera have so far.
struct SeenSoFar {
  std::array<bool, kImageRegions> empty{};
  bool has_size = false;
  int views = 0;  ///< of a flat target
  double tilt = 1.0;
  double nearest = 0.0, farthest = 0.0;  ///< pixels per metre on the target: largest, smallest

  SeenSoFar() { empty.fill(true); }

  void add(const Observation& seen) {
    const double width = seen.camera->width, height = seen.camera->height;
    if (!(width > 0.0 && height > 0.0)) return;
    has_size = true;
    for (const Feature& feature : seen.features) {
      if (!feature.point.allFinite()) continue;
      empty[image_region(feature.point.x() / width, feature.point.y() / height)] = false;
    }
  }
  void add(const TargetView& view) {
    constexpr std::size_t kFewest = 6;
    if (view.plane.size() < kFewest) return;
    const auto h = homography(view.plane, view.pixels);
    if (!h) return;
    double low = HUGE_VAL, high = 0.0;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : view.plane) {
      const double depth = std::abs(h->row(2).dot(Vector3<double>(p.x(), p.y(), 1.0)));
      low = std::min(low, depth);
      high = std::max(high, depth);
      middle += p / static_cast<double>(view.plane.size());
    }
    if (!(low > 0.0)) return;
    ++views;
    tilt = std::max(tilt, high / low);
    constexpr double kStep = 1e-4;  // metres
    const Eigen::Vector2d at = mapped(*h, middle);
    const Eigen::Vector2d x = mapped(*h, middle + Eigen::Vector2d(kStep, 0.0)) - at,
                          y = mapped(*h, middle + Eigen::Vector2d(0.0, kStep)) - at;
    const double scale = std::sqrt(std::abs(x.x() * y.y() - x.y() * y.x())) / kStep;
    nearest = std::max(nearest, scale);
    farthest = views == 1 ? scale : std::min(farthest, scale);
  }
  /// What to do; empty if nothing is lacking.
  [[nodiscard]] std::string advice() const {
    constexpr double kTilted = 1.15, kDistances = 1.4;
    std::vector<std::string> parts;
    const std::string regions = image_regions_text(empty);
    if (has_size && !regions.empty()) {
      parts.push_back("hold the target at " + regions + " of its image: no feature was there");
    }
    if (views > 0 && tilt < kTilted) {
      parts.emplace_back("tilt the target: it faced the camera in every view");
    }
    if (views > 0 && nearest < kDistances * farthest) {
      parts.emplace_back("hold it nearer and farther: it was at one distance in all views");
    }
    return fmt::format("{}", fmt::join(parts, "; "));
  }
};

/// True for pixels: points of a depth camera have a depth.
[[nodiscard]] bool has_pixels(const Observation& seen) {
  return seen.camera &&
         std::all_of(seen.features.begin(), seen.features.end(),
                     [](const Feature& f) { return f.point.z() == 0.0 || !f.point.allFinite(); });
}

}  // namespace
}  // namespace detail

std::vector<std::string> next_photographs(std::span<const Sample> samples) {
  std::map<std::string, detail::SeenSoFar> cameras;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (!detail::has_pixels(seen)) continue;
      detail::SeenSoFar& so_far = cameras[seen.sensor];
      so_far.add(seen);
      for (const Observation& target : sample.observations) {
        const bool pairs = has_ids(sample) || target.features.size() == seen.features.size();
        if (!target.camera && pairs)
          so_far.add(detail::target_view(target.sensor, seen.sensor, sample));
      }
    }
  }
  std::vector<std::string> all;
  for (const auto& [camera, so_far] : cameras) {
    const std::string advice = so_far.advice();
    if (!advice.empty()) all.push_back("for the lens of '" + camera + "': " + advice);
  }
  return all;
}

}  // namespace kinecal
