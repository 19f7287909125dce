// Features that several sensors observed, paired by their ids.
//
// An error block compares feature i of one sensor with feature i of another.  Where features carry
// ids, each sensor may list them in an order of its own, and may have seen only some of them.  Before
// a sample is evaluated, its observations are brought into one order; where a sensor did not see a
// feature, one without weight stands in.  So evaluation knows places only.
//
//   all features have ids   paired by id.  A block takes the ids that all its sensors saw
//   no feature has an id    paired by place: feature i of each sensor is the same one
//   ids in some sensors     paired by place, if these sensors list the same ids in the same order;
//                           else an error, because nobody knows what the others saw
//
// This concerns the sensors that blocks connect: A with B, and B with C.
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
  bool paired = true;  ///< feature with feature; else the features of each sensor are one plane
};

/// True if a feature of the sample has an id.
[[nodiscard]] bool has_ids(const Sample& sample);

/// The sample in which feature i of all connected sensors is the same one.
/// @param blocks  those with a sensor that the sample does not have connect nothing
/// @returns  nullopt if the sample is like that already.  Else a feature that a sensor did not see is
///           NaN, and features that no block can compare are left out
/// @throws SampleError  with the sensor, if some of its features have ids and others do not, if two
///                      have the same id, or if its ids cannot be paired with places
[[nodiscard]] std::optional<Sample> pair_features(const Sample& sample,
                                                  std::span<const ComparedSensors> blocks);

/// True if all of these sensors observed features with ids, but no id is one of all of them.
[[nodiscard]] bool ids_are_disjoint(const Sample& sample, const std::vector<std::string>& sensors);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/samples/paired_features.ipp"
#endif
