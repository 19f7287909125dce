// The error block PointDistance in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointDistance, double>;

}  // namespace kinecal
