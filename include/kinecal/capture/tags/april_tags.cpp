// Definitions of april_tags.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/april_tags.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/tags/tag_edges.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
#endif

namespace kinecal {

const std::vector<std::string>& april_tag_families() {
  static const std::vector<std::string> names = {
      "tag36h11",       "tag36h10",       "tag25h9",          "tag16h5",         "tagCircle21h7",
      "tagCircle49h12", "tagCustom48h12", "tagStandard41h12", "tagStandard52h13"};
  return names;
}

namespace detail {

[[nodiscard]] std::size_t family_number(const std::string& family) {
  const auto& names = april_tag_families();
  const auto found = std::find(names.begin(), names.end(), family);
  if (found == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("there is no family '" + family + "' of AprilTags, only " + known +
                                " (and dictionaries of ArUco)");
  }
  return static_cast<std::size_t>(found - names.begin());
}

#ifdef KINECAL_HAVE_APRILTAG

std::string april_tag_fault() {
  return "";
}

struct TagFamily {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

/// In the order of april_tag_families().
inline constexpr TagFamily kTagFamilies[] = {{tag36h11_create, tag36h11_destroy},
                                             {tag36h10_create, tag36h10_destroy},
                                             {tag25h9_create, tag25h9_destroy},
                                             {tag16h5_create, tag16h5_destroy},
                                             {tagCircle21h7_create, tagCircle21h7_destroy},
                                             {tagCircle49h12_create, tagCircle49h12_destroy},
                                             {tagCustom48h12_create, tagCustom48h12_destroy},
                                             {tagStandard41h12_create, tagStandard41h12_destroy},
                                             {tagStandard52h13_create, tagStandard52h13_destroy}};

struct TagReader::Library {
  TagFamily calls;
  apriltag_family_t* family;
  apriltag_detector_t* detector;
};

/// The black border of a family is one bit wide; codes lie inside of it.
void widen_border(apriltag_family_t& family, int border) {
  const int more = border - 1;
  family.width_at_border += 2 * more;
  family.total_width += 2 * more;
  for (std::uint32_t i = 0; i < family.nbits; ++i) {
    family.bit_x[i] += static_cast<std::uint32_t>(more);
    family.bit_y[i] += static_cast<std::uint32_t>(more);
  }
}

/// The codes of a family, with the places of their bits.
[[nodiscard]] TagCodes codes_of(const apriltag_family_t& family, int border) {
  TagCodes codes{family.width_at_border,
                 border,
                 static_cast<int>(family.h),
                 {family.codes, family.codes + family.ncodes},
                 {}};
  const double cells = family.width_at_border;
  for (std::uint32_t i = 0; i < family.nbits; ++i) {
    codes.places.emplace_back((family.bit_x[i] + 0.5) / cells,
                              1.0 - (family.bit_y[i] + 0.5) / cells);
  }
  return codes;
}

TagReader::TagReader(const std::string& family, int border, int wrong_bits, double decimate)
    : library_(nullptr, [](Library* l) {
        apriltag_detector_destroy(l->detector);
        l->calls.destroy(l->family);
        delete l;
      }) {
  const TagFamily calls = kTagFamilies[family_number(family)];
  library_.reset(new Library{calls, calls.create(), apriltag_detector_create()});
  const bool has_border =
      family.starts_with("tag36") || family.starts_with("tag25") || family.starts_with("tag16");
  if (border > 1 && !has_border) {
    throw std::invalid_argument("tags of family " + family + " have no black border of " +
                                std::to_string(border) + " bits");
  }
  widen_border(*library_->family, border);
  if (has_border) codes_ = codes_of(*library_->family, border);
  apriltag_detector_add_family_bits(library_->detector, library_->family, wrong_bits);
  library_->detector->nthreads = 1;
  library_->detector->quad_decimate = static_cast<float>(decimate);
}

double TagReader::cells() const {
  return library_->family->width_at_border;
}

/// The tags that libapriltag finds.
[[nodiscard]] std::vector<SeenTag> detected(apriltag_detector_t* detector, const GrayImage& image) {
  constexpr int kLeastSide = 32;
  if (image.width < kLeastSide || image.height < kLeastSide) return {};
  image_u8_t pixels = {image.width, image.height, image.width,
                       const_cast<std::uint8_t*>(image.pixels.data())};
  zarray_t* found = apriltag_detector_detect(detector, &pixels);
  std::vector<SeenTag> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(found, i, &d);
    SeenTag tag{d->id, {}};
    // In libapriltag the centre of the first pixel is at (0.5, 0.5).
    for (std::size_t k = 0; k < 4; ++k) tag.corners[k] = {d->p[k][0] - 0.5, d->p[k][1] - 0.5};
    tags.push_back(tag);
  }
  apriltag_detections_destroy(found);
  return tags;
}

std::vector<SeenTag> TagReader::read(const GrayImage& image) const {
  std::vector<SeenTag> tags = detected(library_->detector, image);
  for (SeenTag& tag : tags) {
    refine_tag(image, (tag.corners[1] - tag.corners[0]).norm() / cells(), tag.corners);
  }
  return tags;
}

std::vector<SeenTag> TagReader::read_roughly(const GrayImage& image) const {
  float& decimate = library_->detector->quad_decimate;
  const float usual = std::exchange(decimate, 1.0F);
  std::vector<SeenTag> tags = detected(library_->detector, image);
  decimate = usual;
  return tags;
}

#else

struct TagReader::Library {};

std::string april_tag_fault() {
  return "this kinecal was built without libapriltag, which finds AprilTags; install "
         "libapriltag-dev and build it again";
}

TagReader::TagReader(const std::string& family, int, int, double)
    : library_(nullptr, [](Library*) {}) {
  (void)family_number(family);
}

double TagReader::cells() const {
  return 8.0;
}

std::vector<SeenTag> TagReader::read(const GrayImage&) const {
  return {};
}

std::vector<SeenTag> TagReader::read_roughly(const GrayImage&) const {
  return {};
}

#endif

}  // namespace detail

}  // namespace kinecal
