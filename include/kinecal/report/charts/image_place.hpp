// The features of an error block in an image, and the image's frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// Corners of an image, pixels.
struct ImageFrame {
  ChartPoint low = {0.0, 0.0}, high = {1.0, 1.0};
  bool is_known = false;  ///< else the range of the features
};

/// Features with a finite pixel and two finite residuals in pixels, of samples in the fit.
[[nodiscard]] std::vector<const ReportedFeature*> features_in_image(const ReportData& data,
                                                                    const ReportedBlock& block);

/// The frame of a block's image.
[[nodiscard]] ImageFrame image_frame(const ReportedBlock& block,
                                     const std::vector<const ReportedFeature*>& features);

}  // namespace kinecal::detail
