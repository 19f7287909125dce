// Definitions of light_blob.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/light_blob.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinecal {
namespace detail {
namespace {

/// A pixel and those connected to it that are brighter than the edge.
std::vector<LightPixel> connected_pixels(const Image<float>& light, const LightPixel& peak,
                                         float edge) {
  Image<std::uint8_t> seen(light.width, light.height);
  seen(peak.u, peak.v) = 1;
  std::vector<LightPixel> pixels = {peak};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const LightPixel at = pixels[i];
    for (const LightPixel& next : {LightPixel{at.u - 1, at.v}, LightPixel{at.u + 1, at.v},
                                   LightPixel{at.u, at.v - 1}, LightPixel{at.u, at.v + 1}}) {
      if (!light.contains(next.u, next.v) || seen(next.u, next.v) != 0) continue;
      if (!(light(next.u, next.v) > edge)) continue;
      seen(next.u, next.v) = 1;
      pixels.push_back(next);
    }
  }
  return pixels;
}

}  // namespace
}  // namespace detail

double LightBlob::elongation() const {
  constexpr double kPixel = 0.25;  // a few pixels in a row are not yet a line
  const double mean = 0.5 * (uu + vv), half = std::hypot(0.5 * (uu - vv), uv);
  return std::sqrt((mean + half + kPixel) / (std::max(0.0, mean - half) + kPixel));
}

LightBlob light_blob(const Image<float>& light, const LightPixel& peak) {
  constexpr float kEdge = 0.3F;  // of the peak
  const float edge = kEdge * light(peak.u, peak.v);
  LightBlob blob;
  blob.box = {peak.u, peak.v, peak.u, peak.v};
  double sum = 0.0;
  for (const auto& [u, v] : detail::connected_pixels(light, peak, edge)) {
    const double w = static_cast<double>(light(u, v) - edge);
    const double du = u - peak.u, dv = v - peak.v;
    sum += w;
    blob.u += w * du;
    blob.v += w * dv;
    blob.uu += w * du * du;
    blob.uv += w * du * dv;
    blob.vv += w * dv * dv;
    ++blob.pixels;
    blob.box = {std::min(blob.box.left, u), std::min(blob.box.top, v), std::max(blob.box.right, u),
                std::max(blob.box.bottom, v)};
  }
  blob.u /= sum;
  blob.v /= sum;
  blob.uu = blob.uu / sum - blob.u * blob.u;
  blob.uv = blob.uv / sum - blob.u * blob.v;
  blob.vv = blob.vv / sum - blob.v * blob.v;
  blob.u += peak.u;
  blob.v += peak.v;
  return blob;
}

}  // namespace kinecal
