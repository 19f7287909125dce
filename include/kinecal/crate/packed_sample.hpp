// Samples as they are evaluated: as many at once as a packet has lanes.
//
// A sample is prepared once: sine and cosine of its joints, measurements as the sensor models need
// them.  Samples of one shape (the same sensors observed the same number of features in the same
// frames) then share a pack, one lane each: a structure of arrays.  A lane without a sample repeats
// the pack's first sample with weight zero; a feature that is NaN repeats another one with weight
// zero.  So one code path evaluates everything, without a remainder loop.
// Source: ARCHITECTURE.md, ideas 4 (no trigonometry in the loop) and 5 (packets over samples).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <memory>
#include <optional>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/motion.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// What one sensor observed, in one sample (S = double) or in a pack of samples.
template <class S>
struct PackedObservation {
  std::vector<Vector3<S>> measured;  ///< chain3d: point, metres; camera3d: (u, v, z0);
                                     ///< camera2d: (u, v, 0)
  std::vector<S> usable;             ///< of each feature: one, or zero if it is NaN
  std::vector<std::size_t> chain;    ///< of each feature: the chain of the sensor that leads to it
  /// Of the joints of each chain that leads to a feature.
  std::vector<std::optional<std::vector<Motion<S>>>> motions;
  std::unique_ptr<DepthCamera<S>> depth_camera = {};      ///< as recorded, camera3d only
  std::unique_ptr<PinholeCamera<S>> pinhole_camera = {};  ///< as recorded, camera2d only
};

/// What samples must have in common to share a pack.
struct SampleShape {
  std::vector<std::optional<std::vector<std::size_t>>> chains;  ///< of each feature, by sensor
  std::vector<int> terms;                                       ///< indices of the terms that apply

  /// Any strict order, for a map.
  auto operator<=>(const SampleShape&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Samples of one shape, one per lane.
template <class S>
struct PackedSample {
  const SampleShape* shape = nullptr;                     ///< that of all its samples
  std::vector<int> samples;                               ///< indices in the problem, by lane
  std::vector<std::optional<PackedObservation<S>>> seen;  ///< by sensor
};

namespace detail {

/// Sets one lane of every number of an observation.
template <class S>
class LaneWriter {
 public:
  LaneWriter(PackedObservation<S>& to, int lane) : to_(to), lane_(lane) {}

  void write(const PackedObservation<double>& from, double weight) {
    for (std::size_t i = 0; i < from.measured.size(); ++i) {
      for (int k = 0; k < 3; ++k) set_lane(to_.measured[i](k), lane_, from.measured[i](k));
      set_lane(to_.usable[i], lane_, weight * from.usable[i]);
    }
    for (std::size_t c = 0; c < from.motions.size(); ++c) {
      if (from.motions[c]) write(*to_.motions[c], *from.motions[c]);
    }
    if (from.depth_camera) write(*to_.depth_camera, *from.depth_camera);
    if (from.pinhole_camera) write(*to_.pinhole_camera, *from.pinhole_camera);
  }

 private:
  void write(std::vector<Motion<S>>& to, const std::vector<Motion<double>>& from) {
    for (std::size_t j = 0; j < from.size(); ++j) {
      set_lane(to[j].position, lane_, from[j].position);
      set_lane(to[j].cos, lane_, from[j].cos);
      set_lane(to[j].sin, lane_, from[j].sin);
    }
  }
  void write(DepthCamera<S>& to, const DepthCamera<double>& from) {
    set_lane(to.fx, lane_, from.fx);
    set_lane(to.fy, lane_, from.fy);
    set_lane(to.cx, lane_, from.cx);
    set_lane(to.cy, lane_, from.cy);
    set_lane(to.z_offset, lane_, from.z_offset);
    set_lane(to.z_scaling, lane_, from.z_scaling);
  }
  void write(PinholeCamera<S>& to, const PinholeCamera<double>& from) {
    set_lane(to.fx, lane_, from.fx);
    set_lane(to.fy, lane_, from.fy);
    set_lane(to.cx, lane_, from.cx);
    set_lane(to.cy, lane_, from.cy);
    for (std::size_t k = 0; k < from.d.size(); ++k) set_lane(to.d[k], lane_, from.d[k]);
  }

  PackedObservation<S>& to_;
  int lane_;
};

/// An observation of a pack with the extent of one of a sample.
template <class S>
[[nodiscard]] PackedObservation<S> like(const PackedObservation<double>& one) {
  PackedObservation<S> pack;
  pack.measured.resize(one.measured.size());
  pack.usable.resize(one.usable.size());
  pack.chain = one.chain;
  pack.motions.resize(one.motions.size());
  for (std::size_t c = 0; c < one.motions.size(); ++c) {
    if (one.motions[c]) pack.motions[c].emplace(one.motions[c]->size());
  }
  if (one.depth_camera) pack.depth_camera = std::make_unique<DepthCamera<S>>();
  if (one.pinhole_camera) pack.pinhole_camera = std::make_unique<PinholeCamera<S>>();
  return pack;
}

}  // namespace detail

/// Starts a pack with its first sample.
/// @param seen  what each sensor observed
template <class S>
[[nodiscard]] PackedSample<S> make_pack(
    const SampleShape& shape, int sample,
    const std::vector<std::optional<PackedObservation<double>>>& seen) {
  PackedSample<S> pack{&shape, {sample}, {}};
  for (const auto& one : seen) {
    auto& observation = pack.seen.emplace_back();
    if (!one) continue;
    observation = detail::like<S>(*one);
    for (int lane = 0; lane < kLanes<S>; ++lane) {
      detail::LaneWriter<S>(*observation, lane).write(*one, lane == 0 ? 1.0 : 0.0);
    }
  }
  return pack;
}

/// Adds a sample of the same shape to a pack.
/// @param seen  what each sensor observed
/// @returns  false, without adding the sample, if the pack is full
template <class S>
[[nodiscard]] bool add_to_pack(PackedSample<S>& pack, int sample,
                               const std::vector<std::optional<PackedObservation<double>>>& seen) {
  const int lane = static_cast<int>(pack.samples.size());
  if (lane == kLanes<S>) return false;
  pack.samples.push_back(sample);
  for (std::size_t s = 0; s < seen.size(); ++s) {
    if (seen[s]) detail::LaneWriter<S>(*pack.seen[s], lane).write(*seen[s], 1.0);
  }
  return true;
}

}  // namespace kinecal
