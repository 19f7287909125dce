// Definitions of stored_result.hpp; stored_report.ipp reads its report.json.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/stored_result.hpp"

#include <filesystem>

#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/install/result_folder.hpp"
#include "kinecal/tools/install/stored_report.ipp"

namespace kinecal {

namespace detail {

inline constexpr const char* kAgain = "; calibrate again with this version";

/// A file of the result.
/// @throws InputError  if an older version did not write it, or it was removed
[[nodiscard]] inline std::string needed_file(const std::string& folder, const char* name) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  if (std::filesystem::exists(path)) return path.string();
  throw InputError(folder + ": has no " + name +
                   ", so it cannot be checked; an older version wrote it, " +
                   "or the file was removed" + kAgain);
}

}  // namespace detail

StoredResult read_result(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder +
                     (std::filesystem::exists(folder) ? ": is not a folder" : ": does not exist") +
                     "; give the folder that 'kinecal calibrate --output' wrote");
  }
  const ResultFolder files = read_result_folder(folder);
  StoredResult result;
  result.folder = folder;
  result.values = files.parameters;
  result.report = detail::needed_file(folder, "report.json");
  result.urdf = detail::needed_file(folder, kOriginalUrdf);
  const std::string config = detail::needed_file(folder, kConfigCopy);
  result.urdf_text = read_urdf_text(result.urdf);
  result.robot = parse_urdf(result.urdf_text, result.urdf);
  Diagnostics diagnostics;
  result.config = read_config(config, diagnostics);
  diagnostics.throw_if_errors();
  try {
    detail::read_calibration(files.report.content,
                             (std::filesystem::path(folder) / files.values.name).string(), result);
  } catch (const detail::JsonError& error) {
    throw InputError(result.report + ": " + error.what() + detail::kAgain);
  }
  for (const auto read : {&rising_of, &ros2_control_offsets}) {
    for (const auto& [joint, after] : read(files.urdf.content, files.urdf.name)) {
      result.added_offsets[joint] += after;
    }
    for (const auto& [joint, before] : read(result.urdf_text, result.urdf)) {
      result.added_offsets[joint] -= before;
    }
  }
  std::erase_if(result.added_offsets, [](const auto& of) { return of.second == 0.0; });
  return result;
}

std::vector<double> StoredResult::values_of(const ParameterTable& table) const {
  std::vector<double> all;
  for (const Parameter& parameter : table) {
    const auto found = values.find(parameter.name);
    all.push_back(found == values.end() ? 0.0 : found->second);
  }
  return all;
}

CalibratedState StoredResult::state(const ParameterTable& table) const {
  CalibratedState state;
  const auto index = [&](const std::string& name) {
    const int found = table.find(name);
    if (found >= 0) return found;
    throw InputError(report + ": '" + name + "' was calibrated, but " + config.place.file +
                     " does not have it; one of them was changed, so calibrate again");
  };
  state.values = values_of(table);
  for (const std::string& name : parameters) state.parameters.push_back(index(name));
  const auto n = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd full(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      full(i, j) = full(j, i) =
          covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  state.covariance = full;
  for (const auto& combination : undetermined) {
    Combination& of = state.undetermined.emplace_back();
    for (const auto& [name, factor] : combination) of.emplace_back(index(name), factor);
  }
  state.noise = noise;
  state.common = common;
  return state;
}

std::vector<Sample> StoredResult::pose_samples() const {
  std::vector<Sample> all;
  for (std::size_t i = 0; i < poses.positions.size(); ++i) {
    const std::vector<double>& positions = poses.positions[i];
    Sample sample;
    for (std::size_t j = 0; j < poses.floating.size(); ++j) {
      sample.poses[poses.floating[j]] = poses.measured[i][j];
    }
    sample.joint_names = poses.joints;
    sample.joint_positions = positions;
    all.push_back(std::move(sample));
  }
  return all;
}

}  // namespace kinecal
