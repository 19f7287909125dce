// Definitions of board_turns.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/board_turns.hpp"

#include <fmt/core.h>

#include <variant>

#include "kinecal/capture/finders/board_flips.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Frame of a camera's features; empty if absent.
[[nodiscard]] std::string camera_frame(const std::string& camera,
                                       const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen != nullptr && !seen->features.empty()) return seen->features.front().frame;
  }
  return {};
}

/// The first of these that the robot has; empty if absent.
[[nodiscard]] std::string link_among(const Robot& robot, const std::string& wanted,
                                     const std::string& other) {
  if (!wanted.empty()) return wanted;
  return robot.has_link(other) ? other : "";
}

[[nodiscard]] std::string alike_text(const CaptureFinder& finder, const AlikeBoard& board) {
  return fmt::format("finder '{}': {} looks the same when it is turned", finder.name, board.called);
}

/// The board of a finder, if it looks the same when it is turned.
[[nodiscard]] std::optional<AlikeBoard> board_alike(const FinderSettings& settings) {
  constexpr int kFullTurn = 4;  // quarters
  return std::visit(
      [](const auto& chosen) -> std::optional<AlikeBoard> {
        if constexpr (requires { alike_board(chosen); }) {
          if (AlikeBoard board = alike_board(chosen); board.turns < kFullTurn) return board;
        }
        return std::nullopt;
      },
      settings);
}

/// What was turned, in words.
void report_turns(const CaptureFinder& finder, const Flips& flips,
                  const std::vector<Sample>& samples, Diagnostics& diagnostics) {
  constexpr int kQuarter = 90;  // degrees
  std::string turned, doubtful;
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const int quarters = flips.quarter_turns[i];
    if (quarters == 0) continue;
    ++count;
    turned += fmt::format("{}{} ({} deg)", turned.empty() ? "" : ", ", samples[i].source,
                          kQuarter * quarters);
  }
  for (const std::size_t i : flips.undecided) {
    doubtful += (doubtful.empty() ? "" : ", ") + samples[i].source;
  }
  if (count > 0) {
    diagnostics.note(finder.place,
                     fmt::format("finder '{}': the board was turned in {} of {}: {}", finder.name,
                                 count, counted(samples.size(), "sample"), turned));
  }
  if (!doubtful.empty()) {
    diagnostics.warning(
        finder.place, fmt::format("finder '{}': which way round the board is cannot be decided in "
                                  "these samples; leave them out if they do not fit: {}",
                                  finder.name, doubtful));
  }
}

}  // namespace
}  // namespace detail

void turn_boards(const std::vector<CaptureFinder>& finders, const std::optional<Robot>& robot,
                 const BoardLinks& links, std::vector<Sample>& samples, Diagnostics& diagnostics) {
  for (const CaptureFinder& finder : finders) {
    const std::optional<AlikeBoard> board = detail::board_alike(finder.settings);
    if (!board) continue;
    std::string in, link;
    if (robot) {
      in = detail::link_among(*robot, links.board, board->target.frame);
      link = detail::link_among(*robot, links.camera,
                                detail::camera_frame(board->target.camera_sensor, samples));
    }
    if (in.empty() || link.empty()) {
      diagnostics.warning(
          finder.place,
          detail::alike_text(finder, *board) +
              "; x is taken as the direction nearest to the image's right. Give --urdf, "
              "--board-link "
              "and --camera-link to have turned boards put right, leave out images in which it is "
              "turned further, or use " +
              board->better);
      continue;
    }
    try {
      const auto poses = link_poses(*robot, in, link, samples);
      detail::report_turns(finder, resolve_flips(samples, *board, poses), samples, diagnostics);
    } catch (const std::exception& error) {
      diagnostics.warning(finder.place, detail::alike_text(finder, *board) +
                                            ", and turned ones cannot be put "
                                            "right: " +
                                            error.what());
    }
  }
}

}  // namespace kinecal
