// The common part of all robots' programs: options, samples, the report.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <optional>

#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/report/text.hpp"
#include "simulate.hpp"

namespace kinecal::examples {
namespace {

enum ExitCode { kGood = 0, kBadInput = 1, kNotGood = 2 };

struct Options {
  std::string samples, write_samples, output;
  int pairs = 100, planes = 25;
  std::uint64_t seed = 1;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--samples", options.samples, "calibrate on these instead of simulated ones")
      ->type_name("FILE");
  app.add_option("--write-samples", options.write_samples, "write the samples")->type_name("FILE");
  app.add_option("--output", options.output, "folder for the results, as of 'kinecal calibrate'")
      ->type_name("DIR");
  app.add_option("--pairs", options.pairs, "simulated samples for each block of two sensors")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--planes", options.planes, "simulated samples for each block of a plane")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the simulation")->capture_default_str();
}

std::vector<Sample> read(const std::string& file) {
  Diagnostics diagnostics;
  std::vector<Sample> samples = read_recording(file, diagnostics).samples;
  diagnostics.throw_if_errors();
  for (const std::string& warning : diagnostics.warnings) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
  return samples;
}

void write(const std::string& path, const std::vector<Sample>& samples) {
  std::ofstream file(path);
  write_samples(file, samples);
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

Calibration calibration_of(const RobotExample& example, const std::vector<Sample>& samples) {
  std::unique_ptr<AnyProblem> problem = example.problem(samples);
  const FreeSet free = example.free_set(problem->table());
  return make_calibration(std::move(problem), free, samples);
}

/// An error block on held-out samples.
struct HeldOut {
  std::string name, unit;
  std::int64_t features = 0;
  double by_urdf = 0.0, calibrated = 0.0,
         noise = 0.0;   ///< rms of distances; noise: with the true values
  double metres = 1.0;  ///< per unit of the residual
};

std::vector<HeldOut> hold_out(const RobotExample& example, Simulation& simulation,
                              const Options& options, const CalibrationResult& result) {
  const std::vector<Sample> samples = simulation.samples(options.pairs, options.planes);
  const Calibration calibration = calibration_of(example, samples);
  const AnyProblem& problem = *calibration.steps.front().problem;
  const auto statistics = [&](const ParameterTable& known) {
    Eigen::VectorXd all = problem.table().values();
    const Eigen::VectorXd before = all;
    for (const Parameter& p : known) all(problem.table().index(p.name)) = p.value;
    const auto size = static_cast<std::size_t>(all.size());
    return block_statistics(problem, {before.data(), size}, {all.data(), size});
  };
  const auto found = statistics(result.table), real = statistics(simulation.truth());
  std::vector<HeldOut> blocks;
  for (std::size_t i = 0; i < example.blocks.size(); ++i) {
    HeldOut& block = blocks.emplace_back();
    block = {found[i].name,       found[i].unit,      found[i].count,
             found[i].before.rms, found[i].after.rms, real[i].after.rms};
    if (block.unit == "px") {
      block.metres = simulation.metres_a_pixel(example.blocks[i].sensors.back());
    }
  }
  return blocks;
}

/// Prints the error blocks.
/// @returns  true if the calibrated robot is nearly as good as the true one
bool is_as_good_as_the_truth(const std::vector<HeldOut>& blocks) {
  constexpr double kNearly = 1.2;  // 27 parameters from 100 tracker points: a tenth more than noise
  bool good = true;
  TextTable table(
      {"error block", "features", "unit", "by the URDF", "calibrated", "noise alone", "mm"});
  for (const HeldOut& block : blocks) {
    const auto text = [&](double value) { return in_reading_unit(value, block.unit); };
    table.add({block.name, fmt::format("{}", block.features), reading_unit(block.unit),
               text(block.by_urdf), text(block.calibrated), text(block.noise),
               fmt::format("{:.3f}", 1e3 * block.metres * block.calibrated)});
    good = good && block.calibrated <= kNearly * block.noise;
  }
  fmt::print("On samples held out (rms of distances)\n{}\n", table.str());
  return good;
}

int calibrate(const RobotExample& example, const Options& options) {
  std::optional<Simulation> simulation;
  if (options.samples.empty()) simulation.emplace(example, options.seed);
  const std::vector<Sample> samples =
      simulation ? simulation->samples(options.pairs, options.planes) : read(options.samples);
  if (!options.write_samples.empty()) write(options.write_samples, samples);
  std::optional<OutputFolder> folder;
  if (!options.output.empty()) folder.emplace(options.output);

  const CalibratedRobot calibrated = example.calibrate(samples, read_urdf_text(example.urdf));
  fmt::print("{}", summary_text(calibrated));
  std::fflush(stdout);
  if (!calibrated.is_usable()) return kNotGood;
  if (folder) {
    const std::vector<OutputFile> files = calibrated_files(calibrated);
    folder->write(files);
    for (const OutputFile& file : files) {
      fmt::print("wrote {}\n", (folder->path() / file.name).string());
    }
  }
  if (!simulation) return kGood;
  if (is_as_good_as_the_truth(hold_out(example, *simulation, options, calibrated.result)))
    return kGood;
  fmt::print(
      stderr,
      "error: samples that were held out show more than noise; calibrate with more of them?\n");
  return kNotGood;
}

}  // namespace

int calibrate_robot(const RobotExample& example, int argc, char** argv) {
  CLI::App app("Calibrates the robot '" + example.robot.name() + "' on simulated samples.");
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
    return calibrate(example, options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kGood : kBadInput;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
  }
  return kBadInput;
}

}  // namespace kinecal::examples
