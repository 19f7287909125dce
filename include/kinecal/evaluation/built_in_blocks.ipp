// What built_in_blocks.hpp declares, compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/built_in_blocks.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {

template class BlockTerm<PointToPoint, Packet>;
template class BlockTerm<PointToPixel, Packet>;
template class BlockTerm<PointToPlane, Packet>;
template class BlockTerm<PlaneToPlane, Packet>;
template class BlockTerm<PointDistance, Packet>;
template class BlockTerm<PointToLine, Packet>;
template class BlockTerm<PointToSphere, Packet>;
template class BlockTerm<PointToRay, Packet>;

}  // namespace kinecal::detail
#endif
