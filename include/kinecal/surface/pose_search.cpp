// Definitions of pose_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/pose_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "kinecal/solve/rotation_grid.hpp"

namespace kinecal {

namespace detail {
namespace {

using Points = std::vector<Vector3<double>>;

constexpr double kCell = 0.03;   ///< metres, of the grids
constexpr double kFar = 0.25;    ///< metres, beyond which all distances are alike
constexpr double kMoved = 0.06;  ///< metres, that a point must be away from another sample's

/// The cell of a point, as one number.
[[nodiscard]] std::int64_t cell_of(const Vector3<double>& p, double size, int dx = 0, int dy = 0,
                                   int dz = 0) {
  const auto along = [&](Eigen::Index k, int shift) {
    constexpr double kMost = 1e6;
    const double cell = std::clamp(std::floor(p[k] / size), -kMost, kMost - 1.0);
    return static_cast<std::int64_t>(cell) + shift + (std::int64_t{1} << 20);
  };
  return (along(0, dx) << 42) | (along(1, dy) << 21) | along(2, dz);
}

/// Points of a link's surface, one in each cell that it passes.
[[nodiscard]] Points surface_points(const TriangleTree& tree, double size) {
  Points points;
  std::unordered_set<std::int64_t> cells;
  for (int t = 0; t < tree.count(); ++t) {
    const auto& [a, b, c] = tree.corners(t);
    const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(longest / size)));
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        const Vector3<double> p = a + (b - a) * i / parts + (c - a) * j / parts;
        if (cells.insert(cell_of(p, size)).second) points.push_back(p);
      }
    }
  }
  return points;
}

/// Distances from a surface, in a grid about it.
class DistanceGrid {
 public:
  explicit DistanceGrid(const Points& surface) {
    Vector3<double> low = surface.front(), high = surface.front();
    for (const Vector3<double>& p : surface) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    origin_ = (low.array() - kFar).matrix();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      size_[k] = static_cast<int>((high[axis] - low[axis] + 2.0 * kFar) / kCell) + 2;
    }
    squares_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], kNothing);
    for (const Vector3<double>& p : surface) {
      const Vector3<double> at = (p - origin_) / kCell;
      squares_[index(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                     static_cast<int>(std::lround(at.z())))] = 0.0F;
    }
    transform();
    for (float& square : squares_) {
      square = std::min(static_cast<float>(kFar), static_cast<float>(kCell) * std::sqrt(square));
    }
  }

  /// The distance of a point, and its gradient.
  [[nodiscard]] double at(const Vector3<double>& p, Vector3<double>* gradient) const {
    const Vector3<double> place = (p - origin_) / kCell;
    std::array<int, 3> first{};
    std::array<double, 3> part{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = place[static_cast<Eigen::Index>(k)];
      if (!(x >= 0.0 && x < size_[k] - 1)) return kFar;
      first[k] = static_cast<int>(x);
      part[k] = x - first[k];
    }
    const float* base = &squares_[index(first[0], first[1], first[2])];
    const std::ptrdiff_t up = size_[2], over = std::ptrdiff_t{size_[1]} * size_[2];
    const double u = part[0], v = part[1], w = part[2];
    const auto line = [&](const float* from) { return from[0] + w * (from[1] - from[0]); };
    const double a = line(base), b = line(base + up), c = line(base + over),
                 d = line(base + over + up);
    const double low = a + v * (b - a), high = c + v * (d - c);
    if (gradient != nullptr) {
      const auto rise = [](const float* from) { return double{from[1]} - from[0]; };
      const double r = rise(base) + v * (rise(base + up) - rise(base)),
                   s = rise(base + over) + v * (rise(base + over + up) - rise(base + over));
      *gradient =
          Vector3<double>(high - low, (b - a) + u * ((d - c) - (b - a)), r + u * (s - r)) / kCell;
    }
    return low + u * (high - low);
  }

 private:
  static constexpr float kNothing = 1e6F;

  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[2]) +
           static_cast<std::size_t>(z);
  }

  /// Squared distances in cells, one axis after another: the lower envelope of parabolas.
  void transform() {
    std::vector<float> values, low;
    std::vector<int> places;
    std::vector<float> starts;
    const auto along = [&](std::size_t first, std::size_t step, int count) {
      const auto n = static_cast<std::size_t>(count);
      values.resize(n);
      for (std::size_t i = 0; i < n; ++i) values[i] = squares_[first + i * step];
      places.assign(n, 0);
      starts.assign(n + 1, 0.0F);
      std::size_t k = 0;
      starts[0] = -1e9F;
      starts[1] = 1e9F;
      for (int q = 1; q < count; ++q) {
        const auto meet = [&](int p) {
          return (values[static_cast<std::size_t>(q)] + static_cast<float>(q * q) -
                  values[static_cast<std::size_t>(p)] - static_cast<float>(p * p)) /
                 static_cast<float>(2 * (q - p));
        };
        float s = meet(places[k]);
        while (s <= starts[k]) s = meet(places[--k]);
        places[++k] = q;
        starts[k] = s;
        starts[k + 1] = 1e9F;
      }
      k = 0;
      for (int q = 0; q < count; ++q) {
        while (starts[k + 1] < static_cast<float>(q)) ++k;
        const int p = places[k];
        squares_[first + static_cast<std::size_t>(q) * step] =
            static_cast<float>((q - p) * (q - p)) + values[static_cast<std::size_t>(p)];
      }
    };
    for (int x = 0; x < size_[0]; ++x) {
      for (int y = 0; y < size_[1]; ++y) along(index(x, y, 0), 1, size_[2]);
      for (int z = 0; z < size_[2]; ++z) {
        along(index(x, 0, z), static_cast<std::size_t>(size_[2]), size_[1]);
      }
    }
    for (int y = 0; y < size_[1]; ++y) {
      for (int z = 0; z < size_[2]; ++z) {
        along(index(0, y, z), static_cast<std::size_t>(size_[1] * size_[2]), size_[0]);
      }
    }
  }

  Vector3<double> origin_;
  std::array<int, 3> size_{};
  std::vector<float> squares_;
};

/// The middle of points: the median along each axis.
[[nodiscard]] Vector3<double> middle_of(const Points& points) {
  Vector3<double> middle;
  std::vector<double> along(points.size());
  for (Eigen::Index k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < points.size(); ++i) along[i] = points[i][k];
    const auto half = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
    std::nth_element(along.begin(), half, along.end());
    middle[k] = *half;
  }
  return middle;
}

/// So many points, evenly from the list.
[[nodiscard]] Points some_of(const Points& points, std::size_t most) {
  Points some;
  const std::size_t count = std::min(points.size(), most);
  for (std::size_t i = 0; i < count; ++i) some.push_back(points[i * points.size() / count]);
  return some;
}

/// Of each cloud, the points that are away from most of the others.
[[nodiscard]] std::vector<Points> moved_points(const std::vector<Points>& all) {
  std::vector<std::unordered_set<std::int64_t>> cells(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    for (const Vector3<double>& p : all[s]) cells[s].insert(cell_of(p, kMoved));
  }
  std::vector<Points> moved(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    for (const Vector3<double>& p : all[s]) {
      std::size_t away = 0;
      for (std::size_t o = 0; o < all.size(); ++o) {
        bool is_near = false;
        for (int n = 0; n < 27 && !is_near; ++n) {
          is_near = cells[o].contains(cell_of(p, kMoved, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
        }
        if (!is_near) ++away;
      }
      if (2 * away >= all.size() - 1 && away > 0) moved[s].push_back(p);
    }
  }
  return moved;
}

/// A pose and the mean distance of all points under it.
struct Candidate {
  Pose<double> pose;
  double distance = 0.0;
};

/// The search: grids of some samples, a few points of each.
class PoseSearcher {
 public:
  PoseSearcher(const RobotSurface& surface, std::span<const PosedCloud> samples,
               const SurfaceSearch& search)
      : search_(search) {
    std::vector<Points> of_links;
    for (const SurfaceLink& link : surface.links()) {
      of_links.push_back(surface_points(link.tree, 0.5 * kCell));
    }
    std::vector<Points> robots;
    std::vector<std::vector<Pose<double>>> poses;
    for (const PosedCloud& sample : samples) {
      poses.push_back(sample.points.empty() ? std::vector<Pose<double>>() : sample.links);
    }
    std::vector<Points> clouds;
    for (const std::size_t i : farthest_apart(poses, static_cast<std::size_t>(search.samples))) {
      const PosedCloud* sample = &samples[i];
      Points& robot = robots.emplace_back();
      for (std::size_t l = 0; l < of_links.size(); ++l) {
        for (const Vector3<double>& p : of_links[l]) robot.push_back(sample->links[l] * p);
      }
      grids_.emplace_back(robot);
      clouds.push_back(sample->points);
    }
    const std::vector<Points> moved = moved_points(clouds);
    for (std::size_t s = 0; s < clouds.size(); ++s) {  // most of a cloud may be background
      constexpr std::size_t kFewest = 20;
      const auto most = static_cast<std::size_t>(search.points);
      const bool has_moved = moved[s].size() >= kFewest;
      clouds_.push_back(some_of(clouds[s], has_moved ? most / 2 : most));
      if (!has_moved) continue;
      const Points more = some_of(moved[s], most - clouds_.back().size());
      clouds_.back().insert(clouds_.back().end(), more.begin(), more.end());
    }
    add_middles(robots, clouds);
    add_middles(moved_points(robots), moved);
  }

  [[nodiscard]] std::vector<Candidate> search() const {
    std::vector<Candidate> all;
    for (int i = 0; i < search_.rotations; ++i) {
      const Matrix3<double> turn = exp(grid_rotation(i, search_.rotations));
      for (const auto& middles : middles_) {
        Vector3<double> shift = Vector3<double>::Zero();
        for (const auto& [robot, cloud] : middles) shift += robot - turn * cloud;
        const Pose<double> pose{turn, shift / static_cast<double>(middles.size())};
        all.push_back({pose, distance(pose)});
      }
    }
    const auto is_better = [](const Candidate& a, const Candidate& b) {
      return a.distance < b.distance;
    };
    const std::size_t most = std::min(all.size(), static_cast<std::size_t>(search_.refined));
    std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(most), all.end(),
                      is_better);
    all.resize(most);
    for (Candidate& one : all) refine(one);
    std::stable_sort(all.begin(), all.end(), is_better);
    std::vector<Candidate> apart;
    for (const Candidate& one : all) {
      const auto is_same = [&](const Candidate& other) {
        constexpr double kShift = 0.05, kTurn = 0.2;
        return (other.pose.translation - one.pose.translation).norm() < kShift &&
               Eigen::AngleAxisd(other.pose.rotation.transpose() * one.pose.rotation).angle() <
                   kTurn;
      };
      if (std::any_of(apart.begin(), apart.end(), is_same)) continue;
      apart.push_back(one);
      if (std::ssize(apart) == search_.kept) break;
    }
    return apart;
  }

 private:
  void add_middles(const std::vector<Points>& robots, const std::vector<Points>& clouds) {
    constexpr std::size_t kFewest = 20;  // points, for a middle
    std::vector<std::pair<Vector3<double>, Vector3<double>>> middles;
    for (std::size_t s = 0; s < robots.size(); ++s) {
      if (robots[s].size() < kFewest || clouds[s].size() < kFewest) continue;
      middles.emplace_back(middle_of(robots[s]), middle_of(clouds[s]));
    }
    if (!middles.empty()) middles_.push_back(std::move(middles));
  }

  [[nodiscard]] double distance(const Pose<double>& pose) const {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t s = 0; s < grids_.size(); ++s) {
      for (const Vector3<double>& p : clouds_[s]) sum += grids_[s].at(pose * p, nullptr);
      count += clouds_[s].size();
    }
    return sum / static_cast<double>(std::max<std::size_t>(1, count));
  }

  /// Goes downhill: Gauss-Newton steps with weights that fall with the distance.
  void refine(Candidate& one) const {
    double limit = kFar;
    for (int round = 0; round < 25; ++round, limit = std::max(0.05, 0.85 * limit)) {
      Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
      const Vector3<double> pivot = one.pose.translation;
      for (std::size_t s = 0; s < grids_.size(); ++s) {
        for (const Vector3<double>& p : clouds_[s]) {
          const Vector3<double> at = one.pose * p;
          Vector3<double> slope;
          const double d = grids_[s].at(at, &slope);
          if (d >= limit) continue;
          Eigen::Matrix<double, 6, 1> row;
          row << slope, (at - pivot).cross(slope);
          const double weight = 1.0 / (d + 0.01);  // towards the sum of distances
          hessian += weight * row * row.transpose();
          gradient += weight * d * row;
        }
      }
      hessian.diagonal().array() += 1e-5 * hessian.trace() + 1e-9;
      const Eigen::Matrix<double, 6, 1> step = hessian.ldlt().solve(-gradient);
      const Vector3<double> turn = step.tail<3>();
      const double angle = turn.norm();
      const Matrix3<double> rotation =
          exp(Vector3<double>(angle > 0.3 ? Vector3<double>(turn * (0.3 / angle)) : turn));
      one.pose.rotation = rotation * one.pose.rotation;
      one.pose.translation = pivot + step.head<3>();
    }
    one.distance = distance(one.pose);
  }

  SurfaceSearch search_;
  std::vector<DistanceGrid> grids_;
  std::vector<Points> clouds_;
  /// Middles of the robot and of the cloud, by sample; in two ways.
  std::vector<std::vector<std::pair<Vector3<double>, Vector3<double>>>> middles_;
};

}  // namespace
}  // namespace detail

std::vector<Pose<double>> find_poses(const RobotSurface& surface,
                                     std::span<const PosedCloud> samples,
                                     const SurfaceSearch& search) {
  const auto has_points = [](const PosedCloud& sample) { return !sample.points.empty(); };
  if (surface.links().empty() || std::none_of(samples.begin(), samples.end(), has_points))
    return {};
  std::vector<Pose<double>> poses;
  for (const detail::Candidate& one : detail::PoseSearcher(surface, samples, search).search()) {
    poses.push_back(one.pose);
  }
  return poses;
}

}  // namespace kinecal
