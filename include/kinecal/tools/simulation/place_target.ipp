// Places the target of a simulation, for simulation_plan.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/study/tag_grid.hpp"
#include "kinecal/surface/robot_surface.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal::detail {

/// Corners of a rectangle around the origin, in the plane of x and y.
[[nodiscard]] inline std::vector<Vector3<double>> rectangle(double width, double height) {
  const double x = 0.5 * width, y = 0.5 * height;
  return {{-x, -y, 0.0}, {x, -y, 0.0}, {x, y, 0.0}, {-x, y, 0.0}};
}

[[nodiscard]] inline bool has_tags(const SimulatedTarget& target) {
  return target.type == "apriltag" || target.type == "aprilgrid";
}

[[nodiscard]] inline bool is_board(const SimulatedTarget& target) {
  return target.type == "checkerboard" || has_tags(target);
}

/// The tags of a target that has some.
[[nodiscard]] inline TagGridShape tags_of(const SimulatedTarget& target) {
  return target.type == "aprilgrid" ? kKalibrTags : kPlainTags;
}

/// Fills in the default size of a board.
inline void complete(SimulatedTarget& target) {
  const bool tags = has_tags(target);
  if (target.columns == 0) target.columns = tags ? 4 : 6;
  if (target.rows == 0) target.rows = tags ? 3 : 5;
  if (target.size == 0.0) target.size = tags ? 0.04 : 0.025;
}

/// Width and height of a board with its margin, metres.
[[nodiscard]] inline std::pair<double, double> board_size(const SimulatedTarget& target) {
  if (target.type == "checkerboard") {
    return {(target.columns + 3) * target.size, (target.rows + 3) * target.size};
  }
  const TagGridShape tags = tags_of(target);
  const double bit = target.size / tags.tag();
  return {tags.width(target.columns) * bit, tags.width(target.rows) * bit};
}

/// The frame in the middle of a target, like that of a patch: link_T_middle.
[[nodiscard]] inline Pose<double> middle_of(const SimulatedTarget& target) {
  if (!is_board(target)) return target.pose;
  const auto [width, height] = board_size(target);
  const TagGridShape tags = tags_of(target);
  const double before =
      has_tags(target) ? target.size * tags.margin / tags.tag() : 2.0 * target.size;
  Pose<double> middle{Matrix3<double>::Identity(),
                      {0.5 * width - before, 0.5 * height - before, 0.0}};
  if (has_tags(target)) middle.rotation = Vector3<double>(1.0, -1.0, -1.0).asDiagonal();  // y up
  return target.pose * middle;
}

/// Sets the pose of a target by its middle.
inline void set_middle(SimulatedTarget& target, const Pose<double>& link_T_middle) {
  target.pose = {};
  target.pose = link_T_middle * middle_of(target).inverse();
}

/// The visible points of a target, metres, in its link.
[[nodiscard]] inline std::vector<Vector3<double>> points_of(const SimulatedTarget& target) {
  if (!target.leds.empty()) return target.leds;
  constexpr double kLedsX = 0.06, kLedsY = 0.05, kFloor = 0.4;  // metres
  std::vector<Vector3<double>> points = rectangle(kLedsX, kLedsY);
  if (target.type == "ground") points = rectangle(kFloor, kFloor);
  if (is_board(target)) points = rectangle(board_size(target).first, board_size(target).second);
  for (Vector3<double>& point : points) point = middle_of(target) * point;
  return points;
}

/// Points of a link's surface that a camera should see, metres, in the link: the corners of a box half as large as that about
/// it.  The link and the others of the robot may be larger than the image.
[[nodiscard]] inline std::vector<Vector3<double>> points_on(const RobotSurface& surface,
                                                            const std::string& link) {
  const SurfaceLink& of = surface.links().at(static_cast<std::size_t>(surface.find(link)));
  const Vector3<double> half = 0.25 * (of.tree.facts().high - of.tree.facts().low);
  std::vector<Vector3<double>> points;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        points.push_back(of.tree.center() + half.cwiseProduct(Vector3<double>(x, y, z)));
      }
    }
  }
  return points;
}

/// Links may be a little below the floor, metres.
inline constexpr double kBelowFloor = 0.01;

/// The goal of a view of a target.
/// @param scale  of its distances: less than 1 for a small robot
inline void set_goal(SimulationPlan& plan, double scale = 1.0) {
  const SimulatedTarget& target = plan.target;
  const SimulatedCamera& camera = plan.setup.camera;
  ViewGoal& goal = plan.goal;
  goal.base = plan.setup.base;
  goal.camera = camera.frame;
  goal.info = camera.info;
  goal.image = camera.image;
  goal.target = target.link;
  const bool is_robot = target.type == "robot";
  goal.points = is_robot ? points_on(*plan.surface, target.link) : points_of(target);
  if (!is_robot) goal.front = -middle_of(target).rotation.col(2);
  constexpr double kNear = 0.2, kFar = 2.0, kFarFloor = 3.0, kGap = 0.05;  // metres
  constexpr double kBoard = 0.35, kLeds = 0.03;                            // of the image's width
  goal.nearest = camera.has_depth ? camera.nearest + kGap : scale * kNear;
  goal.farthest = target.type == "ground" ? kFarFloor : kFar;
  if (camera.has_depth) goal.farthest = std::min(goal.farthest, camera.farthest);
  goal.least_size = is_board(target) ? kBoard : kLeds;
  if (target.type == "ground") goal.most_angle = 70.0 * std::numbers::pi / 180.0;
  goal.margin = 0.12;  // the true robot points elsewhere than its URDF
  goal.radius = scale * ViewGoal{}.radius;
  goal.ground = floor_height(plan.setup.robot, goal) - kBelowFloor;
}

/// Length of the way to a link, metres.
[[nodiscard]] inline double reach_of(const Robot& robot, const std::string& link) {
  double reach = 0.0;
  for (const Joint* joint : joints_to_root(robot, link)) reach += joint->origin.translation.norm();
  return reach;
}

/// Candidate places of a target, most usual first: link_T_middle.
/// @param scale  as of set_goal()
[[nodiscard]] inline std::vector<Pose<double>> usual_places(const Robot& robot,
                                                            const SimulationPlan& plan,
                                                            double scale) {
  const Vector3<double> x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  std::vector<Pose<double>> places;
  if (plan.target.link != plan.setup.base) {  // in a gripper
    constexpr double kOnTop = 0.04;           // metres
    for (const Vector3<double>& front :
         {z, Vector3<double>(-x), Vector3<double>(-z), y, Vector3<double>(-y), x}) {
      places.push_back(facing(scale * kOnTop * front, front));
    }
    return places;
  }
  const double reach = reach_of(robot, plan.setup.camera.frame);
  for (const double share : {0.4, 0.6, 0.9, 1.3}) {
    places.push_back(facing(share * reach * x, z, -x));
    if (plan.target.type == "ground") continue;
    for (const double height : {0.3, 0.6}) {
      places.push_back(facing(share * reach * x + height * reach * z, -x));
    }
  }
  return places;
}

/// Places a target where the camera can see it, and sets the goal.
/// @param scale    as of set_goal()
/// @param give_up  as of poses_with_view_of()
/// @returns  why there is no such place; empty if there is one
[[nodiscard]] inline std::string why_no_place(SimulationPlan& plan, double scale, int give_up) {
  constexpr int kTrial = 3;
  constexpr std::uint64_t kSeed = 1;
  std::string why;
  for (const Pose<double>& place : usual_places(plan.setup.robot, plan, scale)) {
    try {
      set_middle(plan.target, place);
      set_goal(plan, scale);
      if (plan.target.type == "ground") {
        set_middle(plan.target, Pose<double>{Matrix3<double>::Identity(),
                                             {0.0, 0.0, plan.goal.ground + kBelowFloor}} *
                                    place);
        set_goal(plan, scale);
      }
      if (poses_with_view_of(plan.setup.robot, plan.goal, kTrial, kSeed, give_up).size() == kTrial)
        return "";
      why = "few poses in which '" + plan.goal.camera + "' sees the target on '" +
            plan.goal.target + "'";
    } catch (const std::runtime_error& e) {
      why = e.what();
    }
  }
  return why;
}

/// Places a target where the camera can see it, and sets the goal.  A board whose size is not given is made smaller for a
/// robot whose arm is too short for it.
/// @throws InputError  if there is no such place
inline void place_target(SimulationPlan& plan) {
  const double given = plan.target.size;
  complete(plan.target);
  if (plan.target.has_pose || plan.target.type == "robot") {
    set_goal(plan);
    return;
  }
  constexpr int kGiveUp = 100;
  const double usual = plan.target.size;
  for (const double scale : {1.0, 0.5, 0.25}) {
    if (scale < 1.0 && (given > 0.0 || !is_board(plan.target))) break;
    plan.target.size = scale * usual;
    if (why_no_place(plan, scale, kGiveUp).empty()) return;
  }
  plan.target.size = usual;
  const std::string why = why_no_place(plan, 1.0, 0);
  if (why.empty()) return;
  throw InputError(why +
                   "; give its place in the scene: target: {link: LINK, xyz: [x, y, z], rpy: "
                   "[r, p, y]}");
}

/// Adds the robot's own surface.
inline void add_robot(Scene& scene, const std::shared_ptr<const RobotSurface>& surface) {
  for (const SurfaceLink& link : surface->links()) {
    Solid& solid = scene.solids.emplace_back();
    solid.link = link.name;
    solid.low = link.tree.facts().low;
    solid.high = link.tree.facts().high;
    solid.cast = [surface, &link](const Vector3<double>& origin,
                                  const Vector3<double>& direction) -> std::optional<SolidHit> {
      const auto hit = link.tree.cast(origin, direction);
      if (!hit) return std::nullopt;
      return SolidHit{hit->distance, hit->normal};
    };
  }
}

/// Adds the visible objects: target, floor and wall.
inline void furnish(SimulationPlan& plan) {
  SimulatedTarget& target = plan.target;
  Scene& scene = plan.setup.scene;
  constexpr double kInfinite = std::numeric_limits<double>::infinity(), kWallAhead = 4.0;  // metres
  add_ground(scene, plan.goal.ground + kBelowFloor);
  scene.patches.push_back({.pose = facing({kWallAhead, 0.0, 0.0}, {-1.0, 0.0, 0.0}),
                           .width = kInfinite,
                           .height = kInfinite,
                           .albedo = 0.6});
  if (target.type == "ground") return;
  if (target.type == "robot") return add_robot(scene, plan.surface);
  double width = 0.0, height = 0.0;
  const Pose<double> middle_T_link = middle_of(target).inverse();
  for (const Vector3<double>& point : plan.goal.points) {
    width = std::max(width, 2.0 * std::abs((middle_T_link * point).x()));
    height = std::max(height, 2.0 * std::abs((middle_T_link * point).y()));
  }
  const bool flat = is_board(target);
  const double margin = flat ? 0.0 : 0.03, depth = flat ? 0.01 : 0.05;  // metres
  constexpr double kBehind = 0.0005;
  const Pose<double> body{Matrix3<double>::Identity(), {0.0, 0.0, kBehind + 0.5 * depth}};
  add_box(scene, target.link, middle_of(target) * body, {width + margin, height + margin, depth});
  if (has_tags(target)) {
    const Pose<double> middle_T_corner{Matrix3<double>::Identity(), {-width / 2, -height / 2, 0.0}};
    add_picture(scene, target.link, middle_of(target) * middle_T_corner,
                std::make_shared<const GrayImage>(
                    tag_grid_picture(target.columns, target.rows, tags_of(target))),
                width);
  } else if (flat) {
    add_checkerboard(scene, target.link, target.pose, target.columns, target.rows, target.size);
  } else {
    target.leds = plan.goal.points;
    add_leds(scene, target.link, target.leds, *plan.goal.front);
  }
}

}  // namespace kinecal::detail
