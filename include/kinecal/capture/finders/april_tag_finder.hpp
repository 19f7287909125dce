// A Finder for AprilTags and markers of ArUco, a grid or single ones on one target; some tags may be out
// of view.
//
//   const AprilTagFinder finder({.columns = 6, .rows = 6, .size = 0.088, .spacing = 0.3});
//
// The grid is Kalibr's: the tag of the first id is at the bottom left, ids go to the right, then
// up.  The frame of the target is at the outer bottom left corner of that tag, x right, y up, z
// towards the viewer.  The corners of tag k have the ids 4 k (bottom left), 4 k + 1 (bottom right),
// 4 k + 2 (top right) and 4 k + 3 (top left).  Tags that do not belong to the target are ignored.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// A tag at its own place, upright as in a grid.
struct PlacedTag {
  int id = 0;
  double size = 0.0;                   ///< side of its black border, metres
  Vector3<double> centre = {0, 0, 0};  ///< (3) metres, in the frame of the target
};

class AprilTagFinder;

/// A target with tags.
struct AprilTagSettings {
  using FinderType = AprilTagFinder;  ///< finds it

  int columns = 0;                   ///< of the grid; 0: no grid, only `tags`
  int rows = 0;                      ///< of the grid
  double size = 0.0;                 ///< side of a tag's black border, metres
  double spacing = 0.3;              ///< gap between tags, as a fraction of the size (tagSpacing)
  int first_id = 0;                  ///< of the tag at the bottom left
  std::vector<PlacedTag> tags = {};  ///< instead of a grid, or besides it
  std::string family =
      "tag36h11";              ///< one of april_tag_families(), or a dictionary of ArUco such as
                               ///< DICT_4X4_50
  int border = 1;              ///< bits of the black border: 2 in Kalibr's own PDFs
  int max_wrong_bits = 1;      ///< tolerated in a tag's code, 0 to 2
  double min_side = 24.0;      ///< of a tag, pixels; ignores smaller ones
  int min_tags = 1;            ///< that must be seen
  double decimate = 2.0;       ///< searches an image smaller by this factor
  TargetSettings target = {};  ///< its sensors, and requirements on its image
};

/// Names of the families of tags.
[[nodiscard]] const std::vector<std::string>& april_tag_families();

/// Finds the tags of one target on one thread: AprilTags with libapriltag, markers of ArUco with OpenCV.
/// Not thread-safe.
class AprilTagFinder {
 public:
  /// @throws std::invalid_argument  if the family is unknown, there is no tag, two have the same
  ///                                id, a size is not positive, or check_target() throws
  explicit AprilTagFinder(AprilTagSettings settings);

  /// The tags in a view, or why they are missing: not visible, a tag twice, too small, blurred, ...
  [[nodiscard]] Found find(const View& view) const;

  /// The settings.
  [[nodiscard]] const AprilTagSettings& settings() const { return settings_; }
  /// All tags of the target, in the order of their ids.
  [[nodiscard]] const std::vector<PlacedTag>& tags() const { return tags_; }

 private:
  struct Detector;

  AprilTagSettings settings_;
  std::vector<PlacedTag> tags_;
  std::unique_ptr<Detector, void (*)(Detector*)> detector_;
};
static_assert(Finder<AprilTagFinder>);

}  // namespace kinecal
