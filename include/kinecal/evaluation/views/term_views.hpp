// A term with its sensors, as they see a batch of samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/evaluation/views/sensor_view.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/term.hpp"

namespace kinecal::detail {

/// The largest number of sensors of an error block.
inline constexpr std::size_t kMostBodies = 4;
/// The bodies of a feature, one per sensor of the error block: the chain that ends there.
using BodyChains = std::array<std::size_t, kMostBodies>;

/// Consecutive features of a layout on the same chains.
struct FeatureRun {
  std::size_t first = 0;  ///< index of the first feature
  std::size_t end = 0;    ///< index after the last one
  BodyChains chains{};    ///< of each sensor
  /// Columns of the whole Jacobian that affect them, in this order: parameters of the sensors and
  /// of the block, rotational twists of each body, translational twists of each body.  A parameter
  /// that moves several bodies occurs several times.
  std::vector<int> columns;
};

/// The runs of a term's features in the samples of a layout.
/// @param sensors  of the problem
/// @param own      parameters of the block itself
[[nodiscard]] std::vector<FeatureRun> feature_runs(const Term& term, const SampleLayout& layout,
                                                   std::span<const SensorState> sensors,
                                                   const OwnParameters& own);

/// A term, its sensors as they see a batch, and its own parameters.
template <class S>
struct TermViews {
  const Term* term = nullptr;                               ///< weight and names
  std::array<const SensorView<S>*, kMostBodies> sensors{};  ///< of the term, in its order
  const OwnParameters* own = nullptr;                       ///< of the block itself
  std::span<const FeatureRun> runs;                         ///< of the features, in their order
  /// Of each feature, lane by lane: 1 / sigma, or 0 if it has none of its own; nullptr: none has one.
  const S* inverse_sigmas = nullptr;
  /// Those that the block takes, lane by lane; after those of a block without a sensor: one, or zero in a lane without a
  /// sample.
  const S* conditions = nullptr;
  std::size_t conditions_step =
      0;  ///< from a feature's to the next one's; zero: they are the sample's

  [[nodiscard]] const SensorView<S>& operator[](std::size_t s) const { return *sensors[s]; }

  /// Number of features that are compared.
  [[nodiscard]] std::size_t features() const { return runs.back().end; }
  /// Number of free parameters of sensors and block that affect a feature.
  [[nodiscard]] std::size_t num_own() const {
    std::size_t n = own->free.size();
    for (std::size_t s = 0; s < term->sensors.size(); ++s) n += sensors[s]->own().free.size();
    return n;
  }
};

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/views/term_views.ipp"
#endif
