// Four cameras around a Panda that holds a board: the data set cell_metric, by way of what 'kinecal init --poses' writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/init/hand_eye.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "support/data.hpp"

namespace kinecal::test {

/// The rows of a table that has a header, as texts.
inline std::vector<std::vector<std::string>> rows_of(const std::filesystem::path& table) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string>& row = rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

/// The cell with some of its cameras.
struct MetricCell {
  std::vector<std::string> cameras;
  Robot robot;
  std::vector<Sample> samples;
  std::vector<Pose<double>> truth;  ///< base_T_camera of each

  /// @param numbers  of cameras, from 1
  /// @param folder   for columns.yaml
  explicit MetricCell(const std::vector<int>& numbers, const std::filesystem::path& folder) {
    const auto data = data_folder() / "cell_metric";
    HandEyeTables tables{.poses = (data / "poses.csv").string()};
    tables.target = (data / "target.csv").string();
    for (const int number : numbers) {
      cameras.push_back(fmt::format("c{}", number));
      tables.corners.push_back(
          {cameras.back(), (data / fmt::format("corners_{}.csv", number)).string()});
      const auto row = rows_of(data / "truth.csv")[static_cast<std::size_t>(number - 1)];
      Pose<double>& pose = truth.emplace_back();
      for (int i = 0; i < 3; ++i) {
        const auto at = [&](int j) {
          return std::stod(row[static_cast<std::size_t>(1 + 4 * i + j)]);
        };
        for (int j = 0; j < 3; ++j) pose.rotation(i, j) = at(j);
        pose.translation(i) = at(3);
      }
    }
    Diagnostics diagnostics;
    std::ofstream(folder / "columns.yaml")
        << hand_eye_columns(tables, folder.string(), diagnostics);
    samples = read_csv_samples(tables.poses, (folder / "columns.yaml").string(), diagnostics);
    const std::optional<CameraInfo> info =
        read_camera_file((data / "camera.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    const auto images = rows_of(tables.poses);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      samples[s].source = images[s][0];
      std::erase_if(samples[s].observations,
                    [](const Observation& o) { return o.features.empty(); });
      for (Observation& seen : samples[s].observations) {
        if (seen.sensor != "arm") seen.camera = info;
      }
    }
    robot = parse_urdf(hand_eye_urdf(false, cameras), "hand_eye.urdf");
  }

  /// Leaves out the two views that are above 1 px.
  void drop_outliers() {
    for (Sample& sample : samples) {
      if (sample.source != "0011.png" && sample.source != "0119.png") continue;
      std::erase_if(sample.observations, [](const Observation& o) { return o.sensor == "c3"; });
    }
  }
  /// Those that a function takes, by their places in the table.
  [[nodiscard]] std::vector<Sample> some(const std::function<bool(std::size_t)>& is_in) const {
    std::vector<Sample> all;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      if (is_in(s)) all.push_back(samples[s]);
    }
    return all;
  }
  /// The configuration of init.
  /// @param plain  without sigmas and losses: 1/2 of the sum of squared pixels
  [[nodiscard]] std::string config(bool plain) const {
    std::vector<InitAnswers> all;
    for (const std::string& camera : cameras) {
      InitAnswers answers;
      answers.target = InitTarget::checkerboard;
      answers.base = HandEyeNames::kBase;
      answers.arm = HandEyeNames::kFlange;
      answers.camera = answers.camera_name = camera;
      answers.camera_type = "camera2d";
      answers.target_frame = HandEyeNames::kTarget;
      answers.known_lens = true;
      all.push_back(answers);
    }
    std::istringstream text(initial_config(robot, all));
    std::string kept;
    for (std::string line; std::getline(text, line);) {
      if (plain && (line.starts_with("   sigma:") || line.starts_with("   loss:"))) continue;
      kept += line + "\n";
    }
    return kept;
  }
};

/// How far a pose is from another.
struct PoseDistance {
  double metres = 0.0, radians = 0.0;
};
inline PoseDistance distance(const Pose<double>& a, const Pose<double>& b) {
  return {(a.translation - b.translation).norm(),
          log(Matrix3<double>(a.rotation.transpose() * b.rotation)).norm()};
}

/// base_T_camera of a result.
inline Pose<double> pose_of_camera(const ParameterTable& table, const std::string& camera) {
  const auto value = [&](const char* axis) { return table[camera + "_joint_" + axis].value; };
  return {exp(Vector3<double>(value("a"), value("b"), value("c"))),
          {value("x"), value("y"), value("z")}};
}

}  // namespace kinecal::test
