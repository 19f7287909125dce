// The error block PointToSphere in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<PointToSphere, Packet>;

}  // namespace kinecal
