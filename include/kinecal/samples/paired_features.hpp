// Features that several sensors observed, paired by their ids.
//
// An error block compares feature i of one sensor with feature i of another.  Features with ids may
// come in any order, and each sensor may see only some of them.  Before a sample is evaluated, its
// observations are sorted alike; a feature that a sensor did not see gets a stand-in of weight
// zero.  So evaluation needs no ids.
//
//   all features have ids   paired by id: a block uses the ids that all its sensors saw
//   no feature has an id    paired by place: feature i of each sensor is the same one
//   ids in some sensors     paired by place, if these sensors list the same ids in the same order;
//                           else an error, because the features of the others are ambiguous
//
// Pairing covers all sensors that blocks connect: A with B, and B with C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The sensors of an error block.
struct ComparedSensors {
  std::vector<std::string> names;
  bool paired = true;  ///< feature by feature; else the features of each sensor form one plane
};

/// True if a feature of the sample has an id.
[[nodiscard]] bool has_ids(const Sample& sample);

/// The sample reordered so that feature i of all connected sensors is the same one.
/// @param blocks  ignores those with a sensor that the sample does not have
/// @returns  nullopt if nothing changes.  Else a feature that a sensor did not see is NaN, and
///           features that no block can compare are dropped
/// @throws SampleError  with the sensor, if some of its features have ids and others do not, if two
///                      have the same id, or if its ids cannot be paired with places
[[nodiscard]] std::optional<Sample> pair_features(const Sample& sample,
                                                  std::span<const ComparedSensors> blocks);

/// True if all of these sensors observed features with ids, but share no id.
[[nodiscard]] bool ids_are_disjoint(const Sample& sample, const std::vector<std::string>& sensors);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/samples/paired_features.ipp"
#endif
