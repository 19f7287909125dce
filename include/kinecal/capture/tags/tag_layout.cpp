// Definitions of tag_layout.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/tag_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "kinecal/capture/boards/board_fit.hpp"

namespace kinecal::detail {
namespace {

// Layouts of a grid of tags.

/// Another layout of a grid.
struct TagPlan {
  AprilTagSettings grid;
  int turns = 0;           ///< of each tag on the grid, quarters counter-clockwise
  bool rows_down = false;  ///< the first row is on top
};

/// The place of a tag, on a grid that may have any number of rows.
[[nodiscard]] PlacedTag place_of(const TagPlan& plan, int id) {
  const AprilTagSettings& s = plan.grid;
  const int number = id - s.first_id, column = number % s.columns;
  int row = number / s.columns;
  if (plan.rows_down) row = s.rows - 1 - row;
  const double pitch = s.size * (1.0 + s.spacing), half = s.size / 2.0;
  return {id, s.size, {column * pitch + half, row * pitch + half, 0.0}};
}

/// The corners of a view where a plan has them.
[[nodiscard]] std::vector<TargetCorner> arranged(const TagPlan& plan,
                                                 std::vector<TargetCorner> corners) {
  for (TargetCorner& corner : corners) {
    const int tag = corner.id / 4, k = (corner.id + plan.turns) % 4;
    corner.id = 4 * tag + k;
    corner.target = tag_corner(place_of(plan, tag), k);
  }
  return corners;
}

/// The middles of tags, as corners: they do not show how the tags are turned.
[[nodiscard]] std::vector<TargetCorner> middles(const std::vector<TargetCorner>& corners) {
  std::vector<TargetCorner> all;
  for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
    TargetCorner middle = corners[i];
    middle.pixel = 0.25 * (corners[i].pixel + corners[i + 1].pixel + corners[i + 2].pixel +
                           corners[i + 3].pixel);
    middle.target = 0.25 * (corners[i].target + corners[i + 1].target + corners[i + 2].target +
                            corners[i + 3].target);
    all.push_back(middle);
  }
  return all;
}

}  // namespace

Vector3<double> tag_corner(const PlacedTag& tag, int k) {
  const double half = tag.size / 2.0;
  return tag.centre + Vector3<double>(k == 1 || k == 2 ? half : -half, k >= 2 ? half : -half, 0.0);
}

std::vector<PlacedTag> grid_tags(const AprilTagSettings& s) {
  std::vector<PlacedTag> tags;
  const double pitch = s.size * (1.0 + s.spacing);
  for (int row = 0; row < s.rows; ++row) {
    for (int column = 0; column < s.columns; ++column) {
      tags.push_back({s.first_id + row * s.columns + column,
                      s.size,
                      {column * pitch + s.size / 2.0, row * pitch + s.size / 2.0, 0.0}});
    }
  }
  return tags;
}

namespace {

constexpr double kClearlyBetter = 0.25;  // of what the settings leave, for another layout

/// True if a fit is that of a right layout: of a wrong one, half of the corners may agree.
[[nodiscard]] bool is_right(const BoardFit& fit) {
  constexpr double kMostWrong = 0.3;
  return fit.agrees() && fit.wrong() <= kMostWrong * static_cast<double>(fit.off.size());
}

/// How far a plan is off in the median, pixels; nothing if it does not agree.
[[nodiscard]] std::optional<double> typical_of(const std::vector<TargetCorner>& corners,
                                               const CameraInfo& camera) {
  const BoardFit fit = fit_board(corners, camera);
  if (fit.off.empty() || !is_right(fit)) return std::nullopt;
  return fit.typical;
}

/// The plan in which tags are turned, or rows go down, and that agrees with the view.
[[nodiscard]] std::optional<TagPlan> turned_plan(const AprilTagSettings& grid,
                                                 const CameraInfo& camera,
                                                 const std::vector<TargetCorner>& corners,
                                                 double typical) {
  std::optional<TagPlan> best;
  double least = kClearlyBetter * typical;
  for (const bool down : {false, true}) {
    for (int turns = 0; turns < 4; ++turns) {
      const TagPlan plan{grid, turns, down};
      const auto off = typical_of(arranged(plan, corners), camera);
      if (!off || *off > least) continue;
      least = *off;
      best = plan;
    }
  }
  return best;
}

/// The number of columns that agrees with the view; zero if none does clearly better than others.
[[nodiscard]] int other_columns(const AprilTagSettings& grid, const CameraInfo& camera,
                                const std::vector<TargetCorner>& corners) {
  constexpr std::size_t kEnoughTags = 8;
  constexpr int kMost = 40;
  constexpr double kClearly = 0.15;  // of the tags: another number may fit the first rows
  int highest = grid.first_id;
  for (const TargetCorner& corner : corners) highest = std::max(highest, corner.id / 4);
  const int most = std::min(kMost, highest - grid.first_id + 1);
  int best = 0;
  double least = 1.0, second = 1.0;  // shares that do not fit
  for (int columns = 1; columns <= most; ++columns) {
    TagPlan plan{grid, 0, false};
    plan.grid.columns = columns;
    std::vector<TargetCorner> seen = arranged(plan, corners);
    if (corners.size() >= 4 * kEnoughTags) seen = middles(seen);
    const BoardFit fit = fit_board(seen, camera);
    if (fit.off.empty() || !is_right(fit)) continue;
    const double wrong = fit.wrong() / static_cast<double>(fit.off.size());
    second = std::min(second, std::max(least, wrong));
    if (wrong >= least) continue;
    least = wrong;
    best = columns;
  }
  return best != grid.columns && second - least > kClearly ? best : 0;
}

/// The gap that agrees much better with the view, as a fraction of the size; nothing if none does.
[[nodiscard]] std::optional<double> other_spacing(const TagPlan& from, const CameraInfo& camera,
                                                  const std::vector<TargetCorner>& corners,
                                                  double typical) {
  std::optional<double> best;
  double least = kClearlyBetter * typical;
  const auto attempt = [&](double spacing) {
    TagPlan plan = from;
    plan.grid.spacing = spacing;
    const auto off = typical_of(arranged(plan, corners), camera);
    if (!off || *off > least) return;
    least = *off;
    best = spacing;
  };
  constexpr double kMost = 1.0, kStep = 0.05, kFine = 0.01;
  for (int i = 0; i * kStep <= kMost; ++i) attempt(i * kStep);
  if (!best) return best;
  const double middle = *best;
  for (int i = -4; i <= 4; ++i) attempt(middle + i * kFine);
  return best;
}

[[nodiscard]] std::string two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

[[nodiscard]] std::string turn_note(const TagPlan& plan) {
  std::string note;
  if (plan.turns != 0) {
    note = "the tags are turned by " + std::to_string(90 * plan.turns) +
           " degrees against the grid" + (plan.turns == 2 ? ", as OpenCV draws them" : "");
  }
  if (plan.rows_down)
    note += (note.empty() ? "the" : "; its") + std::string(" first row is on top");
  return note + ": taken so";
}

}  // namespace

TagLayout arrange_tags(const AprilTagSettings& settings, const CameraInfo& camera,
                       std::vector<TargetCorner>& corners) {
  const BoardFit fit = fit_board(corners, camera);
  constexpr double kGood = 0.5;  // pixels
  if (settings.columns == 0 || !settings.tags.empty() || fit.off.empty() ||
      (is_right(fit) && fit.typical <= kGood)) {
    return {};
  }
  // Of a wrong layout, the median may be of the half that agrees.
  const double left = is_right(fit) ? fit.typical : std::max(fit.typical, fit.gap);
  if (!is_right(fit)) {
    if (const auto plan = turned_plan(settings, camera, corners, left)) {
      corners = arranged(*plan, std::move(corners));
      return {"", turn_note(*plan)};
    }
    if (const int columns = other_columns(settings, camera, corners)) {
      const std::string number = std::to_string(columns);
      return {"the tags lie in " + number + (columns == 1 ? " column" : " columns") + ", not in " +
                  std::to_string(settings.columns) + ": write columns: " + number,
              ""};
    }
  }
  if (const auto spacing = other_spacing({settings, 0, false}, camera, corners, left)) {
    return {"the gaps between the tags are " + two_digits(*spacing) + " of a tag, not " +
                two_digits(settings.spacing) + ": write spacing: " + two_digits(*spacing),
            ""};
  }
  return {};
}

}  // namespace kinecal::detail
