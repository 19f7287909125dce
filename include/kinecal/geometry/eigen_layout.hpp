// How Eigen lays out its matrices in memory: alike in a source and in the library that it links.
//
// Storage order and index are Eigen's defaults; the alignment may be another than Eigen's own choice, but
// then the library is compiled with it, too: otherwise a source does not link (linkage.hpp).
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
/// Alignment of Eigen's matrices, bytes: EIGEN_MAX_ALIGN_BYTES, and EIGEN_MAX_STATIC_ALIGN_BYTES of those
/// of fixed size.
template <int kMost, int kMostOfFixedSize>
struct EigenAlignedTo {
  static const bool KINECAL_LIBRARY_CHECK;  ///< defined by the library for its own alignment
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
