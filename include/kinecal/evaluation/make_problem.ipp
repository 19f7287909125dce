// Problems of the instruction set that the library is compiled for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/make_problem.hpp"
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

#ifndef KINECAL_HEADER_ONLY
inline namespace KINECAL_INSTRUCTION_SET {
const bool KINECAL_LIBRARY_CHECK = true;
}  // namespace KINECAL_INSTRUCTION_SET
#endif

KINECAL_INLINE std::unique_ptr<AnyProblem> make_problem(Robot robot, std::string base,
                                                        ParameterTable table,
                                                        std::set<std::string> frames) {
  return std::make_unique<Problem>(std::move(robot), std::move(base), std::move(table),
                                   std::move(frames));
}

KINECAL_INLINE Evaluation evaluation_of_library() {
  return {instruction_set(), kLanes<Packet>};
}

}  // namespace kinecal
