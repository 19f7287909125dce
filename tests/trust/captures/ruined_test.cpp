#include "kinecal/trust/captures/ruined.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "support/repetitions.hpp"
#include "support/simulated.hpp"

namespace kinecal {
namespace {

using test::Simulated;

/// A fit of some of the samples.
struct SomeFit {
  std::vector<int> numbers;  ///< of the samples that it uses, ascending
  CalibrationResult result;
  Assessment found;
};

SomeFit fit_some(const Simulated& simulated, const std::vector<Sample>& all,
                 const std::set<int>& left_out) {
  SomeFit fit;
  std::vector<Sample> used;
  for (int i = 0; i < static_cast<int>(all.size()); ++i) {
    if (left_out.contains(i)) continue;
    fit.numbers.push_back(i);
    used.push_back(all[static_cast<std::size_t>(i)]);
  }
  const Calibration calibration = simulated.calibration(used);
  SolveOptions solving;
  solving.threads = 1;
  fit.result = calibrate(calibration, {}, solving);
  EXPECT_TRUE(fit.result.converged) << fit.result.termination;
  fit.found = assess(calibration, fit.result, used, {.folds = 0}).back();
  return fit;
}

/// By the rule: the last fit, and which samples it leaves out.
std::pair<SomeFit, std::set<int>> fit_by_the_rule(const Simulated& simulated,
                                                  const std::vector<Sample>& samples) {
  std::set<int> left_out;
  const auto again = [&] { return fit_some(simulated, samples, left_out); };
  const auto last = [](const SomeFit& fit) { return &fit.found; };
  const auto leave_out = [&](const SomeFit& fit, const std::vector<CaptureError>& ruined) {
    for (const CaptureError& error : ruined) {
      left_out.insert(fit.numbers[static_cast<std::size_t>(error.sample)]);
    }
  };
  SomeFit fit = fit_without_ruined(again, last, leave_out);
  return {std::move(fit), std::move(left_out)};
}

/// Samples that are left out, or in the fit and named as bad.
std::set<int> named(const SomeFit& fit, std::set<int> left_out) {
  for (const CaptureError& error : fit.found.captures) {
    if (error.bad) left_out.insert(fit.numbers[static_cast<std::size_t>(error.sample)]);
  }
  return left_out;
}

/// Ruins ten samples: two LEDs exchanged, an LED 5 cm off, moved while capturing, in turn.
std::set<int> ruin_ten(std::vector<Sample>& samples, test::Chance& chance) {
  std::set<int> ruined;
  while (ruined.size() < 10) {
    const auto n = static_cast<int>(chance(0.0, static_cast<double>(samples.size())));
    if (!ruined.insert(n).second) continue;
    Sample& sample = samples[static_cast<std::size_t>(n)];
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      const auto led = static_cast<std::size_t>(chance(0.0, 4.0));
      if (ruined.size() % 3 == 0) {
        std::swap(seen.features[led].point, seen.features[(led + 1) % 4].point);
      } else if (ruined.size() % 3 == 1) {
        seen.features[led].point += 0.05 * (chance.rotation() * Vector3<double>(1, 0, 0));
      }
    }
    if (ruined.size() % 3 != 2) continue;
    for (double& position : sample.joint_positions) {
      const double moved = chance(-0.03, 0.03);
      position += moved + std::copysign(0.02, moved);
    }
  }
  return ruined;
}

/// The largest change of a parameter, in its standard deviations.
double largest_change(const SomeFit& fit, const SomeFit& clean) {
  double largest = 0.0;
  for (const int p : fit.found.parameters) {
    const double change = std::abs(fit.result.table[p].value - clean.result.table[p].value);
    largest = std::max(largest, change / *clean.found.deviation(p));
  }
  return largest;
}

std::set<int> only_in(const std::set<int>& a, const std::set<int>& b) {
  std::set<int> difference;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(),
                      std::inserter(difference, difference.end()));
  return difference;
}

TEST(Ruined, TenOfAHundredSamplesOfTheFetchAreLeftOutAndNoOther) {
  const Simulated fetch = test::fetch_and_leds(100);
  const int repetitions = test::repetitions_of_study(200, test::kIsSlow ? 6 : 60);
  int perfect = 0, near_clean = 0, near_unspoiled = 0, clean_near_unspoiled = 0;
  std::size_t clean_named = 0, clean_left_out = 0, missed = 0;
  for (int n = 0; n < repetitions; ++n) {
    std::vector<Sample> samples = fetch.samples(static_cast<std::uint64_t>(n) + 5000);
    const SomeFit unspoiled = fit_some(fetch, samples, {});
    test::Chance chance(static_cast<std::uint64_t>(n) + 9000);
    const std::set<int> ruined = ruin_ten(samples, chance);
    const SomeFit clean = fit_some(fetch, samples, ruined);
    const auto [fit, left_out] = fit_by_the_rule(fetch, samples);
    const std::set<int> all = named(fit, left_out);
    perfect += all == ruined ? 1 : 0;
    clean_named += only_in(all, ruined).size();
    clean_left_out += only_in(left_out, ruined).size();
    missed += only_in(ruined, all).size();
    near_clean += largest_change(fit, clean) <= 1.2 ? 1 : 0;
    near_unspoiled += largest_change(fit, unspoiled) <= 1.2 ? 1 : 0;
    clean_near_unspoiled += largest_change(clean, unspoiled) <= 1.2 ? 1 : 0;
  }
  std::printf(
      "%d repetitions with 10 of 100 samples ruined: %d perfect; clean samples: %zu named, "
      "%zu left out; ruined ones: %zu missed; all parameters within 1.2 sigma of the fit of "
      "the 90 clean samples: %d, of the fit of all 100 before they were ruined: %d (the fit of the "
      "90: %d)\n",
      repetitions, perfect, clean_named, clean_left_out, missed, near_clean, near_unspoiled,
      clean_near_unspoiled);
  RecordProperty("repetitions", repetitions);
  RecordProperty("perfect", perfect);
  // Rarely the joints move so that all LEDs stay within the noise, and a clean data set has a feature
  // beyond the limit once in 1000: 99 of 100 data sets are found perfectly.  By chance, but for once in
  // 1000 times, at least 192 of 200 are, 56 of 60; of 6 at least 4, which finds only a broken rule.
  EXPECT_GE(perfect, test::binomial_band(repetitions, 0.99, 1e-3).least);
  EXPECT_EQ(near_clean, repetitions);
  // Leaving ten samples out moves parameters, too.
  EXPECT_GE(near_unspoiled, clean_near_unspoiled - (repetitions - perfect));
}

TEST(Ruined, AreTheSameInAnyOrderOfTheSamples) {
  const Simulated fetch = test::fetch_and_leds(100);
  std::vector<Sample> samples = fetch.samples(77);
  test::Chance chance(78);
  const std::set<int> ruined = ruin_ten(samples, chance);
  const auto [fit, left_out] = fit_by_the_rule(fetch, samples);
  EXPECT_EQ(left_out, ruined);
  std::vector<Sample> shuffled;
  std::set<int> ruined_there;
  constexpr int kStep = 37;  // prime to 100: each sample once
  for (int n = 0; n < 100; ++n) {
    const int from = (n * kStep + 11) % 100;
    shuffled.push_back(samples[static_cast<std::size_t>(from)]);
    if (ruined.contains(from)) ruined_there.insert(n);
  }
  const auto [again, left_out_there] = fit_by_the_rule(fetch, shuffled);
  EXPECT_EQ(left_out_there, ruined_there);
  for (const int p : fit.found.parameters) {
    const Parameter& one = fit.result.table[p];
    EXPECT_NEAR(again.result.table[p].value, one.value, 1e-9 * std::abs(one.value)) << one.name;
    EXPECT_NEAR(*again.found.deviation(p), *fit.found.deviation(p), 1e-6 * *fit.found.deviation(p));
  }
}

TEST(Ruined, NoneWhereNoneIsRuined) {
  const Simulated fetch = test::fetch_and_leds(100);
  EXPECT_THAT(fit_by_the_rule(fetch, fetch.samples(3)).second, testing::IsEmpty());
}

/// Captures of which some are off by some times the limit.
Assessment with_errors(int samples, int off, double times) {
  Assessment found;
  for (int n = 0; n < samples; ++n) {
    CaptureError error;
    error.sample = n;
    error.limit = 6.0;
    error.times = n < off ? times * error.limit : 1.0;
    error.bad = error.times > error.limit;
    found.captures.push_back(error);
  }
  return found;
}

TEST(Ruined, AreOffByMoreThanTheLimit) {
  EXPECT_THAT(ruined_captures(with_errors(20, 3, 0.9)), testing::IsEmpty());
  EXPECT_THAT(ruined_captures(with_errors(20, 3, 1.1)), testing::SizeIs(3));
}

TEST(Ruined, NoneIsLeftOutWhereRatherTheModelIsWrong) {
  EXPECT_THAT(ruined_captures(with_errors(20, 5, 10.0)), testing::SizeIs(5));
  EXPECT_THAT(ruined_captures(with_errors(20, 6, 10.0)), testing::IsEmpty());
}

}  // namespace
}  // namespace kinecal
