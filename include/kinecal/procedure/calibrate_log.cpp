// Definitions of calibrate_log.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/calibrate_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/cameras/later_cameras.hpp"
#include "kinecal/config/choose_images.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/complete_samples.hpp"
#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/trust/captures/ruined.hpp"
#include "kinecal/trust/judge_shards.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Samples that are kept in memory while files are read.
constexpr std::int64_t kKeptOfLog = 100000;

/// What is known of a file after it was read once.
struct FileContent {
  std::int64_t samples = 0;
  std::optional<std::chrono::nanoseconds> begin =
      {};                                 ///< earliest stamp; nullopt: some sample has none
  std::vector<std::int64_t> places = {};  ///< of the samples that were kept, ascending
  std::vector<Sample> kept = {};
};

/// The i-th of `count` places that are spread evenly over `size`.
[[nodiscard]] std::int64_t even_place(std::int64_t i, std::int64_t count, std::int64_t size) {
  return (2 * i + 1) * size / (2 * count);
}

/// Reads a file, and keeps at most so many of its samples, evenly.
[[nodiscard]] FileContent content_of(std::vector<Sample> samples, std::int64_t most) {
  FileContent content;
  content.samples = std::ssize(samples);
  bool all_have = !samples.empty();
  for (const Sample& sample : samples) {
    all_have = all_have && sample.stamp.has_value();
    if (!all_have) break;
    content.begin = std::min(content.begin.value_or(*sample.stamp), *sample.stamp);
  }
  if (!all_have) content.begin.reset();
  const std::int64_t count = std::min(most, content.samples);
  for (std::int64_t i = 0; i < count; ++i) {
    content.places.push_back(even_place(i, count, content.samples));
    content.kept.push_back(std::move(samples[static_cast<std::size_t>(content.places.back())]));
  }
  return content;
}

/// Files by the time of their first sample; by name if some file has samples without a stamp.
[[nodiscard]] std::vector<int> order_of(const std::vector<FileContent>& files,
                                        const std::vector<std::string>& names) {
  std::vector<int> order(files.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const bool have_times = std::all_of(files.begin(), files.end(), [](const FileContent& file) {
    return file.begin || file.samples == 0;
  });
  const auto key = [&](int file) {
    const auto f = static_cast<std::size_t>(file);
    const std::chrono::nanoseconds begin =
        have_times ? files[f].begin.value_or(std::chrono::nanoseconds::max())
                   : std::chrono::nanoseconds{};
    return std::pair(begin, names[f]);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

/// How many samples each file gives to a draw: in proportion.
[[nodiscard]] std::vector<std::int64_t> shares_of(const std::vector<FileContent>& files,
                                                  std::int64_t drawn, std::int64_t total) {
  std::vector<std::int64_t> shares;
  std::int64_t before = 0;  // samples of the files so far
  for (const FileContent& file : files) {
    const auto until = [&](std::int64_t samples) {
      return total <= drawn ? samples : samples * drawn / total;
    };
    shares.push_back(until(before + file.samples) - until(before));
    before += file.samples;
  }
  return shares;
}

/// Samples that were drawn, and their numbers in the log, from 1.
struct Draw {
  std::vector<Sample> samples = {};
  std::vector<int> numbers = {};
};

/// Moves a draw out of the samples that were kept.
/// @param files  in their order
/// @param most   samples of the draw
/// @param total  samples of all files
[[nodiscard]] Draw draw_of(std::vector<FileContent> files, std::int64_t most, std::int64_t total) {
  const std::vector<std::int64_t> shares = shares_of(files, most, total);
  Draw draw;
  std::int64_t before = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    FileContent& file = files[f];
    const std::int64_t count = std::min(shares[f], std::ssize(file.kept));
    for (std::int64_t i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(even_place(i, count, std::ssize(file.kept)));
      draw.samples.push_back(std::move(file.kept[k]));
      draw.numbers.push_back(static_cast<int>(before + file.places[k] + 1));
    }
    before += file.samples;
  }
  return draw;
}

/// A sample that is left out: its place in its file, from 0, and the worst feature.
struct FarSample {
  int place = 0, term = 0;
  double distance = 0.0, times = 0.0;
};

/// What is known of a file before the sums.
struct CheckedFile {
  std::int64_t samples = 0;            ///< without those left out
  std::vector<FarSample> far = {};     ///< that are left out
  std::vector<double> residuals = {};  ///< of each step, priors once
  std::vector<std::vector<double>> free =
      {};  ///< of each step and parameter of the table: 1 if free

  [[nodiscard]] std::vector<double> packed() const {
    std::vector<double> all = {static_cast<double>(samples), static_cast<double>(far.size())};
    for (const FarSample& one : far) {
      all.insert(all.end(), {static_cast<double>(one.place), static_cast<double>(one.term),
                             one.distance, one.times});
    }
    for (std::size_t s = 0; s < residuals.size(); ++s) {
      all.push_back(residuals[s]);
      all.insert(all.end(), free[s].begin(), free[s].end());
    }
    return all;
  }
  /// @param parameters  of the table
  [[nodiscard]] static CheckedFile unpacked(std::span<const double> all, std::size_t steps,
                                            std::size_t parameters) {
    CheckedFile file;
    file.samples = static_cast<std::int64_t>(all[0]);
    const auto count = static_cast<std::size_t>(all[1]);
    all = all.subspan(2);
    for (std::size_t i = 0; i < count; ++i, all = all.subspan(4)) {
      file.far.push_back({static_cast<int>(all[0]), static_cast<int>(all[1]), all[2], all[3]});
    }
    for (std::size_t s = 0; s < steps; ++s, all = all.subspan(1 + parameters)) {
      file.residuals.push_back(all[0]);
      const std::span<const double> freed = all.subspan(1, parameters);
      file.free.emplace_back(freed.begin(), freed.end());
    }
    return file;
  }
};

/// The calibration of a log with the result of its draw.
class LogProcedure {
 public:
  LogProcedure(const PreparedLog& log, const CalibrationOptions& options,
               const CalibratedRobot& drawn)
      : log_(log), options_(options), drawn_(drawn), surface_input_{drawn.setup.robot,
                                                                    drawn.setup.urdf_text,
                                                                    drawn.setup.urdf,
                                                                    options.mesh_paths,
                                                                    {},
                                                                    options.solving.threads} {
    if (!compares_surface(*drawn.setup.config)) return;
    Config known = *drawn.setup.config;
    Diagnostics found;
    surfaces_ = read_surface_blocks(surface_input_, known, found);
    found.throw_if_errors();
    for (const Parameter& parameter : drawn.result.table) {
      values_[parameter.name] = parameter.value;
    }
  }

  /// Reads all files: what is wrong in them, and which of their samples are left out.
  void check_files() {
    set_limits();
    read_files("files");
    std::int64_t far = 0, samples = 0;
    for (const CheckedFile& file : files_) {
      far += std::ssize(file.far);
      samples += file.samples + std::ssize(file.far);
    }
    if (static_cast<double>(far) <= kMostLeftOut * static_cast<double>(samples)) return;
    limits_.clear();  // so many are no matter of single samples
    read_files("files with all samples");
  }

  /// Solves on all samples, and judges with what the draw shows.
  [[nodiscard]] JudgedResult solve(Calibration& calibration) {
    ShardedCalibration sharded{
        .calibration = calibration,
        .samples = drawn_.samples,
        .drawn = &drawn_,
        .read = [this](int shard) { return used_samples(shard); },
        .exchange = [this](
                        const std::string& what,
                        const NumbersOfShard& numbers_of) { return exchange(what, numbers_of); }};
    for (const int file : log_.order) sharded.names.push_back(name(file));
    for (const CheckedFile& file : files_) sharded.num_samples += file.samples;
    for (std::size_t s = 0; s < steps().size(); ++s) {
      sharded.num_residuals.push_back(residuals(s, sharded.num_samples));
      sharded.free.push_back(free(s));
    }
    ProcedureOptions procedure;
    procedure.solving = options_.solving;
    procedure.doubts = drawn_.setup.diagnostics.doubts;
    procedure.refutable = drawn_.setup.diagnostics.refutable;
    return calibrate_and_judge(sharded, procedure);
  }

  /// The samples that are left out, by number in the log.
  [[nodiscard]] std::vector<LeftOutSample> left_out() const {
    std::vector<LeftOutSample> all;
    std::int64_t before = 0;
    for (std::size_t shard = 0; shard < files_.size(); ++shard) {
      const CheckedFile& file = files_[shard];
      for (const FarSample& far : file.far) {
        const BlockNoise& noise = last().noise[static_cast<std::size_t>(far.term)];
        all.push_back({static_cast<int>(before) + far.place + 1,
                       fmt::format("{}: sample {}", name(log_.order[shard]), far.place + 1),
                       fmt::format("error block '{}': {} off, {:.1f} times the noise", noise.block,
                                   reading(far.distance, noise.unit), far.times)});
      }
      before += file.samples + std::ssize(file.far);
    }
    return all;
  }

  /// Number of samples of all files, with those left out.
  [[nodiscard]] int samples() const { return static_cast<int>(log_.samples); }

 private:
  /// @param what  name of the exchange between processes
  void read_files(const std::string& what) {
    files_.clear();
    for (const std::vector<double>& one :
         exchange(what, [&](int shard) { return check(shard).packed(); })) {
      files_.push_back(CheckedFile::unpacked(one, steps().size(),
                                             static_cast<std::size_t>(calibration().table.size())));
    }
  }

  static constexpr double kMostLeftOut = 0.25;

  [[nodiscard]] const Calibration& calibration() const { return drawn_.setup.calibration; }
  [[nodiscard]] const std::vector<CalibrationStep>& steps() const { return calibration().steps; }
  [[nodiscard]] const Assessment& last() const { return drawn_.assessments.back(); }
  [[nodiscard]] const std::string& name(int file) const {
    return log_.log.names[static_cast<std::size_t>(file)];
  }

  /// Numbers of shards, the files in their order.
  [[nodiscard]] std::vector<std::vector<double>> exchange(const std::string& what,
                                                          const NumbersOfShard& numbers_of) const {
    std::vector<int> shard_of(log_.order.size());
    for (std::size_t shard = 0; shard < log_.order.size(); ++shard) {
      shard_of[static_cast<std::size_t>(log_.order[shard])] = static_cast<int>(shard);
    }
    const auto of_file = [&](int file) {
      return numbers_of(shard_of[static_cast<std::size_t>(file)]);
    };
    std::vector<std::vector<double>> by_file;
    if (log_.log.exchange) {
      by_file = log_.log.exchange(what, of_file);
    } else {
      for (int file = 0; file < std::ssize(log_.order); ++file) by_file.push_back(of_file(file));
    }
    std::vector<std::vector<double>> all;
    for (const int file : log_.order) {
      all.push_back(std::move(by_file[static_cast<std::size_t>(file)]));
    }
    return all;
  }

  /// The samples of a file, as the draw's were prepared.
  [[nodiscard]] std::vector<Sample> samples_of(int shard, Diagnostics& diagnostics) const {
    const int file = log_.order[static_cast<std::size_t>(shard)];
    const auto kept = log_.kept.find(file);
    std::vector<Sample> samples = kept == log_.kept.end() ? log_.log.read(file) : kept->second;
    const PreparedCalibration& draw = drawn_.setup;
    if (draw.recorded == Recorded::before) {
      add_rising(rising_of(draw.urdf_text, draw.urdf), samples);
    }
    complete_samples(*draw.config, samples);
    if (draw.decides_cameras) {
      (void)prepare_later_cameras(draw.robot, *draw.config, draw.samples, samples, diagnostics);
    } else {
      Config same = *draw.config;
      choose_lenses(same, samples, diagnostics);  // a given lens replaces that of camera_info
    }
    if (!surfaces_.empty()) associate(name(file), samples, diagnostics);
    return samples;
  }

  /// Associates clouds and masks where the draw puts the robot, within its gate.  As the gradient of each residual is that of
  /// the true distance, the solution moves from there as if they were associated anew.
  void associate(const std::string& file, std::vector<Sample>& samples,
                 Diagnostics& diagnostics) const {
    Config config = *drawn_.setup.config;
    Diagnostics found;
    match_surface_at(surface_input_, surfaces_, values_, config, samples, found);
    if (are_whole(
            surfaces_)) {  // else points of links that are not listed may be near the listed ones
      found.errors.insert(found.errors.end(), found.doubts.begin(), found.doubts.end());
    }
    for (const std::string& one : found.errors) diagnostics.errors.push_back(file + ": " + one);
  }

  /// The samples of a file that the sums use.
  [[nodiscard]] std::vector<Sample> used_samples(int shard) const {
    Diagnostics diagnostics;
    std::vector<Sample> all = samples_of(shard, diagnostics);
    diagnostics.throw_if_errors();
    const std::vector<FarSample>& far = files_[static_cast<std::size_t>(shard)].far;
    for (auto one = far.rbegin(); one != far.rend(); ++one) all.erase(all.begin() + one->place);
    return all;
  }

  /// Checks a file as prepare() checks a setup; finds which samples are left out.
  /// @throws InputError  with all errors
  [[nodiscard]] CheckedFile check(int shard) const {
    const PreparedCalibration& draw = drawn_.setup;
    const std::string& file = name(log_.order[static_cast<std::size_t>(shard)]);
    Diagnostics found;
    std::vector<Sample> samples = samples_of(shard, found);
    check_images(file, samples, found);
    Calibration part;
    if (found.errors.empty()) {
      part = assemble(*draw.config, draw.robot, samples, found);
      find_doubts({*draw.config, draw.robot, draw.urdf_text, draw.urdf, samples, part,
                   draw.recorded, log_.order.size() > 1},
                  found);
    }
    found.throw_if_errors();
    CheckedFile checked;
    checked.far = far_samples_of(*part.steps.back().problem);
    std::set<int> left;
    for (const FarSample& far : checked.far) left.insert(far.place);
    if (!left.empty()) exclude(part, left, samples);
    checked.samples = std::ssize(samples);
    for (const CalibrationStep& step : part.steps) {
      checked.residuals.push_back(step.problem->num_residuals());
      std::vector<double>& freed =
          checked.free.emplace_back(static_cast<std::size_t>(step.problem->table().size()), 0.0);
      for (const int p : step.free.parameters()) freed[static_cast<std::size_t>(p)] = 1.0;
    }
    return checked;
  }

  /// Images are raw or rectified in all files.
  void check_images(const std::string& file, std::span<const Sample> samples,
                    Diagnostics& diagnostics) const {
    if (!log_.given || drawn_.setup.decides_cameras) return;
    Config config = *log_.given;
    Diagnostics notes;
    choose_images(config, drawn_.setup.robot, samples, notes);
    const std::vector<ModelConfig> here = models_of(config),
                                   there = models_of(*drawn_.setup.config);
    for (std::size_t i = 0; i < std::min(here.size(), there.size()); ++i) {
      if (here[i].image == there[i].image || here[i].image == ImageKind::automatic) continue;
      const bool is_raw = here[i].image == ImageKind::raw;
      diagnostics.errors.push_back(fmt::format(
          "{}: pixels of '{}' are those of {} images, but in other files of {} ones; write 'image' "
          "in the model",
          file, here[i].name, is_raw ? "raw" : "rectified", is_raw ? "rectified" : "raw"));
    }
  }

  /// The limit of each error block of the last step, in its noise, beyond which the draw leaves samples out; empty if it
  /// leaves none out.
  void set_limits() {
    const bool leaves_out = !options_.keep_outliers && !explains_more(last()) &&
                            steps().back().problem->sample_poses().empty();
    if (!leaves_out) return;
    if (!surfaces_.empty()) {
      std::vector<double> typical;
      for (const FarSample& one : wholes_of(*steps().back().problem)) typical.push_back(one.times);
      constexpr double kTimes = 4.0;  // as captures.hpp leaves out clouds
      const double limit =
          typical.empty() ? HUGE_VAL : kTimes * std::max(1.0, median_of(std::move(typical)));
      limits_.assign(last().noise.size(), limit);
      return;
    }
    limits_.assign(last().noise.size(), HUGE_VAL);
    for (const CaptureError& error : last().captures) {
      if (error.limit > 0.0) limits_[static_cast<std::size_t>(error.term)] = error.limit;
    }
  }

  /// Samples of a problem as wholes, at the draw's solution: the root mean square of their residuals, in the noise.  As in
  /// captures.hpp, no point of a cloud counts more than six times the noise.
  [[nodiscard]] std::vector<FarSample> wholes_of(const AnyProblem& problem) const {
    constexpr double kMost = 6.0;
    std::map<int, std::pair<double, double>> sums;  // of squares, and rows
    std::map<int, int> terms;
    const Eigen::VectorXd values = drawn_.result.table.values();
    const auto visit = [&](int t, int sample, const TermResiduals& rows) {
      const double noise = std::max(last().noise[static_cast<std::size_t>(t)].robust, kRounding);
      const double most = problem.term(t).is_of_surface() ? kMost * kMost : HUGE_VAL;
      auto& [squares, count] = sums[sample];
      squares += (rows.residual.cwiseProduct(rows.factor) / noise).cwiseAbs2().cwiseMin(most).sum();
      count += static_cast<double>(rows.residual.size());
      if (rows.residual.size() > 0) terms.emplace(sample, t);
    };
    (void)evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                   visit);
    std::vector<FarSample> all;
    for (const auto& [sample, sum] : sums) {
      if (!(sum.second > 0.0)) continue;
      const double times = std::sqrt(sum.first / sum.second);
      const int term = terms.at(sample);
      all.push_back(
          {sample, term, times * last().noise[static_cast<std::size_t>(term)].robust, times});
    }
    return all;
  }

  /// The samples of a problem beyond the limits, at the draw's solution.
  [[nodiscard]] std::vector<FarSample> far_samples_of(const AnyProblem& problem) const {
    std::map<int, FarSample> far;
    if (limits_.empty()) return {};
    if (!surfaces_.empty()) {
      std::vector<FarSample> wholes = wholes_of(problem);
      std::erase_if(wholes, [&](const FarSample& one) { return one.times <= limits_.front(); });
      return wholes;
    }
    const Eigen::VectorXd values = drawn_.result.table.values();
    const auto visit = [&](int t, int sample, const TermResiduals& rows) {
      const Term& term = problem.term(t);
      const double noise = last().noise[static_cast<std::size_t>(t)].robust;
      const double least = std::max(term.options.sigma.value_or(0.0), kRounding);
      for (Eigen::Index row = 0; row < rows.residual.size(); row += term.feature_size) {
        const double distance = rows.residual.segment(row, term.feature_size)
                                    .cwiseProduct(rows.factor.segment(row, term.feature_size))
                                    .norm();
        const double times = distance / std::max(noise, kRounding);
        if (times <= limits_[static_cast<std::size_t>(t)] || distance <= least) continue;
        FarSample& worst = far[sample];
        if (times > worst.times) worst = {sample, t, distance, times};
      }
    };
    (void)evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                   visit);
    std::vector<FarSample> all;
    for (const auto& [sample, one] : far) all.push_back(one);
    return all;
  }

  /// Residuals of a step in all files; a prior counts once per sample.
  [[nodiscard]] std::int64_t residuals(std::size_t step, std::int64_t samples) const {
    const auto priors =
        static_cast<std::int64_t>(Prior::kRows * steps()[step].problem->priors().size());
    std::int64_t all = priors * samples;
    for (const CheckedFile& file : files_) {
      all += static_cast<std::int64_t>(file.residuals[step]) - priors;
    }
    return all;
  }

  /// What any file determines, in the order of the configuration.
  [[nodiscard]] FreeSet free(std::size_t step) const {
    std::vector<int> all = steps()[step].free.parameters();
    for (const CheckedFile& file : files_) {
      for (int p = 0; p < std::ssize(file.free[step]); ++p) {
        const bool freed = file.free[step][static_cast<std::size_t>(p)] != 0.0;
        if (freed && std::find(all.begin(), all.end(), p) == all.end()) all.push_back(p);
      }
    }
    return FreeSet(std::move(all), calibration().table.size());
  }

  static constexpr double kRounding = 1e-9;  ///< of exact samples, metres or pixels

  const PreparedLog& log_;
  const CalibrationOptions& options_;
  const CalibratedRobot& drawn_;
  std::vector<CheckedFile> files_;
  SurfaceInput surface_input_;
  std::vector<std::vector<SurfaceBlock>> surfaces_;  ///< of each step; empty: no block has one
  std::map<std::string, double> values_;             ///< of the draw, by name; of surfaces only
  std::vector<double> limits_;                       ///< by error block of the last step
};

/// Numbers of samples of the draw become those in the log.
void number(const PreparedLog& log, CalibratedRobot& calibrated) {
  const auto in_log = [&](int& number) {
    number = log.numbers[static_cast<std::size_t>(number - 1)];
  };
  for (int& one : calibrated.numbers) in_log(one);
  for (LeftOutSample& left : calibrated.left_out) in_log(left.number);
}

/// The result of all samples in place of that of the draw.
void take_all(LogProcedure& procedure, CalibratedRobot& calibrated) {
  Findings& drawn = calibrated;
  JudgedResult judged = procedure.solve(calibrated.setup.calibration);
  judged.left_out = procedure.left_out();
  judge_left_out(static_cast<int>(std::ssize(judged.left_out)), procedure.samples(),
                 judged.judgement);
  judged.sources = drawn.sources;
  judged.numbers = drawn.numbers;
  judged.causes = drawn.causes;
  static_cast<JudgedResult&>(drawn) = std::move(judged);
  drawn.drawn = std::ssize(calibrated.samples);
  calibrated.left_out_samples.clear();  // those of the draw
}

}  // namespace
}  // namespace detail

PreparedLog prepare_log(CalibrationSetup setup, RecordedLog log,
                        const CalibrationOptions& options) {
  PreparedLog prepared;
  prepared.given = setup.config;
  const std::int64_t files = std::ssize(log.names), drawn = std::max(1, options.draw);
  const std::int64_t most =
      std::clamp(detail::kKeptOfLog / std::max(std::int64_t{1}, files), std::int64_t{1}, drawn);
  std::vector<detail::FileContent> contents;
  bool keeps = true;
  for (int file = 0; file < files; ++file) {
    std::vector<Sample> samples = log.read(file);
    prepared.samples += std::ssize(samples);
    keeps = keeps && prepared.samples <= detail::kKeptOfLog;
    if (keeps) prepared.kept[file] = samples;
    contents.push_back(detail::content_of(std::move(samples), most));
  }
  if (!keeps) prepared.kept.clear();
  prepared.order = detail::order_of(contents, log.names);
  std::vector<detail::FileContent> ordered;
  for (const int file : prepared.order) {
    ordered.push_back(std::move(contents[static_cast<std::size_t>(file)]));
  }
  prepared.log = std::move(log);
  detail::Draw draw = detail::draw_of(std::move(ordered), drawn, prepared.samples);
  prepared.numbers = std::move(draw.numbers);
  setup.samples = std::move(draw.samples);
  CalibrationOptions of_draw = options;
  of_draw.exclude.clear();
  if (setup.config && !looks_before(*setup.config).empty()) {
    throw InputError(
        "error blocks that compare samples in succession take all samples at once: use "
        "'kinecal calibrate'");
  }
  prepared.draw = prepare(std::move(setup), of_draw);
  return prepared;
}

namespace detail {
namespace {

[[nodiscard]] CalibratedRobot calibrate(PreparedLog log, const CalibrationOptions& options) {
  CalibrationOptions of_draw = options;
  of_draw.exclude.clear();
  const bool is_whole = log.is_whole();
  CalibratedRobot calibrated = solve_and_judge(std::move(log.draw), of_draw);
  number(log, calibrated);
  if (!is_whole && calibrated.result.converged && !calibrated.assessments.empty()) {
    LogProcedure procedure(log, options, calibrated);
    procedure.check_files();
    take_all(procedure, calibrated);
  }
  explain(calibrated, of_draw);
  return calibrated;
}

}  // namespace
}  // namespace detail

CalibratedRobot calibrate_log(PreparedLog log, const CalibrationOptions& options) {
  return detail::as_input_error([&] { return detail::calibrate(std::move(log), options); });
}

}  // namespace kinecal
