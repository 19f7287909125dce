// The error block PointToPoint in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::BlockTerm<PointToPoint, double>;

}  // namespace kinecal
