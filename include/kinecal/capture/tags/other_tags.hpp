// What an image shows in place of the tags of a target: tags with another border, of another family
// or with other ids, and the key to write for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/tags/april_tags.hpp"

namespace kinecal::detail {

/// A kind of tags.
struct TagKind {
  std::string family;
  int border = 1;  ///< bits
};

/// Looks for other tags in the first images without tags of the target: each search takes as long as
/// finding the tags a dozen times.
class OtherTags {
 public:
  /// @param tags  of the target
  OtherTags(const AprilTagSettings& settings, const std::vector<PlacedTag>& tags);

  /// "36 tags with a border of 2 bits are seen: write border: 2"; empty if there are no others.
  /// @param found  tags of the target's kind in the image, none of which belongs to the target
  [[nodiscard]] std::string hint(const GrayImage& image, const std::vector<SeenTag>& found);

 private:
  [[nodiscard]] bool is_ours(int id) const;
  [[nodiscard]] std::string other_ids(const std::vector<SeenTag>& found) const;
  [[nodiscard]] std::size_t count(const TagKind& kind, const GrayImage& image) const;
  [[nodiscard]] std::vector<TagKind> kinds() const;
  [[nodiscard]] std::string sentence(std::size_t count) const;

  TagKind own_;
  double decimate_;
  bool is_grid_;
  std::vector<int> ids_;         ///< of the target, sorted
  std::size_t least_;            ///< tags that are no coincidence
  std::optional<TagKind> seen_;  ///< in an earlier image
  int searches_ = 0;
};

}  // namespace kinecal::detail
