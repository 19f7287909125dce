// A chain of a robot in samples: where its joints stand, and what their joint models make of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A chain with the parameters of its joints.
class SampledChain {
 public:
  /// @param lag  table index of the sensor's lag behind the joints' positions, seconds; -1: none
  /// @throws RobotError  if the table has a parameter of a joint model that the joint cannot have, or
  ///                     there is a lag behind a floating joint
  SampledChain(const Robot& robot, RuntimeChain chain, const ParameterTable& table, int lag = -1);

  /// The chain.
  [[nodiscard]] const RuntimeChain& chain() const { return chain_; }
  /// Table indices of its joints' parameters, by joint.
  [[nodiscard]] const std::vector<JointIndices>& parameters() const { return parameters_; }
  /// True if a sample has the positions of all of its joints, and the poses of floating ones.
  [[nodiscard]] bool has_joints(const Sample& sample) const;

  /// What is taken of velocities and directions that a sample does not have: an error, or those of a
  /// joint that rests in the middle of its play.
  enum class Unknown { refused, at_rest };

  /// The motions of its joints in a sample.
  /// @throws SampleError  if the sample lacks a number, or one is not finite
  [[nodiscard]] ModelledMotions motions(const Sample& sample,
                                        Unknown unknown = Unknown::at_rest) const;
  /// The pose of the tip in the base.
  /// @param corrections  of the joints, from parameters()
  /// @throws  as motions()
  [[nodiscard]] Pose<double> tip(const Sample& sample,
                                 const Corrections<double>& corrections) const;

 private:
  /// How a parameter moves a joint of the chain.
  struct Effect {
    JointModelParameter parameter;
    double factor = 1.0;  ///< the multiplier of a mimic joint
  };

  RuntimeChain chain_;
  std::vector<JointIndices> parameters_;
  std::vector<std::vector<Effect>> effects_;  ///< by joint, in the order of JointIndices::model
  std::shared_ptr<const Robot> robot_;        ///< nullptr without joint models
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/problem/sampled_chain.ipp"
#endif
