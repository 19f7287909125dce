// Definitions of other_tags.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/other_tags.hpp"

#include <algorithm>
#include <set>

#include "kinecal/capture/tags/marker_tags.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal::detail {

OtherTags::OtherTags(const AprilTagSettings& settings, const std::vector<PlacedTag>& tags)
    : own_{settings.family, settings.border},
      decimate_(settings.decimate),
      is_grid_(settings.columns * settings.rows > 0 && settings.tags.empty()) {
  constexpr std::size_t kNoCoincidence = 4;
  for (const PlacedTag& tag : tags) ids_.push_back(tag.id);
  least_ = std::min(kNoCoincidence, ids_.size());
}

bool OtherTags::is_ours(int id) const {
  return std::binary_search(ids_.begin(), ids_.end(), id);
}

/// Tags of the right kind that the target does not have.
std::string OtherTags::other_ids(const std::vector<SeenTag>& found) const {
  if (found.size() < least_) return {};
  const auto [first, last] = std::minmax_element(
      found.begin(), found.end(), [](const SeenTag& a, const SeenTag& b) { return a.id < b.id; });
  const std::string seen = found.size() == 1 ? "tag " + std::to_string(first->id) + " is seen"
                                             : "tags " + std::to_string(first->id) + " to " +
                                                   std::to_string(last->id) + " are seen";
  const std::string ours = ids_.size() == 1 ? "tag " + std::to_string(ids_.front())
                                            : "tags " + std::to_string(ids_.front()) + " to " +
                                                  std::to_string(ids_.back());
  return seen + ", the target has " + ours +
         (is_grid_ ? ": write first_id: " + std::to_string(first->id) : "");
}

/// The kinds of tags to look for, other than the target's own.  Few codes of 16 or 25 bits are found
/// by chance, so for one or two tags they are no evidence.  None for markers of ArUco.
std::vector<TagKind> OtherTags::kinds() const {
  std::vector<TagKind> all;
  if (is_marker_dictionary(own_.family)) return all;
  for (const std::string& family : april_tag_families()) {
    const bool is_weak = family.starts_with("tag16") || family.starts_with("tag25");
    if (is_weak && least_ < 3) continue;
    const bool has_border = is_weak || family.starts_with("tag36");
    for (int border = 1; border <= (has_border ? 2 : 1); ++border) {
      if (family != own_.family || border != own_.border) all.push_back({family, border});
    }
  }
  return all;
}

/// The number of the target's tags that an image shows as a kind.
std::size_t OtherTags::count(const TagKind& kind, const GrayImage& image) const {
  const TagReader reader(kind.family, kind.border, 0, decimate_);
  std::set<int> ids;
  for (const SeenTag& tag : reader.read(image)) {
    if (is_ours(tag.id)) ids.insert(tag.id);
  }
  return ids.size();
}

std::string OtherTags::sentence(std::size_t count) const {
  const bool other_family = seen_->family != own_.family,
             other_border = seen_->border != own_.border;
  std::string what = counted(count, "tag"), keys;
  if (other_family) {
    what += " of family " + seen_->family;
    keys = "family: " + seen_->family;
  }
  if (other_border) {
    what += " with a border of " + counted(static_cast<std::size_t>(seen_->border), "bit");
    keys += (keys.empty() ? "" : ", ") + std::string("border: ") + std::to_string(seen_->border);
  }
  return what + (count == 1 ? " is" : " are") + " seen: write " + keys;
}

std::string OtherTags::hint(const GrayImage& image, const std::vector<SeenTag>& found) {
  constexpr int kMostSearches = 3;
  if (std::string ids = other_ids(found); !ids.empty()) return ids;
  if (seen_) {
    const std::size_t again = count(*seen_, image);
    return again >= least_ ? sentence(again) : "";
  }
  if (searches_++ >= kMostSearches) return {};
  std::size_t most = 0;
  for (const TagKind& kind : kinds()) {
    const std::size_t tags = count(kind, image);
    if (tags < least_ || tags <= most) continue;
    most = tags;
    seen_ = kind;
  }
  return seen_ ? sentence(most) : "";
}

}  // namespace kinecal::detail
