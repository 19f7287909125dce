// What the files of this folder instantiate; each of them includes this first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/problem.ipp"

namespace kinecal {

extern template class detail::SensorCodeOf<ChainPoint, Packet>;
extern template class detail::SensorCodeOf<ChainPose, Packet>;
extern template class detail::SensorCodeOf<DepthCamera, Packet>;
extern template class detail::SensorCodeOf<PinholeCamera, Packet>;
extern template class detail::BlockTerm<PointToPoint, Packet>;
extern template class detail::BlockTerm<PointToPixel, Packet>;
extern template class detail::BlockTerm<PointToPlane, Packet>;
extern template class detail::BlockTerm<PlaneToPlane, Packet>;
extern template class detail::BlockTerm<PointDistance, Packet>;
extern template class detail::BlockTerm<PointToLine, Packet>;
extern template class detail::BlockTerm<PointToSphere, Packet>;
extern template class detail::BlockTerm<PoseToPose, Packet>;
extern template class detail::BlockTerm<RayToRay, Packet>;
extern template class detail::BlockTerm<PointToRay, Packet>;

}  // namespace kinecal
