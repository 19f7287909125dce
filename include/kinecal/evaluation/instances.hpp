// What the library kinecal::core has compiled: the evaluation of the built-in error blocks, in
// packets and in double.
//
// instances/ holds a file for each that is compiled by itself.  An error block of another type is
// compiled where it is used, a crate's walks and sizes, too.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

extern template class SensorView<Packet>;
extern template class LocalSums<Packet>;
extern template class PointWrenches<Packet>;
extern template class FeatureWrenches<Packet>;
extern template class Evaluator<Packet>;
extern template class BasicProblem<Packet>;
extern template class BlockTerm<PointToPoint, Packet>;
extern template class BlockTerm<PointToPixel, Packet>;
extern template class BlockTerm<PointToPlane, Packet>;
extern template class BlockTerm<PlaneToPlane, Packet>;
extern template class BlockTerm<PointDistance, Packet>;
extern template class BlockTerm<PointToLine, Packet>;
extern template class BlockTerm<PointToSphere, Packet>;
extern template class BlockTerm<PoseToPose, Packet>;
extern template class BlockTerm<RayToRay, Packet>;

extern template class SensorView<double>;
extern template class LocalSums<double>;
extern template class PointWrenches<double>;
extern template class FeatureWrenches<double>;
extern template class Evaluator<double>;
extern template class BasicProblem<double>;
extern template class BlockTerm<PointToPoint, double>;
extern template class BlockTerm<PointToPixel, double>;
extern template class BlockTerm<PointToPlane, double>;
extern template class BlockTerm<PlaneToPlane, double>;
extern template class BlockTerm<PointDistance, double>;
extern template class BlockTerm<PointToLine, double>;
extern template class BlockTerm<PointToSphere, double>;
extern template class BlockTerm<PoseToPose, double>;
extern template class BlockTerm<RayToRay, double>;

}  // namespace kinecal
