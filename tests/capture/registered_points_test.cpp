// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/registered_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace kinecal {
namespace {

constexpr double kOneMillimetre = 1e-3;

CameraInfo camera_of(int width, int height, double focal, const std::vector<double>& d) {
  CameraInfo info;
  info.width = width;
  info.height = height;
  info.distortion_model = "plumb_bob";
  info.d = d;
  info.k = {focal, 0, 0.5 * width - 0.5, 0, focal, 0.5 * height - 0.5, 0, 0, 1};
  info.p = {focal, 0, info.k[2], 0, 0, focal, info.k[5], 0, 0, 0, 1, 0};
  return info;
}

/// A coarse depth camera beside a camera with a distorted lens: 50 mm to one side, 2 degrees turned.
struct Pair {
  CameraInfo image = camera_of(320, 240, 260.0, {-0.1, 0.03, 1e-3, -1e-3, 0.0});
  RangeCamera depth{camera_of(160, 120, 120.0, {0, 0, 0, 0, 0})};

  explicit Pair(double side) {
    depth.camera_T_depth = {exp(Vector3<double>(0.01, 0.03, 0.015)), {side * 0.05, 0.003, -0.004}};
  }
};

/// Where a ray first meets the scene: (3) metres in the depth camera; not finite where it does not.
/// @param from, along  (3) in the depth camera
using Scene =
    std::function<Vector3<double>(const Vector3<double>& from, const Vector3<double>& along)>;

DepthImage measured(const Scene& scene, const RangeCamera& camera) {
  const Lens lens(camera.info);
  DepthImage depth(camera.info.width, camera.info.height);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      depth(u, v) = static_cast<float>(scene(Vector3<double>::Zero(), lens.ray(u, v)).z());
    }
  }
  return depth;
}

struct Compared {
  int right = 0, wrong = 0, missing = 0;
};

/// The points of the depth against what the camera of the image sees.
Compared compared(const Scene& scene, const Pair& pair) {
  const PointCloud points = registered_points(measured(scene, pair.depth), pair.depth, pair.image);
  EXPECT_EQ(points.width, pair.image.width);
  EXPECT_EQ(points.height, pair.image.height);
  const Lens lens(pair.image);
  const Pose<double> depth_T_image = pair.depth.camera_T_depth.inverse();
  Compared result;
  for (int v = 0; v < points.height; ++v) {
    for (int u = 0; u < points.width; ++u) {
      const Vector3<double> p = points(u, v).cast<double>();
      const Vector3<double> along = depth_T_image.rotation * lens.ray(u, v);
      const Vector3<double> truth =
          pair.depth.camera_T_depth * scene(depth_T_image.translation, along);
      if (!p.allFinite()) {
        ++result.missing;
      } else {
        ++((p - truth).norm() < kOneMillimetre ? result.right : result.wrong);
      }
    }
  }
  return result;
}

/// A plane through a point.
Scene plane(const Vector3<double>& normal, const Vector3<double>& through) {
  return [=](const Vector3<double>& from, const Vector3<double>& along) -> Vector3<double> {
    return from + along * (normal.dot(through - from) / normal.dot(along));
  };
}

TEST(RegisteredPoints, OfATiltedPlaneAreOnItWhereverTheDepthCameraStands) {
  for (const double side : {-1.0, 1.0}) {
    for (const double tilt : {-0.7, 0.9}) {
      const Compared found =
          compared(plane({std::sin(tilt), 0.1, -std::cos(tilt)}, {0, 0, 0.8}), Pair(side));
      EXPECT_EQ(found.wrong, 0) << tilt;
      EXPECT_GT(found.right, 320 * 240 * 8 / 10) << tilt;
    }
  }
}

TEST(RegisteredPoints, BesideAnEdgeThereIsNoDepthRatherThanThatBehindIt) {
  const Scene board = plane({0, 0, -1}, {0, 0, 0.5}), wall = plane({0.1, 0, -1}, {0, 0, 1.3});
  const Scene both = [&](const Vector3<double>& from, const Vector3<double>& along) {
    const Vector3<double> near = board(from, along);
    const bool is_hit = std::abs(near.x()) < 0.12 && std::abs(near.y()) < 0.1;
    return is_hit ? near : wall(from, along);
  };
  for (const double side : {-1.0, 1.0}) {
    const Compared found = compared(both, Pair(side));
    EXPECT_EQ(found.wrong, 0) << side;
    EXPECT_GT(found.missing, 500) << side;  // what only the camera of the image sees
    EXPECT_GT(found.right, 320 * 240 * 7 / 10) << side;
  }
}

TEST(RegisteredPoints, HolesStayHoles) {
  const Pair pair(1.0);
  DepthImage depth = measured(plane({0, 0, -1}, {0, 0, 1.0}), pair.depth);
  for (int v = 40; v < 80; ++v) {
    for (int u = 60; u < 100; ++u) depth(u, v) = std::nanf("");
  }
  const PointCloud points = registered_points(depth, pair.depth, pair.image);
  const Eigen::Vector2d middle =
      Lens(pair.image).project(pair.depth.camera_T_depth * Vector3<double>(0.0, 0.0, 1.0));
  EXPECT_FALSE(points(static_cast<int>(middle.x()), static_cast<int>(middle.y())).allFinite());
  const PointCloud none = registered_points(DepthImage(160, 120), pair.depth, pair.image);
  for (const Vector3<float>& p : none.pixels) ASSERT_FALSE(p.allFinite());
  EXPECT_THROW((void)registered_points(DepthImage(80, 60), pair.depth, pair.image),
               std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
