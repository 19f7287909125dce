// The terms of the built-in error blocks of points and planes, evaluated in packets: a unit of the library.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/built_in_block.hpp"
#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {

extern template class BlockTerm<PointToPoint, Packet>;
extern template class BlockTerm<PointToPixel, Packet>;
extern template class BlockTerm<PointToPlane, Packet>;
extern template class BlockTerm<PlaneToPlane, Packet>;
extern template class BlockTerm<PointDistance, Packet>;
extern template class BlockTerm<PointToLine, Packet>;
extern template class BlockTerm<PointToSphere, Packet>;
extern template class BlockTerm<PointToRay, Packet>;

}  // namespace kinecal::detail
#endif
