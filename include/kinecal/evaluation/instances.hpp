// What the library kinecal::core has compiled, in packets and in double: problems, and with them the
// evaluation of the built-in sensors and error blocks (instances/).
//
// A sensor or an error block of another type is compiled where it is used, a crate's walks, too.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

extern template class detail::SensorView<Packet>;
extern template class detail::LocalSums<Packet>;
extern template class detail::PointWrenches<Packet>;
extern template class detail::FeatureWrenches<Packet>;
extern template class Evaluator<Packet>;
extern template class BasicProblem<Packet>;

extern template class detail::SensorView<double>;
extern template class detail::LocalSums<double>;
extern template class detail::PointWrenches<double>;
extern template class detail::FeatureWrenches<double>;
extern template class Evaluator<double>;
extern template class BasicProblem<double>;

}  // namespace kinecal
