// Estimating noise.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/inside_bounds.ipp"

namespace kinecal {

double robust_sigma(std::vector<double> distances, int components) {
  if (distances.empty()) return 0.0;
  // Median of chi-square, Wilson and Hilferty: k (1 - 2 / 9k)^3; exact to 2 % for one component.
  const double k = components;
  return median_of(std::move(distances)) / std::sqrt(k * std::pow(1.0 - 2.0 / (9.0 * k), 3.0));
}

double detail::tail_factor(std::vector<double> distances, int components, double sigma) {
  constexpr std::size_t kFew = 40;
  constexpr double kNormal = 1.645, kMost = 1.7;  // quantile of a normal distribution
  if (distances.size() < kFew || !(sigma > 0.0)) return 1.0;
  const auto at =
      distances.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size()));
  std::nth_element(distances.begin(), at, distances.end());
  // Of chi-square, Wilson and Hilferty: k (1 - 2 / 9k + z sqrt(2 / 9k))^3.
  const double k = components, part = 2.0 / (9.0 * k);
  const double expected =
      sigma * std::sqrt(k * std::pow(1.0 - part + kNormal * std::sqrt(part), 3.0));
  return std::clamp(*at / expected, 1.0, kMost);
}

BlockNoise detail::block_noise(const Term& term, std::int64_t features, double squares,
                               double leverage, double robust) {
  BlockNoise of;
  of.block = term.name;
  of.unit = term.options.unit;
  of.features = features;
  of.components = term.feature_size;
  of.unit_sigma = 1.0 / term.weight;
  of.given = term.options.sigma ? of.unit_sigma : 0.0;
  const double rows = static_cast<double>(features) * of.components;
  of.freedom = rows - leverage;
  constexpr double kNoFreedom = 1e-6;  // the parameters fit every row
  if (of.freedom < kNoFreedom * rows || rows == 0.0) return of;
  of.sigma = of.unit_sigma * std::sqrt(squares / of.freedom);
  of.robust = of.unit_sigma * robust * std::sqrt(rows / of.freedom);
  return of;
}

void detail::set_directions(const Eigen::MatrixXd& residuals, BlockNoise& noise) {
  constexpr Eigen::Index kFew = 20;
  if (noise.components < 2 || noise.components > 3 || residuals.cols() < kFew) return;
  const Eigenpairs scatter = eigenpairs(residuals * residuals.transpose());
  const Eigen::MatrixXd along = scatter.vectors.transpose() * residuals;
  const auto sigma = [&](Eigen::Index row) {
    std::vector<double> distances(static_cast<std::size_t>(along.cols()));
    for (Eigen::Index i = 0; i < along.cols(); ++i) {
      distances[static_cast<std::size_t>(i)] = std::abs(along(row, i));
    }
    return noise.unit_sigma * robust_sigma(distances, 1);
  };
  noise.along = sigma(along.rows() - 1);
  noise.across = sigma(along.rows() - 2);
}

void detail::set_pose_errors(const Term& term, const Eigen::MatrixXd& residuals,
                             BlockNoise& noise) {
  if (!term.pose_scales || residuals.cols() == 0 || !(noise.freedom > 0.0)) return;
  const double used = std::sqrt(static_cast<double>(residuals.size()) / noise.freedom);
  const auto typical = [&](const Eigen::MatrixXd& rows, double scale) {
    const Eigen::VectorXd norms = rows.colwise().norm();
    const double rms = norms.norm() / std::sqrt(static_cast<double>(norms.size()));
    const double robust =
        std::sqrt(3.0) * robust_sigma({norms.data(), norms.data() + norms.size()}, 3);
    return scale > 0.0 ? used * std::min(rms, robust) * noise.unit_sigma / scale : 0.0;
  };
  noise.distance = typical(residuals.topRows<3>(), term.pose_scales->per_metre);
  noise.angle = typical(residuals.bottomRows<3>(), term.pose_scales->per_radian);
}

double prior_variance(const std::vector<BlockNoise>& noise) {
  double squares = 0.0, freedom = 0.0;
  bool given = true;
  for (const BlockNoise& of : noise) {
    if (!(of.freedom > 0.0)) continue;
    given = given && of.given > 0.0;
    squares += of.weighted() * of.weighted() * of.freedom;
    freedom += of.freedom;
  }
  return given || freedom == 0.0 ? 1.0 : squares / freedom;
}

std::vector<BlockNoise> estimate_noise(const AnyProblem& problem, const LinearFit& fit,
                                       const Eigen::MatrixXd& inverse) {
  const auto terms = static_cast<std::size_t>(problem.num_terms());
  std::vector<double> squares(terms, 0.0), leverages(terms, 0.0);
  std::vector<std::vector<double>> distances(terms);
  for (const RowBlock& block : fit.blocks) {
    const auto t = static_cast<std::size_t>(block.term);
    const int size = problem.term(block.term).feature_size;
    const auto jacobian = fit.jacobian.middleRows(block.first, block.size);
    const auto loss = fit.loss.segment(block.first, block.size);
    const auto r = fit.residual.segment(block.first, block.size);
    const Eigen::VectorXd leverage =
        (jacobian * inverse).cwiseProduct(jacobian).rowwise().sum().cwiseProduct(loss);
    leverages[t] += leverage.sum() + fit.used.segment(block.first, block.size).sum();
    squares[t] += r.cwiseAbs2().dot(loss);
    for (Eigen::Index row = 0; row < block.size; row += size) {
      distances[t].push_back(r.segment(row, size).norm());
    }
  }
  std::vector<BlockNoise> noise;
  for (std::size_t t = 0; t < terms; ++t) {
    const Term& term = problem.term(static_cast<int>(t));
    noise.push_back(detail::block_noise(term, static_cast<int>(distances[t].size()), squares[t],
                                        leverages[t],
                                        robust_sigma(distances[t], term.feature_size)));
    Eigen::MatrixXd residuals(term.feature_size, std::ssize(distances[t]));
    Eigen::Index column = 0;
    for (const RowBlock& block : fit.blocks) {
      if (block.term != static_cast<int>(t)) continue;
      for (Eigen::Index row = 0; row < block.size; row += term.feature_size) {
        residuals.col(column++) = fit.residual.segment(block.first + row, term.feature_size);
      }
    }
    detail::set_directions(residuals, noise.back());
    detail::set_pose_errors(term, residuals, noise.back());
  }
  return noise;
}

std::vector<BlockNoise> noise_at(const AnyProblem& problem, const FreeSet& free,
                                 ParameterValues values) {
  std::vector<int> at_bound;
  const FreeSet inside = detail::inside_bounds(problem, free, values, at_bound);
  const auto evaluator = problem.evaluator(inside, 1);
  const LinearFit fit =
      linear_fit(*evaluator, values, determined_coordinates(problem, inside, values));
  return estimate_noise(problem, fit, detail::Spectrum(fit.hessian).pseudo_inverse());
}

}  // namespace kinecal
