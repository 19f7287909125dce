// SPDX-License-Identifier: Apache-2.0
#include "input.hpp"

#include <fmt/core.h>

#include <iterator>
#include <optional>

#include "kinecal/io/assemble.hpp"
#include "kinecal/io/cameras/set_camera.hpp"
#include "kinecal/io/config/read_config.hpp"
#include "kinecal/io/samples/read_samples.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"

namespace kinecal::cli {
namespace {

/// Runs one reader; what makes its file unusable joins the other mistakes.
template <class Read>
auto attempt(Read&& read, Diagnostics& diagnostics) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const InputError& e) {
    diagnostics.errors.emplace_back(e.what());
    return std::nullopt;
  }
}

}  // namespace

std::vector<Sample> read_all_samples(const std::vector<std::string>& files,
                                     Diagnostics& diagnostics) {
  std::vector<Sample> all;
  for (const std::string& file : files) {
    auto samples = attempt([&] { return read_samples(file, diagnostics); }, diagnostics);
    if (!samples) continue;
    all.insert(all.end(), std::make_move_iterator(samples->begin()),
               std::make_move_iterator(samples->end()));
  }
  return all;
}

Input read_input(const std::string& urdf, const std::string& config,
                 const std::vector<std::string>& samples, const std::vector<std::string>& cameras) {
  Input input;
  Diagnostics& diagnostics = input.diagnostics;
  const auto robot = attempt(
      [&] {
        input.urdf_text = read_urdf_text(urdf);
        return parse_urdf(input.urdf_text, urdf);
      },
      diagnostics);
  if (robot) input.robot = *robot;
  const std::size_t before = diagnostics.errors.size();
  auto configuration = attempt([&] { return read_config(config, diagnostics); }, diagnostics);
  const bool configuration_is_good = diagnostics.errors.size() == before;
  input.samples = read_all_samples(samples, diagnostics);
  for (const std::string& camera : cameras) {
    attempt([&] { return set_camera(input.samples, camera, diagnostics), true; }, diagnostics);
  }
  if (!robot || !configuration) return input;
  if (diagnostics.errors.size() == before) {
    input.calibration = assemble(*configuration, *robot, input.samples, diagnostics);
    return input;
  }
  // What is known to be wrong is left out; the rest is still held against the robot.
  if (!configuration_is_good) {
    for (StepConfig& step : configuration->steps) step.error_blocks.clear();
  }
  (void)assemble(*configuration, *robot, {}, diagnostics);
  return input;
}

void print(const Diagnostics& diagnostics) {
  for (const std::string& warning : diagnostics.warnings) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
  for (const std::string& error : diagnostics.errors) fmt::print(stderr, "error: {}\n", error);
}

}  // namespace kinecal::cli
