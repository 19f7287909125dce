// A problem and its evaluator in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::SensorCodeOf<ChainPoint, Packet>;
template class detail::SensorCodeOf<ChainPose, Packet>;
template class detail::SensorCodeOf<DepthCamera, Packet>;
template class detail::SensorCodeOf<PinholeCamera, Packet>;
template class detail::SensorView<Packet>;
template class detail::LocalSums<Packet>;
template class detail::PointWrenches<Packet>;
template class detail::FeatureWrenches<Packet>;
template class Evaluator<Packet>;
template class BasicProblem<Packet>;

}  // namespace kinecal
