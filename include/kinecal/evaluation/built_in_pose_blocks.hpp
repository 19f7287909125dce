// The terms of the built-in error blocks of poses and lines of sight, evaluated in packets: a unit of the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
/// Instances of their terms, declared (`extern`) or defined.
#define KINECAL_POSE_BLOCK_CODE(storage)                  \
  storage template class BlockTerm<PoseToPose, Packet>;   \
  storage template class BlockTerm<PointOnPlane, Packet>; \
  storage template class BlockTerm<PointOnLine, Packet>;  \
  storage template class BlockTerm<GravitySeen, Packet>;  \
  storage template class BlockTerm<RayToRay, Packet>

namespace kinecal::detail {
KINECAL_POSE_BLOCK_CODE(extern);
}  // namespace kinecal::detail
#endif
