// Definitions of board_flips.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/board_flips.hpp"

#include <array>
#include <optional>
#include <stdexcept>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/capture/finders/turn_votes.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Directions of a camera's pixels.
[[nodiscard]] std::vector<Vector3<double>> rays_of(const Observation& camera) {
  const Lens lens(camera_info_of(camera));
  std::vector<Vector3<double>> rays;
  for (const Feature& f : camera.features) {
    rays.push_back(lens.ray(f.point.x(), f.point.y()));
  }
  return rays;
}

/// camera_T_board of a whole board with ordered corners; nullopt if it cannot be computed.
[[nodiscard]] std::optional<Pose<double>> board_pose(const Sample& sample,
                                                     const AlikeBoard& board) {
  const Observation* camera = sample.observation(board.target.camera_sensor);
  const Observation* chain = sample.observation(board.target.chain_sensor);
  const auto corners =
      static_cast<std::size_t>(board.columns) * static_cast<std::size_t>(board.rows);
  if (!camera || !chain || camera->features.size() != corners ||
      chain->features.size() != corners || chain->features[0].frame != board.target.frame) {
    return std::nullopt;
  }
  std::vector<Vector3<double>> in_camera, on_board;
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < corners; ++i) {
    if (camera->features[i].id != static_cast<int>(i)) return std::nullopt;
    in_camera.push_back(camera->features[i].point);
    on_board.push_back(chain->features[i].point);
    places.emplace_back(on_board.back().head<2>());
  }
  if (board.target.corners == CornerKind::points) return rigid_fit(in_camera, on_board);
  try {
    return plane_pose(places, rays_of(*camera));
  } catch (const SettingsError&) {
    return std::nullopt;
  }
}

/// Renumbers a camera's corners as if the board were rotated back.
void turn_board(Observation& camera, const AlikeBoard& board, int turns) {
  const std::vector<Feature> seen = camera.features;
  const auto order = turned_order(board.columns, board.rows, turns);
  for (std::size_t i = 0; i < order.size(); ++i) {
    camera.features[i] = seen[order[i]];
    camera.features[i].id = static_cast<int>(i);
  }
}

/// "8x6"
std::string times_text(int columns, int rows) {
  return std::to_string(columns) + "x" + std::to_string(rows);
}

}  // namespace
}  // namespace detail

AlikeBoard alike_board(const CheckerboardSettings& board) {
  return {board.points_x,
          board.points_y,
          turns_alike(board.points_x, board.points_y),
          board.target,
          "a board of " + detail::times_text(board.points_x, board.points_y) + " corners",
          "a board of which points_x + points_y is odd"};
}

AlikeBoard alike_board(const CircleGridSettings& grid) {
  return {grid.points_x,
          grid.points_y,
          turns_alike(grid),
          grid.target,
          "a grid of " + detail::times_text(grid.points_x, grid.points_y) + " discs",
          "an asymmetric grid of which points_y is odd"};
}

Flips resolve_flips(std::span<Sample> samples, const AlikeBoard& board,
                    std::span<const Pose<double>> board_T_camera_link) {
  if (samples.size() != board_T_camera_link.size()) {
    throw std::invalid_argument("resolve_flips needs a pose of each sample, has " +
                                std::to_string(board_T_camera_link.size()) + " poses and " +
                                std::to_string(samples.size()) + " samples");
  }
  Flips flips{std::vector<int>(samples.size(), 0), {}};
  if (board.turns == 4) return flips;
  std::vector<std::size_t> whole;
  std::vector<Matrix3<double>> links, boards;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto pose = detail::board_pose(samples[i], board);
    if (!pose) continue;
    whole.push_back(i);
    links.push_back(board_T_camera_link[i].rotation);
    boards.push_back(pose->rotation);
  }
  const detail::AgreedTurns agreed = detail::agreed_turns(links, boards, board.turns);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const int turns = agreed.turns[k];
    flips.quarter_turns[whole[k]] = turns;
    if (agreed.doubtful[k]) flips.undecided.push_back(whole[k]);
    for (Observation& o : samples[whole[k]].observations) {
      if (turns != 0 && o.sensor == board.target.camera_sensor) detail::turn_board(o, board, turns);
    }
  }
  return flips;
}

std::vector<Pose<double>> link_poses(const Robot& robot, const std::string& in,
                                     const std::string& link, std::span<const Sample> samples) {
  const RuntimeChain chain = make_chain(robot, in, link);
  std::vector<Pose<double>> poses;
  for (const Sample& sample : samples) {
    poses.push_back(forward_kinematics(chain, [&](const std::string& joint) {
      const auto position = sample.position(joint);
      if (position) return *position;
      throw std::invalid_argument(sample.source + ": joint '" + joint + "' was not measured");
    }));
  }
  return poses;
}

}  // namespace kinecal
