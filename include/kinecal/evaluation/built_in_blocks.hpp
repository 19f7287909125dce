// The terms of the built-in error blocks of points and planes, evaluated in packets: a unit of the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
/// Instances of their terms, declared (`extern`) or defined.
#define KINECAL_BLOCK_CODE(storage)                        \
  storage template class BlockTerm<PointToPoint, Packet>;  \
  storage template class BlockTerm<PointToPixel, Packet>;  \
  storage template class BlockTerm<PointToPlane, Packet>;  \
  storage template class BlockTerm<PlaneToPlane, Packet>;  \
  storage template class BlockTerm<PointDistance, Packet>; \
  storage template class BlockTerm<PointToLine, Packet>;   \
  storage template class BlockTerm<PointToSphere, Packet>; \
  storage template class BlockTerm<PointToRay, Packet>;    \
  storage template class BlockTerm<PointToMesh, Packet>;   \
  storage template class BlockTerm<PointToOutline, Packet>

namespace kinecal::detail {
KINECAL_BLOCK_CODE(extern);
}  // namespace kinecal::detail
#endif
