// Problems evaluated in double, one sample at a time: compiled once, by double_problem.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal {

extern template class detail::SensorView<double>;
extern template class detail::LocalSums<double>;
extern template class detail::PointWrenches<double>;
extern template class detail::FeatureWrenches<double>;
extern template class Evaluator<double>;
extern template class BasicProblem<double>;

}  // namespace kinecal
#endif
