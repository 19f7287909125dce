// Definitions of disc_centres.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/disc_centres.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/capture/boards/corner_fit.ipp"
#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/geometry/median.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A disc as an image shows it.
struct SeenDisc {
  Eigen::Vector2d middle = {0, 0};  ///< (2) centroid of its darkness, pixels
  double area = 0.0;                ///< pixels
};

/// A pixel near a disc.
struct DiscPixel {
  Eigen::Vector2d at;     ///< from where the disc is about
  double distance = 0.0;  ///< from the disc's centre, of half the gap
  double value = 0.0;
};

/// The pixels that are nearer to a disc than half the gap.
/// @param to_plane  (2 x 2) of pixels from its middle, halves of the gap for each
[[nodiscard]] std::vector<DiscPixel> pixels_of_disc(const GrayImage& image,
                                                    const Eigen::Vector2d& about,
                                                    const Eigen::Matrix2d& to_plane) {
  const Eigen::Matrix2d to_image = to_plane.inverse();
  const double wide = to_image.row(0).norm(), high = to_image.row(1).norm();
  std::vector<DiscPixel> pixels;
  for (int v = std::max(0, static_cast<int>(std::floor(about.y() - high)));
       v <= std::min(image.height - 1, static_cast<int>(std::ceil(about.y() + high))); ++v) {
    for (int u = std::max(0, static_cast<int>(std::floor(about.x() - wide)));
         u <= std::min(image.width - 1, static_cast<int>(std::ceil(about.x() + wide))); ++u) {
      const Eigen::Vector2d off = Eigen::Vector2d(u, v) - about;
      const double distance = (to_plane * off).norm();
      if (distance <= 1.0) pixels.push_back({off, distance, static_cast<double>(image(u, v))});
    }
  }
  return pixels;
}

/// The brightness of the paper around a disc: a plane over (1, u, v).
[[nodiscard]] std::optional<Vector3<double>> paper_around(const std::vector<DiscPixel>& pixels) {
  constexpr double kFrom = 0.88;  // of half the gap
  Matrix3<double> sums = Matrix3<double>::Zero();
  Vector3<double> right = Vector3<double>::Zero();
  for (const DiscPixel& p : pixels) {
    if (p.distance < kFrom) continue;
    const Vector3<double> row(1.0, p.at.x(), p.at.y());
    sums += row * row.transpose();
    right += p.value * row;
  }
  if (!(std::abs(sums.determinant()) > 1e-6)) return std::nullopt;
  return Vector3<double>(sums.inverse() * right);
}

/// A disc near a place.
[[nodiscard]] std::optional<SeenDisc> measured_disc(const GrayImage& image,
                                                    const Eigen::Vector2d& about,
                                                    const Eigen::Matrix2d& to_plane) {
  constexpr double kLeastContrast = 20.0, kNoise = 0.08, kMiddle = 0.25;
  const std::vector<DiscPixel> pixels = pixels_of_disc(image, about, to_plane);
  const auto paper = paper_around(pixels);
  std::vector<double> inside;
  for (const DiscPixel& p : pixels) {
    if (p.distance < kMiddle) inside.push_back(p.value);
  }
  if (!paper || inside.empty()) return std::nullopt;
  const double black = median_of(inside), contrast = (*paper)(0) - black;
  if (!(contrast > kLeastContrast)) return std::nullopt;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0.0;
  for (const DiscPixel& p : pixels) {
    const double white = paper->dot(Vector3<double>(1.0, p.at.x(), p.at.y()));
    const double dark = std::clamp((white - p.value) / contrast, 0.0, 1.0);
    if (dark < kNoise) continue;
    sum += dark * p.at;
    area += dark;
  }
  if (!(area > 4.0)) return std::nullopt;
  return SeenDisc{about + sum / area, area};
}

/// The plane's image in a fit.
[[nodiscard]] PlaneImage image_of(const CornerFit& fit) {
  return [bent = fit.lens.bent, h = fit.h](const Eigen::Vector2d& place) {
    return bent(mapped(h, place));
  };
}

/// How an image stretches at a place: d pixel / d plane (2 x 2).
[[nodiscard]] Eigen::Matrix2d stretch_of(const PlaneImage& image, const Eigen::Vector2d& at,
                                         double step) {
  const Eigen::Vector2d x(0.5 * step, 0.0), y(0.0, 0.5 * step);
  Eigen::Matrix2d stretch;
  stretch << (image(at + x) - image(at - x)) / step, (image(at + y) - image(at - y)) / step;
  return stretch;
}

/// The discs of a grid, measured where they are about.
struct MeasuredDiscs {
  std::vector<Eigen::Vector2d> middles;
  double radius = 0.0;  ///< in the plane
};

/// @param of_plane  where they are about
[[nodiscard]] std::optional<MeasuredDiscs> measured_discs(const GrayImage& image,
                                                          const std::vector<Eigen::Vector2d>& plane,
                                                          std::vector<Eigen::Vector2d> about,
                                                          double gap, const PlaneImage& of_plane) {
  constexpr int kPasses = 3;  // the window follows the disc
  MeasuredDiscs discs;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<double> radii;
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const Eigen::Matrix2d stretch = stretch_of(of_plane, plane[i], 0.1 * gap);
      if (!(std::abs(stretch.determinant()) * gap * gap > 16.0)) return std::nullopt;
      const Eigen::Matrix2d to_plane = stretch.inverse() / (0.5 * gap);
      const auto disc = measured_disc(image, about[i], to_plane);
      if (!disc) return std::nullopt;
      about[i] = disc->middle;
      radii.push_back(std::sqrt(disc->area / (std::numbers::pi * std::abs(stretch.determinant()))));
    }
    discs.radius = median_of(radii);
  }
  discs.middles = std::move(about);
  return discs;
}

}  // namespace
}  // namespace detail

Eigen::Vector2d middle_of_disc(const PlaneImage& image, const Eigen::Vector2d& centre,
                               double radius) {
  constexpr int kCorners = 64;  // of a polygon in place of the circle
  const Eigen::Vector2d origin = image(centre);
  const auto corner = [&](int k) -> Eigen::Vector2d {
    const double angle = 2.0 * std::numbers::pi * k / kCorners;
    return image(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle))) - origin;
  };
  double area = 0.0;  // doubled
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), last = corner(0);
  for (int k = 1; k <= kCorners; ++k) {
    const Eigen::Vector2d next = corner(k);
    const double triangle = last.x() * next.y() - last.y() * next.x();
    area += triangle;
    sum += triangle / 3.0 * (last + next);
    last = next;
  }
  return origin + sum / area;
}

std::optional<DiscCentres> disc_centres(const GrayImage& image,
                                        const std::vector<Eigen::Vector2d>& plane,
                                        const std::vector<Eigen::Vector2d>& about, double gap,
                                        const CameraInfo& camera) {
  constexpr int kPasses = 5;  // each leaves a tenth of the offset or less
  detail::CornerFit fit = detail::best_lens({plane, about}, camera);
  const auto discs = detail::measured_discs(image, plane, about, gap, detail::image_of(fit));
  if (!discs) return std::nullopt;
  fit = detail::best_lens({plane, discs->middles}, camera);
  DiscCentres centres{discs->middles, discs->radius, {}};
  for (int pass = 0; pass < kPasses; ++pass) {
    fit = detail::PlaneView{plane, centres.pixels}.fit(fit.lens);
    centres.image = detail::image_of(fit);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      const Eigen::Vector2d offset =
          middle_of_disc(centres.image, plane[i], discs->radius) - centres.image(plane[i]);
      if (!offset.allFinite()) return std::nullopt;
      centres.pixels[i] = discs->middles[i] - offset;
    }
  }
  return centres;
}

}  // namespace kinecal
