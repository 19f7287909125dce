// Memory layout of Eigen's matrices: a source and the library it links must agree on it.
//
// Storage order and index type are Eigen's defaults.  You may change the alignment if the library
// is compiled with the same one; otherwise the source does not link (linkage.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "kinecal/linkage.hpp"

namespace kinecal {

static_assert(
    !Eigen::Matrix3d::IsRowMajor,
    "kinecal: EIGEN_DEFAULT_TO_ROW_MAJOR is defined, but kinecal stores matrices by columns; "
    "write Eigen::RowMajor in the types of your own matrices instead");
static_assert(sizeof(Eigen::Index) == sizeof(std::ptrdiff_t),
              "kinecal: EIGEN_DEFAULT_DENSE_INDEX_TYPE is not as wide as std::ptrdiff_t; leave it "
              "undefined");

#ifndef KINECAL_HEADER_ONLY
inline namespace KINECAL_INSTRUCTION_SET {
/// Alignment of Eigen's matrices, bytes: EIGEN_MAX_ALIGN_BYTES, and EIGEN_MAX_STATIC_ALIGN_BYTES
/// for matrices of fixed size.
template <int kMost, int kMostOfFixedSize>
struct EigenAlignedTo {
  static const bool KINECAL_LIBRARY_CHECK;  ///< the library defines the one for its own alignment
};
using EigenAligned = EigenAlignedTo<EIGEN_MAX_ALIGN_BYTES, EIGEN_MAX_STATIC_ALIGN_BYTES>;
template <>
const bool EigenAligned::KINECAL_LIBRARY_CHECK;
}  // namespace KINECAL_INSTRUCTION_SET

namespace detail {
[[gnu::used]] static const bool* const kEigenCheck = &EigenAligned::KINECAL_LIBRARY_CHECK;
}  // namespace detail
#endif

}  // namespace kinecal
