// Definitions of scene.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/scene.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace kinecal {

Pose<double> facing(const Vector3<double>& centre, const Vector3<double>& front,
                    const Vector3<double>& down) {
  const Vector3<double> z = -front.normalized();
  Vector3<double> y = down - z * z.dot(down);
  constexpr double kParallel = 1e-6;
  if (y.norm() < kParallel * down.norm()) y = z.unitOrthogonal();
  y.normalize();
  Pose<double> pose;
  pose.translation = centre;
  pose.rotation.col(0) = y.cross(z);
  pose.rotation.col(1) = y;
  pose.rotation.col(2) = z;
  return pose;
}

void add_box(Scene& scene, const std::string& link, const Pose<double>& link_T_box,
             const Vector3<double>& size, double albedo) {
  for (int axis = 0; axis < 3; ++axis) {
    const int right = (axis + 1) % 3, up = (axis + 2) % 3;
    for (const double sign : {-1.0, 1.0}) {
      const Vector3<double> front = sign * Vector3<double>::Unit(axis);
      const Pose<double> side = facing(0.5 * size(axis) * front, front, Vector3<double>::Unit(up));
      scene.patches.push_back({.link = link,
                               .pose = link_T_box * side,
                               .width = size(right),
                               .height = size(up),
                               .albedo = albedo});
    }
  }
}

void add_picture(Scene& scene, const std::string& link, const Pose<double>& link_T_corner,
                 std::shared_ptr<const GrayImage> picture, double width) {
  if (!picture || picture->empty() || !(width > 0.0)) {
    throw std::invalid_argument("a board needs a picture and a width above zero");
  }
  const double height = width * picture->height / picture->width;
  const Pose<double> corner_T_middle{Matrix3<double>::Identity(), {width / 2, height / 2, 0.0}};
  scene.patches.push_back({.link = link,
                           .pose = link_T_corner * corner_T_middle,
                           .width = width,
                           .height = height,
                           .texture = std::move(picture)});
}

void add_checkerboard(Scene& scene, const std::string& link, const Pose<double>& link_T_board,
                      int columns, int rows, double square) {
  if (columns < 1 || rows < 1 || !(square > 0.0)) {
    throw std::invalid_argument("a checkerboard of " + std::to_string(columns) + " x " +
                                std::to_string(rows) + " corners and squares of " +
                                std::to_string(square) + " m; all must be above zero");
  }
  constexpr std::uint8_t kWhite = 230, kBlack = 20;
  constexpr int kMargin = 1;  // squares
  GrayImage squares(columns + 1 + 2 * kMargin, rows + 1 + 2 * kMargin, kWhite);
  for (int v = 0; v <= rows; ++v) {
    for (int u = 0; u <= columns; ++u) {
      if ((u + v) % 2 == 0) squares(u + kMargin, v + kMargin) = kBlack;
    }
  }
  const double before = -(kMargin + 1) * square;
  const Pose<double> board_T_corner{Matrix3<double>::Identity(), {before, before, 0.0}};
  const double width = squares.width * square;
  add_picture(scene, link, link_T_board * board_T_corner,
              std::make_shared<const GrayImage>(std::move(squares)), width);
}

void add_leds(Scene& scene, const std::string& link, const std::vector<Vector3<double>>& points,
              const Vector3<double>& front, double radius) {
  int code = 0;
  for (const Vector3<double>& point : points) {
    scene.patches.push_back({.link = link,
                             .pose = facing(point, front),
                             .width = 2.0 * radius,
                             .height = 2.0 * radius,
                             .round = true,
                             .albedo = 0.5,
                             .led = ++code});
  }
}

void add_ground(Scene& scene, double height, double albedo) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  scene.patches.push_back({.pose = facing({0.0, 0.0, height}, {0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}),
                           .width = kInfinite,
                           .height = kInfinite,
                           .albedo = albedo});
}

}  // namespace kinecal
