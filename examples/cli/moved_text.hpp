// What a joint, frame or sensor has moved by, in words.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/tools/install/stored_result.hpp"
#include "kinecal/trust/verify/drift.hpp"

namespace kinecal::cli {

/// A change of the parameters of a joint, frame or sensor.
struct NamedChange {
  std::string owner;                    ///< "elbow_flex_joint"
  bool is_frame = false;                ///< its frame, not the offset of the joint
  std::vector<std::string> parameters;  ///< names
  std::vector<std::string> units;       ///< of each
  std::vector<double> change;           ///< of each
  std::vector<double> deviation;        ///< standard deviation of each change
};

/// "joint 'elbow'", "frame 'tracker'", "sensor 'head_camera'" or "error block 'ball'".
/// @param owner     of the parameters: see Mover
/// @param is_frame  its frame, not the offset of the joint
[[nodiscard]] std::string mover_name(const StoredResult& result, const std::string& owner,
                                     bool is_frame);

/// The change of a mover.
[[nodiscard]] NamedChange named_change(const Mover& mover, const ParameterTable& table);

/// "0.57 deg +- 0.01 deg"; of a frame "1.2 mm +- 0.1 mm, 0.1 deg +- 0.02 deg".
/// @param per  follows each number: " a week"
[[nodiscard]] std::string change_text(const NamedChange& of, const std::string& per = "");

/// The length of some changes, and its standard deviation.
[[nodiscard]] std::string length_text(const std::vector<std::pair<double, double>>& changes,
                                      const char* unit, const std::string& per = "");

/// "p = 0.03", "p < 1e-6": a probability by chance.
[[nodiscard]] std::string chance_text(double probability);

}  // namespace kinecal::cli
