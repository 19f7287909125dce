// Definitions of april_tag_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/april_tag_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/tags/april_tags.hpp"
#include "kinecal/capture/tags/marker_tags.hpp"
#include "kinecal/capture/tags/other_tags.hpp"
#include "kinecal/capture/tags/tag_layout.hpp"
#include "kinecal/capture/tags/touching_tags.hpp"

namespace kinecal {

namespace detail {

// The tags of a target by its settings.

/// The tags of a target, in the order of their ids.
[[nodiscard]] inline std::vector<PlacedTag> all_tags(const AprilTagSettings& s) {
  std::vector<PlacedTag> tags = grid_tags(s);
  tags.insert(tags.end(), s.tags.begin(), s.tags.end());
  std::sort(tags.begin(), tags.end(),
            [](const PlacedTag& a, const PlacedTag& b) { return a.id < b.id; });
  return tags;
}

/// Where squares may touch tags: single tags have none.
[[nodiscard]] inline TouchingGrid touching_grid(const AprilTagSettings& s) {
  TouchingGrid grid{s.spacing, s.max_wrong_bits};
  for (const PlacedTag& tag : grid_tags(s)) grid.ids.push_back(tag.id);
  return grid;
}

/// @throws std::invalid_argument  if a target is impossible
inline void check_tags(const AprilTagSettings& s, const std::vector<PlacedTag>& tags) {
  if (tags.empty()) {
    throw std::invalid_argument("a target of AprilTags needs columns and rows of a grid, or tags");
  }
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const std::string name = "AprilTag " + std::to_string(tags[i].id);
    if (!(tags[i].size > 0.0) || tags[i].id < 0) {
      throw std::invalid_argument(name + " has a size of " + std::to_string(tags[i].size) +
                                  " m: sizes must be positive, ids not negative");
    }
    if (i > 0 && tags[i].id == tags[i - 1].id) {
      throw std::invalid_argument(name + " is on the target twice");
    }
  }
  if (!(s.spacing >= 0.0) || !(s.min_side > 0.0) || !(s.decimate >= 1.0) || s.min_tags < 1 ||
      s.border < 1 || s.border > 4 || s.max_wrong_bits < 0 || s.max_wrong_bits > 2) {
    throw std::invalid_argument(
        "AprilTags: spacing >= 0, min_side > 0, decimate >= 1, min_tags >= 1, border 1 to 4 and "
        "max_wrong_bits 0 to 2 are possible");
  }
  if (is_marker_dictionary(s.family) && s.border != 1) {
    throw std::invalid_argument("markers of " + s.family + " have a border of 1 bit");
  }
}

namespace {

/// The usable tags in an image.
struct TagsSeen {
  std::vector<TargetCorner> corners;
  std::vector<EdgeMeasure> edges[2];
  int tags = 0;
  int small = 0;
  int outside = 0;       ///< at the image's border
  double largest = 0.0;  ///< side of a small one, pixels
  int twice = -1;        ///< id
};

[[nodiscard]] double shortest_side(const SeenTag& tag) {
  double least = (tag.corners[0] - tag.corners[3]).norm();
  for (std::size_t k = 0; k < 3; ++k) {
    least = std::min(least, (tag.corners[k + 1] - tag.corners[k]).norm());
  }
  return least;
}

/// Adds the corners and edges of one tag.
void add_tag(const GrayImage& image, const PlacedTag& placed, const SeenTag& tag, double cells,
             TagsSeen& seen) {
  const double side = shortest_side(tag);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d &a = tag.corners[k], &b = tag.corners[(k + 1) % 4];
    const int number = static_cast<int>(k);
    seen.corners.push_back(
        {4 * tag.id + number, a, tag_corner(placed, number), std::max(2.0, 0.15 * side)});
    const auto edge = measure_edge(image, a, b, std::max(1.5, 0.9 * side / cells));
    if (edge) seen.edges[k % 2].push_back(*edge);
  }
  ++seen.tags;
}

[[nodiscard]] TagsSeen tags_seen(const GrayImage& image, const std::vector<SeenTag>& found,
                                 const std::vector<PlacedTag>& tags, double cells,
                                 double min_side) {
  TagsSeen seen;
  std::vector<int> ids;
  for (const SeenTag& tag : found) {
    const auto placed =
        std::find_if(tags.begin(), tags.end(), [&](const PlacedTag& t) { return t.id == tag.id; });
    if (placed == tags.end()) continue;
    if (std::find(ids.begin(), ids.end(), tag.id) != ids.end()) seen.twice = tag.id;
    ids.push_back(tag.id);
    const double side = shortest_side(tag);
    const bool inside = std::all_of(tag.corners.begin(), tag.corners.end(), [&](const auto& c) {
      return c.x() >= 2.0 && c.y() >= 2.0 && c.x() <= image.width - 3.0 &&
             c.y() <= image.height - 3.0;
    });
    if (!inside) {
      ++seen.outside;
    } else if (side < min_side) {
      ++seen.small;
      seen.largest = std::max(seen.largest, side);
    } else {
      add_tag(image, *placed, tag, cells, seen);
    }
  }
  return seen;
}

}  // namespace
}  // namespace detail

/// Finds AprilTags with libapriltag, markers of ArUco with OpenCV.
struct AprilTagFinder::Detector {
  std::string dictionary;                   ///< of ArUco; empty: a family of AprilTags
  std::optional<detail::TagReader> reader;  ///< of that family
  detail::OtherTags others;
  detail::TouchingGrid grid;

  [[nodiscard]] std::string fault() const {
    return reader ? detail::april_tag_fault() : detail::aruco_fault();
  }
  [[nodiscard]] double cells() const {
    return reader ? reader->cells() : detail::marker_cells(dictionary);
  }
  [[nodiscard]] std::vector<detail::SeenTag> read(const GrayImage& image) const {
    if (!reader) return detail::read_marker_tags(image, dictionary);
    return detail::with_touching_tags(*reader, image, grid, reader->read(image));
  }
};

AprilTagFinder::AprilTagFinder(AprilTagSettings settings)
    : settings_(std::move(settings)),
      tags_(detail::all_tags(settings_)),
      detector_(nullptr, [](Detector* d) { delete d; }) {
  detail::check_tags(settings_, tags_);
  check_target(settings_.target);
  const AprilTagSettings& set = settings_;
  detector_.reset(new Detector{"", {}, detail::OtherTags(set, tags_), detail::touching_grid(set)});
  if (detail::is_marker_dictionary(set.family)) {
    detector_->dictionary = set.family;
  } else {
    detector_->reader.emplace(set.family, set.border, set.max_wrong_bits, set.decimate);
  }
}

Found AprilTagFinder::find(const View& view) const {
  if (const auto fault = detector_->fault(); !fault.empty()) return refused(fault);
  if (const auto fault = view_fault(view, settings_.target.corners); !fault.empty()) {
    return refused(fault);
  }
  const std::vector<detail::SeenTag> read = detector_->read(view.image);
  detail::TagsSeen seen =
      detail::tags_seen(view.image, read, tags_, detector_->cells(), settings_.min_side);
  std::vector<Mark> marks = marks_of(seen.corners);
  if (seen.twice >= 0) {
    return refused("tag " + std::to_string(seen.twice) + " is seen twice: which is meant?", marks);
  }
  // A few tags that are read by chance do not hide that the target is of another kind.
  constexpr int kByChance = 3;
  const int any = seen.tags + seen.small + seen.outside;
  std::string hint;
  if (any == 0 || (any <= kByChance && 4 * any < static_cast<int>(tags_.size()))) {
    hint = detector_->others.hint(view.image, read);
  }
  if (seen.tags < settings_.min_tags || !hint.empty()) {
    std::string why =
        std::to_string(seen.tags) + " of " + std::to_string(tags_.size()) + " tags are seen";
    if (seen.tags < settings_.min_tags) {
      why += ", at least " + std::to_string(settings_.min_tags) + " must be";
    }
    if (seen.small > 0) {
      why += "; " + std::to_string(seen.small) + " are too small: sides of at most " +
             detail::one_digit(seen.largest) + " pixels, " + detail::one_digit(settings_.min_side) +
             " are needed";
    }
    if (!hint.empty()) why += "; " + hint;
    if (seen.outside > 0) why += "; " + std::to_string(seen.outside) + " are at the border";
    return refused(why, marks);
  }
  if (const auto fault = edge_fault(seen.edges, settings_.target.quality); !fault.empty()) {
    return refused("the tags are " + fault, marks);
  }
  const detail::TagLayout layout = detail::arrange_tags(settings_, *view.camera, seen.corners);
  if (!layout.fault.empty()) return refused(layout.fault, std::move(marks));
  Found found = observed(view, settings_.target, std::move(seen.corners));
  if (!layout.note.empty()) found.notes.push_back(layout.note);
  return found;
}

}  // namespace kinecal
