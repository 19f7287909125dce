// Corrections: what calibration adds to the joints of a chain, as plain values.
//
// One per joint of the chain, in its order.  They do not know what is free: a forward-kinematics
// user fills them by hand, a calibration from its parameters, once per evaluation and not once per
// sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/motion.hpp"

namespace kinecal {

template <class S>
struct JointCorrection {
  Motion<S> offset;                                   ///< added to the measured position
  Pose<S> frame;                                      ///< between the joint's origin and its motion
  Matrix3<S> left_jacobian = Matrix3<S>::Identity();  ///< of the frame's rotation vector

  void set_frame(const Vector3<S>& translation, const Vector3<S>& rotation_vector) {
    frame = {exp(rotation_vector), translation};
    left_jacobian = kinecal::left_jacobian(rotation_vector);
  }
};

/// Corrections of a chain's joints, in the order of the chain.
template <class S>
using Corrections = std::vector<JointCorrection<S>>;

/// The measured motions of a chain's joints for one sample.
/// @param position_of  callable: name of a joint -> its measured position, radians or metres
template <class PositionOf, std::size_t N>
[[nodiscard]] std::vector<Motion<double>> measured_motions(const Chain<N>& chain,
                                                           PositionOf&& position_of) {
  std::vector<Motion<double>> motions;
  motions.reserve(chain.joints.size());
  for (const ChainJoint& joint : chain.joints) {
    const Mimic& drive = joint.drive;
    motions.push_back(moves(joint.type)
                          ? make_motion(drive.multiplier * position_of(drive.joint) + drive.offset)
                          : Motion<double>{});
  }
  return motions;
}

}  // namespace kinecal
