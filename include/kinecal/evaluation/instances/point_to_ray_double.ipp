// The error block PointToRay in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::BlockTerm<PointToRay, double>;

}  // namespace kinecal
