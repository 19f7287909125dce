// The workload as a kinecal::BasicProblem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/point_to_point.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "work.hpp"

namespace kinecal::bench {

/// @tparam S  scalar of the evaluation
template <class S, ErrorBlock B = PointToPoint>
[[nodiscard]] BasicProblem<S> own_problem(const FetchWork& work, std::span<const Sample> samples,
                                          const TermOptions& options = {}) {
  BasicProblem<S> problem(work.robot, kBase, work.table, kFreeFrames);
  problem.add_sensor(ChainPoint{}, work.arm);
  problem.add_sensor(DepthCamera{}, work.camera);
  problem.add_block("hand_eye", B{}, {work.camera.name, work.arm.name}, options);
  for (const Sample& sample : samples) problem.add_sample(sample);
  return problem;
}

[[nodiscard]] inline FreeSet all_free(const ParameterTable& table) {
  std::vector<int> all;
  for (int i = 0; i < table.size(); ++i) all.push_back(i);
  return FreeSet(all, table.size());
}

}  // namespace kinecal::bench
