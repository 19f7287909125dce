// Finding bad captures.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/captures/captures.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/captures/least_trimmed_squares.ipp"
#include "kinecal/trust/f_distribution.hpp"
#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"

namespace kinecal {

namespace detail {
namespace {

// Samples that are judged as a whole: those with poses of their own, and clouds on the surface of the robot.
//
// A sample with a pose of its own hardly moves the fit of the others; and single corners at the border of a wide lens are
// often off by many times the noise, so that a fit without these views would be a worse one.  Of the thousands of points of a
// cloud some are always far off: a cable, an edge.  So such a sample is judged by the root mean square of its residuals.  The
// floor under a robot may be many times farther than the noise, and is no fault of the cloud: no point counts more than six
// times the noise.

[[nodiscard]] bool judges_wholes(const AnyProblem& problem) {
  bool clouds = false;
  for (int t = 0; t < problem.num_terms(); ++t) {
    clouds = clouds || problem.term(t).is_of_surface();
  }
  return clouds || !problem.sample_poses().empty();
}

/// True for each sample whose residuals are four times those of a typical one.
/// @param sigma  noise of a weighted residual, by term
[[nodiscard]] std::vector<bool> far_samples(const AnyProblem& problem, const LinearFit& fit,
                                            const std::vector<double>& sigma) {
  constexpr double kTimes = 4.0, kRounding = 1e-9, kMost = 6.0;
  const auto samples = static_cast<std::size_t>(problem.num_samples());
  std::vector<double> sum(samples, 0.0), left(samples, 0.0), typical;
  for (const RowBlock& block : fit.blocks) {
    const auto s = static_cast<std::size_t>(block.sample);
    const double noise = std::max(kRounding, sigma[static_cast<std::size_t>(block.term)]);
    const double most = problem.term(block.term).is_of_surface() ? kMost * kMost : HUGE_VAL;
    sum[s] += (fit.residual.segment(block.first, block.size)
                   .cwiseAbs2()
                   .cwiseProduct(fit.loss.segment(block.first, block.size)) /
               (noise * noise))
                  .cwiseMin(most)
                  .sum();
    left[s] += static_cast<double>(block.size) - fit.used.segment(block.first, block.size).sum();
  }
  for (std::size_t s = 0; s < samples; ++s) {
    sum[s] = left[s] > 0.0 ? std::sqrt(sum[s] / left[s]) : 0.0;
    if (left[s] > 0.0) typical.push_back(sum[s]);
  }
  const double limit = typical.empty() ? HUGE_VAL : kTimes * std::max(1.0, median_of(typical));
  std::vector<bool> far(samples);
  for (std::size_t s = 0; s < samples; ++s) far[s] = sum[s] > limit;
  return far;
}

// Influence: how far each sample moves the fit.

/// Leave-one-out influence of each sample, by down-dating: without its rows J_s the coordinates
/// move by H^-1 J_s^T (1 - J_s H^-1 J_s^T)^-1 r_s = (H - J_s^T J_s)^-1 J_s^T r_s; the smaller of the two systems is solved.
void set_influences(const LinearFit& fit, std::vector<CaptureError>& captures) {
  const Eigen::MatrixXd& hessian = fit.hessian;
  const Eigen::MatrixXd inverse = Spectrum(hessian).pseudo_inverse();
  const double n = std::max<double>(1.0, static_cast<double>(fit.size()));
  const double rows = std::max(1.0, static_cast<double>(fit.residual.size()) - n);
  const double noise = std::sqrt(fit.residual.cwiseAbs2().dot(fit.loss) / rows);
  for (std::size_t b = 0; b < fit.blocks.size();) {
    std::size_t end = b;
    Eigen::Index size = 0;
    while (end < fit.blocks.size() && fit.blocks[end].sample == fit.blocks[b].sample) {
      size += fit.blocks[end++].size;
    }
    Eigen::VectorXd step;
    if (fit.size() > 0 && size > fit.size()) {
      RowSums own(fit.size());
      for (std::size_t i = b; i < end; ++i) {
        own += row_sums(fit, fit.blocks[i], fit.loss, fit.residual);
      }
      step = (hessian - own.information).fullPivLu().solve(own.gradient);
    } else {
      const Eigen::Index first = fit.blocks[b].first;  // the blocks of a sample are consecutive
      const Eigen::VectorXd root = fit.loss.segment(first, size).cwiseSqrt();
      const Eigen::MatrixXd j = root.asDiagonal() * fit.jacobian.middleRows(first, size);
      const Eigen::VectorXd r = root.cwiseProduct(fit.residual.segment(first, size));
      const Eigen::MatrixXd left =
          Eigen::MatrixXd::Identity(size, size) - j * inverse * j.transpose();
      step = inverse * (j.transpose() * left.fullPivLu().solve(r));
    }
    captures[static_cast<std::size_t>(fit.blocks[b].sample)].influence =
        noise > 0.0 ? std::sqrt(std::max(0.0, step.dot(hessian * step)) / n) / noise : 0.0;
    b = end;
  }
}

/// The search for bad captures on the rows of one problem.
class CaptureSearch {
 public:
  CaptureSearch(const AnyProblem& problem, const LinearFit& fit, const PoseGroups& poses)
      : problem_(problem),
        fit_(fit),
        poses_(poses),
        bad_(static_cast<std::size_t>(problem.num_samples()), false) {
    for (const RowBlock& block : fit.blocks) {
      const int size = problem.term(block.term).feature_size;
      for (Eigen::Index row = 0; row < block.size; row += size) {
        features_.push_back(
            {block.term, block.sample, static_cast<int>(row) / size, block.first + row, size});
      }
    }
  }

  [[nodiscard]] std::vector<CaptureError> find() {
    if (judges_wholes(problem_)) {
      fit_without(bad_);
      mark(Tail::as_seen);
      bad_ = far_samples(problem_, fit_, sigma_);
      return worst();
    }
    fit_robustly();
    mark();
    constexpr int kRefits = 10;
    for (int round = 0; round < kRefits; ++round) {
      const std::vector<bool> before = bad_;
      fit_without(bad_);
      mark(Tail::as_seen);
      if (bad_ == before) break;
    }
    return worst();
  }

 private:
  struct FeatureRows {
    int term, sample, number;
    Eigen::Index row;
    int size;
  };

  [[nodiscard]] double distance(const FeatureRows& f) const {
    return residual_.segment(f.row, f.size).norm();
  }
  /// Noise of each term, from the median of the features in samples that are not bad.
  void set_sigmas(double freedom) {
    std::vector<std::vector<double>> distances(static_cast<std::size_t>(problem_.num_terms()));
    std::vector<int> sizes(distances.size(), 1);
    for (const FeatureRows& f : features_) {
      if (bad_[static_cast<std::size_t>(f.sample)]) continue;
      distances[static_cast<std::size_t>(f.term)].push_back(distance(f));
      sizes[static_cast<std::size_t>(f.term)] = f.size;
    }
    sigma_.clear();
    tail_.clear();
    for (std::size_t t = 0; t < distances.size(); ++t) {
      const double sigma = robust_sigma(distances[t], sizes[t]);
      tail_.push_back(tail_factor(distances[t], sizes[t], sigma));
      sigma_.push_back(sigma / std::sqrt(freedom));
    }
  }
  /// The share of rows that parameters do not use up; readings of a pose count once.
  [[nodiscard]] double freedom(double rows) const {
    const double n = static_cast<double>(fit_.size()) * poses_.readings() + fit_.used.sum();
    return rows > 2.0 * n ? 1.0 - n / rows : 0.5;
  }
  void solve(const Eigen::VectorXd& weights) {
    inverse_ = Spectrum(information(fit_, weights)).pseudo_inverse();
    const Eigen::VectorXd gradient =
        fit_.jacobian.transpose() * weights.cwiseProduct(fit_.residual) + fit_.prior_gradient;
    residual_ = fit_.residual - fit_.jacobian * (inverse_ * gradient);
  }
  void fit_without(const std::vector<bool>& bad) {
    Eigen::VectorXd weights = fit_.loss;
    double rows = 0.0;
    for (const RowBlock& block : fit_.blocks) {
      if (bad[static_cast<std::size_t>(block.sample)]) {
        weights.segment(block.first, block.size).setZero();
      } else {
        rows += static_cast<double>(block.size);
      }
    }
    solve(weights);
    set_sigmas(freedom(rows));
  }
  /// M-estimates with the scale of the median, from a start that bad captures do not affect.
  void fit_robustly() {
    residual_ = fit_.residual + fit_.jacobian * least_trimmed_squares(fit_, poses_);
    set_sigmas(1.0);
    constexpr int kIterations = 12;
    for (int i = 0; i < kIterations; ++i) {
      Eigen::VectorXd weights = fit_.loss;
      for (const FeatureRows& f : features_) {
        const double s = distance(f) / sigma_of(f), squared = s * s / f.size;
        weights.segment(f.row, f.size) *= Loss{LossType::tukey, 4.685}(squared).derivative;
      }
      solve(weights);
      set_sigmas(freedom(static_cast<double>(fit_.residual.size())));
    }
  }
  /// Noise of a weighted residual; at least the rounding of exact data.
  [[nodiscard]] double sigma_of(const FeatureRows& f) const {
    return std::max(sigma_[static_cast<std::size_t>(f.term)], 1e-9);
  }
  /// Sets the leverage of each row in the present fit.
  void set_leverages() {
    leverage_.resize(fit_.residual.size());
    for (const RowBlock& block : fit_.blocks) {
      const auto j = fit_.jacobian.middleRows(block.first, block.size);
      leverage_.segment(block.first, block.size) = (j * inverse_).cwiseProduct(j).rowwise().sum();
    }
  }
  /// Distance of this feature in standard deviations.
  [[nodiscard]] double times(const FeatureRows& f) const {
    const double leverage = std::min(0.99, leverage_.segment(f.row, f.size).mean());
    const double used = fit_.used.segment(f.row, f.size).mean();
    const bool in = !bad_[static_cast<std::size_t>(f.sample)];
    const double variance = 1.0 - used + (in ? -leverage : leverage);
    return distance(f) / (sigma_of(f) * std::sqrt(std::max(0.01, variance)));
  }
  /// Equal noise in all directions, or the tail of the features that fit, once bad ones are out.
  enum class Tail { normal, as_seen };

  void mark(Tail tail = Tail::normal) {
    if (features_.empty()) return;
    set_leverages();
    constexpr double kFalse = 1e-3, kEfficiency = 0.37;  // share of false alarms; of the median
    const double rows = static_cast<double>(fit_.residual.size());
    const double b = std::max(2.0, kEfficiency * rows * freedom(rows) / poses_.readings());
    limit_.assign(tail_.size(), 0.0);
    for (std::size_t t = 0; t < tail_.size(); ++t) {
      const double k = problem_.term(static_cast<int>(t)).feature_size;
      const double chance = kFalse / static_cast<double>(features_.size());
      const double factor = tail == Tail::as_seen ? tail_[t] : 1.0;
      limit_[t] = factor * std::sqrt(k * f_exceeded(k, b, chance));
    }
    constexpr double kRounding = 1e-9;  // of exact samples, metres or pixels
    std::vector<bool> bad(bad_.size(), false);
    for (const FeatureRows& f : features_) {
      const Term& term = problem_.term(f.term);
      const double least = std::max(term.options.sigma ? std::abs(term.options.scale) : 0.0,
                                    kRounding * term.weight);
      if (times(f) > limit_[static_cast<std::size_t>(f.term)] && distance(f) > least)
        bad[static_cast<std::size_t>(f.sample)] = true;
    }
    bad_ = std::move(bad);
  }

  [[nodiscard]] std::vector<CaptureError> worst() const {
    std::vector<CaptureError> all(bad_.size());
    for (const FeatureRows& f : features_) {
      CaptureError& of = all[static_cast<std::size_t>(f.sample)];
      const double unit = 1.0 / problem_.term(f.term).weight, d = unit * distance(f);
      const double so_far = times(f);
      of.least = of.term == f.term && of.times > 0.0 ? std::min(of.least, d) : d;
      if (so_far > of.times) {
        of.others = of.term == f.term ? std::max(of.others, of.distance) : 0.0;
        of.times = so_far;
        of.limit = limit_[static_cast<std::size_t>(f.term)];
        of.term = f.term;
        of.feature = problem_.feature(f.term, f.sample, f.number);
        of.distance = d;
      } else if (of.term == f.term) {
        of.others = std::max(of.others, d);
      }
    }
    for (std::size_t s = 0; s < all.size(); ++s) {
      all[s].sample = static_cast<int>(s);
      all[s].bad = bad_[s];
    }
    return all;
  }

  const AnyProblem& problem_;
  const LinearFit& fit_;
  const PoseGroups& poses_;
  std::vector<FeatureRows> features_;
  std::vector<bool> bad_;      ///< by sample
  std::vector<double> sigma_;  ///< of weighted residual components, by term
  std::vector<double> tail_;   ///< factor of the limit, by term: see tail_factor()
  std::vector<double> limit_;  ///< of `times`, by term
  Eigen::VectorXd residual_;   ///< of the present fit
  Eigen::MatrixXd inverse_;    ///< of its information
  Eigen::VectorXd leverage_;   ///< of each row, at the last mark()
};

}  // namespace
}  // namespace detail

std::vector<CaptureError> capture_errors(const AnyProblem& problem, const LinearFit& fit,
                                         const PoseGroups& poses) {
  std::vector<CaptureError> captures = detail::CaptureSearch(problem, fit, poses).find();
  detail::set_influences(fit, captures);
  return captures;
}

}  // namespace kinecal
