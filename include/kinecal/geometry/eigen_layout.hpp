// Memory layout of Eigen's matrices: a source and the library it links must agree on it.
//
// Storage order, index type and members are Eigen's defaults.  You may change the alignment and who aligns
// memory if the library is compiled with the same; otherwise the source does not link (linkage.hpp).
// Every header that uses matrices includes this one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

#include "kinecal/linkage.hpp"

namespace kinecal {

static_assert(
    !Eigen::Matrix3d::IsRowMajor,
    "kinecal: EIGEN_DEFAULT_TO_ROW_MAJOR is defined, but kinecal stores matrices by columns; "
    "write Eigen::RowMajor in the types of your own matrices instead");
static_assert(std::is_same_v<Eigen::Index, std::ptrdiff_t>,
              "kinecal: EIGEN_DEFAULT_DENSE_INDEX_TYPE is not std::ptrdiff_t; leave it undefined");
static_assert(sizeof(Eigen::Matrix<double, 3, 1>) == 3 * sizeof(double) &&
                  sizeof(Eigen::VectorXd) == 2 * sizeof(double*),
              "kinecal: EIGEN_MATRIX_PLUGIN or another plugin adds members to Eigen's matrices; "
              "derive a type of your own instead");

#ifndef KINECAL_HEADER_ONLY
inline namespace KINECAL_INSTRUCTION_SET {
/// Alignment of Eigen's matrices, bytes: EIGEN_MAX_ALIGN_BYTES, and EIGEN_MAX_STATIC_ALIGN_BYTES
/// for matrices of fixed size; and whether malloc() aligns memory, EIGEN_MALLOC_ALREADY_ALIGNED.
template <int kMost, int kMostOfFixedSize, bool kByMalloc>
struct EigenAlignedTo {
  static const bool KINECAL_LIBRARY_CHECK;  ///< the library defines the one for its own alignment
};
using EigenAligned = EigenAlignedTo<EIGEN_MAX_ALIGN_BYTES, EIGEN_MAX_STATIC_ALIGN_BYTES,
                                    EIGEN_MALLOC_ALREADY_ALIGNED != 0>;  ///< here
template <>
const bool EigenAligned::KINECAL_LIBRARY_CHECK;
}  // namespace KINECAL_INSTRUCTION_SET

namespace detail {
[[gnu::used]] static const bool* const kEigenCheck = &EigenAligned::KINECAL_LIBRARY_CHECK;
}  // namespace detail
#endif

}  // namespace kinecal
