// Definitions of judge_input.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge_input.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Some of the samples.
struct SomeSamples {
  int count = 0;
  int first = 0;  ///< number of the first one

  void add(int sample) {
    if (count++ == 0) first = sample;
  }
  /// True for more than one sample of so many.
  [[nodiscard]] bool are_more_than_one_of(double so_many, int samples) const {
    return count * so_many > samples;
  }
};

/// What is left out of the samples of all steps.
class UnusedSamples {
 public:
  explicit UnusedSamples(const Calibration& calibration)
      : samples_(calibration.steps.front().problem->num_samples()) {
    std::set<std::string> sensors;
    for (const CalibrationStep& step : calibration.steps) {
      const AnyProblem& problem = *step.problem;
      if (problem.num_samples() != samples_) continue;  // of other samples
      problems_.push_back(&problem);
      for (const MountedSensor& sensor : problem.sensors()) sensors.insert(sensor.mount().name);
    }
    for (int i = 0; i < samples_; ++i) add(i, sensors);
  }

  /// Observations under a name that is nearly that of a sensor which the sample lacks.
  void judge_names(std::vector<std::string>& all, Judgement& judgement) const {
    constexpr double kSoMany = 10.0;
    for (const auto& [name, some] : misspelt_) {
      const std::string text = "'" + name.first + "' is observed in " + share(some) +
                               ", and is not a sensor of the calibration; did you mean '" +
                               name.second + "'?";
      all.push_back(text);
      if (some.are_more_than_one_of(kSoMany, samples_)) {
        judgement.add(Grade::use_with_care, text, {Remedy::Kind::mend});
      }
    }
  }
  /// Features that are not numbers, and samples that nothing uses for that reason.
  void judge_numbers(std::vector<std::string>& all, Judgement& judgement) const {
    constexpr double kSoMany = 4.0;
    for (const auto& [sensor, some] : not_numbers_) {
      all.push_back("features of sensor '" + sensor + "' are not numbers in " + share(some) +
                    "; they are left out");
    }
    if (without_numbers_.count == 0) return;
    const std::string text = share(without_numbers_) +
                             (without_numbers_.count == 1 ? " is" : " are") +
                             " left out: features are not numbers";
    all.push_back(text);
    if (without_numbers_.are_more_than_one_of(kSoMany, samples_)) {
      judgement.add(Grade::use_with_care, text, {Remedy::Kind::mend});
    }
  }
  /// @param is_known  a doubt about the input says so already
  void judge_copies(std::vector<std::string>& all, bool is_known, Judgement& judgement) const {
    constexpr double kSoMany = 50.0;
    if (copies_.count == 0) return;
    const bool all_of_them = copies_.count + 1 == samples_;
    const std::string text = all_of_them ? "all " + std::to_string(samples_) +
                                               " samples are the same one; record different poses"
                                         : share(copies_) +
                                               (copies_.count == 1 ? " is a copy" : " are copies") +
                                               " of others; " + std::string(kCopiesCountTwice);
    all.push_back(text);
    if (is_known || !copies_.are_more_than_one_of(kSoMany, samples_)) return;
    judgement.add(all_of_them ? Grade::do_not_use : Grade::use_with_care, text,
                  {all_of_them ? Remedy::Kind::record : Remedy::Kind::mend});
  }
  /// Samples that no error block compares for another reason: not all of its sensors observe something.
  void add_others(std::vector<std::string>& all) const {
    if (others_.count == 0) return;
    all.push_back(share(others_) + (others_.count == 1 ? " is" : " are") +
                  " compared by no error block: not all of its sensors observe something");
  }

 private:
  void add(int i, const std::set<std::string>& sensors) {
    bool is_used = false;
    std::vector<std::uint64_t> prints;
    std::set<std::string> not_numbers;
    std::set<std::pair<std::string, std::string>> misspelt;
    for (const AnyProblem* problem : problems_) {
      const UnusedInput& unused = problem->unused(i);
      is_used = is_used || problem->is_used(i);
      prints.push_back(problem->fingerprint(i));
      not_numbers.insert(unused.not_numbers.begin(), unused.not_numbers.end());
      for (const std::string& other : unused.others) {
        if (sensors.contains(other)) continue;  // of another step
        const std::optional<std::string> meant = nearest_name(other, unused.absent);
        if (meant) misspelt.insert({other, *meant});
      }
    }
    for (const auto& names : misspelt) misspelt_[names].add(i);
    for (const std::string& sensor : not_numbers) not_numbers_[sensor].add(i);
    if (is_used) {
      if (!prints_.insert(prints).second) copies_.add(i);
    } else if (misspelt.empty()) {
      (not_numbers.empty() ? others_ : without_numbers_).add(i);
    }
  }
  /// "30 of 40 samples (the first is samples.yaml:37)"
  [[nodiscard]] std::string share(const SomeSamples& some) const {
    return std::to_string(some.count) + " of " +
           counted(static_cast<std::size_t>(samples_), "sample") + " (the first is " +
           problems_.front()->source(some.first) + ")";
  }

  int samples_;
  std::vector<const AnyProblem*> problems_;                              ///< of the steps
  std::map<std::pair<std::string, std::string>, SomeSamples> misspelt_;  ///< by name and meant one
  std::map<std::string, SomeSamples> not_numbers_;                       ///< by sensor
  SomeSamples without_numbers_, others_, copies_;
  std::set<std::vector<std::uint64_t>> prints_;  ///< by step
};

}  // namespace
}  // namespace detail

std::vector<std::string> judge_input(const Calibration& calibration,
                                     const std::vector<std::string>& doubts, Judgement& judgement) {
  std::vector<std::string> all;
  if (calibration.steps.empty()) return all;
  const detail::UnusedSamples unused(calibration);
  unused.judge_names(all, judgement);
  unused.judge_numbers(all, judgement);
  const bool is_known = std::any_of(doubts.begin(), doubts.end(), [](const std::string& doubt) {
    return doubt.ends_with(kCopiesCountTwice);
  });
  unused.judge_copies(all, is_known, judgement);
  unused.add_others(all);
  return all;
}

}  // namespace kinecal
