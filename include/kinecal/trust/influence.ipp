// Influence: how far each sample moves the fit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "kinecal/solve/spectrum.hpp"
#include "kinecal/trust/captures.hpp"

namespace kinecal::detail {

/// Leave-one-out influence of each sample, by down-dating: without its rows J_s the coordinates
/// move by H^-1 J_s^T (1 - J_s H^-1 J_s^T)^-1 r_s = (H - J_s^T J_s)^-1 J_s^T r_s; the smaller of the two systems is solved.
inline void set_influences(const LinearFit& fit, std::vector<CaptureError>& captures) {
  const Eigen::MatrixXd hessian = information(fit, fit.loss);
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
    const Eigen::Index first = fit.blocks[b].first;  // the blocks of a sample are consecutive
    const Eigen::VectorXd root = fit.loss.segment(first, size).cwiseSqrt();
    const Eigen::MatrixXd j = root.asDiagonal() * fit.jacobian.middleRows(first, size);
    const Eigen::VectorXd r = root.cwiseProduct(fit.residual.segment(first, size));
    Eigen::VectorXd step;
    if (fit.size() > 0 && size > fit.size()) {
      const Eigen::MatrixXd left = hessian - j.transpose() * j;
      step = left.fullPivLu().solve(j.transpose() * r);
    } else {
      const Eigen::MatrixXd left =
          Eigen::MatrixXd::Identity(size, size) - j * inverse * j.transpose();
      step = inverse * (j.transpose() * left.fullPivLu().solve(r));
    }
    captures[static_cast<std::size_t>(fit.blocks[b].sample)].influence =
        noise > 0.0 ? std::sqrt(std::max(0.0, step.dot(hessian * step)) / n) / noise : 0.0;
    b = end;
  }
}

}  // namespace kinecal::detail
