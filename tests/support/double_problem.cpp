#include "support/double_problem.hpp"

#include "kinecal/evaluation/basic_problem.ipp"

namespace kinecal {

template class detail::SensorView<double>;
template class detail::LocalSums<double>;
template class detail::PointWrenches<double>;
template class detail::FeatureWrenches<double>;
template class Evaluator<double>;
template class BasicProblem<double>;

}  // namespace kinecal
