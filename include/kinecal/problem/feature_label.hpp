// What a feature of a sample is called in messages and tables.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace kinecal {

/// A feature of a sample: its place and its id.
struct FeatureLabel {
  int place = 0;               ///< from 0, in the list of the observation
  std::optional<int> id = {};  ///< Feature::id, if it has one

  /// "feature 3", counted from 1, or "the feature with id 17".
  [[nodiscard]] std::string text() const {
    return id ? "the feature with id " + std::to_string(*id)
              : "feature " + std::to_string(place + 1);
  }
};

}  // namespace kinecal
