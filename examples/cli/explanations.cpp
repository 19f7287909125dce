// SPDX-License-Identifier: Apache-2.0
#include "explanations.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/geometry/median.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal::cli {
namespace {

/// The columns of an explanation's parameters among the free ones.
std::vector<int> columns_of(const StudyInput& input, std::size_t explanation) {
  const std::vector<std::string> names = free_names(input);
  std::vector<int> columns;
  for (const std::string& name : input.explanations.at(explanation)) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) {
      throw InputError("--tell-apart: no pose here depends on '" + name + "'");
    }
    columns.push_back(static_cast<int>(at - names.begin()));
  }
  return columns;
}

/// What some poses say of both.
struct KnownExplanations {
  std::vector<double> deviations;  ///< of the parameters of the first, then of the second
  double correlation = 1.0;        ///< the largest size of one between them; 1: not determined
};

KnownExplanations known_by(const StudyInput& input, const PoseChoice& choice,
                           const std::vector<int>& chosen) {
  const ExpectedUncertainty expected =
      expected_uncertainty(choice.design, with_existing(choice, chosen));
  const Eigen::MatrixXd covariance = expected.covariance.matrix(),
                        deviation = expected.deviation.matrix();
  const std::vector<int> first = columns_of(input, 0), second = columns_of(input, 1);
  KnownExplanations known;
  for (const auto& columns : {first, second}) {
    for (const int c : columns) known.deviations.push_back(deviation(c));
  }
  const auto& all = known.deviations;
  if (!std::all_of(all.begin(), all.end(), [](double d) { return std::isfinite(d); })) return known;
  known.correlation = 0.0;
  for (const int a : first) {
    for (const int b : second) {
      const double size = std::sqrt(covariance(a, a) * covariance(b, b));
      known.correlation = std::max(known.correlation, std::abs(covariance(a, b)) / size);
    }
  }
  return known;
}

/// Medians of random sets of so many poses.
KnownExplanations known_by_random(const StudyInput& input, const PoseChoice& choice,
                                  std::size_t count) {
  constexpr int kSets = 51;
  std::vector<std::vector<double>> deviations;
  std::vector<double> correlations;
  SeededRandom random(1);
  const int all = static_cast<int>(choice.candidates.information.size());
  std::vector<int> order(static_cast<std::size_t>(all));
  std::iota(order.begin(), order.end(), 0);
  for (int set = 0; set < kSets; ++set) {
    for (std::size_t i = 0; i < count; ++i) {
      std::swap(order[i],
                order[static_cast<std::size_t>(random.integer(static_cast<int>(i), all - 1))]);
    }
    const KnownExplanations known = known_by(
        input, choice, {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count)});
    deviations.resize(known.deviations.size());
    for (std::size_t p = 0; p < deviations.size(); ++p) {
      deviations[p].push_back(known.deviations[p]);
    }
    correlations.push_back(known.correlation);
  }
  KnownExplanations median{{}, median_of(correlations)};
  for (const std::vector<double>& of : deviations) median.deviations.push_back(median_of(of));
  return median;
}

std::string deviation_text(double deviation, const std::string& unit) {
  return std::isfinite(deviation) ? "+- " + reading(deviation, unit) : "not determined";
}

/// Sets of poses by their number: own ones while a search is short, else the first of a large set.
class DecidingSets {
 public:
  DecidingSets(const StudyInput& input, const PoseChoice& choice, ProgressMeter meter)
      : input_(input), choice_(choice), meter_(std::move(meter)) {
    constexpr int kMost = 100;
    largest_ = selected(std::min(kMost, static_cast<int>(choice.candidates.information.size())));
  }

  [[nodiscard]] int most() const { return static_cast<int>(largest_.size()); }

  [[nodiscard]] std::vector<int> first(int count) const {
    return {largest_.begin(), largest_.begin() + count};
  }
  [[nodiscard]] double correlation(const std::vector<int>& chosen) const {
    if (chosen.empty() && choice_.have.empty()) return 1.0;
    return known_by(input_, choice_, chosen).correlation;
  }

  /// The smallest set below the limit; nullopt if every set is above it.
  [[nodiscard]] std::optional<std::vector<int>> fewest(double limit) const {
    int count = 0;
    while (count <= most() && correlation(first(count)) >= limit) ++count;
    if (count > most()) return std::nullopt;
    std::vector<int> best = first(count);
    while (!best.empty()) {
      std::vector<int> fewer = selected(static_cast<int>(best.size()) - 1);
      if (correlation(fewer) >= limit) break;
      best = std::move(fewer);
    }
    return best;
  }

 private:
  [[nodiscard]] std::vector<int> selected(int count) const {
    if (count == 0) return {};
    return kinecal::select_poses(choice_.candidates, {.count = count, .meter = meter_}).chosen;
  }

  const StudyInput& input_;
  const PoseChoice& choice_;
  ProgressMeter meter_;
  std::vector<int> largest_;  ///< the most useful first
};

}  // namespace

DecidingPoses deciding_poses(const StudyInput& input, const PoseChoice& choice,
                             const ProgressMeter& meter) {
  const DecidingSets sets(input, choice, meter);
  DecidingPoses found;
  const auto fewest = sets.fewest(kAlike);
  found.decide = fewest.has_value();
  found.chosen = fewest ? *fewest : sets.first(sets.most());
  found.correlation = sets.correlation(found.chosen);
  const std::string &a = input.explanations[0].front(), &b = input.explanations[1].front();
  TextTable table({choice.have.empty() ? "poses" : "more poses", "correlation", "random", a, b}, 0);
  std::set<int> counts = {3, 5, 8, 12, 20, 30, 50, 100};
  if (!found.chosen.empty()) counts.insert(static_cast<int>(found.chosen.size()));
  for (const int count : counts) {
    if (count > sets.most()) break;
    const bool is_found = count == static_cast<int>(found.chosen.size());
    const KnownExplanations known =
        known_by(input, choice, is_found ? found.chosen : sets.first(count));
    const KnownExplanations random =
        known_by_random(input, choice, static_cast<std::size_t>(count));
    const auto deviation = [&](const std::string& name, std::size_t at) {
      return deviation_text(known.deviations[at], input.calibration.table[name].unit);
    };
    table.add({std::to_string(count), fmt::format("{:.3f}", known.correlation),
               fmt::format("{:.3f}", random.correlation), deviation(a, 0),
               deviation(b, input.explanations[0].size())});
  }
  found.curve =
      "By number of poses; random: the correlation of as many random ones\n" + table.str();
  return found;
}

void choose_between(const StudyInput& input, PoseChoice& choice) {
  std::vector<int> columns = columns_of(input, 0);
  const std::vector<int> second = columns_of(input, 1);
  columns.insert(columns.end(), second.begin(), second.end());
  std::vector<int> all(choice.candidates.information.size());
  std::iota(all.begin(), all.end(), 0);
  const KnownExplanations known = known_by(input, choice, all);
  constexpr double kTheSame = 0.9999;  // of a correlation by all poses together
  if (known.correlation > kTheSame) {
    throw InputError(fmt::format(
        "--tell-apart: no pose tells '{}' and '{}' apart, beside what else is free: not even all "
        "{} "
        "together; a calibration with either is as good, so free the one that you can correct",
        input.explanations[0].front(), input.explanations[1].front(), counted(all.size(), "pose")));
  }
  choice.candidates.goal = goal_of_parameters(choice.candidates, columns);
}

std::string explanations_text(const StudyInput& input, const PoseChoice& choice,
                              const std::vector<int>& chosen) {
  const KnownExplanations known = known_by(input, choice, chosen),
                          random = known_by_random(input, choice, chosen.size());
  const bool has_more = !choice.have.empty();
  std::vector<std::string> head = {"", "these poses", "as many random ones"};
  if (has_more) head.push_back("none of them");
  const KnownExplanations before =
      has_more ? known_by(input, choice, {}) : KnownExplanations{known.deviations, 1.0};
  TextTable table(head);
  std::size_t at = 0;
  for (const auto& names : input.explanations) {
    for (const std::string& name : names) {
      const std::string& unit = input.calibration.table[name].unit;
      std::vector<std::string> row = {name, deviation_text(known.deviations[at], unit),
                                      deviation_text(random.deviations[at], unit)};
      if (has_more) row.push_back(deviation_text(before.deviations[at], unit));
      table.add(row);
      ++at;
    }
  }
  std::vector<std::string> row = {"correlation", fmt::format("{:.3f}", known.correlation),
                                  fmt::format("{:.3f}", random.correlation)};
  if (has_more) row.push_back(fmt::format("{:.3f}", before.correlation));
  table.add(row);
  return fmt::format(
             "{} of {} selected, which tell '{}' and '{}' apart{}\n\n", chosen.size(),
             counted(choice.candidates.information.size(), "pose"), input.explanations[0].front(),
             input.explanations[1].front(),
             has_more ? fmt::format(", with your {}", counted(choice.have.size(), "sample")) : "") +
         table.str() + "\n";
}

}  // namespace kinecal::cli
