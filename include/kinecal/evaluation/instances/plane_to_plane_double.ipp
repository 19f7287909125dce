// The error block PlaneToPlane in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PlaneToPlane, double>;

}  // namespace kinecal
