// A problem and its evaluator in double.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

template class SensorView<double>;
template class LocalSums<double>;
template class PointWrenches<double>;
template class FeatureWrenches<double>;
template class Evaluator<double>;
template class BasicProblem<double>;

}  // namespace kinecal
