// The error block RayToRay in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class detail::BlockTerm<RayToRay, Packet>;

}  // namespace kinecal
