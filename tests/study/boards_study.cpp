// Photographs in which kinecal finds a checkerboard, beside OpenCV's search, called in the same way but
// without kinecal's checks: how many, with corners on wrong features, their error, and the processor's time.
//
//   boards_study [VIEWS]                      renders VIEWS, by default 20, for each lens and board
//   boards_study FOLDER COLUMNS ROWS          photographs, of a board with so many inner corners
//
// Rendered boards are anywhere in the field of view, also beyond 90 degrees from the axis of a fisheye.
// The camera_info that kinecal gets is that of a pinhole, as before a calibration.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numbers>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"

namespace kinecal::test {
namespace {

constexpr double kSquare = 0.03;  // metres
constexpr double kWrong = 2.0;    // pixels: a corner is on another feature
constexpr double kDegree = std::numbers::pi / 180.0;

using Corners = std::vector<Eigen::Vector2d>;

/// What one program made of a set of photographs.
struct Score {
  int found = 0, wrong = 0, corners = 0;
  double squares = 0.0, seconds = 0.0;

  /// @param truth  in the same order, or from the last to the first; empty: unknown
  void add(const Corners& seen, const Corners& truth) {
    if (seen.empty()) return;
    ++found;
    if (truth.empty()) return;
    double most = 1e9, sum = 0.0;
    for (const bool reversed : {false, true}) {
      double worst = 0.0, total = 0.0;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const double off = (seen[i] - truth[reversed ? truth.size() - 1 - i : i]).norm();
        worst = std::max(worst, off);
        total += off * off;
      }
      if (worst < most) most = worst, sum = total;
    }
    if (most > kWrong) {
      ++wrong;
      return;
    }
    corners += static_cast<int>(seen.size());
    squares += sum;
  }
};

/// The result of a function, whose time is added: of the processor, so that other programs do not count.
template <class F>
auto timed(double& seconds, const F& function) {
  const std::clock_t start = std::clock();
  auto result = function();
  seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return result;
}

/// Both programs on one photograph.
struct Comparison {
  int views = 0;
  Score kinecal, opencv;
  bool names = false;  ///< prints why kinecal refuses a photograph

  void add(const GrayImage& image, int columns, int rows, const Corners& truth,
           const std::string& name) {
    ++views;
    View view;
    view.image = image;
    view.camera = unknown_lens(image.width, image.height);
    const CheckerboardFinder finder({columns, rows, kSquare, {}});
    const Found found = timed(kinecal.seconds, [&] { return finder.find(view); });
    Corners seen, there;
    if (found) {
      for (const Feature& seen_at : found.observations[0].features) {
        seen.emplace_back(seen_at.point.head<2>());
        if (!truth.empty()) there.push_back(truth[static_cast<std::size_t>(*seen_at.id)]);
      }
    }
    const Corners plain = timed(opencv.seconds, [&] {
      Corners corners =
          detail::find_chessboard(image, columns, rows, detail::BoardSearch::sectors, 1600.0);
      if (corners.empty()) {
        corners =
            detail::find_chessboard(image, columns, rows, detail::BoardSearch::squares, 1600.0);
      }
      detail::refine_corners(image, 4, corners);
      return corners;
    });
    kinecal.add(seen, there);
    Corners ordered = plain;
    if (!ordered.empty()) order_corners(image, columns, rows, ordered);
    opencv.add(ordered, truth);
    if (names && (seen.empty() != plain.empty() || !found.refusal.empty())) {
      std::printf("  %s: %s%s\n", name.c_str(), found.refusal.c_str(),
                  plain.empty() ? " (nor does OpenCV)" : "");
    }
  }

  void print(const std::string& what, int columns, int rows) const {
    std::printf("| %s | %d x %d | %d |", what.c_str(), columns, rows, views);
    for (const Score& s : {kinecal, opencv}) {
      std::printf(" %d | %d | ", s.found, s.wrong);
      if (s.corners > 0) std::printf("%.2f", std::sqrt(s.squares / s.corners));
      std::printf(" | %.2f |", s.seconds / std::max(1, views));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
};

void print_head() {
  std::printf(
      "| lens | board | views | kinecal found | wrong | px | s | OpenCV found | wrong | px | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
}

/// A camera by its name.
struct NamedCamera {
  const char* name;
  CameraInfo camera;
  double half_view;  ///< radians: boards are within it
};

std::vector<NamedCamera> cameras() {
  return {{"pinhole, 56 degrees", camera_640(600.0), 28 * kDegree},
          {"fisheye, 120 degrees",
           fisheye_camera(748, 480, 120 * kDegree, {-.042, .012, -.012, .0025}), 55 * kDegree},
          {"fisheye, 150 degrees", fisheye_camera(800, 600, 150 * kDegree), 70 * kDegree},
          {"fisheye, 190 degrees", fisheye_camera(900, 900, 190 * kDegree), 93 * kDegree},
          {"fisheye, 190 degrees, 1600 pixels", fisheye_camera(1600, 1200, 190 * kDegree),
           93 * kDegree}};
}

/// A board anywhere in the field of view, with all of it and its margin in the image.
std::optional<Target> board_in_view(const NamedCamera& of, int columns, int rows,
                                    std::uint64_t seed) {
  const Lens lens(of.camera);
  SeededRandom random(seed);
  const Vector3<double> middle((columns - 1) * kSquare / 2, (rows - 1) * kSquare / 2, 0.0);
  for (int tries = 0; tries < 2000; ++tries) {
    const double angle = of.half_view * std::sqrt(random.uniform(0.0, 1.0)),
                 round = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double distance = random.uniform(0.12, 0.7), tilt_x = random.uniform(-0.6, 0.6),
                 tilt_y = random.uniform(-0.6, 0.6), roll = random.uniform(-0.8, 0.8);
    Pose<double> pose = facing({0, 0, distance}, tilt_x, tilt_y, roll, middle);
    const Eigen::AngleAxisd away(angle, Vector3<double>(std::cos(round), std::sin(round), 0.0));
    pose.rotation = away * pose.rotation;
    pose.translation = away * pose.translation;
    bool fits = true;
    double side = 1e9;
    for (int r = -2; r <= rows + 1 && fits; ++r) {
      for (int c = -2; c <= columns + 1 && fits; ++c) {
        const auto at = [&](int x, int y) -> Eigen::Vector2d {
          return lens.project(pose * Vector3<double>(x * kSquare, y * kSquare, 0.0));
        };
        const Eigen::Vector2d p = at(c, r);
        fits = p.x() > 2 && p.y() > 2 && p.x() < of.camera.width - 3 &&
               p.y() < of.camera.height - 3 &&
               std::acos((pose * Vector3<double>(c * kSquare, r * kSquare, 0.0)).normalized().z()) <
                   of.half_view;
        if (!fits) break;
        side = std::min({side, (at(c + 1, r) - p).norm(), (at(c, r + 1) - p).norm()});
      }
    }
    if (fits && side >= 9.0) return Target{checkerboard(columns, rows, kSquare), pose};
  }
  return std::nullopt;
}

void render(int views) {
  print_head();
  const std::vector<std::pair<int, int>> boards = {{5, 4}, {8, 6}, {11, 8}};
  for (const NamedCamera& camera : cameras()) {
    for (const auto& [columns, rows] : boards) {
      Comparison both;
      both.names = std::getenv("KINECAL_REFUSALS") != nullptr;
      for (int i = 0; i < views; ++i) {
        const auto target = board_in_view(camera, columns, rows, static_cast<std::uint64_t>(i));
        if (!target) continue;
        Exposure how;
        how.blur = 0.4 + 0.1 * (i % 9);
        how.noise = 1.0 + i % 4;
        how.shade = 0.1 * (i % 5);
        how.seed = static_cast<unsigned>(i);
        Corners truth;
        for (int k = 0; k < columns * rows; ++k) {
          truth.push_back(pixel_of(camera.camera, target->camera_T_board,
                                   {k % columns * kSquare, k / columns * kSquare, 0.0}));
        }
        both.add(picture(camera.camera, {*target}, how), columns, rows, truth,
                 "view " + std::to_string(i));
      }
      both.print(camera.name, columns, rows);
    }
  }
}

void read(const std::string& folder, int columns, int rows) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  Comparison both;
  both.names = true;
  for (const std::string& file : files) both.add(read_image(file), columns, rows, {}, file);
  print_head();
  both.print(folder, columns, rows);
}

}  // namespace
}  // namespace kinecal::test

int main(int count, char** words) {
  if (count == 4) {
    kinecal::test::read(words[1], std::atoi(words[2]), std::atoi(words[3]));
  } else {
    kinecal::test::render(count > 1 ? std::max(1, std::atoi(words[1])) : 20);
  }
  return 0;
}
