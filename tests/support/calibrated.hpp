// A calibration from files: read, assemble, solve; errors in the files throw.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::test {

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Calibrated {
  Robot robot;
  std::vector<Sample> samples;
  Calibration calibration;
  CalibrationResult result;
  Diagnostics diagnostics;

  [[nodiscard]] double cost() const { return result.steps.back().final_cost; }
  /// Root of the mean squared distance of the first error block's features, millimetres.
  [[nodiscard]] double rms_mm() const { return 1e3 * result.blocks.front().after.rms; }
};

inline Calibrated calibrate_samples(const Robot& robot, const std::filesystem::path& config,
                                    std::vector<Sample> samples) {
  Calibrated c;
  c.robot = robot;
  c.samples = std::move(samples);
  const Config configuration = read_config(config.string(), c.diagnostics);
  c.calibration = assemble(configuration, c.robot, c.samples, c.diagnostics);
  c.diagnostics.throw_if_errors();
  c.result = calibrate(c.calibration);
  return c;
}

inline Calibrated calibrate_files(const std::filesystem::path& urdf,
                                  const std::filesystem::path& config,
                                  const std::filesystem::path& samples) {
  Diagnostics diagnostics;
  std::vector<Sample> read = read_samples(samples.string(), diagnostics);
  diagnostics.throw_if_errors();
  return calibrate_samples(read_urdf(urdf.string()), config, std::move(read));
}

}  // namespace kinecal::test
