// A robot's links in space, and its body as spheres: does a pose touch itself, the ground, or a
// line of sight?
//
// It needs no meshes: a body is a sphere swept along the lines between joint origins.  Pairs of
// bodies that touch in almost every pose count as neighbours, and are not checked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A robot's links as poses and as spheres.
class RobotBody {
 public:
  /// @param base    link in which everything is given
  /// @param radius  of the spheres, metres
  /// @param held    positions of joints that never move: bodies that always touch are neighbours
  /// @throws RobotError  if there is no such link
  RobotBody(const Robot& robot, const std::string& base, double radius,
            const std::map<std::string, double>& held = {});

  /// The joints with their own position that move anything connected to the base: the order of q
  /// below.
  [[nodiscard]] const std::vector<std::string>& joints() const { return joints_; }

  /// Index of a link.
  /// @throws RobotError  if it is not connected to the base, or does not exist
  [[nodiscard]] std::size_t link(const std::string& name) const;

  /// Poses of all links: base_T_link, by index, metres.
  /// @param q  positions of joints(), radians or metres
  [[nodiscard]] std::vector<Pose<double>> poses(std::span<const double> q) const;

  /// True if parts that are not neighbours come closer than their spheres.
  [[nodiscard]] bool touches_itself(const std::vector<Pose<double>>& poses) const;

  /// True if the origin of a moving link is below a height in the base, metres.
  [[nodiscard]] bool is_below(const std::vector<Pose<double>>& poses, double height) const;

  /// True if a part that is not a neighbour of either end blocks the line of sight between two
  /// links.
  /// @param a, b          links at its ends
  /// @param p_a, p_b      (3) its ends in the base, metres
  [[nodiscard]] bool hides(const std::vector<Pose<double>>& poses, std::size_t a,
                           const Vector3<double>& p_a, std::size_t b,
                           const Vector3<double>& p_b) const;

 private:
  struct Step {  // from a link to its child
    Joint joint;
    std::size_t parent, child;
    int q = -1;        ///< index of its position
    Mimic drive = {};  ///< how it follows that
  };
  struct Bone {
    std::size_t link;      ///< that carries it
    Vector3<double> a, b;  ///< metres, in the link
  };
  using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

  void add_links(const Robot& robot, const std::string& base);
  void add_bones();
  void find_neighbours(const Robot& robot, const std::map<std::string, double>& held);
  [[nodiscard]] Pairs touching(const std::vector<Pose<double>>& poses) const;
  [[nodiscard]] bool are_neighbours(std::size_t a, std::size_t b) const;

  double radius_;
  std::size_t base_ = 0;
  std::vector<std::string> joints_;
  std::map<std::string, std::size_t> links_;
  std::vector<Step> steps_;          ///< parents first
  std::vector<std::size_t> bodies_;  ///< of each link: the first link that is rigidly connected
  std::vector<Bone> bones_;
  Pairs neighbours_;  ///< of bodies
};

}  // namespace kinecal
