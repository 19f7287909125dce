// Assembles problems from a configuration and reports every error at its line.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/assemble.hpp"

#include "kinecal/config/add_blocks.ipp"
#include "kinecal/config/config_free.ipp"
#include "kinecal/config/few_samples.ipp"
#include "kinecal/config/free_set.ipp"
#include "kinecal/config/id_warnings.ipp"
#include "kinecal/config/missing_sensors.ipp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/sample_warnings.ipp"
#include "kinecal/config/unknown_frames.ipp"
#include "kinecal/config/unneeded_parts.ipp"
#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Adds the samples.  Samples that are refused for one reason give one error.
/// @returns  indices of those that were added
std::vector<int> add_samples(AnyProblem& problem, std::span<const Sample> samples,
                             Diagnostics& diagnostics) {
  constexpr std::size_t kReported = 5;  // the first few show what is wrong
  std::size_t others = 0;
  struct Reason {
    std::string text, first;  // without and with the place of a sample
    std::size_t count = 1;
  };
  std::vector<Reason> refused;
  std::vector<int> added;
  for (const Sample& sample : samples) {
    try {
      problem.add_sample(sample);
      added.push_back(static_cast<int>(&sample - samples.data()));
    } catch (const SampleError& e) {
      const std::string what = e.what(), place = sample.source + ": ";
      const std::string reason = what.starts_with(place) ? what.substr(place.size()) : what;
      const auto known = std::find_if(refused.begin(), refused.end(),
                                      [&](const Reason& one) { return one.text == reason; });
      if (known != refused.end()) {
        ++known->count;
      } else if (refused.size() < kReported) {
        refused.push_back({reason, what});
      } else {
        ++others;
      }
    }
  }
  for (const Reason& reason : refused) {
    diagnostics.errors.push_back(
        reason.first +
        (reason.count > 1 ? " (and in " + counted(reason.count - 1, "more sample") + ")" : ""));
  }
  if (others > 0) {
    diagnostics.errors.push_back(
        fmt::format("{} more sample{} errors like these", others, others == 1 ? " has" : "s have"));
  }
  return added;
}

/// The error if no sample has an observation of a block's ground; else empty.
[[nodiscard]] std::string missing_ground(const BlockConfig& block,
                                         std::span<const Sample> samples) {
  if (block.ground.empty()) return {};
  std::set<std::string> recorded;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) recorded.insert(observation.sensor);
  }
  if (recorded.contains(block.ground)) return {};
  return fmt::format("; none has a sensor '{}', which its key 'ground' names{}", block.ground,
                     did_you_mean(block.ground, recorded));
}

/// Reports terms without samples, and plane blocks that also use the samples of another block.
/// @returns  false if no term has samples, an error
bool check_terms(const StepConfig& step, const AnyProblem& problem, std::span<const Sample> samples,
                 const MissingSensors& missing, Diagnostics& diagnostics) {
  int total = 0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const Term& term = problem.term(t);
    const auto block = std::find_if(step.error_blocks.begin(), step.error_blocks.end(),
                                    [&](const BlockConfig& b) { return b.name == term.name; });
    const int count = problem.samples_of(t);
    total += count;
    if (missing.are_in(*block)) continue;  // report_missing() says so
    warn_of_disjoint_ids(term, *block, samples, diagnostics);
    warn_of_one_sided_ids(term, *block, samples, diagnostics);
    if (count == 0) {
      diagnostics.warning(block->place, fmt::format("error block '{}': no sample has usable "
                                                    "features of all its sensors{}",
                                                    term.name, missing_ground(*block, samples)));
    } else if (const int paired = problem.shared_samples(t); block->type == "chain3d_to_plane" &&
                                                             block->ground.empty() && paired > 0 &&
                                                             paired < count) {
      diagnostics.warning(
          block->place,
          fmt::format(
              "error block '{0}' also takes the {1} samples in which other sensors observe "
              "something together with '{2}'; write 'samples: exclusive' in it to leave them "
              "out",
              term.name, paired, block->models.front()));
    } else if (is_exclusive_by_default(*block, step, samples)) {
      diagnostics.warning(
          block->place,
          fmt::format("error block '{}' takes only the samples in which '{}' observes alone; write "
                      "'samples: all' in it to take the others, too",
                      term.name, block->models.front()));
    }
  }
  if (total > 0) return true;
  if (missing.models.empty()) {
    diagnostics.error(step.place, fmt::format("step '{}': no sample has usable features for any of "
                                              "its error blocks",
                                              step.name));
  } else {
    diagnostics.error(missing.models.front()->place, sentence_of(missing));
  }
  return false;
}

/// The table with the bounds of a step.
[[nodiscard]] ParameterTable with_bounds(ParameterTable table, const StepConfig& step,
                                         Diagnostics& diagnostics) {
  for (const BoundConfig& bound : step.bounds) {
    const int index = table.find(bound.name);
    if (index < 0) continue;
    table[index].lower = bound.lower;
    table[index].upper = bound.upper;
    double value = table[index].value;
    for (const auto& [assigned, initial] : initial_assignments(step, table)) {
      if (assigned == index) value = initial;
    }
    if (value < bound.lower || value > bound.upper) {
      diagnostics.error(bound.place, fmt::format("bound: the initial value {} of '{}' is outside "
                                                 "[{}, {}]",
                                                 value, bound.name, bound.lower, bound.upper));
    }
  }
  return table;
}

/// Adds the sensors and error blocks of a step.
/// @return  false, with errors, if they do not match the robot
bool add_models(AnyProblem& problem, const StepConfig& step, std::span<const Sample> samples,
                Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  for (const ModelConfig& model : step.models) {
    try {
      sensor_entry(model).add(problem, mount_from(model), options_of(model));
    } catch (const std::exception& e) {
      diagnostics.error(model.place, fmt::format("model '{}': {}", model.name, e.what()));
    }
  }
  if (diagnostics.errors.size() != before) return false;
  for (const BlockConfig& block : step.error_blocks) {
    try {
      add_block(problem, block,
                block.exclusive.value_or(is_exclusive_by_default(block, step, samples)));
    } catch (const std::exception& e) {
      const std::string what = e.what(), subject = "error block '" + block.name + "'";
      diagnostics.error(block.place,
                        what.starts_with(subject) ? what : fmt::format("{}: {}", subject, what));
    }
  }
  return diagnostics.errors.size() == before;
}

/// The robot with the gravity and payload of a configuration.
[[nodiscard]] Robot with_weight(Robot robot, const Config& config, Diagnostics& diagnostics) {
  RobotWeight weight = robot.weight();
  if (config.gravity) weight.gravity = *config.gravity;
  weight.payload = config.payload_link;
  try {
    robot.set_weight(std::move(weight));
  } catch (const RobotError& e) {
    diagnostics.error(config.place, fmt::format("payload_link or gravity: {}", e.what()));
  }
  return robot;
}

void give_own_poses(AnyProblem& problem, const Config& config) {
  std::vector<std::string> joints;
  for (const FreeParamConfig& frame : config.per_sample) joints.push_back(frame.name);
  problem.give_own_poses(std::move(joints));
}

/// Prepares the search for unknown poses of a step: the frames, and a few samples, with lines of
/// sight instead of pixels, because the search also looks behind the camera.
void prepare_search(CalibrationStep& step, const Config& config, const StepConfig& of_config,
                    const Robot& robot, std::span<const Sample> samples) {
  const ParameterTable& table = step.problem->table();
  step.unknown_frames = unknown_frames(config, of_config, robot, table, step.free);
  if (!config.per_sample.empty())
    step.unknown_frames.clear();  // start_cameras() knows where to begin
  if (step.unknown_frames.empty()) return;
  StepConfig of_step = of_config;
  Diagnostics ignored;  // already reported for the whole problem
  std::vector<BlockConfig> pixels;
  std::erase_if(of_step.error_blocks, [&](const BlockConfig& block) {
    const BlockEntry* entry = entry_of(block);
    const bool is_pixel = entry != nullptr && entry->read_as == PointToPixel::kType;
    if (is_pixel) pixels.push_back(block);
    return is_pixel;
  });
  auto few = make_problem(robot, config.base_link, table, frames_of(config));
  if (!add_models(*few, of_step, samples, ignored)) return;
  for (const BlockConfig& block : pixels) {
    few->add_built_in(block.name, PointToRay{}, block.models,
                      {.exclusive = block.exclusive.value_or(false), .beside = block.ground});
  }
  const FewSamples chosen = few_samples(*step.problem, samples);
  for (const int i : add_samples(*few, chosen.samples, ignored)) {
    step.of_excerpt.push_back(chosen.numbers[static_cast<std::size_t>(i)]);
  }
  if (few->num_residuals() > 0) step.excerpt = std::move(few);
}

}  // namespace
}  // namespace detail

Calibration assemble(const Config& given, const Robot& of_urdf, std::span<const Sample> samples,
                     Diagnostics& diagnostics) {
  Calibration calibration;
  const Robot robot = detail::with_weight(of_urdf, given, diagnostics);
  if (!robot.has_link(given.base_link)) {
    diagnostics.error(given.base_link_place.value_or(given.place),
                      fmt::format("base_link{}: no link '{}' in robot '{}'{}",
                                  given.base_link_place ? "" : " is not given", given.base_link,
                                  robot.name(), did_you_mean(given.base_link, robot.link_names())));
    return calibration;
  }
  const std::set<std::string> frames = detail::frames_of(given);
  calibration.table = detail::parameters_from(given, robot, samples, diagnostics);
  const Config config =
      detail::without_unneeded(given, robot, calibration.table, samples, diagnostics);
  if (!config.steps.empty()) {  // values of later steps are set when those steps start
    for (const auto& [index, value] :
         detail::initial_assignments(config.steps.front(), calibration.table)) {
      calibration.table[index].value = value;
    }
  }
  detail::warn_of_unusable(config, samples, diagnostics);
  detail::warn_of_far_points(config, samples, diagnostics);
  detail::warn_of_changing_cameras(samples, diagnostics);
  detail::warn_of_joints_with_two_positions(samples, diagnostics);
  for (const StepConfig& step : config.steps) {
    std::unique_ptr<AnyProblem> problem = make_problem(
        robot, config.base_link, detail::with_bounds(calibration.table, step, diagnostics), frames);
    detail::give_own_poses(*problem, config);
    if (!detail::add_models(*problem, step, samples, diagnostics)) continue;
    (void)detail::add_samples(*problem, samples, diagnostics);
    if (!diagnostics.errors.empty()) continue;
    const detail::MissingSensors missing = detail::missing_sensors(step, samples);
    if (!samples.empty() && !detail::check_terms(step, *problem, samples, missing, diagnostics)) {
      continue;
    }
    FreeSet free = detail::free_set(step, *problem, samples, missing, diagnostics);
    calibration.steps.push_back({step.name, step.max_num_iterations, std::move(problem),
                                 std::move(free),
                                 detail::initial_assignments(step, calibration.table)});
    if (!samples.empty()) {
      detail::prepare_search(calibration.steps.back(), config, step, robot, samples);
    }
  }
  return calibration;
}

Calibration with_samples(const Calibration& assembled, std::span<const Sample> samples) {
  Calibration calibration{assembled.table, {}, assembled.begin};
  for (const CalibrationStep& step : assembled.steps) {
    if (step.problem->num_samples() != std::ssize(samples)) {
      throw std::invalid_argument(fmt::format("with_samples: {} samples in place of {}",
                                              samples.size(), step.problem->num_samples()));
    }
    CalibrationStep& other = calibration.steps.emplace_back(
        CalibrationStep{step.name, step.max_num_iterations, step.problem->without_samples(),
                        step.free, step.assignments, step.unknown_frames});
    for (const Sample& sample : samples) other.problem->add_sample(sample);
    if (!step.excerpt) continue;
    other.excerpt = step.excerpt->without_samples();
    other.of_excerpt = step.of_excerpt;
    for (const int i : step.of_excerpt) {
      other.excerpt->add_sample(
          detail::excerpt_of(*other.problem, samples[static_cast<std::size_t>(i)]));
    }
  }
  return calibration;
}

}  // namespace kinecal
