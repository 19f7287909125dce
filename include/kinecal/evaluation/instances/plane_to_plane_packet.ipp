// The error block PlaneToPlane in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::BlockTerm<PlaneToPlane, Packet>;

}  // namespace kinecal
