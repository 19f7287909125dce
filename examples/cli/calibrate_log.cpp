// kinecal calibrate-log: recordings that do not fit into memory, file after file.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/calibrate_log.hpp"

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
#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/files/cameras/set_camera.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/report.hpp"
#include "kinecal/text/counted.hpp"
#include "output.hpp"
#include "processes.hpp"
#include "report.hpp"
#include "robot_files.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

constexpr const char* kSums = "sums";  ///< folder of checkpoints, in that of the result

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
  LogRun(const LogOptions& options, const Processes& processes)
      : options_(options), processes_(processes) {
    processes_.alike([&] { read_texts(); });
    processes_.require_same(identity_of_input(false), "{one} reads other input files than {first}");
    checkpoints_.emplace(std::filesystem::path(options.output) / kSums, identity_of_input(true));
  }

  /// Solves, assesses and judges.
  [[nodiscard]] CalibratedRobot calibrate() {
    CalibrationOptions calibrating = calibration_options(options_);
    calibrating.solving.threads = options_.threads;
    calibrating.draw = options_.draw;
    try {
      PreparedLog log;
      processes_.alike([&] {
        log = prepare_log(std::move(input_.setup), recorded_log(), calibrating);
        print_or_throw(log.draw.diagnostics);
        check_robot_files(options_, log.draw.robot, input_.texts);
        judge_files_of(options_, log.draw.robot, calibrating);
      });
      samples_ = log.samples;
      return kinecal::calibrate_log(std::move(log), calibrating);
    } catch (const InputError&) {
      if (processes_.size() == 1) checkpoints_->forget_new();
      throw;
    }
  }

  [[nodiscard]] const InputTexts& texts() const { return input_.texts; }
  /// Samples of all files.
  [[nodiscard]] std::int64_t samples() const { return samples_; }
  /// When there is a verdict.
  void forget_checkpoints() { checkpoints_->forget_all(); }

 private:
  [[nodiscard]] int files() const { return static_cast<int>(options_.samples.size()); }

  void read_texts() {
    if (options_.output.empty()) throw InputError("--output is required");
    check_files_differ(options_.samples);
    check_results(options_);
    check_reports(options_);
    input_ = read_files(options_, false);
    print_or_throw(input_.diagnostics);
  }

  [[nodiscard]] RecordedLog recorded_log() {
    return {.names = options_.samples,
            .read = [this](int file) { return samples_of(file); },
            .exchange =
                [this](const std::string& what, const NumbersOfShard& numbers_of) {
                  return exchange(what, numbers_of);
                }};
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
      check_interruption();
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

  void check_interruption() const {
    if (!Interruption::is_asked()) return;
    throw Interrupted(options_.output + ": run the same command again to go on");
  }

  /// The samples of a file, with the cameras of the options; what its reader notes is printed once.
  [[nodiscard]] std::vector<Sample> samples_of(int file) {
    check_interruption();
    Diagnostics diagnostics;
    std::vector<Sample> samples =
        read_recordings({options_.samples[static_cast<std::size_t>(file)]}, diagnostics).samples;
    for (const std::string& camera : options_.cameras) set_camera(samples, camera, diagnostics);
    if (!is_read_.insert(file).second || processes_.rank() > 0) {
      diagnostics.throw_if_errors();
    } else {
      print_or_throw(diagnostics);
    }
    return samples;
  }

  /// What makes sums those of this calibration.
  /// @param when  also when files were changed, which differs between nodes
  [[nodiscard]] std::string identity_of_input(bool when) const {
    std::string text = KINECAL_VERSION + input_.texts.urdf_text + input_.texts.config_text;
    text += fmt::format(" {}", static_cast<int>(options_.recorded));
    for (const std::string& joint : options_.hold) text += '\n' + joint;
    for (const std::string& camera : options_.cameras) {
      text += '\n' + camera.substr(0, camera.find('='));
      text += traits_of(camera.substr(camera.find('=') + 1), when);
    }
    for (const std::string& file : options_.samples) text += '\n' + traits_of(file, when);
    return sha256_text(text);
  }

  const LogOptions& options_;
  const Processes& processes_;
  Input input_;
  std::optional<Checkpoints> checkpoints_;
  std::set<int> is_read_;  ///< files that were read once
  std::int64_t samples_ = 0;
};

/// Prints and writes what the first process has found.
int report(const LogOptions& options, LogRun& run, CalibratedRobot& calibrated) {
  Findings& findings = calibrated;
  findings.call = {options.command, input_options(options), options.output, KINECAL_VERSION,
                   read_files(options, run.texts())};
  say("{}", summary_text(findings));
  std::fflush(stdout);
  write_reports(options, run.texts(), calibrated);
  if (!calibrated.is_usable()) {
    run.forget_checkpoints();
    say(stderr, "error: calibration of step '{}' failed, no results written: {}\n",
        findings.result.steps.empty() ? "" : findings.result.steps.back().name,
        findings.judgement.reasons.front());
    return kNotUsable;
  }
  const Robot& robot = calibrated.setup.robot;
  std::vector<OutputFile> all = files_of(options, run.texts(), calibrated);
  std::erase_if(all, [](const OutputFile& file) { return file.name == "residuals.csv"; });
  const RobotFiles others =
      robot_files(options, robot, run.texts(), findings.result.table, all.front().content);
  OutputFolder folder(options.output);
  write(folder, all, options.force);
  write(others);
  run.forget_checkpoints();
  return kDone;
}

/// The calibration of one process, or of several.
int calibrate_log_in(const Processes& processes, const LogOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Interruption interruption;
  LogRun run(options, processes);
  CalibratedRobot calibrated = run.calibrate();
  if (processes.rank() > 0) return kDone;
  const int code = report(options, run, calibrated);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  say("{} of {}, {:.3f} s: {}\n", counted(static_cast<std::size_t>(run.samples()), "sample"),
      counted(options.samples.size(), "file"), taken.count(), solving_text(calibrated.result));
  return code;
}

}  // namespace

int calibrate_log(const LogOptions& options) {
  const Processes processes;
  return processes.run([&] { return calibrate_log_in(processes, options); });
}

}  // namespace kinecal::cli
