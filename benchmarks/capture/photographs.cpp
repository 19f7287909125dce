// A checkerboard in real photographs: kinecal's corners beside those of findChessboardCornersSB().
//
//   photographs FOLDER COLUMNS ROWS
//
// Exit code 1 if kinecal finds fewer boards, or its corners are off by more than half a pixel.
// Both sets calibrate the same camera in the same way, with OpenCV's calibrateCamera(): five coefficients of
// distortion, the corners that both find.  So the error that is left is the corners' own.
// OpenCV's own photographs are in Debian's opencv-doc: examples/data, left01.jpg to right14.jpg, 9 x 6 corners.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/files/images/read_image.hpp"

namespace {

using Corners = std::vector<cv::Point2f>;

/// The views in which a finder finds a board.
struct Sightings {
  std::string name;
  int views = 0;
  std::vector<Corners> corners = {};                 ///< of the views that both find
  std::vector<std::vector<cv::Point3f>> board = {};  ///< where they are on the board, squares

  void add(const Corners& found, const std::vector<cv::Point3f>& places) {
    corners.push_back(found);
    board.push_back(places);
  }

  /// Prints the distances between corners and their projections, pixels.
  /// @returns  their median
  [[nodiscard]] double print(cv::Size image) const {
    cv::Mat camera, distortion;
    std::vector<cv::Mat> turns, places;
    cv::calibrateCamera(board, corners, image, camera, distortion, turns, places);
    std::vector<double> distances;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      Corners projected;
      cv::projectPoints(board[i], turns[i], places[i], camera, distortion, projected);
      for (std::size_t k = 0; k < projected.size(); ++k) {
        distances.push_back(cv::norm(projected[k] - corners[i][k]));
      }
    }
    std::sort(distances.begin(), distances.end());
    const double squares =
        std::inner_product(distances.begin(), distances.end(), distances.begin(), 0.0);
    const auto count = distances.size();
    std::printf("%-24s %5d %8zu %8.3f %8.3f %8.3f\n", name.c_str(), views, count,
                distances[count / 2], std::sqrt(squares / static_cast<double>(count)),
                distances.back());
    return distances[count / 2];
  }
};

Corners corners_of(const kinecal::Found& found, std::vector<cv::Point3f>& places, int columns) {
  Corners corners;
  places.clear();
  if (!found) return corners;
  for (const kinecal::Feature& feature : found.observations.front().features) {
    corners.emplace_back(static_cast<float>(feature.point.x()),
                         static_cast<float>(feature.point.y()));
    const int id = feature.id.value();
    places.emplace_back(static_cast<float>(id % columns), static_cast<float>(id / columns), 0.0F);
  }
  return corners;
}

cv::Point2f nearest_to(cv::Point2f corner, const Corners& all) {
  return *std::min_element(all.begin(), all.end(), [&](cv::Point2f a, cv::Point2f b) {
    return cv::norm(a - corner) < cv::norm(b - corner);
  });
}

/// @returns  whether kinecal finds all boards that OpenCV finds, and their corners
[[nodiscard]] bool compare(const std::string& folder, int columns, int rows) {
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(folder)) files.push_back(file.path());
  std::sort(files.begin(), files.end());
  kinecal::CheckerboardSettings settings{columns, rows, 1.0, {}};
  const kinecal::CheckerboardFinder finder(settings);
  Sightings own{"kinecal"}, other{"findChessboardCornersSB"};
  cv::Size size;
  for (const auto& file : files) {
    kinecal::View view;
    view.image = kinecal::read_image(file.string());
    view.camera.emplace();  // finders want to know the size
    view.camera->width = view.image.width;
    view.camera->height = view.image.height;
    const cv::Mat image(view.image.height, view.image.width, CV_8UC1, view.image.pixels.data());
    size = image.size();
    Corners theirs;
    const bool is_found = cv::findChessboardCornersSB(image, {columns, rows}, theirs);
    std::vector<cv::Point3f> places;
    const kinecal::Found found = finder.find(view);
    const Corners ours = corners_of(found, places, columns);
    own.views += ours.empty() ? 0 : 1;
    other.views += is_found ? 1 : 0;
    if (ours.empty()) std::printf("%s: %s\n", file.filename().c_str(), found.refusal.c_str());
    if (!is_found || ours.empty()) continue;
    own.add(ours, places);
    Corners nearest;
    for (const cv::Point2f& corner : ours) nearest.push_back(nearest_to(corner, theirs));
    other.add(nearest, places);
  }
  std::printf("%zu photographs; error after the same calibration, pixels\n", files.size());
  std::printf("%-24s %5s %8s %8s %8s %8s\n", "", "views", "corners", "median", "RMS", "largest");
  constexpr double kFound = 0.5;  // pixels
  const bool is_found = own.print(size) < kFound;
  (void)other.print(size);
  return is_found && own.views >= other.views;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: photographs FOLDER COLUMNS ROWS\n", stderr);
    return 2;
  }
  try {
    return compare(argv[1], std::stoi(argv[2]), std::stoi(argv[3])) ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 1;
  }
}
