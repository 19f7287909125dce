// A calibration problem that is evaluated in packets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/basic_problem.hpp"

namespace kinecal {

/// A problem evaluated in packets as wide as the instruction set it is compiled for.
using Problem = BasicProblem<Packet>;

#ifndef KINECAL_HEADER_ONLY
// Compiled once, with all built-in sensors and error blocks.  A sensor or an error block of another type is
// compiled where it is used, a crate's walks, too.
extern template class detail::SensorView<Packet>;
extern template class detail::LocalSums<Packet>;
extern template class detail::PointWrenches<Packet>;
extern template class detail::FeatureWrenches<Packet>;
extern template class Evaluator<Packet>;
extern template class BasicProblem<Packet>;
#endif

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/any_evaluator.ipp"
#endif
