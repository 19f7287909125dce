// Finds an LED in an image: the light that appears when it is switched on, and vanishes when off.
//
// A pulse is three images: dark, lit, dark again.  A pixel gains twice the smaller of both changes,
// for two switches:
//
//   d = 2 * 3 * min(lit - before, lit - after)      3: as a sum of red, green and blue
//
// A change of ambient light, or a passing object, changes the image once, not up and down, and
// gains nothing.  Even and odd pulses are summed separately; the smaller of their means counts,
// times the number of pulses.  So it takes two pulses, and a single flash is not an LED.
// Source: Fetch paper, III-A; the rest above.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "kinecal/capture/finders/image_motion.hpp"
#include "kinecal/capture/image.hpp"

namespace kinecal {

/// A part of an image: the pixels near a place.
struct PixelCircle {
  double u = 0.0, v = 0.0;  ///< centre, pixels
  double radius = 0.0;      ///< pixels
};

/// The brightest light of the pulses, and doubts about it.
struct LedSpot {
  double u = 0.0, v = 0.0;  ///< weighted centroid, pixels
  double peak = 0.0;        ///< accumulated difference of its brightest pixel
  PixelBox box;             ///< of its pixels
  std::string problem;      ///< why it is not clearly an LED; empty if it is
};

/// Accumulated differences of one LED.
class LedDifference {
 public:
  /// Adds a pulse.
  /// @throws std::invalid_argument  if sizes differ, also from those of the pulses before
  void add(const GrayImage& before, const GrayImage& lit, const GrayImage& after);

  /// Pulses so far.
  [[nodiscard]] int pulses() const { return pulses_; }

  /// The brightest light.
  /// @param threshold  accumulated difference that its brightest pixel must have
  /// @param within     search only there
  [[nodiscard]] LedSpot spot(double threshold, const std::optional<PixelCircle>& within = {}) const;

 private:
  std::array<Image<std::int32_t>, 2> halves_;  // of even and odd pulses
  std::int32_t strongest_ = 0;                 // of any pixel in any pulse
  int pulses_ = 0;
};

}  // namespace kinecal
