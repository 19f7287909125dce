// kinecal --version: the version, and the instruction set of the evaluation.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "commands.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal::cli {

std::string version() {
  const Evaluation evaluation = evaluation_of_library();
  return fmt::format("kinecal " KINECAL_VERSION " ({}, {} samples at a time)",
                     evaluation.instruction_set, evaluation.lanes);
}

}  // namespace kinecal::cli
