// kinecal --version: the version, the instruction set of the evaluation, and which targets this build finds.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <utility>

#include "commands.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/tags/april_tags.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

std::string version() {
  const Evaluation evaluation = evaluation_of_library();
  return fmt::format("kinecal " KINECAL_VERSION " ({}, {} samples at a time)",
                     evaluation.instruction_set, evaluation.lanes);
}

std::string found_targets() {
  std::string found, others;
  for (const auto& [target, fault] :
       {std::pair("checkerboards (OpenCV)", detail::chessboard_fault()),
        std::pair("grids of discs (OpenCV)", detail::circles_fault()),
        std::pair("ChArUco boards (OpenCV)", detail::aruco_fault()),
        std::pair("AprilTags (libapriltag)", detail::april_tag_fault())}) {
    std::string& list = fault.empty() ? found : others;
    list += (list.empty() ? "" : ", ") + std::string(target);
  }
  std::string text = "finds " + (found.empty() ? "no boards or tags" : found);
  if (!others.empty()) text += "\ndoes not find " + others;
  return text;
}

std::string fault_of_target(std::string_view target) {
  if (target.ends_with("checkerboard")) return detail::chessboard_fault();
  if (target.ends_with("charuco")) return detail::aruco_fault();
  const bool has_tags = target.ends_with("apriltag") || target == "aprilgrid";
  return has_tags ? detail::april_tag_fault() : "";
}

void note_fault_of_target(std::string_view target) {
  const std::string fault = fault_of_target(target);
  if (fault.empty()) return;
  const bool finds_tags = detail::april_tag_fault().empty();
  say(stderr, "note: {}{}\n", fault,
      finds_tags ? "; or take a grid of AprilTags, which it finds: --target apriltag" : "");
}

}  // namespace kinecal::cli
