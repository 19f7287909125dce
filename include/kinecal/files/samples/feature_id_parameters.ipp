// Ids of features in messages of samples, which have no field for them.  They are stored as
// parameters in the observation's ext_camera_info, beside z_offset_mm.
//
//   feature_id_<k>: n     feature k, from 0, has the id n, the next one n + 1, and so on until the
//                         next such parameter.  n = -1: they have no ids
//
// A whole board needs one parameter, `feature_id_0: 0`.  robot_calibration skips unknown names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

inline constexpr std::string_view kFeatureId = "feature_id_";

/// An id in a file; nullopt if it is not a whole number from 0.
[[nodiscard]] inline std::optional<int> feature_id(double value) {
  if (!(value >= 0.0 && value <= std::numeric_limits<int>::max() && value == std::floor(value))) {
    return std::nullopt;
  }
  return static_cast<int>(value);
}

/// Names and values of the parameters; empty if no feature has an id.
[[nodiscard]] inline std::vector<std::pair<std::string, double>> feature_id_parameters(
    const std::vector<Feature>& features) {
  std::vector<std::pair<std::string, double>> parameters;
  double next = -1.0;  // id of feature k without a parameter
  for (std::size_t k = 0; k < features.size(); ++k) {
    const double id = features[k].id ? *features[k].id : -1.0;
    if (id != next) parameters.emplace_back(fmt::format("{}{}", kFeatureId, k), id);
    next = id < 0.0 ? -1.0 : id + 1.0;
  }
  return parameters;
}

/// The parameters of one observation while it is read.
class FeatureIdParameters {
 public:
  /// @returns  the error; empty if absent
  [[nodiscard]] std::string add(std::string_view name, std::optional<double> value) {
    const std::string_view digits = name.substr(kFeatureId.size());
    std::size_t k = 0;
    const auto [end, failed] = std::from_chars(digits.data(), digits.data() + digits.size(), k);
    if (failed != std::errc() || end != digits.data() + digits.size()) {
      return fmt::format("{}: its name must end in the number of a feature, from 0", name);
    }
    if (!value || (*value != -1.0 && !feature_id(*value))) {
      return fmt::format("{}: an id is a whole number from 0, or -1 for none", name);
    }
    starts_[k] = *value;
    return {};
  }

  /// Gives features their ids, unless they already have ids.
  /// @returns  the error; empty if absent
  [[nodiscard]] std::string apply(std::vector<Feature>& features) const {
    if (!starts_.empty() && starts_.rbegin()->first >= features.size()) {
      return fmt::format("{}{} is the id of feature {} of {}", kFeatureId, starts_.rbegin()->first,
                         starts_.rbegin()->first + 1, features.size());
    }
    for (auto start = starts_.begin(); start != starts_.end(); ++start) {
      const auto after = std::next(start);
      const std::size_t end = after == starts_.end() ? features.size() : after->first;
      for (std::size_t k = start->first; k < end && start->second >= 0.0; ++k) {
        const auto id = feature_id(start->second + static_cast<double>(k - start->first));
        if (!id)
          return fmt::format("{}{}: the ids after it are too large", kFeatureId, start->first);
        if (!features[k].id) features[k].id = id;
      }
    }
    return {};
  }

 private:
  std::map<std::size_t, double> starts_;  ///< by number of the feature
};

}  // namespace kinecal::detail
