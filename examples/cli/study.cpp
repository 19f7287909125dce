// kinecal study: how well the calibrations of a robot repeat.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "commands.hpp"
#include "interruption.hpp"
#include "kinecal/io/printable.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/report/checksum.hpp"
#include "progress.hpp"
#include "study_input.hpp"
#include "study_journal.hpp"
#include "study_tables.hpp"

namespace kinecal::cli {
namespace {

/// The files of a result.
constexpr const char *kTrials = "trials.csv", *kTables = "study.txt", *kJson = "study.json";

/// What makes two studies the same one.
std::string identity(const StudyOptions& options, const StudyInput& input,
                     const std::vector<int>& poses) {
  std::string text;
  for (const std::string& file : input.files) {
    if (std::filesystem::is_regular_file(file)) text += detail::read_text_file(file);
  }
  std::string counts;
  for (const int count : poses) counts += fmt::format(" {}", count);
  return fmt::format("study of {}: robots {}, repeats {}, poses{}, ruined {}, seed {}",
                     sha256_text(text), options.robots, options.repeats, counts, input.setup.ruined,
                     input.setup.seed);
}

std::vector<int> poses_of_study(const StudyOptions& options, std::size_t available) {
  std::vector<int> poses = options.poses.empty() ? std::vector{100, 50, 25} : options.poses;
  const int most = static_cast<int>(available);
  for (int& count : poses) {
    if (count <= most) continue;
    if (!options.poses.empty()) {
      fmt::print(stderr, "warning: --poses: {} are asked for, the camera sees the target in {}\n",
                 count, most);
    }
    count = most;
  }
  std::sort(poses.rbegin(), poses.rend());
  poses.erase(std::unique(poses.begin(), poses.end()), poses.end());
  return poses;
}

/// All jobs of one robot.
std::vector<StudyJob> jobs_of(const StudyOptions& options, const std::vector<int>& poses,
                              int robot) {
  std::vector<StudyJob> jobs;
  for (const int count : poses) {
    for (int repeat = 0; repeat < options.repeats; ++repeat) jobs.push_back({robot, count, repeat});
  }
  return jobs;
}

/// Runs all jobs that are not done, on several threads.
class StudyRun {
 public:
  StudyRun(const StudyOptions& options, const StudyInput& input, const std::vector<int>& poses,
           StudyTrials done, StudyJournal* journal)
      : options_(options),
        input_(input),
        poses_(poses),
        trials_(std::move(done)),
        journal_(journal),
        robots_(static_cast<std::size_t>(options.robots)),
        before_(robots_.size()) {}

  void run() {
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    const int threads = options_.threads > 0 ? options_.threads : static_cast<int>(cores);
    slices_ = options_.robots < threads ? threads : 1;
    meter_ = line_.meter();
    std::vector<std::thread> workers;
    for (int i = 1; i < threads; ++i) workers.emplace_back([this] { work(); });
    work();
    for (std::thread& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
  }

  [[nodiscard]] const StudyTrials& trials() const { return trials_; }
  /// Robots, by number; those without jobs were not made.
  [[nodiscard]] const std::vector<StudyRobot>& robots() const { return robots_; }
  [[nodiscard]] const std::vector<double>& before() const { return before_; }

 private:
  void work() {
    while (!Interruption::is_asked() && !failed_) {
      const int item = next_++;
      if (item >= options_.robots * slices_) return;
      try {
        study(item / slices_, item % slices_);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        error_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  /// Every so many jobs of a robot.
  void study(int number, int slice) {
    const StudyRobot robot = study_robot(input_.setup, number);
    const double before = error_before(input_.setup, robot);
    const std::vector<StudyJob> jobs = jobs_of(options_, poses_, number);
    for (auto i = static_cast<std::size_t>(slice); i < jobs.size();
         i += static_cast<std::size_t>(slices_)) {
      const StudyJob& job = jobs[i];
      if (Interruption::is_asked() || failed_) break;
      if (is_done(job)) continue;
      const StudyTrial trial = run_study_job(input_.setup, robot, job);
      if (journal_ != nullptr) journal_->add(trial);
      const std::lock_guard lock(mutex_);
      trials_[job] = trial;
      show();
    }
    const std::lock_guard lock(mutex_);
    before_[static_cast<std::size_t>(number)] = before;
    robots_[static_cast<std::size_t>(number)] = robot;
    constexpr int kKept = 20;  // of more, only the truth is kept
    if (number >= kKept) robots_[static_cast<std::size_t>(number)].samples.clear();
  }

  [[nodiscard]] bool is_done(const StudyJob& job) {
    const std::lock_guard lock(mutex_);
    return trials_.contains(job);
  }

  void show() {
    const double all = static_cast<double>(options_.robots) * static_cast<double>(poses_.size()) *
                       options_.repeats;
    if (meter_) meter_(static_cast<double>(trials_.size()) / all, "calibrating");
  }

  const StudyOptions& options_;
  const StudyInput& input_;
  const std::vector<int>& poses_;
  StudyTrials trials_;
  StudyJournal* journal_;
  std::vector<StudyRobot> robots_;
  std::vector<double> before_;
  ProgressLine line_;
  ProgressMeter meter_;
  std::mutex mutex_;
  std::atomic<int> next_ = 0;
  int slices_ = 1;  ///< into which the jobs of a robot are divided
  std::atomic<bool> failed_ = false;
  std::exception_ptr error_;
};

StudyResult result_of(const StudyOptions& options, const StudyInput& input,
                      const std::vector<int>& poses, const StudyRun& run) {
  StudyResult result;
  result.jobs = static_cast<std::size_t>(options.robots) * poses.size() *
                static_cast<std::size_t>(options.repeats);
  result.done = run.trials().size();
  result.limit = options.limit;
  std::vector<StudyTrial> trials;
  double seconds = 0.0, solves = 0.0;
  for (const auto& [job, trial] : run.trials()) {
    if (run.robots()[static_cast<std::size_t>(job.robot)].truth.empty()) continue;
    trials.push_back(trial);
    seconds += trial.seconds;
    solves += trial.solves;
  }
  result.solves_per_second = seconds > 0.0 ? solves / seconds : 0.0;
  result.before = run.before();
  result.groups = summarize(input.setup, run.robots(), trials, options.limit);
  for (StudyGroup& group : result.groups) {
    const StudyRobot& robot = run.robots()[static_cast<std::size_t>(group.robot)];
    if (robot.samples.empty()) continue;
    std::vector<StudyTrial> of_group;
    for (const StudyTrial& trial : trials) {
      if (trial.job.robot == group.robot && trial.job.poses == group.poses) {
        of_group.push_back(trial);
      }
    }
    predict(input.setup, robot, of_group, group);
  }
  return result;
}

}  // namespace

int study(const StudyOptions& options) {
  const std::filesystem::path folder = options.output;
  if (!options.output.empty() && !options.force && std::filesystem::exists(folder / kJson)) {
    throw OutputError(folder.string() +
                      ": has a study already; use --force to replace it, or choose another folder");
  }
  const int most =
      options.poses.empty() ? 100 : *std::max_element(options.poses.begin(), options.poses.end());
  const std::unique_ptr<StudyInput> input = read_study(options, most);
  if (options.ruined >= 0.0) input->setup.ruined = options.ruined;
  input->keep_ruined = !(input->setup.ruined > 0.0);
  const std::vector<int> poses = poses_of_study(options, input->samples.size());
  std::optional<OutputFolder> output;
  std::optional<StudyJournal> journal;
  StudyTrials done;
  if (!options.output.empty()) {
    output.emplace(folder);
    if (options.force) StudyJournal::remove(folder);
    journal.emplace(folder, identity(options, *input, poses), 0);
    done = journal->read();
    if (!done.empty()) fmt::print(stderr, "note: {} calibrations were done before\n", done.size());
  }
  const Interruption interruption;
  StudyRun run(options, *input, poses, std::move(done), journal ? &*journal : nullptr);
  run.run();
  const StudyResult result = result_of(options, *input, poses, run);
  const std::string text = study_text(*input, result);
  fmt::print("{}", printable(text));
  if (result.solves_per_second > 0.0) {
    fmt::print("{:.0f} solves per second and core\n", result.solves_per_second);
  }
  if (output && result.done == result.jobs) {
    std::string lines = trial_columns(free_names(*input)) + "\n";
    for (const auto& [job, trial] : run.trials()) lines += trial_line(trial) + "\n";
    output->write({{kTrials, lines}, {kTables, text}, {kJson, study_json(*input, result)}});
    StudyJournal::remove(folder);
  } else if (output) {
    fmt::print("{}: run the same command again to go on\n", folder.string());
  }
  return Interruption::is_asked() ? kInterrupted : kDone;
}

}  // namespace kinecal::cli
