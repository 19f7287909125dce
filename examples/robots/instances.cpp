// SPDX-License-Identifier: Apache-2.0
#include "instances.hpp"

namespace kinecal {

template class SensorView<Packet>;
template class LocalSums<Packet>;
template class DifferenceGram<Packet>;
template class FeatureGram<Packet>;
template class BlockTerm<PointToPoint, Packet>;
template class BlockTerm<PointToPixel, Packet>;
template class BlockTerm<PointToPlane, Packet>;
template class BasicProblem<Packet>;

}  // namespace kinecal
