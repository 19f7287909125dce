// How often 95 % intervals of parameters cover the truth, over simulated calibrations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/trust/assess.hpp"
#include "support/repetitions.hpp"

namespace kinecal::test {

/// Half the width of the 95 % interval in standard deviations: Student's t.
/// Source: Abramowitz, Stegun, Handbook of Mathematical Functions, 26.7.5.
inline double student(double freedom) {
  const double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4.0 * freedom) +
         (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom);
}

/// The assessment of a calibration with one step, without held-out errors.
inline Assessment assessment_of(const Calibration& calibration, const CalibrationResult& result,
                                const std::vector<Sample>& samples) {
  EXPECT_TRUE(result.converged) << result.termination;
  return assess(calibration, result, samples, {.folds = 0}).back();
}

/// Truth of a frame's parameter.
/// @param correction  from its origin
inline double of_frame(char axis, const Pose<double>& correction) {
  const std::size_t k = std::string("xyzabc").find(axis);
  return k < 3 ? correction.translation(static_cast<Eigen::Index>(k))
               : log(correction.rotation)(static_cast<Eigen::Index>(k - 3));
}

/// Counts the intervals of all parameters of several calibrations.
class IntervalCoverage {
 public:
  explicit IntervalCoverage(std::string name) : name_(std::move(name)) {}

  /// Counts one calibration.
  /// @param truth  the value of a parameter, by its name
  void add(const CalibrationResult& result, const Assessment& found,
           const std::function<double(const std::string&)>& truth) {
    double freedom = 0.0;
    for (const BlockNoise& noise : found.noise) freedom += noise.freedom;
    const double width = student(freedom);
    double hits = 0.0, intervals = 0.0;
    for (std::size_t c = 0; c < found.parameters.size(); ++c) {
      const Parameter& parameter = result.table[found.parameters[c]];
      const double deviation = found.uncertainty.deviation(static_cast<Eigen::Index>(c));
      ASSERT_TRUE(std::isfinite(deviation)) << parameter.name;
      const double z = (parameter.value - truth(parameter.name)) / deviation;
      const bool covers = std::abs(z) <= width;
      covered_[parameter.name] += covers ? 1 : 0;
      hits += covers ? 1.0 : 0.0;
      intervals += 1.0;
      farthest_ = std::max(farthest_, std::abs(z));
    }
    shares_.push_back(hits / intervals);
  }

  /// Checks the counts and prints them.
  /// @param may_exceed  intervals may be wider than they need to be
  void check(bool may_exceed = false) const {
    const auto n = static_cast<double>(shares_.size());
    ASSERT_GT(n, 1.0);
    const int runs = static_cast<int>(shares_.size());
    const Band band = binomial_band(runs, kShare, kTail);
    double mean = 0.0, square = 0.0;
    for (const double share : shares_) mean += share / n;
    for (const double share : shares_) square += (share - mean) * (share - mean);
    const double deviation = std::sqrt(square / (n * (n - 1.0)));
    int least = runs, most = 0;
    for (const auto& [name, covered] : covered_) {
      EXPECT_TRUE(band.contains(covered)) << name << ": " << covered << " of " << runs;
      least = std::min(least, covered);
      most = std::max(most, covered);
    }
    std::printf(
        "%s: %d calibrations, %zu parameters: %.2f +- %.2f %% of the 95 %% intervals cover the "
        "truth; "
        "a parameter %d to %d times (chance: %d to %d); the farthest %.1f standard deviations "
        "off\n",
        name_.c_str(), runs, covered_.size(), 100.0 * mean, 100.0 * deviation, least, most,
        band.least, band.most, farthest_);
    // All of an interval's calibrations may cover, which have no scatter: one miss is the resolution.
    const double resolution = 1.0 / (n * static_cast<double>(covered_.size()));
    if (!may_exceed || mean < kShare) {
      EXPECT_NEAR(mean, kShare, kSigmas * std::max(deviation, resolution));
    }
    EXPECT_LE(farthest_, kFarthest);
  }

 private:
  static constexpr double kShare = 0.95;
  static constexpr double kTail = 1e-5;     // of the count of a parameter
  static constexpr double kSigmas = 4.0;    // of a mean over the calibrations
  static constexpr double kFarthest = 5.5;  // once in 13 000 tests of 2000 intervals

  std::string name_;
  std::map<std::string, int> covered_;
  std::vector<double> shares_;  ///< of each calibration: of its intervals that cover the truth
  double farthest_ = 0.0;       ///< error, standard deviations
};

}  // namespace kinecal::test
