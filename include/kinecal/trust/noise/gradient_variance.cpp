// Computing the variance of grouped gradients.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/gradient_variance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/noise/pose_rows.ipp"

namespace kinecal {

namespace detail {
namespace {

/// (I - M)^-1/2 g.  A direction that only this group determines has no residual left and adds nothing.
[[nodiscard]] Eigen::VectorXd restored(const Eigen::MatrixXd& share, const Eigen::VectorXd& g) {
  constexpr double kSmall = 0.1;
  if (share.trace() < kSmall) {  // its power series
    const Eigen::VectorXd first = share * g, second = share * first, third = share * second;
    return g + 0.5 * first + 0.375 * second + 0.3125 * third;
  }
  const Eigenpairs spectrum = eigenpairs(share);
  constexpr double kAlone = 1e-6;
  const Eigen::ArrayXd factor = (1.0 + kAlone - spectrum.values.array()).max(kAlone).rsqrt();
  return spectrum.vectors * (factor * (spectrum.vectors.transpose() * g).array()).matrix();
}

/// Sums over one group, and over all.
struct GradientSums {
  Eigen::MatrixXd influence;            ///< (free x coordinates) of a gradient on each parameter
  Eigen::VectorXd together;             ///< gradient of all features of a group
  Eigen::MatrixXd share;                ///< of the group in the information
  Eigen::VectorXd sum, squares;         ///< (free) of shares in the variance of each parameter
  std::vector<Eigen::VectorXd> groups;  ///< x of each group
  double of_features = 0.0;             ///< squares of the gradients of single features
  double chance = 0.0;  ///< variance of trace S if features err independently, relative

  explicit GradientSums(Eigen::MatrixXd of)
      : influence(std::move(of)),
        together(Eigen::VectorXd::Zero(influence.cols())),
        share(Eigen::MatrixXd::Zero(influence.cols(), influence.cols())),
        sum(Eigen::VectorXd::Zero(influence.rows())),
        squares(sum) {}

  /// @param rows  derivatives of a block's residuals, in whitened coordinates
  /// @param size  residuals of a feature
  void add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& residual,
           const Eigen::VectorXd& loss, int size) {
    const Eigen::VectorXd weighted = loss.cwiseProduct(residual);
    for (Eigen::Index row = 0; row < rows.rows(); row += size) {
      const Eigen::VectorXd of_feature =
          rows.middleRows(row, size).transpose() * weighted.segment(row, size);
      of_features += of_feature.squaredNorm();
    }
    together.noalias() += rows.transpose() * weighted;
    share.noalias() += rows.transpose() * loss.asDiagonal() * rows;
  }
  /// Adds the group and starts another one.
  void end_group() {
    groups.push_back(restored(share, together));
    chance += 2.0 * share.squaredNorm();
    const Eigen::VectorXd of_parameters =
        (influence * share).cwiseProduct(influence).rowwise().sum().cwiseMax(0.0);
    sum += of_parameters;
    squares += of_parameters.cwiseAbs2();
    together.setZero();
    share.setZero();
  }
  /// S.
  [[nodiscard]] Eigen::MatrixXd scatter() const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(influence.cols(), influence.cols());
    for (const Eigen::VectorXd& x : groups) all.noalias() += x * x.transpose();
    return all;
  }
};

/// S of few groups: widened for each parameter so that two standard deviations are the 95 % of Student's distribution, with one
/// degree of freedom less than groups that show the parameter, and one at least: see student_widening().
/// Source: Satterthwaite 1946; Bell, McCaffrey, Bias reduction in standard errors for linear regression with multi-stage
/// samples, 2002.
[[nodiscard]] Eigen::MatrixXd widened(const GradientSums& sums, const Eigen::MatrixXd& scatter) {
  const Eigen::MatrixXd& of = sums.influence;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(of.rows());
  for (Eigen::Index p = 0; p < of.rows(); ++p) {
    if (!(sums.squares(p) > 0.0)) continue;
    factor(p) = student_widening(sums.sum(p) * sums.sum(p) / sums.squares(p) - 1.0);
  }
  const Eigen::MatrixXd back =
      Spectrum(of.transpose() * of).pseudo_inverse() * of.transpose() * factor.asDiagonal() * of;
  return back * scatter * back.transpose();
}

/// S, shrunk towards a target as far as the scatter of the variances of the parameters demands.
/// @param are_few  groups: S is widened
[[nodiscard]] Eigen::MatrixXd shrunk(const GradientSums& sums, const Eigen::MatrixXd& target,
                                     bool are_few) {
  const Eigen::MatrixXd scatter = sums.scatter(), &of = sums.influence;
  const auto variances = [&](const Eigen::MatrixXd& matrix) {
    return Eigen::ArrayXd((of * matrix).cwiseProduct(of).rowwise().sum().array());
  };
  const Eigen::ArrayXd found = variances(scatter), expected = variances(target);
  double apart = 0.0, chance = 0.0;
  for (Eigen::Index p = 0; p < found.size(); ++p) {
    if (!(expected(p) > 0.0) || !(sums.sum(p) > 0.0)) continue;
    const double by = found(p) / expected(p) - 1.0;
    apart += by * by;
    chance += 2.0 * sums.squares(p) / (sums.sum(p) * sums.sum(p));
  }
  if (!(apart > chance)) return target;
  const double weight = chance / apart;  // of the target
  return weight * target + (1.0 - weight) * (are_few ? widened(sums, scatter) : scatter);
}

/// Rows of a block, feature after feature.
struct RowPiece {
  std::size_t block = 0;
  Eigen::Index first = 0, size = 0;
};

using RowGroups = std::vector<std::vector<RowPiece>>;

[[nodiscard]] RowPiece piece_of(const LinearFit& fit, std::size_t block) {
  return {block, fit.blocks[block].first, fit.blocks[block].size};
}

[[nodiscard]] RowGroups groups_by_pose(const LinearFit& fit, const PoseGroups& poses) {
  RowGroups groups;
  for (const std::vector<std::size_t>& of_pose : blocks_by_pose(fit, poses)) {
    std::vector<RowPiece>& group = groups.emplace_back();
    for (const std::size_t b : of_pose) group.push_back(piece_of(fit, b));
  }
  return groups;
}

/// Each link is a group; what is on none is grouped by pose.
[[nodiscard]] RowGroups groups_by_link(const LinearFit& fit, const PoseGroups& poses,
                                       const FeatureLinks& links) {
  RowGroups groups(static_cast<std::size_t>(links.count + poses.count));
  for (std::size_t b = 0; b < fit.blocks.size(); ++b) {
    const RowBlock& block = fit.blocks[b];
    const std::vector<int>& on = links.of_blocks[b];
    if (on.empty()) {
      const int pose = poses.of_sample[static_cast<std::size_t>(block.sample)];
      groups[static_cast<std::size_t>(links.count + pose)].push_back(piece_of(fit, b));
      continue;
    }
    const Eigen::Index size = block.size / std::ssize(on);
    for (std::size_t i = 0, end = 0; i < on.size(); i = end) {
      while (end < on.size() && on[end] == on[i]) ++end;
      groups[static_cast<std::size_t>(on[i])].push_back(
          {b, block.first + static_cast<Eigen::Index>(i) * size,
           static_cast<Eigen::Index>(end - i) * size});
    }
  }
  return groups;
}

/// What variances of grouped gradients are made of.
struct WhitenedFit {
  const AnyProblem& problem;
  const LinearFit& fit;
  Eigen::MatrixXd whitening;  ///< (coordinates x rank)
  Eigen::MatrixXd back;       ///< (coordinates x rank) its inverse, transposed
};

/// @param independent  without the share of priors
/// @param are_runs     groups are few, and their errors may cancel each other: those of motions between tracked poses do
[[nodiscard]] std::optional<GradientVariance> variance_of(const WhitenedFit& of,
                                                          const RowGroups& groups,
                                                          const Eigen::MatrixXd& independent,
                                                          bool are_runs) {
  const LinearFit& fit = of.fit;
  GradientSums sums(fit.coordinates.basis * of.whitening);
  double directions = 0.0;
  for (const std::vector<RowPiece>& group : groups) {
    for (const RowPiece& piece : group) {
      const Eigen::MatrixXd rows = fit.jacobian.middleRows(piece.first, piece.size) * of.whitening;
      const Eigen::VectorXd loss = fit.loss.segment(piece.first, piece.size);
      directions += (loss.asDiagonal() * rows).cwiseProduct(rows).sum();
      sums.add(rows, fit.residual.segment(piece.first, piece.size), loss,
               of.problem.term(fit.blocks[piece.block].term).feature_size);
    }
    if (!group.empty()) sums.end_group();
  }
  if (sums.groups.empty()) return std::nullopt;
  const auto count = static_cast<double>(fit.residual.size()),
             rank = static_cast<double>(of.whitening.cols());
  const double of_features = sums.of_features * count / std::max(1.0, count - rank);
  if (!(of_features > 0.0)) return std::nullopt;
  double of_groups = 0.0;
  for (const Eigen::VectorXd& x : sums.groups) of_groups += x.squaredNorm();
  double effect = of_groups / of_features;
  const double chance = std::sqrt(sums.chance) / directions;
  const bool is_more = effect > 1.0 + 3.0 * chance, is_less = effect < 1.0 / (1.0 + 3.0 * chance);
  if (!is_more && !(are_runs && is_less)) effect = 1.0;
  const Eigen::MatrixXd of_rows = of.whitening.transpose() * independent * of.whitening;
  return GradientVariance{of.back * shrunk(sums, effect * of_rows, are_runs) * of.back.transpose(),
                          effect};
}

}  // namespace
}  // namespace detail

double student_widening(double freedom) {
  constexpr double kZ = 1.959964, kOne = 12.706205 / kZ, kTwo = 4.302653 / kZ;
  if (freedom < 3.0) {
    const double nu = std::max(1.0, freedom), three = student_widening(3.0);
    const bool is_below_two = nu < 2.0;
    const double far = std::log(is_below_two ? kOne : kTwo),
                 near = std::log(is_below_two ? kTwo : three), at_far = is_below_two ? 1.0 : 0.5,
                 at_near = is_below_two ? 0.5 : 1.0 / 3.0;
    return std::exp(near + (far - near) * (1.0 / nu - at_near) / (at_far - at_near));
  }
  constexpr double z2 = kZ * kZ, z4 = z2 * z2, z6 = z4 * z2, z8 = z4 * z4;
  constexpr double kFirst = (z2 + 1.0) / 4.0, kSecond = (5.0 * z4 + 16.0 * z2 + 3.0) / 96.0,
                   kThird = (3.0 * z6 + 19.0 * z4 + 17.0 * z2 - 15.0) / 384.0,
                   kFourth = (79.0 * z8 + 776.0 * z6 + 1482.0 * z4 - 1920.0 * z2 - 945.0) / 92160.0;
  const double by = 1.0 / freedom;
  return 1.0 + by * (kFirst + by * (kSecond + by * (kThird + by * kFourth)));
}

FeatureLinks feature_links(const AnyProblem& problem, const LinearFit& fit,
                           std::span<const Sample> samples) {
  FeatureLinks links;
  links.of_blocks.resize(fit.blocks.size());
  std::map<std::string, int> numbers;
  for (std::size_t b = 0; b < fit.blocks.size(); ++b) {
    const RowBlock& block = fit.blocks[b];
    const Term& term = problem.term(block.term);
    for (const int number : term.sensors) {
      const Mount& mount = problem.sensors()[static_cast<std::size_t>(number)].mount();
      if (mount.links.empty()) continue;
      const Observation* seen =
          samples[static_cast<std::size_t>(block.sample)].observation(mount.name);
      if (seen == nullptr || std::ssize(seen->features) * term.feature_size != block.size) continue;
      std::vector<int>& on = links.of_blocks[b];
      for (const Feature& feature : seen->features) {
        on.push_back(numbers.emplace(feature.frame, std::ssize(numbers)).first->second);
      }
      break;
    }
  }
  links.count = static_cast<int>(numbers.size());
  return links;
}

GradientVariance gradient_variance(const AnyProblem& problem, const LinearFit& fit,
                                   const PoseGroups& poses, const FeatureLinks& links,
                                   const Eigen::MatrixXd& independent,
                                   const Eigen::MatrixXd& of_priors) {
  const Eigen::Index n = fit.size();
  const detail::Spectrum spectrum(fit.hessian);
  const Eigen::Index rank = n - spectrum.null;
  if (rank == 0) return {independent};
  const auto vectors = spectrum.vectors.rightCols(rank);
  const auto singular = spectrum.singular.tail(rank);
  const detail::WhitenedFit whitened{
      problem, fit,
      spectrum.scale.cwiseInverse().asDiagonal() * vectors * singular.cwiseInverse().asDiagonal(),
      spectrum.scale.asDiagonal() * vectors * singular.asDiagonal()};
  const Eigen::MatrixXd of_rows = independent - of_priors;
  auto found =
      detail::variance_of(whitened, detail::groups_by_pose(fit, poses), of_rows, poses.are_runs);
  if (!found) return {independent};
  if (links.count > 1) {
    const auto by_links =
        detail::variance_of(whitened, detail::groups_by_link(fit, poses, links), of_rows, false);
    if (by_links && by_links->effect > found->effect) {
      found = by_links;
      found->by_links = true;
    }
  }
  found->variance += of_priors;
  return *found;
}

}  // namespace kinecal
