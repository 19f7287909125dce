// The error block PointToPixel in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::BlockTerm<PointToPixel, Packet>;

}  // namespace kinecal
