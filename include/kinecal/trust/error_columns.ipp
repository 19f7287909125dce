// Columns of an error of samples, beside those of a fit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/trust/unexplained.ipp"

namespace kinecal::detail {

/// An error's columns beside those of a fit: slopes of the residuals times the error's course.
class ErrorColumns {
 public:
  ErrorColumns(const LinearFit& fit, const Eigen::VectorXd& slope, Eigen::Index samples)
      : squared_(Eigen::VectorXd::Zero(samples)),
        gradient_(Eigen::VectorXd::Zero(samples)),
        cross_(Eigen::MatrixXd::Zero(samples, fit.size())) {
    for (const RowBlock& block : fit.blocks) {
      const auto d = slope.segment(block.first, block.size);
      const Eigen::VectorXd w = d.cwiseProduct(fit.loss.segment(block.first, block.size));
      squared_(block.sample) += w.dot(d);
      gradient_(block.sample) += w.dot(fit.residual.segment(block.first, block.size));
      cross_.row(block.sample) += w.transpose() * fit.jacobian.middleRows(block.first, block.size);
    }
  }

  /// Sum of the squared slopes, with losses.
  [[nodiscard]] double squares() const { return squared_.sum(); }
  /// @param course  (samples x columns) of the error
  [[nodiscard]] Fall fall(const Eigen::MatrixXd& course, const Eigen::MatrixXd& inverse) const {
    const AddedColumns added{course.transpose() * squared_.asDiagonal() * course,
                             course.transpose() * cross_, course.transpose() * gradient_};
    return fall_of(added, unit_lengths(added), inverse);
  }

 private:
  Eigen::VectorXd squared_, gradient_;  // by sample: d^T W d, d^T W r of its rows
  Eigen::MatrixXd cross_;               // (samples x coordinates) d^T W J
};

}  // namespace kinecal::detail
