// The error block PointDistance in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointDistance, Packet>;

}  // namespace kinecal
