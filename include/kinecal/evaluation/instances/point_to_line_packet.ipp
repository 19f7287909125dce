// The error block PointToLine in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointToLine, Packet>;

}  // namespace kinecal
