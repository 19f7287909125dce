// Problems for those who do not know how they are evaluated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// A problem that the library evaluates in packets, as wide as its instruction set allows.
/// Parameters as those of the constructor of AnyProblem.
[[nodiscard]] std::unique_ptr<AnyProblem> make_problem(Robot robot, std::string base,
                                                       ParameterTable table,
                                                       std::set<std::string> frames);

/// How the library evaluates problems.
struct Evaluation {
  std::string_view instruction_set;  ///< what its packets are compiled for: "x86-64-v3"
  int lanes = 1;                     ///< samples evaluated at a time
};
/// How the library that this program is linked with evaluates problems.
[[nodiscard]] Evaluation evaluation_of_library();

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/make_problem.ipp"
#endif
