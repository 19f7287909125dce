// Correlation of consecutive poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinecal {

Neighbours neighbours(const AnyProblem& problem, const LinearFit& fit, const PoseGroups& poses) {
  constexpr double kChance = 5.0, kLeast = 0.25;
  constexpr int kFewest = 10;  // groups
  double squares = 0.0, products = 0.0, count = 0.0;
  for (int t = 0; t < problem.num_terms(); ++t) {
    const int size = problem.term(t).feature_size;
    Eigen::MatrixXd means = Eigen::MatrixXd::Zero(size, poses.count);
    std::vector<double> features(static_cast<std::size_t>(poses.count), 0.0);
    for (const RowBlock& block : fit.blocks) {
      if (block.term != t) continue;
      const int pose = poses.of_sample[static_cast<std::size_t>(block.sample)];
      for (Eigen::Index row = block.first; row < block.first + block.size; row += size) {
        means.col(pose) += fit.loss(row) * fit.residual.segment(row, size);
        features[static_cast<std::size_t>(pose)] += 1.0;
      }
    }
    double known = 0.0;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    for (Eigen::Index p = 0; p < means.cols(); ++p) {
      if (features[static_cast<std::size_t>(p)] == 0.0) continue;
      means.col(p) /= features[static_cast<std::size_t>(p)];
      mean += means.col(p);
      known += 1.0;
    }
    mean /= std::max(1.0, known);
    Eigen::Index before = -1;
    for (Eigen::Index p = 0; p < means.cols(); ++p) {
      if (features[static_cast<std::size_t>(p)] == 0.0) continue;
      means.col(p) -= mean;
      squares += means.col(p).squaredNorm();
      if (before >= 0) products += means.col(before).dot(means.col(p)), count += size;
      before = p;
    }
  }
  const double rho = squares > 0.0 ? products / squares : 0.0;
  if (rho < kLeast || rho * std::sqrt(count) < kChance) return {};
  const double together = std::ceil((1.0 + rho) / std::max(1.0 - rho, 1e-3));
  return {rho, std::clamp(static_cast<int>(std::min(together, 1e6)), 1,
                          std::max(1, poses.count / kFewest))};
}

PoseGroups joined(const PoseGroups& poses, int together) {
  PoseGroups groups = poses;
  for (int& of : groups.of_sample) of /= together;
  groups.count = (poses.count + together - 1) / together;
  return groups;
}

}  // namespace kinecal
