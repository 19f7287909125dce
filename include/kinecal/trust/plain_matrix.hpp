// A matrix that one library may create and another destroy.
//
// The program loads evaluation and solving compiled for the processor's instruction set.  There,
// Eigen allocates with another alignment than in the program, so results hold their numbers in a
// std::vector.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/geometry/eigen_layout.hpp"

namespace kinecal {

/// Read-only numbers of a matrix or vector.
class PlainMatrix {
 public:
  PlainMatrix() = default;
  /// Copies an expression.
  template <class Derived>
  PlainMatrix(const Eigen::MatrixBase<Derived>& from)  // NOLINT: as the matrix itself
      : rows_(from.rows()), numbers_(static_cast<std::size_t>(from.size())) {
    Eigen::Map<Eigen::MatrixXd>(numbers_.data(), from.rows(), from.cols()) = from;
  }

  /// Number of rows.
  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  /// An entry; the column of a vector is 0.
  [[nodiscard]] double operator()(Eigen::Index row, Eigen::Index column = 0) const {
    return numbers_[static_cast<std::size_t>(row + column * rows_)];
  }
  /// As a matrix to compute with.
  [[nodiscard]] Eigen::MatrixXd matrix() const {
    const auto size = static_cast<Eigen::Index>(numbers_.size());
    return Eigen::Map<const Eigen::MatrixXd>(numbers_.data(), rows_, rows_ > 0 ? size / rows_ : 0);
  }

 private:
  Eigen::Index rows_ = 0;
  std::vector<double> numbers_;  ///< column by column
};

}  // namespace kinecal
