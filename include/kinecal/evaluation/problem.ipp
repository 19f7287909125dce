// What problem.hpp declares, compiled: everything that evaluates a problem in packets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/basic_problem.ipp"
#include "kinecal/evaluation/built_in_base_blocks.hpp"
#include "kinecal/evaluation/built_in_blocks.hpp"
#include "kinecal/evaluation/built_in_pose_blocks.hpp"
#include "kinecal/evaluation/built_in_sensors.hpp"
#include "kinecal/evaluation/problem.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal {

template class detail::SensorView<Packet>;
template class detail::LocalSums<Packet>;
template class detail::PointWrenches<Packet>;
template class detail::FeatureWrenches<Packet>;
template class Evaluator<Packet>;
template class BasicProblem<Packet>;

}  // namespace kinecal
#endif
