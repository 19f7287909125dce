// Photographs in which kinecal finds a target, beside OpenCV's search, called in the same way but without
// kinecal's checks: how many, with corners on wrong features, their error, and the processor's time.
//
//   boards_study [VIEWS [TARGET]]             renders VIEWS, by default 20, for each lens and target, or only
//                                             for targets whose names contain TARGET
//   boards_study bent [VIEWS]                 Kalibr's grid on flat and on bent paper
//   boards_study FOLDER COLUMNS ROWS          photographs, of a board with so many inner corners
//
// Rendered targets are anywhere in the field of view, also beyond 90 degrees from the axis of a fisheye.
// The camera_info that kinecal gets is that of a pinhole, as before a calibration.  For Kalibr's grids the
// number found is that of tags.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/capture/finders/circle_grid_finder.hpp"
#include "kinecal/files/images/read_image.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "support/board_images.hpp"
#include "support/disc_images.hpp"
#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"
#endif

namespace kinecal::test {
namespace {

constexpr double kSquare = 0.03;  // metres
constexpr double kWrong = 2.0;    // pixels: a corner is on another feature
constexpr double kDegree = std::numbers::pi / 180.0;

using Corners = std::vector<Eigen::Vector2d>;

/// A target, kinecal's finder of it and OpenCV's.
struct Kind {
  std::string name;
  Print print;
  Corners places;               ///< of its corners, metres
  Eigen::Vector2d least, most;  ///< of what must be in the image, metres
  double step = kSquare;        ///< metres of it that are to have ...
  double pixels = 9.0;          ///< ... at least so many pixels
  std::function<Found(const View&)> find;
  std::function<Corners(const GrayImage&)> opencv = {};
  bool turns = true;       ///< looks the same when turned by half a turn
  bool y_is_up = false;    ///< of an upright print
  int corners_of_one = 0;  ///< of what is counted: a tag; 0: the whole target
};

/// A corner that was found, and where it is.
using Pair = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

/// What one program made of a set of photographs.
struct Score {
  int found = 0, wrong = 0, corners = 0;
  double squares = 0.0, seconds = 0.0;

  /// @param count  found in this photograph
  void add(const std::vector<Pair>& pairs, int count) {
    found += count;
    double worst = 0.0, total = 0.0;
    for (const auto& [seen, truth] : pairs) {
      worst = std::max(worst, (seen - truth).norm());
      total += (seen - truth).squaredNorm();
    }
    if (worst > kWrong) {
      ++wrong;
      return;
    }
    corners += static_cast<int>(pairs.size());
    squares += total;
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

  /// @param pixel_of_place  where a place of the target is in the image; empty: unknown
  void add(const GrayImage& image, const Kind& kind,
           const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& pixel_of_place,
           const std::string& name) {
    ++views;
    View view;
    view.image = image;
    view.camera = unknown_lens(image.width, image.height);
    const Found found = timed(kinecal.seconds, [&] { return kind.find(view); });
    if (found) {
      std::vector<Pair> best;
      double least = 1e300;
      for (const bool turned : {false, true}) {
        if (!pixel_of_place || (turned && !kind.turns)) continue;
        std::vector<Pair> pairs;
        double sum = 0.0;
        for (std::size_t i = 0; i < found.observations[0].features.size(); ++i) {
          const Eigen::Vector2d at = found.observations[1].features[i].point.head<2>();
          const Eigen::Vector2d place = turned ? kind.places.front() + kind.places.back() - at : at;
          pairs.emplace_back(found.observations[0].features[i].point.head<2>(),
                             pixel_of_place(place));
          sum += (pairs.back().first - pairs.back().second).norm();
        }
        if (sum < least) least = sum, best = pairs;
      }
      const int seen = static_cast<int>(found.observations[0].features.size());
      kinecal.add(best, kind.corners_of_one > 0 ? seen / kind.corners_of_one : 1);
    }
    Corners plain;
    if (kind.opencv) plain = timed(opencv.seconds, [&] { return kind.opencv(image); });
    if (!plain.empty()) {
      std::vector<Pair> pairs;  // whatever their order is
      for (const Eigen::Vector2d& seen : plain) {
        if (!pixel_of_place) break;
        pairs.emplace_back(seen, Eigen::Vector2d(1e9, 1e9));
        for (const Eigen::Vector2d& place : kind.places) {
          const Eigen::Vector2d at = pixel_of_place(place);
          if ((at - seen).norm() < (pairs.back().second - seen).norm()) pairs.back().second = at;
        }
      }
      opencv.add(pairs, 1);
    }
    if (names && !found.refusal.empty()) {
      std::printf("  %s: %s%s\n", name.c_str(), found.refusal.c_str(),
                  plain.empty() ? " (nor does OpenCV)" : "");
    }
  }

  void print(const std::string& what, const Kind& kind) const {
    std::printf("| %s | %s | %d |", what.c_str(), kind.name.c_str(), views);
    for (const Score& s : {kinecal, opencv}) {
      std::printf(" %d | %d | ", s.found, s.wrong);
      if (s.corners > 0) std::printf("%.3f", std::sqrt(s.squares / s.corners));
      std::printf(" | %.2f |", s.seconds / std::max(1, views));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
};

void print_head() {
  std::printf(
      "| lens | target | views | kinecal found | wrong | px | s | OpenCV found | wrong | px | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
}

[[nodiscard]] Kind board_kind(int columns, int rows) {
  Kind kind;
  kind.name = std::to_string(columns) + " x " + std::to_string(rows) + " checkerboard";
  kind.print = checkerboard(columns, rows, kSquare);
  for (int k = 0; k < columns * rows; ++k) {
    kind.places.emplace_back(k % columns * kSquare, k / columns * kSquare);
  }
  kind.least = Eigen::Vector2d::Constant(-2 * kSquare);
  kind.most = Eigen::Vector2d(columns + 1, rows + 1) * kSquare;
  kind.find = [finder = std::make_shared<CheckerboardFinder>(CheckerboardSettings{
                   columns, rows, kSquare, {}})](const View& view) { return finder->find(view); };
  kind.opencv = [=](const GrayImage& image) {
    Corners corners =
        detail::find_chessboard(image, columns, rows, detail::BoardSearch::sectors, 1600.0);
    if (corners.empty()) {
      corners = detail::find_chessboard(image, columns, rows, detail::BoardSearch::squares, 1600.0);
    }
    detail::refine_corners(image, 4, corners);
    return corners;
  };
  return kind;
}

[[nodiscard]] Kind discs_kind(int columns, int rows, bool asymmetric, bool white) {
  CircleGridSettings settings;
  settings.points_x = columns;
  settings.points_y = rows;
  settings.asymmetric = asymmetric;
  settings.size = asymmetric ? 0.02 : kSquare;
  Kind kind;
  kind.name = std::to_string(columns) + " x " + std::to_string(rows) +
              (asymmetric ? " asymmetric " : " ") + (white ? "white discs" : "discs");
  const Print black = disc_print(settings, 0.375 * settings.size);
  kind.print = white ? negative(black) : black;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      kind.places.emplace_back(disc_place(settings, column, row).head<2>());
    }
  }
  kind.least = Eigen::Vector2d::Constant(-1.5 * settings.size);
  kind.most = kind.places.back() + Eigen::Vector2d::Constant(2.0 * settings.size);
  kind.step = settings.size;
  kind.pixels = 12.0;
  kind.turns = !asymmetric;
  kind.find = [finder = std::make_shared<CircleGridFinder>(settings)](const View& view) {
    return finder->find(view);
  };
  kind.opencv = [=](const GrayImage& image) {
    GrayImage dark = image;
    if (white) {
      for (std::uint8_t& p : dark.pixels) p = static_cast<std::uint8_t>(255 - p);
    }
    return detail::find_circles(dark, columns, rows, asymmetric);
  };
  return kind;
}

#ifdef KINECAL_HAVE_APRILTAG

[[nodiscard]] Kind tags_kind(int columns, int rows) {
  AprilTagSettings settings;
  settings.columns = columns;
  settings.rows = rows;
  settings.size = kTagSize;
  settings.spacing = kTagSpacing;
  settings.border = 2;
  settings.min_side = 12.0;
  Kind kind;
  kind.name = std::to_string(columns) + " x " + std::to_string(rows) + " tags of Kalibr";
  kind.print = kalibr_grid(columns, rows);
  kind.least = Eigen::Vector2d::Constant(-2 * kTagSpacing * kTagSize);
  kind.most = Eigen::Vector2d(columns, rows) * (1 + kTagSpacing) * kTagSize - 0.5 * kind.least;
  kind.step = kTagSize;
  kind.pixels = 24.0;
  kind.turns = false;
  kind.y_is_up = true;
  kind.corners_of_one = 4;
  kind.find = [finder = std::make_shared<AprilTagFinder>(settings)](const View& view) {
    return finder->find(view);
  };
  return kind;
}

#endif

[[nodiscard]] std::vector<Kind> kinds() {
  std::vector<Kind> all = {board_kind(5, 4),
                           board_kind(8, 6),
                           board_kind(11, 8),
                           discs_kind(7, 5, false, false),
                           discs_kind(7, 5, false, true),
                           discs_kind(4, 11, true, false),
                           discs_kind(4, 11, true, true)};
#ifdef KINECAL_HAVE_APRILTAG
  all.push_back(tags_kind(6, 6));
#endif
  return all;
}

/// A camera by its name.
struct NamedCamera {
  const char* name;
  CameraInfo camera;
  double half_view;  ///< radians: targets are within it
};

std::vector<NamedCamera> cameras() {
  return {{"pinhole, 56 degrees", camera_640(600.0), 28 * kDegree},
          {"fisheye, 100 degrees",
           fisheye_camera(640, 480, 100 * kDegree, {-.042, .012, -.012, .0025}), 48 * kDegree},
          {"fisheye, 120 degrees",
           fisheye_camera(748, 480, 120 * kDegree, {-.042, .012, -.012, .0025}), 55 * kDegree},
          {"fisheye, 150 degrees", fisheye_camera(800, 600, 150 * kDegree), 70 * kDegree},
          {"fisheye, 190 degrees", fisheye_camera(900, 900, 190 * kDegree), 93 * kDegree},
          {"fisheye, 190 degrees, 1600 pixels", fisheye_camera(1600, 1200, 190 * kDegree),
           93 * kDegree}};
}

/// A target anywhere in the field of view, with all of it and its margin in the image.
std::optional<Target> target_in_view(const NamedCamera& of, const Kind& kind, std::uint64_t seed) {
  const Lens lens(of.camera);
  SeededRandom random(seed);
  Vector3<double> middle(0.0, 0.0, 0.0);
  middle.head<2>() = 0.5 * (kind.least + kind.most);
  for (int tries = 0; tries < 4000; ++tries) {
    const double angle = of.half_view * std::sqrt(random.uniform(0.0, 1.0)),
                 round = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double distance = random.uniform(0.12, 0.7), tilt_x = random.uniform(-0.6, 0.6),
                 tilt_y = random.uniform(-0.6, 0.6), roll = random.uniform(-0.8, 0.8);
    Pose<double> pose = facing({0, 0, distance}, tilt_x + (kind.y_is_up ? std::numbers::pi : 0.0),
                               tilt_y, roll, middle);
    const Eigen::AngleAxisd away(angle, Vector3<double>(std::cos(round), std::sin(round), 0.0));
    pose.rotation = away * pose.rotation;
    pose.translation = away * pose.translation;
    const auto at = [&](const Eigen::Vector2d& p) -> Vector3<double> {
      return pose * Vector3<double>(p.x(), p.y(), 0.0);
    };
    bool fits = true;
    constexpr int kSteps = 12;
    for (int i = 0; i < (kSteps + 1) * (kSteps + 1) && fits; ++i) {
      const Eigen::Vector2d share(i % (kSteps + 1) / double{kSteps},
                                  i / (kSteps + 1) / double{kSteps});
      const Eigen::Vector2d place = kind.least + share.cwiseProduct(kind.most - kind.least);
      const Eigen::Vector2d p = lens.project(at(place)), half(0.5 * kind.step, 0.0);
      const auto side = [&](const Eigen::Vector2d& way) {
        return (lens.project(at(place + way)) - lens.project(at(place - way))).norm();
      };
      fits = p.x() > 2 && p.y() > 2 && p.x() < of.camera.width - 3 &&
             p.y() < of.camera.height - 3 && std::acos(at(place).normalized().z()) < of.half_view &&
             std::min(side(half), side({0.0, half.x()})) >= kind.pixels;
    }
    if (fits) return Target{kind.print, pose};
  }
  return std::nullopt;
}

void render(const NamedCamera& camera, const Kind& kind, int views,
            const std::function<double(double, double)>& bend = {}) {
  Comparison both;
  both.names = std::getenv("KINECAL_REFUSALS") != nullptr;
  for (int i = 0; i < views; ++i) {
    auto target = target_in_view(camera, kind, static_cast<std::uint64_t>(i));
    if (!target) continue;
    target->bend = bend;
    Exposure how;
    how.blur = 0.4 + 0.1 * (i % 9);
    how.noise = 1.0 + i % 4;
    how.shade = 0.1 * (i % 5);
    how.seed = static_cast<unsigned>(i);
    const auto truth = [&](const Eigen::Vector2d& place) {
      return pixel_of(camera.camera, *target, place);
    };
    both.add(picture(camera.camera, {*target}, how), kind, truth, "view " + std::to_string(i));
  }
  both.print(camera.name, kind);
}

void render(int views, const std::string& which) {
  print_head();
  for (const NamedCamera& camera : cameras()) {
    for (const Kind& kind : kinds()) {
      if (kind.name.find(which) != std::string::npos) render(camera, kind, views);
    }
  }
}

#ifdef KINECAL_HAVE_APRILTAG

/// Kalibr's grid of 6 x 6 tags of 50 mm on paper that is flat, rolled, wavy, or whose corner curls up.
void render_bent(int views) {
  const Kind flat = tags_kind(6, 6);
  const double size = flat.most.x();
  struct Paper {
    const char* name;
    std::function<double(double, double)> bend;
  };
  const auto rolled = [=](double height) {
    return [=](double x, double y) {
      const double u = (0.9 * x + 0.4 * y) / size - 0.6;
      return -4.0 * height * u * u;
    };
  };
  const auto curled = [=](double height) {
    return [=](double x, double y) {
      const double beyond = std::max(0.0, (x + y) / size - 1.2) / 0.8;
      return -height * beyond * beyond;
    };
  };
  const auto wavy = [=](double height) {
    return [=](double x, double y) {
      return height * std::sin(2.0 * std::numbers::pi * (x + 0.3 * y) / size);
    };
  };
  const std::vector<Paper> papers = {{"flat", {}},
                                     {"rolled 5 mm", rolled(0.005)},
                                     {"rolled 15 mm", rolled(0.015)},
                                     {"curled 5 mm", curled(0.005)},
                                     {"curled 15 mm", curled(0.015)},
                                     {"curled 30 mm", curled(0.03)},
                                     {"wavy 2 mm", wavy(0.002)},
                                     {"wavy 5 mm", wavy(0.005)}};
  print_head();
  for (const NamedCamera& camera : cameras()) {
    for (const Paper& paper : papers) {
      Kind kind = flat;
      kind.name += std::string(", ") + paper.name;
      render(camera, kind, views, paper.bend);
    }
  }
}

#endif

void read(const std::string& folder, int columns, int rows) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  const Kind kind = board_kind(columns, rows);
  Comparison both;
  both.names = true;
  for (const std::string& file : files) both.add(read_image(file), kind, {}, file);
  print_head();
  both.print(folder, kind);
}

}  // namespace
}  // namespace kinecal::test

int main(int count, char** words) {
#ifdef KINECAL_HAVE_APRILTAG
  if (count > 1 && std::string(words[1]) == "bent") {
    kinecal::test::render_bent(count > 2 ? std::max(1, std::atoi(words[2])) : 10);
    return 0;
  }
#endif
  if (count == 4) {
    kinecal::test::read(words[1], std::atoi(words[2]), std::atoi(words[3]));
  } else {
    kinecal::test::render(count > 1 ? std::max(1, std::atoi(words[1])) : 20,
                          count > 2 ? words[2] : "");
  }
  return 0;
}
