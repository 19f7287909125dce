// Definitions of calibrate_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/calibrate_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/cameras/prepare_cameras.hpp"
#include "kinecal/config/complete_samples.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/hold_parameters.hpp"
#include "kinecal/config/magnetometer_start.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/explain/judge_causes.hpp"
#include "kinecal/explain/would_help.hpp"
#include "kinecal/procedure/background_rounds.hpp"
#include "kinecal/procedure/judge_read_back.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/tools/identify/another_robot.hpp"
#include "kinecal/tools/identify/open_config.hpp"
#include "kinecal/trust/judge_files.hpp"
#include "kinecal/trust/systematic/speed_limit.hpp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"

namespace kinecal {

namespace detail {
namespace {

/// True if a lens is to be found.
[[nodiscard]] bool searches_lenses(const Config& config) {
  const std::vector<ModelConfig> models = models_of(config);
  return std::any_of(models.begin(), models.end(),
                     [](const ModelConfig& model) { return model.lens == kAnyLens; });
}

/// Assembles the problems, and doubts the input.
void assemble(PreparedCalibration& prepared, const std::vector<int>& exclude) {
  prepared.calibration =
      kinecal::assemble(*prepared.config, prepared.robot, prepared.samples, prepared.diagnostics);
  const auto doubt = [&](std::span<const Sample> samples) {
    find_doubts({*prepared.config, prepared.robot, prepared.urdf_text, prepared.urdf, samples,
                 prepared.calibration, prepared.recorded, prepared.is_part},
                prepared.diagnostics);
  };
  exclude.empty() ? doubt(prepared.samples) : doubt(heard_samples(prepared.samples, exclude));
}

/// What a search begins with: the unknown poses are free, and a note says that there is a search.
/// @param is_proposed  the samples suggest the configuration
void leave_open(PreparedCalibration& prepared, Search search, bool is_proposed) {
  Config& config = *prepared.config;
  prepared.is_searched = true;
  if (search == Search::if_open) {
    prepared.diagnostics.notes.push_back(
        (is_proposed ? "there is no --config; the samples suggest one"
                     : config.place.file + ": nothing is free") +
        ": what these samples support is searched for, as 'kinecal identify' does");
  }
  if (config.steps.size() == 1 && frees_nothing(config)) {
    free_unknown_poses(config, prepared.robot, prepared.samples);
  }
}

/// Associates clouds with the surface of the robot; returns where the solve begins.
[[nodiscard]] std::vector<double> match_surface(PreparedCalibration& prepared,
                                                const CalibrationOptions& options, bool is_open) {
  const SurfaceInput input{prepared.robot,     prepared.urdf_text, prepared.urdf,
                           options.mesh_paths, options.exclude,    options.solving.threads};
  if (!is_open) {
    return kinecal::match_surface(input, *prepared.config, prepared.samples, prepared.diagnostics);
  }
  Config poses = *prepared.config;  // what a search frees is not known yet
  if (poses.steps.size() == 1 && frees_nothing(poses)) {
    free_unknown_poses(poses, prepared.robot, prepared.samples);
  }
  (void)kinecal::match_surface(input, poses, prepared.samples, prepared.diagnostics);
  for (std::size_t s = 0; s < poses.steps.size(); ++s) {
    prepared.config->steps[s].models = poses.steps[s].models;  // they know the links now
    prepared.config->steps[s].error_blocks = poses.steps[s].error_blocks;
  }
  return {};
}

/// "raw" or "rectified", by camera, where it was chosen.
[[nodiscard]] std::map<std::string, std::string> images_of(const Config& config) {
  std::map<std::string, std::string> images;
  for (const ModelConfig& model : models_of(config)) {
    if (model.image == ImageKind::automatic) continue;
    images[model.name] = model.image == ImageKind::raw ? "raw" : "rectified";
  }
  return images;
}

/// The lens of each camera of raw images, as far as it is known.
[[nodiscard]] std::map<std::string, std::string> lenses_of(const Config& config) {
  std::map<std::string, std::string> lenses;
  for (const ModelConfig& model : models_of(config)) {
    if (!model.lens.empty() && model.image != ImageKind::rectified) lenses[model.name] = model.lens;
  }
  return lenses;
}

[[nodiscard]] ProcedureOptions procedure_of(const PreparedCalibration& prepared,
                                            const CalibrationOptions& options) {
  ProcedureOptions procedure{.solving = options.solving,
                             .folds = options.folds,
                             .keep_outliers = options.keep_outliers,
                             .exclude = {},
                             .doubts = prepared.diagnostics.doubts,
                             .refutable = prepared.diagnostics.refutable,
                             .progress = options.progress,
                             .between = options.between};
  for (const std::string& name : options.between) {
    if (prepared.calibration.steps.empty()) break;
    try {
      (void)frame_named(*prepared.calibration.steps.back().problem, prepared.samples, name);
    } catch (const std::invalid_argument& error) {
      throw InputError(std::string("--between: ") + error.what());
    }
  }
  for (const int number : options.exclude) {
    if (number < 1 || number > std::ssize(prepared.samples)) {
      throw InputError(fmt::format("--exclude: no sample {}; there are samples 1 to {}", number,
                                   prepared.samples.size()));
    }
    procedure.exclude[number - 1] = "--exclude";
  }
  return procedure;
}

/// Each sample with its own poses where the result has them.
void take_sample_poses(const AnyProblem& problem, std::vector<Sample>& samples) {
  for (std::size_t s = 0; s < problem.poses_of_samples().size(); ++s) {
    for (std::size_t f = 0; f < problem.sample_poses().size(); ++f) {
      samples[s].poses[problem.sample_poses()[f]] = problem.poses_of_samples()[s][f];
    }
  }
}

/// Judges files that do not go with the others.  A few samples scatter too much to say so of their file.
void judge_files(const Calibration& calibration, std::span<const Sample> samples,
                 JudgedResult& judged) {
  constexpr int kFewest = 10;  // samples of a file
  if (!judged.result.converged) return;
  std::map<std::string, int> counts, numbers;
  for (const Sample& sample : samples) ++counts[recording_of(sample)];
  std::vector<std::string> names;
  for (const auto& [file, count] : counts) {
    numbers[file] = count < kFewest ? -1 : static_cast<int>(std::ssize(names));
    if (count >= kFewest) names.push_back(file);
  }
  std::vector<int> files;
  for (const Sample& sample : samples) files.push_back(numbers[recording_of(sample)]);
  const Eigen::VectorXd values = judged.result.table.values();
  judge_misfits(misfits_of(*calibration.steps.back().problem,
                           {values.data(), static_cast<std::size_t>(values.size())}, files),
                names, judged.judgement);
}

/// Checks that the URDF has a place for the zeros that are free, before a result lacks one.
/// @throws InputError  if <ros2_control> should hold them, and does not have the joint
void check_offset_places(const PreparedCalibration& setup, const CalibrationOptions& options) {
  if (options.offsets != OffsetStyle::ros2_control || setup.urdf_text.empty()) return;
  constexpr double kSome = 1e-3;  // radians or metres
  std::vector<JointPatch> zeros;
  const ParameterTable& table = setup.calibration.table;
  for (int p = 0; p < table.size(); ++p) {
    const auto frees_it = [&](const CalibrationStep& step) {
      const std::vector<int>& free = step.free.parameters();
      return std::find(free.begin(), free.end(), p) != free.end();
    };
    const std::string& name = table[p].name;
    if (!setup.robot.has_joint(name) || options.in_servos.contains(name)) continue;
    const std::vector<CalibrationStep>& steps = setup.calibration.steps;
    if (std::any_of(steps.begin(), steps.end(), frees_it)) zeros.push_back({name, kSome});
  }
  (void)patch_urdf(setup.urdf_text, setup.urdf, setup.robot, zeros, options.offsets);
}

/// Solves and judges what is assembled.
void fit(const CalibrationOptions& options, CalibratedRobot& calibrated) {
  PreparedCalibration& setup = calibrated.setup;
  setup.diagnostics.throw_if_errors();
  check_offset_places(setup, options);
  JudgedResult judged =
      calibrate_and_judge(setup.calibration, setup.samples, procedure_of(setup, options));
  calibrated.samples = used_samples(judged, setup.samples);
  take_sample_poses(*setup.calibration.steps.back().problem, calibrated.samples);
  judge_files(setup.calibration, calibrated.samples, judged);
  calibrated.left_out_samples.clear();
  for (const LeftOutSample& left : judged.left_out) {
    calibrated.left_out_samples.push_back(setup.samples[static_cast<std::size_t>(left.number - 1)]);
  }
  static_cast<Findings&>(calibrated) =
      findings_of(setup.robot, setup.calibration, std::move(judged), calibrated.samples);
  calibrated.images = images_of(*setup.config);
  calibrated.lenses = lenses_of(*setup.config);
  calibrated.has_sample_poses = !setup.config->per_sample.empty();
}

/// Searches, and calibrates with what was found; again without samples that do not fit.
void search_and_fit(const CalibrationOptions& options, CalibratedRobot& calibrated) {
  PreparedCalibration& setup = calibrated.setup;
  const Config open = *setup.config;
  const Diagnostics before = setup.diagnostics;
  const auto run = [&](std::span<const Sample> samples) {
    calibrated.robot_search =
        search_robot(open, setup.robot, samples, {options.geometry_only, options.hold});
    setup.config = calibrated.robot_search->config;
    if (frees_nothing(*setup.config)) return;
    setup.diagnostics = before;
    assemble(setup, options.exclude);
    fit(options, calibrated);
  };
  run(setup.samples);
  if (!calibrated.left_out_samples.empty()) {
    const std::vector<Sample> used = used_samples(calibrated, setup.samples);
    run(used);
  }
  calibrated.search = reported(*calibrated.robot_search);
  if (frees_nothing(*setup.config)) {
    calibrated.robot = setup.robot.name();
    calibrated.judgement.add(Grade::do_not_use,
                             "nothing is free, and these samples support no parameter");
  }
}

/// How fast is still good, if the configuration has a lag.
[[nodiscard]] std::vector<std::string> how_fast(const CalibratedRobot& calibrated) {
  const CalibrationResult& result = calibrated.result;
  const CalibrationStep& last = calibrated.setup.calibration.steps.back();
  const Eigen::VectorXd values = result.table.values();
  std::vector<std::string> sentences;
  for (const SpeedLimit& limit :
       speed_limits(*last.problem, last.free,
                    {values.data(), static_cast<std::size_t>(values.size())}, calibrated.samples)) {
    sentences.push_back(limit.text());
  }
  return sentences;
}

}  // namespace

CalibratedRobot solve_and_judge(PreparedCalibration prepared, const CalibrationOptions& options) {
  prepared.diagnostics.throw_if_errors();
  CalibratedRobot calibrated;
  calibrated.setup = std::move(prepared);
  calibrated.setup.is_searched ? search_and_fit(options, calibrated) : fit(options, calibrated);
  return calibrated;
}

void explain(CalibratedRobot& calibrated, const CalibrationOptions& options) {
  const PreparedCalibration& setup = calibrated.setup;
  Findings& findings = calibrated;
  const bool frees_some = !setup.calibration.steps.empty();
  const CalibrationInput input{*setup.config, setup.robot,        setup.urdf_text,
                               setup.urdf,    calibrated.samples, setup.calibration};
  const int causes = findings.judgement.causes;
  if (frees_some) {
    judge_causes(input, heard_samples(setup.samples, options.exclude), findings, options.suspects);
  }
  if (calibrated.robot_search && findings.judgement.causes == causes) {
    const std::string why = another_robot(*calibrated.robot_search);
    if (!why.empty()) findings.judgement.add_causes(Grade::do_not_use, {why});
  }
  if (!frees_some) return;
  const bool is_explained = findings.judgement.causes > causes;
  std::future<WouldHelp> beside;
  if (!calibrated.robot_search) {  // else it is freed already
    beside = std::async(std::launch::async, [&] {
      return would_help(*setup.config, setup.robot, calibrated.samples, setup.calibration,
                        findings.result);
    });
  }
  judge_scales(input, findings);
  if (beside.valid()) {
    const WouldHelp help = beside.get();
    findings.helps = help.sentences;
    findings.helps_leave = help.left;
    if (!findings.assessments.empty() && !is_explained) {
      judge_help(help, findings.assessments.back(), findings.judgement);
    }
  }
  if (findings.result.converged) findings.speeds = how_fast(calibrated);
  judge_read_back(calibrated, options);
}

}  // namespace detail

PreparedCalibration prepare(CalibrationSetup setup, const CalibrationOptions& options,
                            Diagnostics diagnostics) {
  PreparedCalibration prepared{std::move(setup)};
  prepared.diagnostics = std::move(diagnostics);
  Diagnostics& found = prepared.diagnostics;
  const std::size_t before = found.errors.size();
  const auto is_good = [&] { return found.errors.size() == before; };
  const auto check_only = [&] {
    // Frames with a pose in each sample are given with the samples only.
    if (prepared.config && prepared.config->per_sample.empty())
      (void)assemble(*prepared.config, prepared.robot, {}, found);
    return std::move(prepared);
  };
  if (before > 0) return check_only();
  const bool is_proposed = !prepared.config;
  if (is_proposed) {
    try {
      prepared.config = config_from_samples(prepared.robot, prepared.samples);
    } catch (const InputError& error) {
      found.errors.emplace_back(error.what());
      return prepared;
    }
  }
  Config& config = *prepared.config;
  const bool is_open = options.search == Search::always || (options.search == Search::if_open &&
                                                            (is_proposed || frees_nothing(config)));
  const bool waits = detail::searches_lenses(config);  // what is free is not known yet
  if (!is_open && !waits) hold_parameters(config, options.hold, found);
  if (!is_good()) return check_only();
  if (prepared.recorded == Recorded::before) {
    add_rising(rising_of(prepared.urdf_text, prepared.urdf), prepared.samples);
  }
  const auto has_moves = [](const Sample& sample) { return !sample.joint_moves.empty(); };
  if (std::none_of(prepared.samples.begin(), prepared.samples.end(), has_moves)) {
    set_joint_moves(prepared.samples);
  }
  begin_magnetometer(config, prepared.samples, found);
  complete_samples(config, prepared.samples);
  prepared.decides_cameras = waits || !config.per_sample.empty();
  if (!prepare_cameras(prepared.robot, config, prepared.samples, found)) return prepared;
  if (!is_open && waits) hold_parameters(config, options.hold, found);
  if (!is_good()) return prepared;
  std::vector<double> begin;
  if (compares_surface(config)) begin = detail::match_surface(prepared, options, is_open);
  if (is_good() && !is_open && begin.empty() && has_background(config, prepared.samples)) {
    begin =
        leave_out_background(prepared.robot, {}, config, prepared.samples, options.solving, found);
  }
  if (!is_good()) return prepared;
  is_open ? detail::leave_open(prepared, options.search, is_proposed)
          : detail::assemble(prepared, options.exclude);
  if (!begin.empty()) begin_at(std::move(begin), prepared.calibration);
  return prepared;
}

CalibratedRobot calibrate_robot(PreparedCalibration prepared, const CalibrationOptions& options) {
  return detail::as_input_error([&] {
    CalibratedRobot calibrated = detail::solve_and_judge(std::move(prepared), options);
    detail::explain(calibrated, options);
    return calibrated;
  });
}

CalibratedRobot calibrate_robot(CalibrationSetup setup, const CalibrationOptions& options) {
  return calibrate_robot(prepare(std::move(setup), options), options);
}

}  // namespace kinecal
