// kinecal calibrate-log: recordings that do not fit into memory, file after file.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "checkpoints.hpp"
#include "commands.hpp"
#include "fit.hpp"
#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/config/choose_lenses.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/report.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/cameras/later_cameras.hpp"
#include "kinecal/trust/judge_shards.hpp"
#include "output.hpp"
#include "processes.hpp"
#include "robot_files.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

constexpr const char* kSums = "sums";  ///< folder of checkpoints, in that of the result

/// What is known of all files before the work begins.
struct LogContent {
  std::int64_t samples = 0;
  std::vector<std::int64_t> residuals;  ///< of each step, priors once per sample
  std::vector<FreeSet> free;            ///< of each step: what any file determines
  int doubts = 0;                       ///< about the files after the first
};

/// Size and some places of a file, or of all files of a folder: enough to see that it is another one, without
/// reading it all.
/// @param when  also when it was changed: an edit may be anywhere
std::string traits_of(const std::filesystem::path& path, bool when) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    std::set<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(path)) files.insert(file.path());
    std::string all;
    for (const std::filesystem::path& file : files) all += traits_of(file, when);
    return all;
  }
  constexpr std::streamoff kPlace = 16384, kPlaces = 16;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  std::string text = fmt::format("{} {} ", path.filename().string(), size);
  std::string place(static_cast<std::size_t>(std::clamp(size, std::streamoff{0}, kPlace)), '\0');
  for (std::streamoff i = 0; i < kPlaces; ++i) {
    const std::streamoff last = std::max(std::streamoff{0}, size - kPlace);
    file.seekg(last * i / (kPlaces - 1))
        .read(place.data(), static_cast<std::streamsize>(place.size()));
    text += sha256_text(place);
  }
  if (when) {
    text += fmt::format(" {}",
                        std::filesystem::last_write_time(path, error).time_since_epoch().count());
  }
  return text;
}

/// Each file once.
void check_files_differ(const std::vector<std::string>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      std::error_code missing;
      if (!std::filesystem::equivalent(files[i], files[k], missing)) continue;
      throw InputError(files[i] + ": is given twice, so its samples would count twice");
    }
  }
}

/// Numbers behind one another: how many, then these.
void append(const std::vector<double>& numbers, std::string& bytes) {
  const auto count = static_cast<double>(numbers.size());
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}
/// The first of them, which it removes.
std::vector<double> take(std::string_view& bytes) {
  double count = 0.0;
  std::memcpy(&count, bytes.data(), sizeof count);
  std::vector<double> numbers(static_cast<std::size_t>(count));
  if (!numbers.empty()) {
    std::memcpy(numbers.data(), bytes.data() + sizeof count, numbers.size() * sizeof(double));
  }
  bytes.remove_prefix((numbers.size() + 1) * sizeof(double));
  return numbers;
}

/// One run of one process.
class LogRun {
 public:
  LogRun(const ResultOptions& options, const Processes& processes)
      : options_(options), processes_(processes) {
    processes_.alike([&] { read_first(); });
    processes_.require_same(identity_of_input(false), "{one} reads other input files than {first}");
    checkpoints_.emplace(std::filesystem::path(options.output) / kSums, identity_of_input(true));
    try {
      content_ = check_files();
    } catch (const InputError&) {
      if (processes_.size() == 1) checkpoints_->forget_new();
      throw;
    }
  }

  /// Solves, assesses and judges.
  [[nodiscard]] Findings calibrate() {
    ShardedCalibration sharded{std::move(first_.calibration),
                               first_.samples,
                               options_.samples,
                               content_.samples,
                               content_.residuals,
                               content_.free,
                               [&](int file) { return samples_of(file); },
                               [&](const std::string& what, const NumbersOfShard& numbers_of) {
                                 return exchange(what, numbers_of);
                               }};
    ProcedureOptions procedure;
    procedure.solving.threads = options_.threads;
    procedure.doubts = first_.diagnostics.doubts;
    procedure.refutable = first_.diagnostics.refutable;
    if (content_.doubts > 0) {
      procedure.doubts.push_back(
          fmt::format("{} about other files, printed above",
                      counted(static_cast<std::size_t>(content_.doubts), "doubt")));
    }
    JudgedResult judged = calibrate_and_judge(sharded, procedure);
    first_.calibration = std::move(sharded.first);
    const std::string why =
        impossible_camera(first_.calibration, judged.result.table, first_.samples);
    if (judged.result.converged && !why.empty()) judged.judgement.add(Grade::do_not_use, why);
    Findings findings =
        findings_of(first_.robot, first_.calibration, std::move(judged), first_.samples);
    findings.images = images_of(first_.config);
    findings.lenses = lenses_of(first_.config);
    findings.has_own_poses = !first_.config.per_sample.empty();
    return findings;
  }

  [[nodiscard]] const Input& first() const { return first_; }
  [[nodiscard]] const LogContent& content() const { return content_; }
  /// When there is a verdict.
  void forget_checkpoints() { checkpoints_->forget_all(); }

 private:
  [[nodiscard]] int files() const { return static_cast<int>(options_.samples.size()); }
  [[nodiscard]] int steps() const { return static_cast<int>(first_.config.steps.size()); }

  void read_first() {
    if (options_.output.empty()) throw InputError("--output is required");
    check_files_differ(options_.samples);
    check_results(options_);
    first_ = read(0);
    print_or_throw(first_.diagnostics);
    check_robot_files(options_, first_);
  }

  /// Numbers of all files: each process computes those of every n-th one, unless they are on disk.
  /// All are the same in each process, so each of them comes to the same result by itself.
  [[nodiscard]] std::vector<std::vector<double>> exchange(const std::string& what,
                                                          const NumbersOfShard& numbers_of) {
    processes_.require_same(sha256_text(what),
                            "{one} is at other values than {first}: their processors or libraries "
                            "differ, so they cannot share one calibration");
    std::string own;
    for (int file = processes_.rank(); file < files(); file += processes_.size()) {
      if (Interruption::is_asked()) {
        throw Interrupted(options_.output + ": run the same command again to go on");
      }
      std::optional<std::vector<double>> numbers = checkpoints_->find(what, file);
      if (!numbers) {
        numbers = numbers_of(file);
        checkpoints_->keep(what, file, *numbers);
      }
      append(*numbers, own);
    }
    std::vector<std::vector<double>> all(options_.samples.size());
    const std::vector<std::string> gathered = processes_.gather(own);
    for (std::size_t rank = 0; rank < gathered.size(); ++rank) {
      std::string_view rest = gathered[rank];
      for (std::size_t file = rank; file < all.size(); file += gathered.size()) {
        all[file] = take(rest);
      }
    }
    return all;
  }

  /// A file with all that is checked of it.
  [[nodiscard]] Input read(int file) const {
    InputOptions one = options_;
    one.samples = {options_.samples[static_cast<std::size_t>(file)]};
    one.is_part = files() > 1;
    if (file > 0) one.urdf_text = first_.urdf_text;  // bags that were split have it in the first
    return read_input(one, file > 0 ? &first_ : nullptr);
  }

  /// What makes sums those of this calibration.
  /// @param when  also when files were changed, which differs between nodes
  [[nodiscard]] std::string identity_of_input(bool when) const {
    std::string text = KINECAL_VERSION + first_.urdf_text + first_.config_text;
    text += fmt::format(" {}", static_cast<int>(options_.recorded));
    for (const std::string& joint : options_.hold) text += '\n' + joint;
    for (const std::string& camera : options_.cameras) {
      text += '\n' + camera.substr(0, camera.find('='));
      text += traits_of(camera.substr(camera.find('=') + 1), when);
    }
    for (const std::string& file : options_.samples) text += '\n' + traits_of(file, when);
    return sha256_text(text);
  }

  /// Samples, doubts, and for each step the residuals and the parameters that they determine.
  [[nodiscard]] std::vector<double> numbers_of_file(int file) const {
    std::optional<Input> other;
    if (file > 0) {
      other = read(file);
      print_or_throw(other->diagnostics);
      check_images(*other, file);
    }
    const Input& input = other ? *other : first_;
    std::vector<double> numbers = {static_cast<double>(input.samples.size()),
                                   static_cast<double>(input.diagnostics.doubts.size())};
    for (const CalibrationStep& step : input.calibration.steps) {
      numbers.push_back(step.problem->num_residuals());
      std::vector<double> freed(static_cast<std::size_t>(step.problem->table().size()), 0.0);
      for (const int p : step.free.parameters()) freed[static_cast<std::size_t>(p)] = 1.0;
      numbers.insert(numbers.end(), freed.begin(), freed.end());
    }
    return numbers;
  }

  /// Images are raw or rectified in all files.
  void check_images(const Input& other, int file) const {
    const auto here = detail::models_of(other.config), there = detail::models_of(first_.config);
    for (std::size_t i = 0; i < std::min(here.size(), there.size()); ++i) {
      if (here[i].image == there[i].image) continue;
      throw InputError(fmt::format(
          "{}: pixels of '{}' are those of {} images, but in {} of {} ones; write 'image' in the "
          "model",
          options_.samples[static_cast<std::size_t>(file)], here[i].name,
          here[i].image == ImageKind::raw ? "raw" : "rectified", options_.samples.front(),
          there[i].image == ImageKind::raw ? "raw" : "rectified"));
    }
  }

  [[nodiscard]] LogContent check_files() {
    const auto all = exchange("files", [&](int file) { return numbers_of_file(file); });
    LogContent content;
    const int size = first_.calibration.table.size();
    for (const std::vector<double>& of : all) {
      content.samples += static_cast<std::int64_t>(of[0]);
      if (&of != &all.front()) content.doubts += static_cast<int>(of[1]);
    }
    for (int step = 0; step < steps(); ++step) {
      const std::size_t at =
          2 + static_cast<std::size_t>(step) * (1 + static_cast<std::size_t>(size));
      const int priors = Prior::kRows * static_cast<int>(problem_of(step).priors().size());
      std::int64_t residuals = priors * content.samples;
      // In the order of the configuration; then what only other files determine.
      std::vector<int> free =
          first_.calibration.steps[static_cast<std::size_t>(step)].free.parameters();
      for (const std::vector<double>& of : all) {
        residuals += static_cast<std::int64_t>(of[at]) - priors;
        for (int p = 0; p < size; ++p) {
          const bool freed = of[at + 1 + static_cast<std::size_t>(p)] != 0.0;
          if (freed && std::find(free.begin(), free.end(), p) == free.end()) free.push_back(p);
        }
      }
      content.residuals.push_back(residuals);
      content.free.emplace_back(std::move(free), size);
    }
    return content;
  }

  [[nodiscard]] const AnyProblem& problem_of(int step) const {
    return *first_.calibration.steps[static_cast<std::size_t>(step)].problem;
  }

  [[nodiscard]] std::vector<Sample> samples_of(int file) const {
    Diagnostics diagnostics;
    std::vector<Sample> samples =
        read_recordings({options_.samples[static_cast<std::size_t>(file)]}, diagnostics).samples;
    for (const std::string& camera : options_.cameras) set_camera(samples, camera, diagnostics);
    if (options_.recorded == Recorded::before) {
      add_rising(rising_of(first_.urdf_text, first_.urdf), samples);
    }
    if (first_.decides_cameras) {
      (void)prepare_later_cameras(first_.robot, first_.config, first_.samples, samples,
                                  diagnostics);
    } else {
      Config same = first_.config;
      choose_lenses(same, samples, diagnostics);  // a given lens replaces that of camera_info
    }
    diagnostics.throw_if_errors();
    return samples;
  }

  const ResultOptions& options_;
  const Processes& processes_;
  Input first_;
  std::optional<Checkpoints> checkpoints_;
  LogContent content_;
};

/// Prints and writes what the first process has found.
int report(const ResultOptions& options, LogRun& run, const Findings& findings) {
  say("{}", summary_text(findings));
  std::fflush(stdout);
  const CalibrationResult& result = findings.result;
  if (findings.judgement.verdict == Grade::do_not_use) {
    run.forget_checkpoints();
    say(stderr, "error: calibration of step '{}' failed, no results written: {}\n",
        result.steps.empty() ? "" : result.steps.back().name, findings.judgement.reasons.front());
    return kNotUsable;
  }
  const Input& first = run.first();
  std::vector<OutputFile> all =
      output_files(first.robot, {first.urdf, first.urdf_text}, first.calibration, findings,
                   first.samples, file_options(options, first.robot));
  std::erase_if(all, [](const OutputFile& file) { return file.name == "residuals.csv"; });
  const std::string& calibrated = all.front().content;
  const RobotFiles others = robot_files(options, first, result.table, calibrated);
  OutputFolder folder(options.output);
  write(folder, with_copies(options, first, std::move(all)));
  write(others);
  run.forget_checkpoints();
  return kDone;
}

/// The calibration of one process, or of several.
int calibrate_log_in(const Processes& processes, const ResultOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Interruption interruption;
  LogRun run(options, processes);
  const Findings findings = run.calibrate();
  if (processes.rank() > 0) return kDone;
  const int code = report(options, run, findings);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  say("{} of {}, {:.3f} s: {}\n",
      counted(static_cast<std::size_t>(run.content().samples), "sample"),
      counted(options.samples.size(), "file"), taken.count(), solving_text(findings.result));
  return code;
}

}  // namespace

int calibrate_log(const ResultOptions& options) {
  const Processes processes;
  return processes.run([&] { return calibrate_log_in(processes, options); });
}

}  // namespace kinecal::cli
