// The error block PointToPixel in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointToPixel, double>;

}  // namespace kinecal
