// kinecal study: how well the calibrations of a robot repeat.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>

#include "commands.hpp"
#include "interruption.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "output_file.hpp"
#include "processes.hpp"
#include "progress.hpp"
#include "study_input.hpp"
#include "study_journal.hpp"
#include "study_page.hpp"
#include "study_tables.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The files of a result.
constexpr const char *kTrials = "trials.csv", *kTables = "study.txt", *kJson = "study.json";

/// What makes two studies the same one.
std::string identity(const StudyOptions& options, const StudyInput& input,
                     const std::vector<int>& poses) {
  std::string text;
  for (const auto& [role, file] : input.files) {
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
      say(stderr, "warning: --poses: {} are asked for, the camera sees the target in {}\n", count,
          most);
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

/// Runs the jobs of this process, but those that were done before, on several threads.
class StudyRun {
 public:
  StudyRun(const StudyOptions& options, const StudyInput& input, const std::vector<int>& poses,
           const Processes& processes, StudyTrials done, StudyJournal* journal)
      : options_(options),
        input_(input),
        poses_(poses),
        processes_(processes),
        done_(std::move(done)),
        journal_(journal) {}

  void run() {
    const int cores = processes_.size() > 1
                          ? 1
                          : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const int threads = options_.threads > 0 ? options_.threads : cores;
    const int workers_in_all = threads * processes_.size();
    slices_ = options_.robots < workers_in_all ? workers_in_all : 1;
    if (processes_.rank() == 0) meter_ = line_.meter();
    std::vector<std::thread> workers;
    for (int i = 1; i < threads; ++i) workers.emplace_back([this] { work(); });
    work();
    for (std::thread& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
  }

  /// The trials of this process's jobs.
  [[nodiscard]] const StudyTrials& trials() const { return trials_; }

 private:
  void work() {
    while (!Interruption::is_asked() && !failed_) {
      const int item = processes_.rank() + processes_.size() * next_++;
      if (item / slices_ >= options_.robots) return;
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
    std::optional<StudyRobot> robot;
    const std::vector<StudyJob> jobs = jobs_of(options_, poses_, number);
    for (auto i = static_cast<std::size_t>(slice); i < jobs.size();
         i += static_cast<std::size_t>(slices_)) {
      const StudyJob& job = jobs[i];
      if (Interruption::is_asked() || failed_) return;
      const auto done = done_.find(job);
      std::optional<StudyTrial> trial;
      if (done != done_.end()) trial = done->second;
      if (!trial) {
        if (!robot) robot = study_robot(input_.setup, number);
        trial = run_study_job(input_.setup, *robot, job);
        if (journal_ != nullptr) journal_->add(*trial);
      }
      const std::lock_guard lock(mutex_);
      trials_[job] = *std::move(trial);
      show();
    }
  }

  void show() {
    const double all = static_cast<double>(options_.robots) * static_cast<double>(poses_.size()) *
                       options_.repeats / processes_.size();
    if (meter_) {
      meter_(std::min(1.0, static_cast<double>(trials_.size()) / all), "calibrating");
    }
  }

  const StudyOptions& options_;
  const StudyInput& input_;
  const std::vector<int>& poses_;
  const Processes& processes_;
  const StudyTrials done_;  ///< in an earlier run
  StudyTrials trials_;
  StudyJournal* journal_;
  ProgressLine line_;
  ProgressMeter meter_;
  std::mutex mutex_;
  std::atomic<int> next_ = 0;
  int slices_ = 1;  ///< into which the jobs of a robot are divided
  std::atomic<bool> failed_ = false;
  std::exception_ptr error_;
};

/// The trials of all processes, in the first of them.
StudyTrials trials_of_all(const Processes& processes, const StudyTrials& own) {
  if (processes.size() == 1) return own;
  std::string lines;
  for (const auto& [job, trial] : own) lines += journal_line(trial);
  StudyTrials all;
  for (const std::string& of_one : processes.gather_in_first(lines)) read_journal(of_one, all);
  return all;
}

std::size_t number_of_jobs(const StudyOptions& options, const std::vector<int>& poses) {
  return static_cast<std::size_t>(options.robots) * poses.size() *
         static_cast<std::size_t>(options.repeats);
}

/// The trials of a group.
std::vector<StudyTrial> trials_of(const std::vector<StudyTrial>& trials, const StudyGroup& group) {
  std::vector<StudyTrial> of_group;
  std::copy_if(trials.begin(), trials.end(), std::back_inserter(of_group),
               [&](const StudyTrial& trial) {
                 return trial.job.robot == group.robot && trial.job.poses == group.poses;
               });
  return of_group;
}

StudyResult result_of(const StudyOptions& options, const StudyInput& input,
                      const std::vector<int>& poses, const StudyTrials& trials_by_job) {
  StudyResult result;
  result.jobs = number_of_jobs(options, poses);
  result.done = trials_by_job.size();
  const double usual = unit_of_study(input) == "px" ? 1.0 : 3e-3;
  result.limit = options.limit > 0.0 ? options.limit : usual;
  std::vector<StudyTrial> trials;
  double seconds = 0.0, solves = 0.0;
  for (const auto& [job, trial] : trials_by_job) {
    trials.push_back(trial);
    seconds += trial.seconds;
    solves += trial.solves;
  }
  result.solves_per_second = seconds > 0.0 ? solves / seconds : 0.0;
  std::vector<StudyRobot> robots;
  for (int number = 0; number < options.robots; ++number) {
    robots.push_back({number, study_truth(input.setup, number), {}});
    result.before.push_back(error_before(input.setup, robots.back().truth));
  }
  result.groups = summarize(input.setup, robots, trials, result.limit);
  const bool ruined = std::any_of(result.groups.begin(), result.groups.end(),
                                  [](const StudyGroup& group) { return group.ruined > 0; });
  if (systematic_error(result) > result.limit && !ruined) {
    constexpr double kNothing = 1e-4;  // metres
    std::vector<int> all(input.setup.samples.size());
    std::iota(all.begin(), all.end(), 0);
    result.remaining = remaining_error(input, all, kNothing);
  }
  constexpr int kPredicted = 20;  // robots; nobody reads more
  for (StudyGroup& group : result.groups) {
    if (group.robot >= kPredicted) break;
    StudyRobot& robot = robots[static_cast<std::size_t>(group.robot)];
    if (robot.samples.empty()) robot = study_robot(input.setup, group.robot);
    predict(input.setup, robot, trials_of(trials, group), group);
  }
  return result;
}

/// Prints what was found, and writes it if all is done.
void report(const StudyOptions& options, const StudyInput& input, const std::vector<int>& poses,
            const StudyTrials& trials, OutputFolder* output) {
  const StudyResult result = result_of(options, input, poses, trials);
  const std::string text = study_text(input, result);
  say("{}", text);
  if (result.solves_per_second > 0.0) {
    say("{:.0f} solves per second and core\n", result.solves_per_second);
  }
  if (output != nullptr && result.done < result.jobs) {
    say("{}: run the same command again to go on\n", options.output);
    return;
  }
  if (!options.report.empty()) {
    write_output(options.report, study_page(input, result));
    say("{}\n", options.report);
  }
  if (output == nullptr) return;
  std::string lines = trial_columns(free_names(input)) + "\n";
  for (const auto& [job, trial] : trials) lines += trial_line(trial) + "\n";
  output->write({{kTrials, lines}, {kTables, text}, {kJson, study_json(input, result)}},
                options.force ? Existing::replaced : Existing::kept);
  StudyJournal::remove(options.output);
}

void check_options(const StudyOptions& options) {
  if (!options.report.empty()) {
    std::vector<std::string> inputs = {options.urdf, options.config, options.pose_file,
                                       options.scene};
    inputs.insert(inputs.end(), options.samples.begin(), options.samples.end());
    check_page(options.report, inputs, options.force);
  }
  if (options.output.empty() || options.force) return;
  if (std::filesystem::exists(std::filesystem::path(options.output) / kJson)) {
    throw OutputError(options.output +
                      ": has a study already; use --force to replace it, or choose another folder");
  }
}

}  // namespace

namespace {

/// The study of one process, or of several.
int study_in(const Processes& processes, const StudyOptions& options) {
  std::unique_ptr<StudyInput> input;
  std::vector<int> poses;
  std::optional<OutputFolder> output;
  processes.alike([&] {
    check_options(options);
    const int most =
        options.poses.empty() ? 100 : *std::max_element(options.poses.begin(), options.poses.end());
    input = read_study(options, most);
    if (input->is_of_surface) {
      throw InputError(
          "a study does not associate clouds and masks with the robot's surface, so it would be "
          "too "
          "good; simulate such robots with 'kinecal simulate --target robot --seed N', and "
          "calibrate each");
    }
    if (input->is_touched) {
      throw InputError(
          "a study simulates what a sensor measures, and a tip that touches something has none; "
          "'kinecal plan' says what poses give");
    }
    if (options.ruined >= 0.0) input->setup.ruined = options.ruined;
    input->setup.free_targets = options.free_targets;
    input->keep_ruined = !(input->setup.ruined > 0.0);
    poses = poses_of_study(options, input->samples.size());
    if (options.output.empty()) return;
    output.emplace(options.output);
    if (options.force && processes.rank() == 0) {  // an interrupted --force goes on
      StudyJournal::remove(options.output, identity(options, *input, poses));
    }
  });
  const std::string identity_of_study = identity(options, *input, poses);
  processes.require_same(identity_of_study, "{one} reads other input files than {first}");
  std::optional<StudyJournal> journal;
  StudyTrials done;
  if (output) {
    journal.emplace(options.output, identity_of_study, processes.rank());
    done = journal->read();
    (void)processes.gather("");  // nobody adds to a journal before all have read them
  }
  if (!done.empty() && processes.rank() == 0) {
    say(stderr, "note: {} calibrations were done before\n", done.size());
  }
  const Interruption interruption;
  StudyRun run(options, *input, poses, processes, std::move(done), journal ? &*journal : nullptr);
  run.run();
  if (Interruption::is_asked() && processes.size() > 1) {
    throw Interrupted(output ? options.output + ": run the same command again to go on"
                             : "stopped");
  }
  const StudyTrials trials = trials_of_all(processes, run.trials());
  if (processes.rank() == 0) {
    report(options, *input, poses, trials, output ? &*output : nullptr);
  }
  return Interruption::is_asked() ? kInterrupted : kDone;
}

}  // namespace

int study(const StudyOptions& options) {
  const Processes processes;
  return processes.run([&] { return study_in(processes, options); });
}

}  // namespace kinecal::cli
