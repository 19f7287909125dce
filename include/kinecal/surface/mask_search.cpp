// Definitions of mask_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/mask_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/solve/rotation_grid.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kSpread = 25.0;  ///< pixels: of the edges of a mask, in the image of the search
constexpr std::size_t kTriangles = 300;  ///< of a link there
constexpr double kFarOutside = 30.0;  ///< pixels there: points farther outside of a mask are alike

/// A mask in the image of the search.
struct SearchedMask {
  std::vector<MaskEdge> edges;
  PixelGrid grid;
  Image<float> outside;  ///< distance of each cell's middle from the mask, pixels; negative inside
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double spread = 0.0;  ///< root of the mean squared distance from the middle, pixels
  int cells = 0;        ///< that are inside
  std::vector<Vector3<double>> points;  ///< of the robot, in the frame of the links
  std::vector<Pose<double>> links;
};

struct CameraPose {
  Pose<double> camera_T_parent;
  double misfit = 0.0;
};

class MaskSearcher {
 public:
  MaskSearcher(const RobotSurface& surface, std::span<const PosedMask> samples,
               const MaskSearch& search)
      : search_(search), outliner_(surface, kTriangles) {
    std::vector<std::vector<Vector3<double>>> of_links;
    for (const SurfaceLink& link : surface.links()) of_links.push_back(few_points(link.tree));
    set_image(samples);
    std::vector<std::vector<Pose<double>>> poses;
    for (const PosedMask& sample : samples) {
      poses.push_back(sample.edges.empty() ? std::vector<Pose<double>>() : sample.links);
    }
    for (const std::size_t i : farthest_apart(poses, static_cast<std::size_t>(search.samples))) {
      add(samples[i], of_links);
    }
  }

  [[nodiscard]] std::vector<CameraPose> search() const {
    if (masks_.empty()) return {};
    std::vector<CameraPose> poses;
    for (int i = 0; i < search_.rotations; ++i) {
      const Matrix3<double> turn = exp(grid_rotation(i, search_.rotations));
      CameraPose& one = poses.emplace_back(CameraPose{{turn, shift_of(turn)}});
      one.misfit = roughly(one.camera_T_parent);
      shift(one, 1.0);
    }
    poses = best_of(poses, search_.shifted, 0.0, 0.0);
    for (CameraPose& one : poses) {
      for (const double step : {0.5, 0.25}) shift(one, step);
    }
    constexpr double kFarTurn = 0.2, kTurn = 0.05, kShift = 0.03;
    poses = best_of(poses, search_.refined, kFarTurn, 1e9);
    poses = best_of(downhill(std::move(poses)), 2 * search_.kept, kTurn, kShift);
    for (CameraPose& one : poses) refine(one, 0.3 * kFarOutside, 8);
    poses = best_of(poses, search_.kept, kTurn, kShift);
    std::erase_if(poses, [&](const CameraPose& one) {
      constexpr double kNearly = 1.5;  // of the best
      return one.misfit > kNearly * poses.front().misfit;
    });
    return poses;
  }

 private:
  [[nodiscard]] static double turn_between(const CameraPose& a, const CameraPose& b) {
    return log(Matrix3<double>(a.camera_T_parent.rotation.transpose() * b.camera_T_parent.rotation))
        .norm();
  }

  /// Lets poses go downhill, some at a time until one fits: there, misfits of right poses are a quarter of others'.
  [[nodiscard]] std::vector<CameraPose> downhill(std::vector<CameraPose> poses) const {
    constexpr std::size_t kAtATime = 20;
    const double fits = 0.4 * static_cast<double>(masks_.size());
    for (std::size_t i = 0, n = 0; i < poses.size(); i = n) {
      bool is_found = false;
      for (n = i; n < std::min(i + kAtATime, poses.size()); ++n) {
        refine(poses[n], kFarOutside, 4);
        is_found = is_found || poses[n].misfit < fits;
      }
      if (is_found) poses.resize(n);
    }
    return poses;
  }

  /// The best of some poses, the best first; of those that are closer together, the best.
  /// @param turn   rad
  /// @param shift  metres
  [[nodiscard]] static std::vector<CameraPose> best_of(std::vector<CameraPose> poses, int count,
                                                       double turn, double shift) {
    std::ranges::stable_sort(poses, {}, &CameraPose::misfit);
    std::vector<CameraPose> best;
    for (const CameraPose& one : poses) {
      const auto is_same = [&](const CameraPose& other) {
        return turn_between(one, other) < turn && (one.camera_T_parent.inverse().translation -
                                                   other.camera_T_parent.inverse().translation)
                                                          .norm() < shift;
      };
      if (turn > 0.0 && std::ranges::any_of(best, is_same)) continue;
      best.push_back(one);
      if (std::ssize(best) == count) break;
    }
    return best;
  }

  /// Points of a link, evenly by area.
  [[nodiscard]] static std::vector<Vector3<double>> few_points(const TriangleTree& tree) {
    constexpr int kPoints = 40;
    std::vector<double> areas;
    for (int t = 0; t < tree.count(); ++t) {
      const auto& [a, b, c] = tree.corners(t);
      areas.push_back((areas.empty() ? 0.0 : areas.back()) + (b - a).cross(c - a).norm());
    }
    std::vector<Vector3<double>> points;
    for (int i = 0; i < kPoints; ++i) {
      const double at = (i + 0.5) / kPoints * areas.back();
      const auto t = std::lower_bound(areas.begin(), areas.end(), at) - areas.begin();
      const auto& [a, b, c] = tree.corners(static_cast<int>(t));
      points.push_back((a + b + c) / 3.0);
    }
    return points;
  }

  /// The image of the search shows what the camera shows, so large that half of the edges of a mask are within kSpread
  /// pixels of their middle.
  void set_image(std::span<const PosedMask> samples) {
    Eigen::Vector2d low = samples.front().low, high = samples.front().high;
    std::vector<double> spreads;
    for (const PosedMask& sample : samples) {
      low = low.cwiseMin(sample.low);
      high = high.cwiseMax(sample.high);
      if (sample.edges.empty()) continue;
      std::vector<double> u, v, away;
      for (const MaskEdge& edge : sample.edges) {
        u.push_back(edge.pixel.x());
        v.push_back(edge.pixel.y());
      }
      const Eigen::Vector2d middle(median_of(std::move(u)), median_of(std::move(v)));
      for (const MaskEdge& edge : sample.edges) away.push_back((edge.pixel - middle).norm());
      spreads.push_back(median_of(std::move(away)));
    }
    constexpr double kMost = 800.0;  // pixels
    const Eigen::Vector2d size = high - low;
    focal_ =
        std::min(kSpread / std::max(1e-9, median_of(std::move(spreads))), kMost / size.maxCoeff());
    offset_ = -focal_ * low;
    width_ = std::max(1, static_cast<int>(std::ceil(focal_ * size.x())));
    height_ = std::max(1, static_cast<int>(std::ceil(focal_ * size.y())));
  }

  void add(const PosedMask& sample, const std::vector<std::vector<Vector3<double>>>& of_links) {
    std::vector<MaskEdge> edges;
    std::vector<Eigen::Vector2d> pixels;
    for (const MaskEdge& edge : sample.edges) {
      const Eigen::Vector2d at = focal_ * edge.pixel + offset_;
      if (at.x() < kMaskBorder || at.y() < kMaskBorder || at.x() > width_ - 1 - kMaskBorder ||
          at.y() > height_ - 1 - kMaskBorder) {
        continue;
      }
      edges.push_back({at, edge.normal});
      pixels.push_back(at);
    }
    if (edges.empty()) return;
    SearchedMask mask{
        std::move(edges), PixelGrid(std::move(pixels), width_, height_), {}, {}, 0.0, 0, {},
        sample.links};
    mask.outside = Image<float>(1 + width_ / kStep, 1 + height_ / kStep, 0.0F);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double squares = 0.0;
    for (int v = 0; v < mask.outside.height; ++v) {
      for (int u = 0; u < mask.outside.width; ++u) {
        const Eigen::Vector2d at(kStep * (u + 0.5), kStep * (v + 0.5));
        const int i = mask.grid.nearest(at, 1e9, [](int) { return true; });
        const MaskEdge& edge = mask.edges[static_cast<std::size_t>(i)];
        const Eigen::Vector2d way = at - edge.pixel;
        const bool is_outside = way.dot(edge.normal) > 0.0;
        mask.outside(u, v) = static_cast<float>(is_outside ? way.norm() : -way.norm());
        if (is_outside) continue;
        sum += at;
        squares += at.squaredNorm();
        ++mask.cells;
      }
    }
    if (mask.cells < 4) return;
    mask.middle = sum / mask.cells;
    mask.spread = std::sqrt(std::max(1.0, squares / mask.cells - mask.middle.squaredNorm()));
    for (std::size_t l = 0; l < of_links.size(); ++l) {
      for (const Vector3<double>& p : of_links[l]) mask.points.push_back(sample.links[l] * p);
    }
    masks_.push_back(std::move(mask));
  }

  /// A translation that puts the middles of robots where those of masks are, as far away as their spreads say: mean of
  /// the samples.
  [[nodiscard]] Vector3<double> shift_of(const Matrix3<double>& turn) const {
    Vector3<double> ahead = Vector3<double>::Zero(), middle = ahead;
    for (const SearchedMask& mask : masks_) {
      Vector3<double> mean = Vector3<double>::Zero();
      double squares = 0.0;
      for (const Vector3<double>& p : mask.points) {
        const Vector3<double> q = turn * p;
        mean += q;
        squares += q.head<2>().squaredNorm();
      }
      const auto count = static_cast<double>(mask.points.size());
      mean /= count;
      const double spread =
          std::sqrt(std::max(1e-6, squares / count - mean.head<2>().squaredNorm()));
      const Eigen::Vector2d direction = (mask.middle - offset_) / focal_;
      ahead += focal_ * spread / mask.spread * Vector3<double>(direction.x(), direction.y(), 1.0);
      middle += mean;
    }
    return (ahead - middle) / static_cast<double>(masks_.size());
  }

  /// Moves the robot across the line of sight and along it while that helps: a mask is cut by the border of its image
  /// and by what stands before the robot, so its middle is not the robot's.
  /// @param step  of kSideways and kAlong
  void shift(CameraPose& one, double step) const {
    constexpr int kPasses = 4;
    constexpr double kSideways = 20.0;  // pixels
    constexpr double kAlong = 0.3;      // of the distance
    for (int pass = 0; pass < kPasses; ++pass) {
      const double before = one.misfit;
      const Vector3<double> pivot = pivot_of(one.camera_T_parent);
      const double sideways = step * kSideways / focal_ * pivot.z();
      for (const double sign : {-1.0, 1.0}) {
        for (const Vector3<double>& way :
             {Vector3<double>(sign * sideways, 0.0, 0.0),
              Vector3<double>(0.0, sign * sideways, 0.0),
              Vector3<double>(pivot * (std::exp(sign * step * kAlong) - 1.0))}) {
          CameraPose next = one;
          next.camera_T_parent.translation += way;
          next.misfit = roughly(next.camera_T_parent);
          if (next.misfit < one.misfit) one = next;
        }
      }
      if (!(one.misfit < before)) break;
    }
  }

  /// Shares of robots outside of their masks and of masks without their robots.  Nothing is known of what the image
  /// does not show.
  [[nodiscard]] double roughly(const Pose<double>& camera_T_parent) const {
    double misfit = 0.0;
    for (const SearchedMask& mask : masks_) {
      Image<std::uint8_t> covered(mask.outside.width, mask.outside.height, 0);
      double outside = 0.0;
      for (const Vector3<double>& p : mask.points) {
        const Vector3<double> q = camera_T_parent * p;
        if (q.z() <= 0.05) continue;
        const int u = static_cast<int>(std::floor((focal_ * q.x() / q.z() + offset_.x()) / kStep)),
                  v = static_cast<int>(std::floor((focal_ * q.y() / q.z() + offset_.y()) / kStep));
        if (!mask.outside.contains(u, v)) continue;
        covered(u, v) = 1;
        outside += std::clamp(mask.outside(u, v) / kFarOutside, 0.0, 1.0);
      }
      int bare = 0;
      for (int v = 0; v < covered.height; ++v) {
        for (int u = 0; u < covered.width; ++u) {
          if (mask.outside(u, v) > 0.0F) continue;
          const bool has_robot = covered(u, v) != 0 || (u > 0 && covered(u - 1, v) != 0) ||
                                 (v > 0 && covered(u, v - 1) != 0) ||
                                 (u + 1 < covered.width && covered(u + 1, v) != 0) ||
                                 (v + 1 < covered.height && covered(u, v + 1) != 0);
          bare += has_robot ? 0 : 1;
        }
      }
      misfit += outside / static_cast<double>(mask.points.size()) +
                static_cast<double>(bare) / mask.cells;
    }
    return misfit;
  }

  /// Goes downhill on outlines, both ways, with a narrowing limit; then judges by the mean distance up to a limit.
  /// @param limit  pixels, of the first round
  void refine(CameraPose& one, double limit, int rounds) const {
    for (int round = 0; round <= rounds; ++round, limit = std::max(3.0, 0.75 * limit)) {
      Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
      double sum = 0.0;
      const double judged = round == rounds ? 10.0 : limit;  // pixels
      for (const SearchedMask& mask : masks_) {
        sum += add_sums(mask, one.camera_T_parent, judged, hessian, gradient);
      }
      if (round == rounds) {
        one.misfit = sum;
        return;
      }
      for (int k = 0; k < 6; ++k) hessian(k, k) *= 1.01;
      hessian.diagonal().array() += 1e-9 * hessian.trace() + 1e-12;
      const Eigen::Matrix<double, 6, 1> step = hessian.ldlt().solve(-gradient);
      const Vector3<double> turn = step.tail<3>();
      constexpr double kMost = 0.2;  // rad
      const double angle = turn.norm();
      const Matrix3<double> rotation =
          exp(Vector3<double>(angle > kMost ? Vector3<double>(turn * (kMost / angle)) : turn));
      const Vector3<double> pivot = pivot_of(one.camera_T_parent);
      one.camera_T_parent.rotation = rotation * one.camera_T_parent.rotation;
      one.camera_T_parent.translation =
          rotation * (one.camera_T_parent.translation - pivot) + pivot + step.head<3>();
    }
  }

  [[nodiscard]] Vector3<double> pivot_of(const Pose<double>& camera_T_parent) const {
    Vector3<double> mean = Vector3<double>::Zero();
    for (const Vector3<double>& p : masks_.front().points) mean += p;
    return camera_T_parent *
           Vector3<double>(mean / static_cast<double>(masks_.front().points.size()));
  }

  /// Adds the sums of a sample.
  /// @returns  mean distances of both ways, in limits
  double add_sums(const SearchedMask& mask, const Pose<double>& camera_T_parent, double limit,
                  Eigen::Matrix<double, 6, 6>& hessian,
                  Eigen::Matrix<double, 6, 1>& gradient) const {
    std::vector<Pose<double>> links;
    for (const Pose<double>& link : mask.links) links.push_back(camera_T_parent * link);
    const auto pixel_of = [&](const Vector3<double>& p) {
      return p.z() > 0.05 ? Eigen::Vector2d(focal_ * p.head<2>() / p.z() + offset_)
                          : Eigen::Vector2d(Eigen::Vector2d::Constant(
                                std::numeric_limits<double>::quiet_NaN()));
    };
    const std::vector<OutlinePoint> outline = outliner_.outline(links, pixel_of, width_, height_);
    std::vector<Eigen::Vector2d> pixels;
    for (const OutlinePoint& point : outline) pixels.push_back(point.pixel);
    const PixelGrid grid(std::move(pixels), width_, height_);
    const Vector3<double> pivot = pivot_of(camera_T_parent);
    const auto add = [&](const OutlinePoint& point, const MaskEdge& edge, double weight) {
      const Eigen::Vector2d way = point.pixel - edge.pixel;
      const double r = point.normal.dot(way);
      const Vector3<double> p = links[static_cast<std::size_t>(point.link)] * point.point;
      const Eigen::Vector2d n = focal_ / p.z() * point.normal;
      const Vector3<double> by_point(n.x(), n.y(), -(n.x() * p.x() + n.y() * p.y()) / p.z());
      Eigen::Matrix<double, 6, 1> row;
      row << by_point, (p - pivot).cross(by_point);
      weight /= 1.0 + std::pow(3.0 * r / limit, 2);
      hessian += weight * row * row.transpose();
      gradient += weight * r * row;
    };
    double distance = 0.0;
    const auto both = [&](std::size_t count, auto&& match) {
      double of_way = 0.0;
      for (std::size_t i = 0; i < count; ++i) of_way += match(i, 1.0 / static_cast<double>(count));
      distance += of_way / (limit * static_cast<double>(std::max<std::size_t>(1, count)));
    };
    both(mask.edges.size(), [&](std::size_t i, double weight) {
      const MaskEdge& edge = mask.edges[i];
      const int at = grid.nearest(edge.pixel, limit, [&](int k) {
        return outline[static_cast<std::size_t>(k)].normal.dot(edge.normal) > 0.0;
      });
      if (at < 0) return limit;
      const OutlinePoint& point = outline[static_cast<std::size_t>(at)];
      add(point, edge, weight);
      return (point.pixel - edge.pixel).norm();
    });
    if (outline.empty()) return 2.0;
    both(outline.size(), [&](std::size_t i, double weight) {
      const OutlinePoint& point = outline[i];
      const int at = mask.grid.nearest(point.pixel, limit, [&](int k) {
        return mask.edges[static_cast<std::size_t>(k)].normal.dot(point.normal) > 0.0;
      });
      if (at < 0) return limit;
      const MaskEdge& edge = mask.edges[static_cast<std::size_t>(at)];
      add(point, edge, weight);
      return (point.pixel - edge.pixel).norm();
    });
    return distance;
  }

  static constexpr int kStep = 6;  ///< pixels of a cell

  MaskSearch search_;
  Outliner outliner_;
  double focal_ = 1.0;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();
  int width_ = 1, height_ = 1;
  std::vector<SearchedMask> masks_;
};

}  // namespace
}  // namespace detail

std::vector<Pose<double>> find_camera_poses(const RobotSurface& surface,
                                            std::span<const PosedMask> samples,
                                            const MaskSearch& search) {
  const auto has_edges = [](const PosedMask& sample) { return !sample.edges.empty(); };
  if (surface.links().empty() || std::none_of(samples.begin(), samples.end(), has_edges)) return {};
  std::vector<Pose<double>> poses;
  for (const detail::CameraPose& one : detail::MaskSearcher(surface, samples, search).search()) {
    poses.push_back(one.camera_T_parent.inverse());
  }
  return poses;
}

}  // namespace kinecal
