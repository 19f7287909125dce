// Definitions of touching_tags.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/touching_tags.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/capture/boards/saddle_corner.hpp"
#include "kinecal/capture/boards/shrunk_black.hpp"
#include "kinecal/capture/tags/tag_code.hpp"

namespace kinecal::detail {

namespace {

using TagCorners = std::array<Eigen::Vector2d, 4>;

/// Tags between squares in one image.
class TouchingSearch {
 public:
  TouchingSearch(const GrayImage& image, const TagCodes& codes, const TouchingGrid& grid)
      : image_(image),
        codes_(codes),
        grid_(grid),
        reach_(std::min(static_cast<double>(codes.border) / codes.cells, grid.spacing)) {}

  /// Adds a tag at whose corners squares are, and all that can be reached from it.
  void add(const SeenTag& seed) {
    if (has(middle(seed.corners))) return;
    const auto exact = tag_at(seed.corners, kSeedReach);
    if (!exact) return;
    tags_.push_back(*exact);
    for (std::size_t next = tags_.size() - 1; next < tags_.size(); ++next) {
      for (int side = 0; side < 4; ++side) add_neighbour(SeenTag(tags_[next]).corners, side);
    }
  }

  [[nodiscard]] const std::vector<SeenTag>& tags() const { return tags_; }

  [[nodiscard]] bool knows(int id) const {
    return std::any_of(tags_.begin(), tags_.end(), [&](const SeenTag& t) { return t.id == id; });
  }

 private:
  static constexpr double kSeedReach = 1.0, kNearReach = 0.75, kFarReach = 1.0;  // of the axes

  [[nodiscard]] static Eigen::Vector2d middle(const TagCorners& corners) {
    return (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
  }

  /// True if a place is in a tag that was found.
  [[nodiscard]] bool has(const Eigen::Vector2d& place) const {
    return std::any_of(tags_.begin(), tags_.end(), [&](const SeenTag& tag) {
      return (middle(tag.corners) - place).norm() <
                 0.5 * (tag.corners[1] - tag.corners[0]).norm() ||
             (middle(tag.corners) - place).norm() < 0.5 * (tag.corners[2] - tag.corners[1]).norm();
    });
  }

  /// The saddle at a corner of a tag.
  /// @param h       maps the plane of the tag to the image
  /// @param corner  in that plane
  /// @param way     into the tag, along both edges
  [[nodiscard]] std::optional<Eigen::Vector2d> corner_at(const Matrix3<double>& h,
                                                         const Eigen::Vector2d& corner,
                                                         const Eigen::Vector2d& way,
                                                         double reach) const {
    const Eigen::Vector2d at = mapped(h, corner), x(way.x(), 0.0), y(0.0, way.y());
    const auto axis = [&](const Eigen::Vector2d& along) -> Eigen::Vector2d {
      return 0.5 * (mapped(h, corner + reach_ * along) - mapped(h, corner - reach_ * along));
    };
    return find_saddle(image_, at, {axis(x), axis(y)}, reach);
  }

  [[nodiscard]] static Eigen::Vector2d inwards(const Eigen::Vector2d& unit) {
    return Eigen::Vector2d::Ones() - 2.0 * unit;
  }

  /// The tag whose corners are about there.
  [[nodiscard]] std::optional<SeenTag> tag_at(const TagCorners& about, double reach) const {
    const auto h = homography(unit_tag(), {about.begin(), about.end()});
    if (!h) return std::nullopt;
    TagCorners corners;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = corner_at(*h, unit_tag()[k], inwards(unit_tag()[k]), reach);
      if (!at) return std::nullopt;
      corners[k] = *at;
    }
    return named(corners);
  }

  /// The tag between corners, counter-clockwise from its bottom left.
  [[nodiscard]] std::optional<SeenTag> named(const TagCorners& corners) const {
    // Four squares are evidence, too: two more bits may be wrong if codes differ in many.
    const int wrong_bits =
        std::max(grid_.wrong_bits, std::min(grid_.wrong_bits + 2, (codes_.distance - 1) / 3));
    const auto reading = read_code(image_, codes_, corners, wrong_bits);
    if (!reading) return std::nullopt;
    SeenTag tag{reading->id, corners};
    std::rotate(tag.corners.begin(), tag.corners.begin() + reading->turns, tag.corners.end());
    return tag;
  }

  /// Adds the tag beyond a side of a tag: right, top, left, bottom.
  void add_neighbour(const TagCorners& tag, int side) {
    constexpr double kWays[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const Eigen::Vector2d way(kWays[side][0], kWays[side][1]);
    const Eigen::Vector2d offset = (1.0 + grid_.spacing) * way;
    std::vector<Eigen::Vector2d> plane = unit_tag(), pixels(tag.begin(), tag.end());
    auto h = homography(plane, pixels);
    if (!h || has(mapped(*h, Eigen::Vector2d(0.5, 0.5) + offset))) return;
    TagCorners corners;
    for (const bool far : {false, true}) {
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector2d unit = unit_tag()[k], corner = unit + offset;
        if (((unit - Eigen::Vector2d(0.5, 0.5)).dot(way) > 0.0) != far) continue;
        const auto at = corner_at(*h, corner, inwards(unit), far ? kFarReach : kNearReach);
        if (!at) return;
        corners[k] = *at;
        plane.push_back(corner);
        pixels.push_back(*at);
      }
      if (!far) h = homography(plane, pixels);
      if (!h) return;
    }
    if (const auto found = named(corners)) tags_.push_back(*found);
  }

  const GrayImage& image_;
  const TagCodes& codes_;
  TouchingGrid grid_;
  double reach_;  ///< of the uniform areas around a corner, of a tag
  std::vector<SeenTag> tags_ = {};
};

}  // namespace

std::vector<SeenTag> with_touching_tags(const TagReader& reader, const GrayImage& image,
                                        const TouchingGrid& grid, std::vector<SeenTag> found) {
  constexpr std::size_t kEnough = 4;
  if (reader.codes().codes.empty() || grid.ids.size() < 2 || !(grid.spacing > 0.0)) return found;
  TouchingSearch search(image, reader.codes(), grid);
  std::size_t ours = 0;
  for (const SeenTag& tag : found) {
    search.add(tag);
    ours += grid.has(tag.id) ? 1 : 0;
  }
  if (search.tags().empty() && ours >= kEnough) return found;  // at none of which squares are
  for (const double scale : search_scales(image)) {
    const std::size_t before = search.tags().size();
    if (before >= grid.ids.size()) break;
    for (SeenTag seed : reader.read_roughly(shrunk_black(image, scale))) {
      for (Eigen::Vector2d& corner : seed.corners) corner = at_full_size(corner, scale);
      search.add(seed);
    }
    if (before >= kEnough && search.tags().size() == before) break;
  }
  if (search.tags().empty()) return found;
  std::erase_if(found,
                [&](const SeenTag& tag) { return grid.has(tag.id) || search.knows(tag.id); });
  found.insert(found.end(), search.tags().begin(), search.tags().end());
  return found;
}

}  // namespace kinecal::detail
