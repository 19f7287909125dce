// A problem and its evaluator in packets.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class SensorView<Packet>;
template class LocalSums<Packet>;
template class PointWrenches<Packet>;
template class FeatureWrenches<Packet>;
template class Evaluator<Packet>;
template class BasicProblem<Packet>;

}  // namespace kinecal
