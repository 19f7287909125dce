// Pictures of flat targets, rendered by their geometry: boards and tags as a camera would see them.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal::test {

/// What is printed: brightness (0 to 1) at (x, y) metres of the target; negative beyond its edge.
using Print = std::function<double(double x, double y)>;

/// How a picture is taken.
struct Exposure {
  double blur = 0.5;          ///< of the lens, pixels (standard deviation)
  double noise = 2.0;         ///< of 255 (standard deviation)
  double black = 30.0;        ///< of 255
  double white = 210.0;       ///< of 255
  double background = 130.0;  ///< of 255
  double shade = 0.0;         ///< brightness lost from the left to the right border, 0 to 1
  int motion = 0;             ///< smear to the right, pixels
  unsigned seed = 1;          ///< of the noise
};

/// A target in front of the camera.
struct Target {
  Print print;                                          ///< what is printed on it
  Pose<double> camera_T_board;                          ///< z forward, x right, y down
  std::function<double(double x, double y)> bend = {};  ///< z of its paper, metres; empty: flat
};

inline CameraInfo camera_640(double focal_length = 600.0) {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.p = {focal_length, 0, 319.5, 0, 0, focal_length, 239.5, 0, 0, 0, 1, 0};
  camera.k = {focal_length, 0, 319.5, 0, focal_length, 239.5, 0, 0, 1};
  return camera;
}

/// A camera whose lens nobody has calibrated: a guess of its focal length.
inline CameraInfo unknown_lens(int width, int height) {
  CameraInfo camera = camera_640(width);
  camera.width = width;
  camera.height = height;
  camera.k[2] = camera.p[2] = 0.5 * width - 0.5;
  camera.k[5] = camera.p[6] = 0.5 * height - 0.5;
  return camera;
}

/// A fisheye (equidistant) whose image is as wide as its field of view.
/// @param view  radians from the left to the right border
/// @param d     (4) its coefficients
inline CameraInfo fisheye_camera(int width, int height, double view,
                                 const std::vector<double>& d = {0, 0, 0, 0}) {
  const double t = 0.5 * view, w = t * t;
  const double f = 0.5 * width / (t * (1 + w * (d[0] + w * (d[1] + w * (d[2] + w * d[3])))));
  CameraInfo camera;
  camera.width = width;
  camera.height = height;
  camera.distortion_model = "equidistant";
  camera.d = d;
  camera.k = {f, 0, 0.5 * width - 0.5, 0, f, 0.5 * height - 0.5, 0, 0, 1};
  return camera;
}

/// Where a point of a target appears, pixels.
inline Eigen::Vector2d pixel_of(const CameraInfo& camera, const Pose<double>& camera_T_board,
                                const Vector3<double>& p_board) {
  return Lens(camera).project(camera_T_board * p_board);
}

/// The same of a place on the paper of a target, which may be bent.
inline Eigen::Vector2d pixel_of(const CameraInfo& camera, const Target& target,
                                const Eigen::Vector2d& place) {
  const double z = target.bend ? target.bend(place.x(), place.y()) : 0.0;
  return pixel_of(camera, target.camera_T_board, {place.x(), place.y(), z});
}

/// A target that faces the camera, then turned about the camera's axes (radians), with the point
/// `middle` of the target at `at` (metres, in the camera).
inline Pose<double> facing(const Vector3<double>& at, double tilt_x, double tilt_y, double roll,
                           const Vector3<double>& middle) {
  const Eigen::AngleAxisd rx(tilt_x, Vector3<double>::UnitX()),
      ry(tilt_y, Vector3<double>::UnitY()), rz(roll, Vector3<double>::UnitZ());
  Pose<double> pose;
  pose.rotation = (rx * ry * rz).toRotationMatrix();
  pose.translation = at - pose.rotation * middle;
  return pose;
}

/// The picture of targets by the camera's lens: 4 x 4 rays a pixel, then blur, shade and noise.
[[nodiscard]] GrayImage picture(const CameraInfo& camera, const std::vector<Target>& targets,
                                const Exposure& how = {});

/// What the camera of camera_640() sees of them.
inline View view_of(const std::vector<Target>& targets, const Exposure& how = {}) {
  View view;
  view.frame = "optical";
  view.camera = camera_640();
  view.image = picture(*view.camera, targets, how);
  return view;
}

/// Mean distance of the corners that a finder found in it from where they are, pixels; 1000 if it found
/// none.
inline double mean_error(const Found& found, const Target& target) {
  if (!found) return 1000.0;
  double sum = 0.0;
  const auto& seen = found.observations[0].features;
  const auto& held = found.observations[1].features;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto truth = pixel_of(camera_640(), target.camera_T_board, held[i].point);
    sum += (truth - seen[i].point.head<2>()).norm();
  }
  return sum / static_cast<double>(seen.size());
}

/// A checkerboard whose first inner corner is at the origin: dark between the first corners, with a
/// white margin of one square.
/// @param border  width of its outer squares, of the others'
[[nodiscard]] Print checkerboard(int columns, int rows, double square, double border = 1.0);

}  // namespace kinecal::test
