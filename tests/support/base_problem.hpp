// A problem of a mobile base alone, with one error block named "base".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/robots.hpp"

namespace kinecal::test {

/// A block with the dimensions of the simulated base.
template <class B>
B block_of(const SimulatedBase& base) {
  B block;
  if constexpr (requires { block.mount; }) {
    block.mount = base.mount;
    block.translation_scale = 1.0 / base.tracked_position;
    block.rotation_scale = 1.0 / base.tracked_angle;
  }
  if constexpr (requires { block.drive.track_width; }) block.drive = base.drive;
  return block;
}

/// A calibration of such parameters.
/// @param names  of the block's parameters, without "base_"
template <class B>
Calibration base_calibration(const B& block, const std::vector<std::string>& names,
                             std::vector<Sample>& samples) {
  std::set<std::string> before;
  for (const std::string_view name : kConditionsOfBlock<B>) {
    if (name.starts_with(kBefore)) before.emplace(name.substr(kBefore.size()));
  }
  set_before(samples, before);
  ParameterTable table;
  add_parameters(table, "base", parameters_of(block));
  std::vector<int> free;
  for (const std::string& name : names) free.push_back(table.index("base_" + name));
  auto problem =
      std::make_unique<Problem>(mobile_manipulator(), "base_link", table, std::set<std::string>());
  problem->add_block("base", block, {});
  return make_calibration(std::move(problem), FreeSet(std::move(free), table.size()), samples);
}

/// Calibrates a base and judges it.
template <class B>
JudgedResult judged_base(const B& block, const std::vector<std::string>& names,
                         std::vector<Sample> samples, const ProcedureOptions& options = {}) {
  Calibration calibration = base_calibration(block, names, samples);
  return calibrate_and_judge(calibration, samples, options);
}

}  // namespace kinecal::test
