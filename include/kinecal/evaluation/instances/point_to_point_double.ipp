// The error block PointToPoint in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointToPoint, double>;

}  // namespace kinecal
