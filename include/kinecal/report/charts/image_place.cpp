// Features in images.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/image_place.hpp"

#include <algorithm>
#include <cmath>

namespace kinecal::detail {

std::vector<const ReportedFeature*> features_in_image(const ReportData& data,
                                                      const ReportedBlock& block) {
  std::vector<const ReportedFeature*> features;
  if (block.unit != "px") return features;
  constexpr double kMost = 1e6;  // pixels; larger images are implausible
  for (const ReportedFeature& feature : block.features) {
    if (!feature.pixel || feature.residual.size() < 2) continue;
    const auto [x, y] = *feature.pixel;
    const bool usable = std::abs(x) < kMost && std::abs(y) < kMost &&
                        std::isfinite(feature.residual[0]) && std::isfinite(feature.residual[1]);
    if (usable && !sample_of(data, feature).left_out) features.push_back(&feature);
  }
  return features;
}

ImageFrame image_frame(const ReportedBlock& block,
                       const std::vector<const ReportedFeature*>& features) {
  const auto [width, height] = block.image;
  if (width > 0.0 && height > 0.0 && std::isfinite(width) && std::isfinite(height)) {
    return {{0.0, 0.0}, {width, height}, true};
  }
  ImageFrame frame;
  for (std::size_t i = 0; i < 2 && !features.empty(); ++i) {
    frame.low[i] = frame.high[i] = (*features[0]->pixel)[i];
    for (const ReportedFeature* feature : features) {
      frame.low[i] = std::min(frame.low[i], (*feature->pixel)[i]);
      frame.high[i] = std::max(frame.high[i], (*feature->pixel)[i]);
    }
    if (!(frame.high[i] > frame.low[i])) frame.high[i] = frame.low[i] + 1.0;
  }
  return frame;
}

}  // namespace kinecal::detail
