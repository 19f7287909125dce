// SPDX-License-Identifier: Apache-2.0
#include "study_input.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "input.hpp"
#include "kinecal/config/assemble.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/procedure/surface_views.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/identify/tell_apart.hpp"
#include "kinecal/tools/simulation/pose_samples.hpp"
#include "kinecal/tools/simulation/touched_samples.hpp"
#include "kinecal/trust/assess.hpp"
#include "kinecal/trust/captures/ruined.hpp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"
#include "pose_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// True if some error block has residuals of a sample.
bool is_used(const Calibration& calibration, const Sample& sample) {
  return std::any_of(calibration.steps.begin(), calibration.steps.end(), [&](const auto& step) {
    const std::unique_ptr<AnyProblem> one = step.problem->without_samples();
    one->add_sample(sample);
    for (int t = 0; t < one->num_terms(); ++t) {
      if (one->samples_of(t) > 0) return true;
    }
    return false;
  });
}

/// Takes recorded clouds or masks of the robot: it is calibrated as `kinecal calibrate` does, and what lies on it then is what
/// its samples show.
/// @returns  the result
ParameterTable take_recorded_surface(const StudyFiles& files, StudyInput& input) {
  Diagnostics found;
  CalibrationSetup setup{.robot = input.robot,
                         .config = input.config,
                         .samples = read_recordings(files.samples, found).samples,
                         .urdf_text = input.urdf_text,
                         .urdf = files.urdf};
  CalibrationOptions options;
  options.mesh_paths = files.mesh_paths;
  options.search = Search::never;
  PreparedCalibration prepared = prepare(std::move(setup), options, std::move(found));
  print_or_throw(prepared.diagnostics);
  const CalibratedRobot calibrated = calibrate_robot(std::move(prepared), options);
  if (!calibrated.is_usable() || calibrated.assessments.back().compared.empty()) {
    throw InputError("the samples cannot be calibrated: " +
                     (calibrated.judgement.reasons.empty() ? "no pose is compared"
                                                           : calibrated.judgement.reasons.front()) +
                     "; a selection starts from their result");
  }
  input.config = *calibrated.setup.config;
  input.calibrated = calibrated.assessments.back().compared[0].position;
  std::vector<std::string> blocks;
  for (const BlockConfig& block : input.config.steps.back().error_blocks) {
    if (block.surface) blocks.push_back(block.name);
  }
  const Eigen::VectorXd values = calibrated.result.table.values();
  input.samples = surface_points(*calibrated.setup.calibration.steps.back().problem,
                                 {values.data(), static_cast<std::size_t>(values.size())}, blocks,
                                 calibrated.samples);
  for (const Sample& sample : input.samples) {
    input.poses.push_back({sample.joint_names, sample.joint_positions, {}, sample.source});
  }
  return calibrated.result.table;
}

/// Takes recorded samples and their poses, but those that no error block uses.
/// @returns  the result of these samples
ParameterTable take_recorded(const StudyFiles& files, StudyInput& input) {
  Diagnostics of_files, of_samples;
  input.samples = read_recordings(files.samples, of_files).samples;
  print_or_throw(of_files);
  Calibration calibration = assemble(input.config, input.robot, input.samples, of_samples);
  print_or_throw(of_samples);
  const std::size_t unused = std::erase_if(
      input.samples, [&](const Sample& sample) { return !is_used(calibration, sample); });
  if (unused > 0) {
    say(stderr, "note: {} left out: no error block has features of all its models there\n",
        counted(unused, "sample"));
  }
  for (const Sample& sample : input.samples) {
    input.poses.push_back({sample.joint_names, sample.joint_positions, {}, sample.source});
  }
  CalibrationResult found = kinecal::calibrate(calibration);
  if (!found.converged) {
    throw InputError("the samples cannot be calibrated: " + found.termination +
                     "; a study starts from their result");
  }
  return std::move(found.table);
}

/// The poses of a file, each with a name for messages.
std::vector<CapturePose> named_poses(const std::string& file) {
  std::vector<CapturePose> poses = read_pose_file(file);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].source.empty()) poses[i].source = fmt::format("{}: pose {}", file, i + 1);
  }
  return poses;
}

/// The poses of the file, those of the scene, or new ones.
std::vector<CapturePose> poses_for(const StudyFiles& files, int count, StudyInput& input) {
  if (!files.pose_file.empty()) return named_poses(files.pose_file);
  if (input.plan.given.empty()) input.plan.poses = count;
  std::vector<CapturePose> poses;
  for (JointTarget& target : poses_of(input.plan)) {
    poses.push_back({std::move(target.names),
                     std::move(target.positions),
                     {},
                     fmt::format("generated pose {}", poses.size() + 1)});
  }
  return poses;
}

[[nodiscard]] SurfaceInput surface_input(const StudyFiles& files, const StudyInput& input) {
  return {input.robot, input.urdf_text, files.urdf, files.mesh_paths};
}

/// Takes poses without samples, in which a simulated target is seen.
/// @returns  values by which the robot differs from the configuration
ParameterTable take_poses(const StudyFiles& files, int count, StudyInput& input) {
  std::vector<CapturePose> poses = poses_for(files, count, input);
  const std::size_t candidates = poses.size();
  if (!files.have.empty()) {
    const std::vector<CapturePose> have = named_poses(files.have);
    poses.insert(poses.end(), have.begin(), have.end());
  }
  PoseSamples made;
  if (input.is_of_surface) {
    Diagnostics found;
    made = surface_views(surface_input(files, input), input.plan.setup.camera, input.config, poses,
                         found);
    print_or_throw(found);
  } else {
    made = pose_samples(input.plan, input.config, poses);
  }
  constexpr std::size_t kShown = 3;
  for (std::size_t i = 0; i < made.skipped.size() && i < kShown; ++i) {
    say(stderr, "warning: {}{}\n", made.skipped[i],
        i + 1 == kShown && made.skipped.size() > kShown
            ? fmt::format(" (and {})", counted(made.skipped.size() - kShown, "other pose"))
            : "");
  }
  if (made.samples.empty()) throw InputError("the camera sees the target in none of the poses");
  for (const std::size_t i : made.poses) {
    input.poses.push_back(poses[i]);
    input.have += i >= candidates ? 1 : 0;
  }
  if (input.have == made.poses.size()) {
    throw InputError("the camera sees the target in none of the poses to choose from");
  }
  input.samples = std::move(made.samples);
  return made.values;
}

/// Takes generated poses in which a tip touches something, or both hands hold one thing.
/// @returns  values by which the robot differs from the configuration
ParameterTable take_touches(const StudyFiles& files, const ConfiguredTouch& touch, int count,
                            StudyInput& input) {
  if (!files.pose_file.empty() || !files.have.empty()) {
    throw InputError(
        "--poses and --have are of robots that a camera sees; of a tip that touches something, "
        "give "
        "what was recorded as --samples");
  }
  const std::uint64_t seed = static_cast<std::uint64_t>(std::max(1, files.seed));
  TouchedSamples made =
      touched_samples(input.robot, touch, static_cast<std::size_t>(std::max(1, count)), seed);
  input.samples = std::move(made.samples);
  for (const Sample& sample : input.samples) {
    input.poses.push_back({sample.joint_names, sample.joint_positions, {}, sample.source});
  }
  return std::move(made.values);
}

/// Adds new poses before the recorded samples, which exist already: positions between those that were recorded, and
/// the features of recorded samples.
void add_poses_between(int count, std::uint64_t seed, StudyInput& input) {
  const std::vector<Sample> recorded = std::move(input.samples);
  const std::vector<CapturePose> known = std::move(input.poses);
  std::vector<CapturePose> poses;
  std::vector<Sample> made;
  SeededRandom random(seed);
  std::map<std::string, std::pair<double, double>> ranges;
  for (const Sample& sample : recorded) {
    for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
      const double at = sample.joint_positions[j];
      const auto [range, is_new] = ranges.try_emplace(sample.joint_names[j], at, at);
      range->second = {std::min(range->second.first, at), std::max(range->second.second, at)};
    }
  }
  for (int i = 0; i < count; ++i) {
    Sample sample = recorded[static_cast<std::size_t>(i) % recorded.size()];
    for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
      const auto& [low, high] = ranges.at(sample.joint_names[j]);
      sample.joint_positions[j] = low < high ? random.uniform(low, high) : low;
    }
    sample.source = fmt::format("generated pose {}", i + 1);
    poses.push_back({sample.joint_names, sample.joint_positions, {}, sample.source});
    made.push_back(std::move(sample));
  }
  input.have = recorded.size();
  made.insert(made.end(), recorded.begin(), recorded.end());
  poses.insert(poses.end(), known.begin(), known.end());
  input.samples = std::move(made);
  input.poses = std::move(poses);
}

/// Frees two explanations that are to be told apart; with recorded samples, adds poses where no camera must see them.
void free_both(const StudyFiles& files, int poses, StudyInput& input) {
  Explanations both = free_explanations(input.config, input.robot, input.samples, files.tell_apart);
  input.config = std::move(both.config);
  input.explanations = std::move(both.parameters);
  if (files.samples.empty() || !sees_everywhere(input.config)) return;
  add_poses_between(poses, static_cast<std::uint64_t>(std::max(1, files.seed)), input);
}

/// The values of a robot without errors: of the configuration; or what recorded samples show.
/// @param recorded  the result by the configuration that was given; nullptr: there are no recorded samples
void set_drawn(const ParameterTable& places, const ParameterTable* recorded, StudyInput& input) {
  ParameterTable table = input.calibration.table;
  if (recorded != nullptr) {
    for (const Parameter& parameter : *recorded) {
      if (const int p = table.find(parameter.name); p >= 0) table[p].value = parameter.value;
    }
  }
  for (const CalibrationStep& step : input.calibration.steps) {
    if (recorded != nullptr) break;
    for (const auto& [parameter, value] : step.assignments) table[parameter].value = value;
  }
  const Eigen::VectorXd configured = table.values();
  input.configured.assign(configured.begin(), configured.end());
  for (const Parameter& place : places) {
    if (const int p = table.find(place.name); p >= 0) table[p].value = place.value;
  }
  const Eigen::VectorXd values = table.values();
  input.setup.drawn.assign(values.begin(), values.end());
}

void set_up(const StudyFiles& files, StudyInput& input) {
  StudySetup& setup = input.setup;
  const CalibrationStep& step = input.calibration.steps.back();
  setup.make = [&problem = *step.problem] { return problem.without_samples(); };
  setup.free = step.free.parameters();
  if (setup.free.empty()) throw InputError(files.config + ": no free parameter affects a residual");
  setup.samples = input.samples;
  const auto frames = compared_frames(*step.problem, input.samples);
  if (frames.empty())
    throw InputError(files.config + ": nothing is compared whose pose could be judged");
  setup.frame = frames.front().frame;
  setup.in = frames.front().in;
  setup.noise = input.plan.noise;
  setup.errors = input.plan.errors;
  setup.ruined = input.plan.setup.faults.outliers;
  setup.ruined_by = input.plan.setup.faults.outlier_size;
  setup.seed = input.plan.setup.seed;
  setup.fit = [&input](std::span<const Sample> samples) {
    return fit_study(input, input.config, samples);
  };
}

}  // namespace

StudyFit fit_study(const StudyInput& input, const Config& config, std::span<const Sample> all) {
  StudyFit fit;
  fit.solves = 0;
  std::vector<Sample> samples(all.begin(), all.end());
  Diagnostics ignored;
  Calibration calibration = assemble(config, input.robot, samples, ignored);
  ignored.throw_if_errors();
  SolveOptions solving;
  solving.threads = 1;
  const auto once = [&] {
    CalibrationResult result = kinecal::calibrate(calibration, {}, solving);
    for (const StepResult& step : result.steps) fit.seconds += step.seconds;
    ++fit.solves;
    return result;
  };
  Assessment assessed;
  const auto last = [&](const CalibrationResult& result) -> const Assessment* {
    if (input.keep_ruined || !result.converged) return nullptr;
    assessed = assess(calibration, result, samples, {.folds = 1}).back();
    return &assessed;
  };
  const auto leave_out = [&](const CalibrationResult&, const std::vector<CaptureError>& ruined) {
    std::set<int> left;
    for (const CaptureError& error : ruined) left.insert(error.sample);
    exclude(calibration, left, samples);
    fit.left_out += static_cast<int>(left.size());
  };
  const CalibrationResult result = fit_without_ruined(once, last, leave_out);
  fit.converged = result.converged;
  const Eigen::VectorXd values = result.table.values();
  fit.values.assign(values.begin(), values.end());
  return fit;
}

std::unique_ptr<StudyInput> read_study(const StudyFiles& files, int poses) {
  auto input = std::make_unique<StudyInput>();
  Diagnostics diagnostics;
  input->urdf_text = read_urdf_text(files.urdf);
  input->robot = parse_urdf(input->urdf_text, files.urdf);
  if (!files.config.empty()) input->config = read_config(files.config, diagnostics);
  print_or_throw(diagnostics);
  const bool has_config = !files.config.empty();
  Diagnostics of_scene;
  input->is_of_surface = compares_surface(input->config);
  if (input->is_of_surface && !files.target.empty() && files.target != "robot") {
    throw InputError("--target " + files.target + ": " + files.config +
                     " compares the robot with its own surface, so its target is robot");
  }
  const std::optional<ConfiguredTouch> touch =
      files.samples.empty() ? configured_touch(input->config) : std::nullopt;
  if (touch) {
    input->plan.setup.seed = static_cast<std::uint64_t>(std::max(1, files.seed));
  } else if (files.samples.empty() || !files.scene.empty()) {
    const bool is_default = files.target.empty() && files.scene.empty();
    const auto surface = [&] {
      const SurfaceSource source{.urdf = files.urdf,
                                 .places = mesh_places(files.urdf, files.mesh_paths),
                                 .place = {files.scene.empty() ? "--target" : files.scene, 0}};
      return read_surface(input->urdf_text, source, of_scene);
    };
    input->plan = read_simulation(input->robot, files.scene,
                                  input->is_of_surface && is_default ? "robot" : files.target,
                                  static_cast<std::uint64_t>(files.seed), of_scene,
                                  has_config ? &input->config : nullptr, surface);
  }
  if (!has_config && !files.samples.empty()) {
    of_scene.error({"--config", 0}, "is required with samples");
  }
  if (has_config && input->config.steps.empty()) {
    of_scene.error({files.config, 0}, "has no steps");
  }
  print_or_throw(of_scene);
  const bool sees_robot = input->plan.target.type == "robot";
  if (!touch && files.samples.empty() && has_config && sees_robot != input->is_of_surface) {
    throw InputError(files.config +
                     (sees_robot ? ": does not compare the surface of the robot"
                                 : ": compares the robot with its own surface") +
                     "; choose target robot where the configuration compares it, else another one");
  }
  input->is_of_surface = input->is_of_surface || (!has_config && sees_robot);
  if (input->is_of_surface && !files.tell_apart.empty()) {
    throw InputError(
        "--tell-apart: what clouds and masks of the robot would show of two explanations is not "
        "predicted; calibrate with each (--hold), and compare the errors on held-out samples");
  }
  if (!has_config) {
    Diagnostics of_first;
    input->config = parse_config(input->plan.config, "first configuration", of_first);
    print_or_throw(of_first);
  }
  ParameterTable places;
  std::optional<ParameterTable> recorded;
  input->is_touched = touch.has_value();
  if (touch) {
    places = take_touches(files, *touch, poses, *input);
  } else if (files.samples.empty()) {
    places = take_poses(files, poses, *input);
  } else {
    recorded =
        input->is_of_surface ? take_recorded_surface(files, *input) : take_recorded(files, *input);
  }
  if (!files.tell_apart.empty()) free_both(files, poses, *input);
  Diagnostics of_samples;
  input->calibration = assemble(input->config, input->robot, input->samples, of_samples);
  if (recorded) of_samples.warnings.clear();  // take_recorded() has printed them
  print_or_throw(of_samples);
  set_drawn(places, recorded ? &*recorded : nullptr, *input);
  if (files.seed > 0) input->plan.setup.seed = static_cast<std::uint64_t>(files.seed);
  set_up(files, *input);
  input->command = files.command;
  const std::pair<std::string, std::string> single[] = {{"URDF", files.urdf},
                                                        {"configuration", files.config},
                                                        {"scene", files.scene},
                                                        {"poses", files.pose_file},
                                                        {"poses of samples", files.have}};
  for (const auto& file : single) {
    if (!file.second.empty()) input->files.push_back(file);
  }
  for (const std::string& samples : files.samples) input->files.emplace_back("samples", samples);
  return input;
}

std::vector<std::string> free_names(const StudyInput& input) {
  std::vector<std::string> names;
  for (const int p : input.setup.free) names.push_back(input.calibration.table[p].name);
  return names;
}

}  // namespace kinecal::cli
