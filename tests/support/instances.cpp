#include "support/instances.hpp"

namespace kinecal {

template class SensorView<Packet>;
template class LocalSums<Packet>;
template class DifferenceGram<Packet>;
template class FeatureGram<Packet>;
template class BlockTerm<PointToPoint, Packet>;
template class BlockTerm<PointToPixel, Packet>;
template class BlockTerm<PointToPlane, Packet>;
template class BlockTerm<PlaneToPlane, Packet>;

}  // namespace kinecal
