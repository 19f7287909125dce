// Least trimmed squares: the fit of the share of poses that agree best.
//
// Bad captures that pull a fit towards them hide each other.  So fits start from few poses, drawn at random,
// and each is improved by concentration: fit the share of poses that was nearest, until they stay the same.
// Fits are of the linearized rows: a pose enters by its sums, and its distance is
//
//   |r + J z|^2 = c + 2 g^T z + z^T A z        A = J^T J, g = J^T r, c = r^T r of its rows
//
// Source: Rousseeuw, Van Driessen, Computing LTS Regression for Large Data Sets, 2006.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal::detail {

/// The rows of each pose as sums.
class PoseSums {
 public:
  PoseSums(const LinearFit& fit, const PoseGroups& poses)
      : all_(static_cast<std::size_t>(poses.count), Sums{fit.size()}) {
    for (const RowBlock& block : fit.blocks) {
      const int pose = poses.of_sample[static_cast<std::size_t>(block.sample)];
      Sums& of = all_[static_cast<std::size_t>(pose)];
      const auto w = fit.loss.segment(block.first, block.size);
      const auto r = fit.residual.segment(block.first, block.size);
      of += row_sums(fit, block, fit.loss, fit.residual);
      of.squares += w.dot(r.cwiseAbs2());
      of.rows += static_cast<double>(block.size);
    }
    for (std::size_t s = 0; s < all_.size(); ++s) {
      if (all_[s].rows > 0.0) measured_.push_back(s);
    }
    // Keeps steps of few poses finite, and moves nothing that all determine.
    constexpr double kRidge = 1e-6;
    ridge_ = kRidge * fit.prior_hessian;
    for (const Sums& of : all_) ridge_ += kRidge * of.information;
    ridge_.diagonal().array() +=
        1e-12 * ridge_.trace() / std::max(1.0, static_cast<double>(fit.size()));
  }

  /// The poses that have rows, by number.
  [[nodiscard]] const std::vector<std::size_t>& measured() const { return measured_; }
  /// Rows of a pose that has some, in the mean.
  [[nodiscard]] double rows() const {
    double sum = 0.0;
    for (const std::size_t s : measured_) sum += all_[s].rows;
    return sum / std::max<double>(1.0, static_cast<double>(measured_.size()));
  }

  /// The step (coordinates) to the least squares of some poses.
  template <class Iterator>
  [[nodiscard]] Eigen::VectorXd step(Iterator first, Iterator last) const {
    Eigen::MatrixXd a = ridge_;
    Eigen::VectorXd g = Eigen::VectorXd::Zero(a.rows());
    for (; first != last; ++first) {
      a += all_[*first].information;
      g += all_[*first].gradient;
    }
    return -Ldlt(a).solve(g);
  }
  /// Mean of the squared rows of a pose after a step.
  [[nodiscard]] double distance(std::size_t pose, const Eigen::VectorXd& z) const {
    const Sums& of = all_[pose];
    return (of.squares + z.dot(2.0 * of.gradient + of.information * z)) / of.rows;
  }

 private:
  struct Sums : RowSums {
    using RowSums::RowSums;
    double squares = 0.0, rows = 0.0;
  };
  std::vector<Sums> all_;
  std::vector<std::size_t> measured_;
  Eigen::MatrixXd ridge_;
};

/// A share of the poses and the mean square of their rows.
struct TrimmedFit {
  double mean = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> nearest;  ///< by number
};

/// Fits the nearest samples and takes those that are nearest then, `steps` times or until they stay.
/// @param nearest  any poses; their fit comes first
inline void concentrate(const PoseSums& sums, std::size_t share, int steps, TrimmedFit& fit) {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (int i = 0; i < steps; ++i) {
    const Eigen::VectorXd z = sums.step(fit.nearest.begin(), fit.nearest.end());
    by_distance.clear();
    for (const std::size_t s : sums.measured()) by_distance.emplace_back(sums.distance(s, z), s);
    const auto end = by_distance.begin() + static_cast<std::ptrdiff_t>(share);
    std::nth_element(by_distance.begin(), end - 1, by_distance.end());
    const double before = fit.mean;
    fit.mean = 0.0;
    fit.nearest.clear();
    for (auto at = by_distance.begin(); at != end; ++at) {
      fit.mean += at->first / static_cast<double>(share);
      fit.nearest.push_back(at->second);
    }
    constexpr double kStays = 1e-6;
    if (fit.mean >= (1.0 - kStays) * before) break;
  }
}

/// The step (coordinates) to the fit of the two thirds of the poses that agree best; zero if there are too few.
/// The same for poses in any order but for ties, as all draws are by rank of distance.
[[nodiscard]] inline Eigen::VectorXd least_trimmed_squares(const LinearFit& fit,
                                                           const PoseGroups& poses) {
  constexpr double kShare = 2.0 / 3.0, kWork = 2e7;  // operations
  constexpr std::size_t kBest = 4;
  constexpr int kFirst = 2, kToEnd = 20;
  const PoseSums sums(fit, poses);
  std::vector<std::size_t> order = sums.measured();
  const auto n = static_cast<double>(fit.size());
  const auto share =
      static_cast<std::size_t>(std::ceil(kShare * static_cast<double>(order.size())));
  const auto least = static_cast<std::size_t>(std::ceil(n / std::max(1.0, sums.rows()))) + 1;
  constexpr double kEnough =
      4.0;  // rows for each coordinate: with fewer, a share fits its own noise
  if (fit.size() == 0 || share < least || sums.rows() * static_cast<double>(share) < kEnough * n) {
    return Eigen::VectorXd::Zero(fit.size());
  }
  const Eigen::VectorXd here = Eigen::VectorXd::Zero(fit.size());
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sums.distance(a, here) < sums.distance(b, here);
  });
  std::vector<TrimmedFit> fits(1);
  fits[0].nearest.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(share));
  const double step = n * n * (static_cast<double>(order.size()) * (1.0 + kShare) + n / 6.0);
  const auto starts = static_cast<int>(std::clamp(kWork / (kFirst * step), 10.0, 200.0));
  std::mt19937 random(1);
  for (int i = 0; i < starts; ++i) {
    fits.emplace_back();
    std::vector<std::size_t> drawn = order;
    for (std::size_t k = 0; k < least; ++k) {
      std::swap(drawn[k], drawn[k + random() % (drawn.size() - k)]);
    }
    fits.back().nearest.assign(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(least));
  }
  for (TrimmedFit& each : fits) concentrate(sums, share, kFirst, each);
  const auto less = [](const TrimmedFit& a, const TrimmedFit& b) { return a.mean < b.mean; };
  const std::size_t best = std::min(kBest, fits.size());
  std::partial_sort(fits.begin(), fits.begin() + static_cast<std::ptrdiff_t>(best), fits.end(),
                    less);
  fits.resize(best);
  for (TrimmedFit& each : fits) concentrate(sums, share, kToEnd, each);
  const auto of = std::min_element(fits.begin(), fits.end(), less);
  return sums.step(of->nearest.begin(), of->nearest.end());
}

}  // namespace kinecal::detail
