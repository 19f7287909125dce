// Assembles problems from a configuration and reports every error at its line.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/config_free.ipp"
#include "kinecal/config/expected_joints.hpp"
#include "kinecal/config/few_samples.ipp"
#include "kinecal/config/frame_gaps.hpp"
#include "kinecal/config/loss_names.hpp"
#include "kinecal/config/missing_sensors.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/config/unknown_frames.ipp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/problem/term.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

// Warnings about samples that are probably unintended.

/// Names of the models whose sensors are of some kind.
/// @param is_meant  predicate on an AnySensor
template <class IsMeant>
[[nodiscard]] std::set<std::string> models_where(const Config& config, const IsMeant& is_meant) {
  std::set<std::string> names;
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      const SensorEntry* entry = entry_of(model);
      if (entry != nullptr && is_meant(*entry->sensor)) names.insert(model.name);
    }
  }
  return names;
}

/// Warns of NaN features, once for all steps.
void warn_of_unusable(const Config& config, std::span<const Sample> samples,
                      Diagnostics& diagnostics) {
  const std::set<std::string> oriented =
      models_where(config, [](const AnySensor& sensor) { return sensor.is_oriented(); });
  std::size_t unusable = 0;
  std::string first;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) {
      for (const Feature& feature : observation.features) {
        const bool turned = feature.rotation && oriented.contains(observation.sensor);
        if (feature.point.allFinite() && (!turned || feature.rotation->allFinite())) continue;
        if (unusable++ == 0) first = sample.source + ", sensor '" + observation.sensor + "'";
      }
    }
  }
  if (unusable == 0) return;
  diagnostics.warnings.push_back(
      fmt::format("{} {} and left out; the first is at {}", unusable,
                  unusable == 1 ? "feature is not a number" : "features are not numbers", first));
}

/// Warns of points farther away than any calibration target: the unit or the capture is probably
/// wrong.
void warn_of_far_points(const Config& config, std::span<const Sample> samples,
                        Diagnostics& diagnostics) {
  constexpr double kFar = 100.0;
  const std::set<std::string> in_metres = models_where(
      config, [](const AnySensor& sensor) { return sensor.delivers(Quantity::point); });
  std::size_t count = 0;
  std::string first;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (!in_metres.contains(seen.sensor)) continue;
      for (const Feature& feature : seen.features) {
        const double distance = feature.point.norm();
        if (!(std::isfinite(distance) && distance > kFar)) continue;
        if (count++ > 0) continue;
        first = fmt::format("{}, sensor '{}', {:.0f} m", sample.source, seen.sensor, distance);
      }
    }
  }
  if (count == 0) return;
  diagnostics.warnings.push_back(
      fmt::format("{} point{} more than {:.0f} m away from their frame; are they in metres?  "
                  "The first is at {}",
                  count, count == 1 ? " is" : "s are", kFar, first));
}

/// Warns of cameras whose camera_info changes: the output files start from the first one.
void warn_of_changing_cameras(std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::map<std::string, std::pair<const CameraInfo*, bool>> first;  // true if already reported
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (!seen.camera) continue;
      auto& [info, reported] = first.try_emplace(seen.sensor, &*seen.camera, false).first->second;
      const CameraInfo& now = *seen.camera;
      const bool same = info->p == now.p && info->k == now.k && info->d == now.d &&
                        info->z_offset == now.z_offset && info->z_scaling == now.z_scaling;
      if (same || reported) continue;
      reported = true;
      diagnostics.warnings.push_back(
          fmt::format("{}: the camera_info of sensor '{}' differs from that of the first sample, "
                      "which the written camera files are made from",
                      sample.source, seen.sensor));
    }
  }
}

/// Indices of repeated names, each with the first one of the same name.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> repeated(
    const std::vector<std::string>& names) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::map<std::string_view, std::size_t> first;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [known, is_new] = first.emplace(names[i], i);
    if (!is_new) pairs.emplace_back(known->second, i);
  }
  return pairs;
}

/// Warns of joints that a sample names twice with different positions.  robot_calibration records a
/// joint once per chain that moves it.
void warn_of_joints_with_two_positions(std::span<const Sample> samples, Diagnostics& diagnostics) {
  constexpr double kSame = 1e-9;  // far below what an encoder resolves
  std::size_t count = 0;
  std::string first;
  const std::vector<std::string>* names = nullptr;  // of the previous sample: most have the same
  std::vector<std::pair<std::size_t, std::size_t>>
      twice;  // indices of a name and of its repetition
  for (const Sample& sample : samples) {
    if (sample.joint_names.size() != sample.joint_positions.size()) continue;  // that is an error
    if (names == nullptr || *names != sample.joint_names) {
      names = &sample.joint_names;
      twice = repeated(*names);
    }
    for (const auto& [i, again] : twice) {
      const double taken = sample.joint_positions[i], position = sample.joint_positions[again];
      if (std::abs(position - taken) <= kSame) continue;
      if (count++ > 0) continue;
      first =
          fmt::format("{}, joint '{}' at {} and {}", sample.source, (*names)[i], taken, position);
    }
  }
  if (count == 0) return;
  diagnostics.warnings.push_back(fmt::format(
      "{} joint{} of a sample {} a second position that differs; the first one is used.  "
      "The first is at {}",
      count, count == 1 ? "" : "s", count == 1 ? "has" : "have", first));
}

// Adds the error blocks of a step to a problem.

/// Numbers of samples in which a block's first model observes something: alone, and together with
/// another model of the step.
struct Company {
  int alone = 0, beside = 0;
};
[[nodiscard]] Company company_of(const BlockConfig& block, const StepConfig& step,
                                 std::span<const Sample> samples) {
  Company count;
  for (const Sample& sample : samples) {
    const auto observes = [&](const std::string& model) {
      const Observation* seen = sample.observation(model);
      return seen != nullptr && !seen->features.empty();
    };
    if (block.models.empty() || !observes(block.models.front())) continue;
    const bool beside =
        std::any_of(step.models.begin(), step.models.end(), [&](const ModelConfig& model) {
          return model.name != block.models.front() && observes(model.name);
        });
    ++(beside ? count.beside : count.alone);
  }
  return count;
}

/// True if a plane block uses only the samples in which its model observes alone, by default: if
/// there are such samples, points seen together with another model, such as the LEDs of a gripper,
/// are not on the plane.
[[nodiscard]] bool is_exclusive_by_default(const BlockConfig& block, const StepConfig& step,
                                           std::span<const Sample> samples) {
  if (block.type != "chain3d_to_plane" || block.exclusive || !block.ground.empty()) return false;
  const Company count = company_of(block, step, samples);
  return count.alone > 0 && count.beside > 0;
}

/// @param sigma  stated_sigma()
/// @throws std::exception  if the block's numbers are impossible or its sensors do not match
void add_block(AnyProblem& problem, const BlockConfig& block, bool exclusive,
               const std::optional<double>& sigma) {
  const BlockEntry* entry = entry_of(block);
  if (entry == nullptr) throw std::invalid_argument("no type '" + block.type + "'");
  TermOptions options;
  options.type = block.type;
  options.unit = entry->unit;
  options.exclusive = exclusive;
  options.beside = block.ground;
  options.loss = {loss_type(block.loss.type), block.loss.scale};
  options.sigma = sigma;
  if (const auto scale = block.numbers.find("scale"); scale != block.numbers.end()) {
    options.scale = scale->second;
  }
  entry->add(problem, block, options);
}

// The free parameters of a step that some residual depends on; the others are reported, by their cause.

/// True if a frame of the step keeps its pose.
/// @param held  free parameters that keep their initial values
[[nodiscard]] bool holds_frame(const StepConfig& step, const std::vector<std::string>& held) {
  return std::any_of(held.begin(), held.end(), [&](const std::string& parameter) {
    return std::any_of(step.free_frames.begin(), step.free_frames.end(), [&](const auto& frame) {
      return is_frame_parameter(parameter, frame.name);
    });
  });
}

/// Warns of sensors that are in no sample, with what follows from that.  If a pose that was to be found stays what it was,
/// it is a doubt: the result does not have it.
/// @param held  free parameters that keep their initial values
void report_missing(const MissingSensors& missing, const StepConfig& step,
                    const std::vector<std::string>& held, Diagnostics& diagnostics) {
  if (missing.models.empty()) return;
  std::vector<std::string> blocks;
  for (const BlockConfig& block : step.error_blocks) {
    if (missing.are_in(block)) blocks.push_back(block.name);
  }
  std::string text = fmt::format("{}; so {} {} no samples", sentence_of(missing),
                                 quoted_list(blocks), blocks.size() == 1 ? "has" : "have");
  if (!held.empty()) {
    text += fmt::format(", and {} {}", quoted_list(held, 3, "parameter"),
                        held.size() == 1 ? "keeps its initial value" : "keep their initial values");
  }
  const SourceLocation& place = missing.models.front()->place;
  const bool is_surface =
      missing.models.front()->is_surface;  // the camera that sees it is not associated
  const bool is_doubt = !is_surface && holds_frame(step, held);
  is_doubt ? diagnostics.doubt(place, text) : diagnostics.warning(place, text);
}

/// Warns of parameters of one line of the file that have no residual.
void report_untouched(const std::vector<const Parameter*>& parameters, const SourceLocation& place,
                      Diagnostics& diagnostics) {
  if (parameters.size() == 1) {
    diagnostics.warning(place, fmt::format("no residual of these samples depends on '{}'; it "
                                           "keeps its initial value {}",
                                           parameters[0]->name, parameters[0]->value));
    return;
  }
  std::vector<std::string> names;
  for (const Parameter* parameter : parameters) names.push_back(parameter->name);
  diagnostics.warning(place, fmt::format("no residual of these samples depends on {}; they keep "
                                         "their initial values",
                                         quoted_list(names)));
}

/// The free parameters of a step that affect residuals, in file order; warns of others.
[[nodiscard]] FreeSet free_set(const StepConfig& step, const AnyProblem& problem,
                               std::span<const Sample> samples, const MissingSensors& missing,
                               Diagnostics& diagnostics) {
  const ParameterTable& table = problem.table();
  const std::vector<int> touched = problem.touched_parameters();
  const Consequences consequences(missing, step, problem);
  std::vector<int> free;
  std::vector<std::string> held;
  std::vector<std::pair<SourceLocation, std::vector<const Parameter*>>> others;  // by line
  for (const FreeParamConfig& param : free_parameters(step)) {
    const int index = table.find(param.name);
    if (index < 0) continue;
    if (samples.empty() || std::binary_search(touched.begin(), touched.end(), index)) {
      free.push_back(index);
    } else if (consequences.contain(param.name)) {
      held.push_back(param.name);
    } else {
      if (others.empty() || others.back().first.line != param.place.line) {
        others.emplace_back(param.place, std::vector<const Parameter*>());
      }
      others.back().second.push_back(&table[index]);
    }
  }
  report_missing(missing, step, held, diagnostics);
  for (const auto& [place, parameters] : others) report_untouched(parameters, place, diagnostics);
  if (free.empty()) {
    diagnostics.error(step.place, fmt::format("step '{}': these samples determine none of "
                                              "its free parameters",
                                              step.name));
  }
  return FreeSet(std::move(free), table.size());
}

// Warnings about the ids by which error blocks pair features.

/// Warns of samples in which the sensors of a term saw different features.
void warn_of_disjoint_ids(const Term& term, const BlockConfig& block,
                          std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::size_t disjoint = 0;
  std::string first;
  for (const Sample& sample : samples) {
    if (!term.pairs_features() || !ids_are_disjoint(sample, block.models)) continue;
    if (disjoint++ == 0) first = sample.source;
  }
  if (disjoint == 0) return;
  diagnostics.warning(
      block.place,
      fmt::format("error block '{}' does not use {} sample{}: its sensors observed no feature of "
                  "the same id; the first is at {}",
                  term.name, disjoint, disjoint == 1 ? "" : "s", first));
}

/// Warns of samples in which some sensors of a term have ids, and others do not.
void warn_of_one_sided_ids(const Term& term, const BlockConfig& block,
                           std::span<const Sample> samples, Diagnostics& diagnostics) {
  if (!term.pairs_features()) return;
  for (const Sample& sample : samples) {
    std::string with, without;
    for (const std::string& model : block.models) {
      const Observation* seen = sample.observation(model);
      if (seen == nullptr || seen->features.empty()) continue;
      (seen->features.front().id ? with : without) = model;
    }
    if (with.empty() || without.empty()) continue;
    diagnostics.warning(
        block.place, fmt::format("error block '{}': features of '{}' have ids, those of '{}' have "
                                 "none, so they are paired by place; the first sample is at {}",
                                 term.name, with, without, sample.source));
    return;
  }
}

// What a configuration names and this calibration does not need: priors on what no step frees,
// initial values of frames that are not free, models that no error block compares.
//
// robot_calibration runs such files, so each is a warning and has no effect.  A name that neither
// the robot nor the samples have stays an error: it is probably misspelt.

/// Names of the robot and of the frames in which features were recorded.
struct KnownNames {
  const Robot& robot;
  std::set<std::string> recorded;  ///< frames; empty without samples
  bool have_samples = false;

  [[nodiscard]] bool has_frame(const std::string& name) const {
    return robot.has_joint(name) || robot.has_link(name) ||
           recorded.contains(std::string(plain_frame(name)));
  }
  /// True for a joint, link or frame, or a parameter of one: elbow_gear_ratio, tool_joint_x.
  [[nodiscard]] bool has(const std::string& name) const {
    const auto is_part = [&](std::string_view part) {
      const std::string suffix = "_" + std::string(part);
      return name.ends_with(suffix) && has_frame(name.substr(0, name.size() - suffix.size()));
    };
    return has_frame(name) || std::any_of(kFrameAxes.begin(), kFrameAxes.end(), is_part) ||
           joint_model_parameter(robot, name).has_value();
  }
  /// True if nothing shows that a name is misspelt: it is known, or, without samples, it may be a
  /// frame of features and resembles no other name.
  /// @param others  names that could be meant
  template <class Names>
  [[nodiscard]] bool may_be_meant(const std::string& name, const Names& others) const {
    return has(name) || (!have_samples && !nearest_name(name, others) &&
                         !nearest_name(name, robot.joint_names()));
  }
};

/// Drops priors on what no step frees.
void drop_priors_without_effect(Config& config, const ParameterTable& table,
                                const KnownNames& known, Diagnostics& diagnostics) {
  std::set<int> free;
  for (const StepConfig& step : config.steps) {
    for (const FreeParamConfig& param : free_parameters(step)) free.insert(table.find(param.name));
  }
  free.erase(-1);
  std::vector<std::string> names;
  for (const Parameter& parameter : table) names.push_back(parameter.name);
  for (StepConfig& step : config.steps) {
    std::erase_if(step.error_blocks, [&](const BlockConfig& block) {
      if (block.param.empty()) return false;
      const auto rows = Prior{block.param}.parameters(table);
      const bool exists = std::any_of(rows.begin(), rows.end(), [](int p) { return p >= 0; });
      const bool is_held =
          std::none_of(rows.begin(), rows.end(), [&](int p) { return free.contains(p); });
      if (!is_held || (!exists && !known.may_be_meant(block.param, names))) return false;
      diagnostics.warning(block.place, fmt::format("error block '{}' has no effect: no step frees "
                                                   "its param '{}'",
                                                   block.name, block.param));
      return !exists;
    });
  }
}

/// Reports initial values of frames that are free neither in their step nor before it.
void check_initial_frames(const Config& config, const KnownNames& known, Diagnostics& diagnostics) {
  std::set<std::string> free;
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) free.insert(frame.name);
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (free.contains(value.name)) continue;
      const std::string subject = "initial value of free frame '" + value.name + "'";
      if (known.has(value.name) || !nearest_name(value.name, free)) {
        diagnostics.warning(value.place,
                            subject + " has no effect: the frame is not free in this step");
      } else {
        diagnostics.error(value.place, subject + ": there is no such free frame" +
                                           did_you_mean(value.name, free));
      }
    }
  }
}

/// Drops models that no error block compares and that do not fit the robot.
void drop_models_without_use(Config& config, const Robot& robot, Diagnostics& diagnostics) {
  for (StepConfig& step : config.steps) {
    if (step.error_blocks.empty()) continue;  // they are wrong, so what they use is not known
    std::erase_if(step.models, [&](const ModelConfig& model) {
      if (is_used(step, model.name)) return false;
      try {
        (void)make_chain(robot, config.base_link, model.frame);
        return false;
      } catch (const RobotError& e) {
        diagnostics.warning(model.place,
                            fmt::format("model '{}': {}; no error block uses the model,"
                                        " so it is left out",
                                        model.name, e.what()));
        return true;
      }
    });
  }
}

/// The configuration without what has no effect; each is a warning.
[[nodiscard]] Config without_unneeded(Config config, const Robot& robot,
                                      const ParameterTable& table, std::span<const Sample> samples,
                                      Diagnostics& diagnostics) {
  const KnownNames known{robot, feature_frames(samples), !samples.empty()};
  drop_priors_without_effect(config, table, known, diagnostics);
  check_initial_frames(config, known, diagnostics);
  drop_models_without_use(config, robot, diagnostics);
  return config;
}

/// Adds the samples.  Samples that are refused for one reason give one error.
/// @returns  indices of those that were added
std::vector<int> add_samples(AnyProblem& problem, std::span<const Sample> samples,
                             Diagnostics& diagnostics) {
  constexpr std::size_t kReported = 5;  // the first few show what is wrong
  std::size_t others = 0;
  struct Reason {
    std::string text, first, expected;  // without and with the place of a sample; expected_joints()
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
        refused.push_back({reason, what, expected_joints(problem.robot(), sample.joint_names)});
      } else {
        ++others;
      }
    }
  }
  for (const Reason& reason : refused) {
    const bool lacks_camera = reason.text.ends_with("has no camera_info");
    diagnostics.errors.push_back(
        reason.first +
        (reason.count > 1 ? " (and in " + counted(reason.count - 1, "more sample") + ")" : "") +
        (lacks_camera ? "; record it, or give its file: --camera NAME=FILE" : reason.expected));
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
    if (!term.sensors.empty()) {
      warn_of_disjoint_ids(term, *block, samples, diagnostics);
      warn_of_one_sided_ids(term, *block, samples, diagnostics);
    }
    if (count == 0 && term.sensors.empty()) {
      diagnostics.warning(
          block->place, fmt::format("error block '{}': no sample has its conditions: {}", term.name,
                                    fmt::join(term.conditions, ", ")));
    } else if (count == 0) {
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
                block.exclusive.value_or(is_exclusive_by_default(block, step, samples)),
                stated_sigma(block, step, samples));
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

void give_sample_poses(AnyProblem& problem, const Config& config) {
  std::vector<std::string> joints;
  for (const FreeParamConfig& frame : config.per_sample) joints.push_back(frame.name);
  problem.give_sample_poses(std::move(joints));
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

/// The frames of which nothing gives a pose.
[[nodiscard]] std::vector<std::string> names_without_guess(std::span<const UnknownFrame> frames) {
  std::vector<std::string> names;
  for (const UnknownFrame& frame : frames) {
    if (!frame.has_guess) names.push_back(frame.name);
  }
  return names;
}

}  // namespace
}  // namespace detail

std::optional<double> stated_sigma(const BlockConfig& block, const StepConfig& step,
                                   std::span<const Sample> samples) {
  const BlockEntry* entry = entry_of(block);
  const bool of_pixels = entry != nullptr && entry->unit == "px";  // takes those of its camera only
  double variance = 0.0;  // those of several sensors add up
  bool have_all = true;
  for (const ModelConfig& model : step.models) {
    const bool is_of_block =
        std::find(block.models.begin(), block.models.end(), model.name) != block.models.end();
    if (!is_of_block || (of_pixels && !detail::sensor_of(model)->delivers(Quantity::pixel)))
      continue;
    double information = 0.0;
    int with = 0, without = 0;
    for (const Sample& sample : samples) {
      const Observation* seen = sample.observation(model.name);
      if (seen == nullptr) continue;
      for (const Feature& feature : seen->features) {
        const double sigma = feature.sigma.value_or(0.0);
        if (!feature.point.allFinite()) continue;
        ++(sigma > 0.0 ? with : without);
        if (sigma > 0.0) information += 1.0 / (sigma * sigma);
      }
    }
    if (with == 0) continue;
    variance += with / information;
    have_all = have_all && without == 0;
  }
  const bool is_stated = std::isnormal(variance) && (have_all || !block.sigma);
  return is_stated ? std::optional(std::sqrt(variance)) : block.sigma;
}

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
    detail::give_sample_poses(*problem, config);
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
      check_frame_gaps(robot, config.base_link, step,
                       detail::names_without_guess(calibration.steps.back().unknown_frames),
                       samples, diagnostics);
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
