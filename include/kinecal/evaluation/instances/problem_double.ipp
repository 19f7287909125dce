// A problem and its evaluator in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/instances/built_in.ipp"

namespace kinecal {

template class detail::SensorCodeOf<ChainPoint, double>;
template class detail::SensorCodeOf<ChainPose, double>;
template class detail::SensorCodeOf<DepthCamera, double>;
template class detail::SensorCodeOf<PinholeCamera, double>;
template class detail::SensorView<double>;
template class detail::LocalSums<double>;
template class detail::PointWrenches<double>;
template class detail::FeatureWrenches<double>;
template class Evaluator<double>;
template class BasicProblem<double>;

}  // namespace kinecal
