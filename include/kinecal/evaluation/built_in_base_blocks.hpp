// The terms of the built-in error blocks of a mobile base, evaluated in packets: a unit of the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
/// Instances of their terms, declared (`extern`) or defined.
#define KINECAL_BASE_BLOCK_CODE(storage)                        \
  storage template class BlockTerm<DifferentialToPose, Packet>; \
  storage template class BlockTerm<DifferentialToWall, Packet>; \
  storage template class BlockTerm<MecanumToPose, Packet>;      \
  storage template class BlockTerm<MecanumToWall, Packet>;      \
  storage template class BlockTerm<TricycleToPose, Packet>;     \
  storage template class BlockTerm<TricycleToWall, Packet>;     \
  storage template class BlockTerm<OdometryToPose, Packet>;     \
  storage template class BlockTerm<OdometryToWall, Packet>;     \
  storage template class BlockTerm<GyroToPose, Packet>;         \
  storage template class BlockTerm<GyroToWall, Packet>;         \
  storage template class BlockTerm<MagneticField, Packet>

namespace kinecal::detail {
KINECAL_BASE_BLOCK_CODE(extern);
}  // namespace kinecal::detail
#endif
