// kinecal grade: episodes of a data set in which the camera or a zero is not as in the others.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/watch/fleet.hpp"
#include "moved_text.hpp"
#include "new_samples.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

using detail::Json;

/// A recording of the data set, and what is found in it.
struct Episode {
  std::string name;                  ///< path
  std::vector<Sample> samples = {};  ///< of it
  std::string refused = {};          ///< why it cannot be judged; empty: it can
  bool is_consistent = true;
  std::string reason = {};  ///< why it is not consistent, if no mover alone explains it
  double probability = 1.0, statistic = 0.0, freedom = 0.0;
  std::vector<NamedChange> moved = {};  ///< what explains it, the most likely first; empty: nothing
  std::vector<std::string> movers = {};  ///< "joint 'elbow'": of each
};

/// The files that are given, and those in folders.
std::vector<Episode> episodes_of(const GradeOptions& options) {
  std::vector<Episode> all;
  for (const std::string& given : options.episodes) {
    const bool is_bag = std::filesystem::exists(std::filesystem::path(given) / "metadata.yaml");
    if (!std::filesystem::is_directory(given) || is_bag) {
      all.push_back({.name = given});
      continue;
    }
    const std::vector<RecordingFiles> found = recordings_in(given);
    if (found.empty()) throw InputError(given + ": has no recordings");
    for (const RecordingFiles& files : found) all.push_back({.name = files.path});
  }
  return all;
}

void read(const GradeOptions& options, Episode& episode) {
  try {
    Diagnostics diagnostics;
    episode.samples = read_new_recordings(
        {{episode.name}, options.cameras, options.recorded, options.level, options.mesh_paths},
        diagnostics);
    if (!diagnostics.errors.empty()) episode.refused = diagnostics.errors.front();
  } catch (const std::exception& error) {
    episode.refused = error.what();
  }
}

/// What is alike in copies of an episode: positions and features.
std::string content_of(const std::vector<Sample>& samples) {
  std::string bytes;
  const auto add = [&](const double* numbers, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(double));
  };
  for (const Sample& sample : samples) {
    add(sample.joint_positions.data(), sample.joint_positions.size());
    for (const Observation& observation : sample.observations) {
      bytes += observation.sensor;
      for (const Feature& feature : observation.features) add(feature.point.data(), 3);
    }
  }
  return bytes;
}

/// Holds an episode against a result.
void judge(const StoredResult& result, const GradeOptions& options, double level,
           Episode& episode) {
  episode.moved.clear();
  episode.movers.clear();
  try {
    const NewSamples fresh = hold_against(
        result, episode.samples, {{episode.name}, {}, options.recorded, level, options.mesh_paths});
    if (!fresh.diagnostics.errors.empty()) {
      episode.refused = fresh.diagnostics.errors.front();
      return;
    }
    if (!std::isfinite(fresh.misfit)) {
      episode.is_consistent = false;
      episode.probability = 0.0;
      episode.reason = kBehindCamera;
      return;
    }
    const Drift drift = drift_of(result, fresh, {level});
    episode.is_consistent = drift.holds;
    episode.probability = drift.probability;
    episode.statistic = drift.statistic;
    episode.freedom = drift.freedom;
    for (int i = 0; i < drift.alike; ++i) {
      const Mover& mover = drift.movers[static_cast<std::size_t>(i)];
      if (!mover.explains) break;
      episode.moved.push_back(named_change(mover, fresh.problem().table()));
      episode.movers.push_back(mover_name(result, mover.owner, mover.is_frame));
    }
    if (!drift.holds && episode.moved.empty()) {
      episode.reason = "nothing that moved alone explains it";
    }
  } catch (const std::exception& error) {
    episode.refused = error.what();
  }
}

/// A calibration as the result that its files would hold.
StoredResult result_of(const CalibratedRobot& calibrated) {
  const ParameterTable& table = calibrated.result.table;
  const Eigen::VectorXd values = table.values();
  const CalibratedState state = calibrated_state(calibrated.assessments.back(), values);
  StoredResult result;
  result.folder = result.report = "the other episodes";
  result.robot = calibrated.setup.robot;
  result.urdf_text = calibrated.setup.urdf_text;
  result.urdf = result.urdf_then = calibrated.setup.urdf;
  result.config = *calibrated.setup.config;
  for (int p = 0; p < table.size(); ++p) result.values[table[p].name] = values(p);
  for (std::size_t i = 0; i < state.parameters.size(); ++i) {
    result.parameters.push_back(table[state.parameters[i]].name);
    std::vector<double>& row = result.covariance.emplace_back();
    for (std::size_t j = 0; j <= i; ++j) {
      row.push_back(state.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  for (const Combination& combination : state.undetermined) {
    auto& of = result.undetermined.emplace_back();
    for (const auto& [parameter, factor] : combination)
      of.emplace_back(table[parameter].name, factor);
  }
  result.noise = state.noise;
  result.common = state.common;
  result.knows_common = true;
  return result;
}

/// The data set without a result: episodes are calibrated without those that are judged.
class HeldOut {
 public:
  HeldOut(const GradeOptions& options, std::vector<Episode>& episodes)
      : options_(options), episodes_(episodes) {
    InputOptions input;
    input.urdf = options.urdf;
    input.config = options.config;
    input_ = read_files(input, false);
    print_or_throw(input_.diagnostics);
    if (compares_surface(*input_.setup.config)) {
      throw InputError(
          options.config +
          ": compares the robot's own surface; calibrate, and give the result with --result");
    }
    std::map<std::string, std::size_t> known;
    for (std::size_t i = 0; i < episodes.size(); ++i) {
      if (!episodes[i].refused.empty()) continue;
      const auto [first, is_new] = known.emplace(content_of(episodes[i].samples), i);
      (is_new ? used_ : copies_).push_back(i);
      if (is_new) continue;
      say(stderr, "warning: {} is a copy of {}: it counts once\n", episodes[i].name,
          episodes[first->second].name);
    }
    readable_ = used_.size();
  }

  /// Judges all: the one that fits the others least is taken out until the others agree.
  /// @throws InputError  if no majority agrees, or it cannot be calibrated
  void judge_all() {
    const double level = options_.level / static_cast<double>(std::max<std::size_t>(1, readable_));
    if (readable_ < 2) {
      throw InputError(fmt::format("{} to be compared with others; give a result with --result",
                                   readable_ == 1 ? "one episode, and none" : "no episode"));
    }
    std::vector<std::size_t> out;
    while (true) {
      if (2 * used_.size() <= readable_ || used_.size() < 2) {
        throw InputError(
            fmt::format("{} of {} do not agree with the others: no majority of the episodes is "
                        "consistent; calibrate with samples "
                        "that you trust, and give the result with --result",
                        out.size(), counted(readable_, "episode")));
      }
      const std::size_t worst = judge_held_out(level);
      if (episodes_[worst].is_consistent) break;
      out.push_back(worst);
      std::erase(used_, worst);
    }
    const StoredResult result = calibrated(used_, true);
    out.insert(out.end(), copies_.begin(), copies_.end());
    for (const std::size_t i : out) judge(result, options_, level, episodes_[i]);
  }

 private:
  /// Judges each used episode by the others, or by nine tenths of all.
  /// @returns  the one that fits least
  std::size_t judge_held_out(double level) {
    const std::size_t folds = std::min<std::size_t>(10, used_.size());
    for (std::size_t fold = 0; fold < folds; ++fold) {
      std::vector<std::size_t> others;
      for (std::size_t i = 0; i < used_.size(); ++i) {
        if (i % folds != fold) others.push_back(used_[i]);
      }
      const StoredResult result = calibrated(others, false);
      for (std::size_t i = fold; i < used_.size(); i += folds) {
        judge(result, options_, level, episodes_[used_[i]]);
      }
    }
    return *std::min_element(used_.begin(), used_.end(), [&](std::size_t a, std::size_t b) {
      const Episode &x = episodes_[a], &y = episodes_[b];
      return x.probability != y.probability ? x.probability < y.probability
                                            : x.statistic * y.freedom > y.statistic * x.freedom;
    });
  }

  /// @param is_last  its verdict counts; before, some of the episodes are those to be found
  [[nodiscard]] StoredResult calibrated(const std::vector<std::size_t>& from, bool is_last) const {
    CalibrationSetup setup = input_.setup;
    for (const std::size_t i : from) {
      const std::vector<Sample>& samples = episodes_[i].samples;
      setup.samples.insert(setup.samples.end(), samples.begin(), samples.end());
    }
    CalibrationOptions calibrating;
    calibrating.search = Search::never;
    calibrating.folds = 1;
    PreparedCalibration prepared = prepare(std::move(setup), calibrating);
    if (!prepared.diagnostics.errors.empty()) throw InputError(prepared.diagnostics.errors.front());
    const CalibratedRobot solved = detail::solve_and_judge(std::move(prepared), calibrating);
    if ((is_last && !solved.is_usable()) || solved.assessments.empty()) {
      throw InputError(
          "the episodes cannot be calibrated together: " +
          (solved.judgement.reasons.empty() ? "do not use" : solved.judgement.reasons.front()) +
          "; give a result with --result");
    }
    return result_of(solved);
  }

  const GradeOptions& options_;
  std::vector<Episode>& episodes_;
  Input input_;
  std::vector<std::size_t> used_;    ///< with which is calibrated
  std::vector<std::size_t> copies_;  ///< of others
  std::size_t readable_ = 0;
};

std::string line_of(const Episode& episode) {
  if (!episode.refused.empty())
    return fmt::format("{}: refused: {}\n", episode.name, detail::one_line(episode.refused));
  if (episode.is_consistent) {
    return fmt::format("{}: consistent ({})\n", episode.name, chance_text(episode.probability));
  }
  std::string text;
  for (std::size_t i = 0; i < episode.moved.size(); ++i) {
    text += (i == 0 ? "" : ", or ") + episode.movers[i] + " by " + change_text(episode.moved[i]);
  }
  return fmt::format("{}: not consistent: {} ({})\n", episode.name,
                     text.empty() ? episode.reason : text, chance_text(episode.probability));
}

Json json_of(const Episode& episode) {
  Json moved = Json::array();
  for (const NamedChange& of : episode.moved) {
    Json parameters = Json::array();
    for (std::size_t i = 0; i < of.parameters.size(); ++i) {
      parameters.push_back({{"name", of.parameters[i]},
                            {"unit", of.units[i]},
                            {"change", of.change[i]},
                            {"sigma", of.deviation[i]}});
    }
    moved.push_back({{"owner", of.owner}, {"is_frame", of.is_frame}, {"parameters", parameters}});
  }
  const bool is_judged = episode.refused.empty();
  return {{"name", episode.name},
          {"consistent", is_judged ? Json(episode.is_consistent) : Json()},
          {"refused", is_judged ? Json() : Json(episode.refused)},
          {"samples", episode.samples.size()},
          {"probability", is_judged ? Json(episode.probability) : Json()},
          {"statistic", episode.statistic},
          {"freedom", episode.freedom},
          {"moved", moved}};
}

}  // namespace

int grade(const GradeOptions& options) {
  if (options.result.empty() && options.urdf.empty()) {
    throw InputError("grade needs --result, or --urdf and --config");
  }
  std::vector<Episode> episodes = episodes_of(options);
  if (!options.report.empty()) check_json(options.report, options.episodes);
  for (Episode& episode : episodes) read(options, episode);
  if (options.result.empty()) {
    HeldOut(options, episodes).judge_all();
  } else {
    const StoredResult result = read_result(options.result);
    if (compares_surface(result.config)) {
      throw InputError(options.result +
                       ": is a result of the robot's own surface: hold episodes against it with "
                       "'kinecal verify'");
    }
    const double level = options.level / static_cast<double>(episodes.size());
    for (Episode& episode : episodes) {
      if (episode.refused.empty()) judge(result, options, level, episode);
    }
  }
  std::size_t wrong = 0, refused = 0;
  std::string text;
  Json all = Json::array();
  for (const Episode& episode : episodes) {
    const bool is_refused = !episode.refused.empty();
    refused += is_refused ? 1 : 0;
    wrong += !is_refused && !episode.is_consistent ? 1 : 0;
    text += line_of(episode);
    all.push_back(json_of(episode));
  }
  const Json json = {{"episodes", all},
                     {"consistent", episodes.size() - wrong - refused},
                     {"not_consistent", wrong},
                     {"refused", refused}};
  if (options.manner.json) {
    say("{}", detail::json_lines(json));
  } else {
    show(text + fmt::format("{} of {} consistent{}\n", episodes.size() - wrong - refused,
                            counted(episodes.size(), "episode"),
                            refused > 0 ? fmt::format(", {} refused", refused) : ""),
         options.manner);
  }
  if (!options.report.empty()) write_output(options.report, detail::json_lines(json));
  return wrong > 0 ? kNotUsable : refused > 0 ? kBadInput : kDone;
}

}  // namespace kinecal::cli
