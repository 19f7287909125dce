// kinecal simulate: photographs of a simulated robot and a table of its joint positions, or the drive of a mobile
// base; and the truth.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "kinecal/surface/robot_surface.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/initial_base.hpp"
#include "kinecal/tools/simulation/photographs.hpp"
#include "progress.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// @throws OutputError  if results are in the folder and may not be replaced
void check_folder(const std::filesystem::path& folder, bool force) {
  if (force || !std::filesystem::exists(folder / "truth.yaml")) return;
  throw OutputError(folder.string() +
                    ": has a simulation already; use --force to replace it, or choose another "
                    "folder");
}

/// Removes images of a simulation that was there before.
void remove_images(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    const bool is_ours =
        name.size() == 8 && name.ends_with(".png") && name.find_first_not_of("0123456789") == 4;
    if (is_ours) std::filesystem::remove(file.path());
  }
}

void write(const std::filesystem::path& path, PhotographFiles files) {
  OutputFolder folder(path);
  for (const auto& [name, images] :
       {std::pair("images", &files.images), {"depth", &files.depth}, {"masks", &files.masks}}) {
    remove_images(path / name);
    if (images->empty()) continue;
    OutputFolder(path / name).write(*images);
  }
  folder.write(files.others);
}

/// The scene, for sessions with `kinecal capture --robot simulated:scene.yaml`.
std::string scene_text(const SimulateOptions& options, const std::string& target) {
  if (!options.scene.empty()) return detail::read_text_file(options.scene);
  std::string text = fmt::format("seed: {}\n", std::max(1, options.seed));
  if (!target.empty()) text += fmt::format("target: {{type: {}}}\n", target);
  return text;
}

/// The target that is asked for, or another one if this build cannot find the usual one; empty: the usual one,
/// or that of the scene.
std::string target_of(const SimulateOptions& options) {
  if (!options.target.empty() || !options.scene.empty()) return options.target;
  const bool only_tags =
      !fault_of_target("checkerboard").empty() && fault_of_target("apriltag").empty();
  return only_tags ? "apriltag" : "";
}

/// The commands that calibrate what was written of a robot that is its own target.  Meshes may be relative to its URDF.
std::string next_of(const SimulateOptions& options, const SimulationPlan& plan) {
  const auto file = [&](const char* name) {
    return (std::filesystem::path(options.output) / name).string();
  };
  InputOptions inputs{
      .urdf = options.urdf, .config = file("calibrate.yaml"), .samples = {file("samples.yaml")}};
  const std::string calibrate =
      calibrate_command(inputs).add_option("--mesh-path", options.mesh_paths).str();
  if (plan.setup.camera.has_depth) return calibrate;
  return ShellCommand{"kinecal", "detect"}
             .add_option("--masks", {file("masks")})
             .add_option("--poses", {file("poses.csv")})
             .add_option("--camera", {file("camera.yaml")})
             .add_option("--frame", {plan.setup.camera.frame})
             .add_option("-o", {file("samples.yaml")})
             .str() +
         " && " + calibrate;
}

/// A base with errors of 2 %, whose wheels slip now and then.
/// @param sizes  nominal; those that are not known are Fetch's
SimulatedBase wrong_base(const BaseSizes& sizes, std::uint64_t seed) {
  SeededRandom random(seed);
  SimulatedBase base;
  if (sizes.wheel_radius > 0.0) base.drive.wheel_radius = sizes.wheel_radius;
  if (sizes.track_width > 0.0) base.drive.track_width = sizes.track_width;
  for (double* scale : {&base.track_width_scale, &base.left_rollout_scale,
                        &base.right_rollout_scale, &base.imu_scale}) {
    *scale += 0.02 * random.normal();
  }
  base.imu_bias = 0.002 * random.normal();
  for (double& at : base.mount) at += 0.01 * random.normal();
  base.slip_chance = 0.01;
  return base;
}

/// A table: a row for each sample, empty cells where the wall is not seen.
std::string table_of(const std::vector<Sample>& samples) {
  std::string text;
  for (const auto& [name, value] : samples.front().conditions) {
    text += (text.empty() ? "" : ",") + name;
  }
  for (const Sample& sample : samples) {
    std::string row;
    for (const auto& [name, value] : sample.conditions) {
      row += (row.empty() ? "" : ",") + (std::isnan(value) ? "" : fmt::format("{:.9g}", value));
    }
    text += "\n" + row;
  }
  return text + "\n";
}

/// A drive of a base on two wheels, as a table.
/// @throws InputError  if an option of photographs is given
int simulate_drive(const SimulateOptions& options) {
  for (const auto& [option, is_given] : {std::pair("--poses", options.poses > 0),
                                         std::pair("--mesh-path", !options.mesh_paths.empty())}) {
    if (is_given) {
      throw InputError(fmt::format(
          "{} does not go with --target base, which simulates a drive without images", option));
    }
  }
  const std::filesystem::path folder = options.output;
  const std::string urdf = read_urdf_text(options.urdf);
  const Robot robot = parse_urdf(urdf, options.urdf);
  const auto seed = static_cast<std::uint64_t>(std::max(1, options.seed));
  const SimulatedBase base =
      wrong_base(sizes_of_urdf(robot, urdf, base_link_of(robot), "differential"), seed);
  const std::vector<BaseRun> runs = all_runs();
  const BaseRecording drive = simulate_base(base, runs, seed);
  const std::string truth = fmt::format(
      "track_width_scale: {}\nleft_rollout_scale: {}\nright_rollout_scale: {}\nimu_scale: {}\n"
      "imu_bias: {}\nx: {}\ny: {}\nyaw: {}\n",
      base.track_width_scale, base.left_rollout_scale, base.right_rollout_scale, base.imu_scale,
      base.imu_bias, base.mount[0], base.mount[1], base.mount[2]);
  check_folder(folder, options.force);
  OutputFolder(folder).write(
      {{"robot.urdf", urdf}, {"drive.csv", table_of(drive.samples)}, {"truth.yaml", truth}});
  say("{}: {} samples of {} runs of a base on two wheels; {} slips; truth.yaml has its errors\n",
      folder.string(), drive.samples.size(), runs.size(), drive.slipped.size());
  const auto file = [&](const char* name) { return (folder / name).string(); };
  say("next: {}\n", ShellCommand{"kinecal", "init", "--target", "base", "--drive", "differential"}
                        .add_option("--urdf", {file("robot.urdf")})
                        .add_option("--from", {file("drive.csv")})
                        .add_option("--wheel-radius", {fmt::format("{}", base.drive.wheel_radius)})
                        .add_option("--track-width", {fmt::format("{}", base.drive.track_width)})
                        .add_option("--output", {file("base.yaml")})
                        .str());
  return kDone;
}

}  // namespace

int simulate(const SimulateOptions& options) {
  const std::filesystem::path folder = options.output;
  check_folder(folder, options.force);
  if (options.target == kBaseTarget) return simulate_drive(options);
  const Robot robot = read_urdf(options.urdf);
  Diagnostics diagnostics;
  const std::string target = target_of(options), urdf = detail::read_text_file(options.urdf);
  const auto surface = [&] {
    const SurfaceSource source{.urdf = options.urdf,
                               .places = mesh_places(options.urdf, options.mesh_paths),
                               .place = {options.scene.empty() ? "--target" : options.scene, 0}};
    return read_surface(urdf, source, diagnostics);
  };
  SimulationPlan plan =
      read_simulation(robot, options.scene, target, static_cast<std::uint64_t>(options.seed),
                      diagnostics, nullptr, surface);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  note_fault_of_target(plan.target.type);
  if (options.poses > 0) plan.poses = options.poses;
  const std::vector<JointTarget> poses = poses_of(plan);
  PhotographFiles files;
  if (plan.target.type == "leds") {  // which have to be switched while a camera looks
    files.others = files_of(plan, poses);
  } else {
    ProgressLine line;
    const ProgressMeter meter = line.meter();
    files = take_photographs(plan, poses, [&](std::size_t n) {
      if (meter) meter(static_cast<double>(n) / static_cast<double>(poses.size()), "rendering");
    });
  }
  for (const std::string& skipped : files.skipped) say(stderr, "warning: {}\n", skipped);
  files.others.push_back({"robot.urdf", urdf});
  files.others.push_back({"scene.yaml", scene_text(options, target)});
  const std::size_t images = files.images.size();
  check_folder(folder, options.force);  // one may have appeared meanwhile
  write(folder, std::move(files));
  const std::string what =
      images > 0 ? fmt::format("{} images", images)
                 : fmt::format("scene.yaml, and {} poses for a session", poses.size());
  say("{}: {} of '{}' on '{}' by '{}'; truth.yaml has {} errors of the URDF\n", folder.string(),
      what, plan.target.type, plan.target.link, plan.setup.camera.frame, plan.setup.truth.size());
  if (plan.surface != nullptr) say("next: {}\n", next_of(options, plan));
  return kDone;
}

}  // namespace kinecal::cli
