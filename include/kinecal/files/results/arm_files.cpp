// Definitions of arm_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/arm_files.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>

#include "kinecal/files/results/kinematics_yaml.hpp"
#include "kinecal/files/results/result_text.ipp"
#include "kinecal/files/urdf/joined_urdf.hpp"

namespace kinecal {

namespace detail {
namespace {

/// "calibrated_left.urdf"
[[nodiscard]] std::string file_of_arm(const std::string& stem, std::string arm, const char* ending,
                                      const std::string& date) {
  std::replace(arm.begin(), arm.end(), '/', '_');
  return dated(stem + "_" + arm, ending, date);
}

}  // namespace
}  // namespace detail

std::vector<std::string> arm_prefixes(const Robot& robot) {
  constexpr std::size_t kFewest = 4;                   // joints; fingers and legs have fewer
  std::map<std::string, std::set<std::string>> names;  // by prefix
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    const std::string& name = joint.name;
    for (std::size_t at = name.find('_'); at != std::string::npos; at = name.find('_', at + 1)) {
      if (at + 1 < name.size()) names[name.substr(0, at + 1)].insert(name.substr(at + 1));
    }
  }
  std::vector<std::string> prefixes;
  for (const auto& arm : names) {
    if (arm.second.size() < kFewest) continue;
    const bool is_within = std::any_of(prefixes.begin(), prefixes.end(), [&](const auto& shorter) {
      return arm.first.starts_with(shorter);
    });
    const bool has_twin = std::any_of(names.begin(), names.end(), [&](const auto& other) {
      return other.first != arm.first && other.second == arm.second;
    });
    if (!is_within && has_twin) prefixes.push_back(arm.first);
  }
  return prefixes;
}

std::vector<OutputFile> arm_files(const Robot& robot, const std::vector<JointPatch>& patches,
                                  const std::string& calibrated, const std::string& date) {
  std::vector<OutputFile> files;
  for (const std::string& name : joined_robots(calibrated, "calibrated.urdf")) {
    files.push_back({detail::file_of_arm("calibrated", name, ".urdf", date),
                     separated_urdf(calibrated, "calibrated.urdf", name)});
  }
  if (!files.empty()) return files;
  for (const std::string& prefix : arm_prefixes(robot)) {
    const bool is_calibrated =
        std::any_of(patches.begin(), patches.end(),
                    [&](const JointPatch& patch) { return patch.joint.starts_with(prefix); });
    if (!is_calibrated) continue;
    const std::string name =
        detail::file_of_arm("kinematics", prefix.substr(0, prefix.size() - 1), ".yaml", date);
    files.push_back({name, kinematics_yaml(robot, patches, "", name, prefix)});
  }
  return files;
}

}  // namespace kinecal
