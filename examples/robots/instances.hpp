// The built-in error blocks in packets, compiled once for all robots: see instances.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/evaluate.hpp"
#include "kinecal/errors.hpp"

namespace kinecal {

extern template class SensorView<Packet>;
extern template class LocalSums<Packet>;
extern template class DifferenceGram<Packet>;
extern template class FeatureGram<Packet>;
extern template class BlockTerm<PointToPoint, Packet>;
extern template class BlockTerm<PointToPixel, Packet>;
extern template class BlockTerm<PointToPlane, Packet>;
extern template class BasicProblem<Packet>;

}  // namespace kinecal
