// Definitions of view_checks.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/view_checks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/capture/finders/spread.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal {
namespace detail {
namespace {

std::string checked_size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// What is wrong with the size of an image or a cloud.
template <class P>
std::string pixels_problem(const Image<P>& image, const char* name) {
  if (image.empty()) return std::string("the view has no ") + name;
  const bool whole = image.width > 0 && image.height > 0 &&
                     image.pixels.size() == static_cast<std::size_t>(image.width) *
                                                static_cast<std::size_t>(image.height);
  if (whole) return "";
  return std::string("the ") + name + " has " + std::to_string(image.pixels.size()) +
         " values, which are not " + checked_size_text(image.width, image.height);
}

/// Distances between the points of a cloud, projected by camera_info, and their pixels; some points
/// only.
std::vector<double> projection_errors(const View& view) {
  constexpr std::size_t kPoints = 500;
  const auto& p = view.camera->p;
  std::vector<double> errors;
  for (const std::size_t i : thinned(view.points.pixels.size(), kPoints)) {
    const Vector3<double> point = view.points.pixels[i].template cast<double>();
    if (!point.allFinite() || !(point.z() > 0.0)) continue;
    const auto width = static_cast<std::size_t>(view.points.width);
    const std::size_t column = i % width, row = i / width;
    const double u = p[0] * point.x() / point.z() + p[2] - static_cast<double>(column);
    const double v = p[5] * point.y() / point.z() + p[6] - static_cast<double>(row);
    errors.push_back(std::hypot(u, v));
  }
  return errors;
}

}  // namespace
}  // namespace detail

std::string image_problem(const View& view) {
  if (view.image.height == 1 && view.points.height == 1 && view.points.width > 1) {
    return "the cloud is a list of " + std::to_string(view.points.width) +
           " points, without rows and columns in which features can be found; publish an ordered "
           "cloud (realsense2_camera: pointcloud.ordered_pc), or use depth images";
  }
  return detail::pixels_problem(view.image, "image");
}

std::string cloud_problem(const View& view) {
  return detail::pixels_problem(view.points, "point cloud");
}

std::string camera_problem(const View& view) {
  if (!view.camera) {
    return "the camera of '" + view.frame + "' sent no camera_info; is its topic right?";
  }
  const CameraInfo& camera = *view.camera;
  const bool finite = std::all_of(camera.p.begin(), camera.p.end(),
                                  [](double number) { return std::isfinite(number); });
  if (!finite || !(camera.p[0] > 0.0) || !(camera.p[5] > 0.0)) {
    return "the camera_info of '" + view.frame + "' has no focal length in P";
  }
  const auto differs = [&](int width, int height) {
    return camera.width > 0 && camera.height > 0 && width > 0 && height > 1 &&
           (width != camera.width || height != camera.height);
  };
  const std::string of =
      "camera_info is of " + detail::checked_size_text(camera.width, camera.height);
  if (differs(view.image.width, view.image.height)) {
    return of + " pixels, the image has " +
           detail::checked_size_text(view.image.width, view.image.height);
  }
  if (differs(view.points.width, view.points.height)) {
    return of + " pixels, the cloud has " +
           detail::checked_size_text(view.points.width, view.points.height) + " points";
  }
  return "";
}

std::string registration_problem(const View& view) {
  if (view.points.width != view.image.width || view.points.height != view.image.height) {
    return "the cloud has " + detail::checked_size_text(view.points.width, view.points.height) +
           " points, the image " + detail::checked_size_text(view.image.width, view.image.height) +
           " pixels; use a cloud that is registered to the image";
  }
  std::vector<double> errors = detail::projection_errors(view);
  if (errors.empty()) return "the cloud has no valid point";
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  constexpr double kMostPixels = 3.0, kMostOfWidth = 0.02;  // a driver may have its own intrinsics
  if (*middle <= std::max(kMostPixels, kMostOfWidth * view.image.width)) return "";
  return "the points of the cloud are " + reading(*middle, "px") +
         " from where camera_info sees them; are both of the same camera?";
}

std::string image_and_depth_problem(const View& view) {
  for (const auto& check : {image_problem, cloud_problem, camera_problem, registration_problem}) {
    std::string problem = check(view);
    if (!problem.empty()) return problem;
  }
  return "";
}

}  // namespace kinecal
