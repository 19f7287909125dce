// Definitions of triangle_tree.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace kinecal {

namespace detail {
namespace {

/// Searches in floats go this much farther, so that rounding hides nothing.
constexpr float kSlack = 1.00001F;
/// A child that is not there; its square is still less than infinity.
constexpr float kNoBox = 1e18F;

template <class L>
[[nodiscard]] L lower_of(L a, L b) {
  return a < b ? a : b;
}
template <class L>
[[nodiscard]] L higher_of(L a, L b) {
  return a > b ? a : b;
}
template <class L>
[[nodiscard]] L dot_of(const std::array<L, 3>& a, const std::array<L, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where a comparison of four lanes holds: a bit of each.
using Held = int __attribute__((vector_size(16)));
[[nodiscard]] inline unsigned bits_of(Held held) {
  const Held bits = held & Held{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
}

}  // namespace
}  // namespace detail

/// Nodes and leaves that are still to be searched, the nearest last.
class TriangleTree::Open {
 public:
  [[nodiscard]] bool any() const { return count_ > 0; }
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Adds one above the first `below`, where its distance belongs.
  void add(float distance, int number, std::size_t below) {
    std::size_t i = count_++;
    for (; i > below && all_[i - 1].distance < distance; --i) all_[i] = all_[i - 1];
    all_[i] = {distance, number};
  }
  struct One {
    float distance;
    int number;
  };
  [[nodiscard]] One take() { return all_[--count_]; }

 private:
  One all_[256];  // NOLINT: not initialized; three more at most for each of 80 levels
  std::size_t count_ = 0;
};

/// A box about triangles.
struct TriangleTree::Box {
  Vector3<double> low = Vector3<double>::Constant(std::numeric_limits<double>::infinity());
  Vector3<double> high = -low;

  void add(const Vector3<double>& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  /// Half of its surface; zero if it is empty.
  [[nodiscard]] double area() const {
    const Vector3<double> side = (high - low).cwiseMax(0.0);
    return side.x() * side.y() + side.y() * side.z() + side.z() * side.x();
  }
};

/// Divides triangles, in quarters, where boxes of small surface result: few queries enter those.
class TriangleTree::Build {
 public:
  Build(TriangleTree& tree, std::vector<Triangle> all) : tree_(tree), all_(std::move(all)) {
    for (const Triangle& one : all_) {
      Box& box = boxes_.emplace_back();
      for (const Vector3<double>& corner : one.corners) box.add(corner);
      middles_.emplace_back(0.5 * (box.low + box.high));
    }
    order_.resize(all_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    tree_.triangles_.reserve(2 * all_.size());
    (void)node(0, order_.size(), 0);
  }

 private:
  static constexpr int kBins = 12;
  static constexpr int kDeep =
      30;  ///< levels, after which triangles are halved: Open has room for all

  /// A place to divide at: after a bin along an axis.
  struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    Eigen::Index axis = 0;
    int bin = 0;
  };

  [[nodiscard]] static int bin_of(double x, double low, double high) {
    return std::min(kBins - 1, static_cast<int>(kBins * (x - low) / (high - low)));
  }

  [[nodiscard]] Cut best_cut(std::size_t begin, std::size_t end, const Box& middles) const {
    Cut best;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double low = middles.low[axis], high = middles.high[axis];
      if (!(high > low)) continue;
      std::array<Box, kBins> boxes;
      std::array<std::size_t, kBins> counts{};
      for (std::size_t i = begin; i < end; ++i) {
        const auto bin = static_cast<std::size_t>(bin_of(middles_[order_[i]][axis], low, high));
        boxes[bin].add(boxes_[order_[i]]);
        ++counts[bin];
      }
      const auto leaves = [](std::size_t count) {
        return static_cast<double>((count + kWide - 1) / kWide);
      };
      std::array<double, kBins> after{};  // cost of what comes after a bin
      Box rest;
      std::size_t count = 0;
      for (std::size_t bin = kBins - 1; bin > 0; --bin) {
        rest.add(boxes[bin]);
        count += counts[bin];
        after[bin - 1] = rest.area() * leaves(count);
      }
      Box first;
      count = 0;
      for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
        first.add(boxes[bin]);
        count += counts[bin];
        const double cost = first.area() * leaves(count) + after[bin];
        if (count > 0 && count < end - begin && cost < best.cost) {
          best = {cost, axis, static_cast<int>(bin)};
        }
      }
    }
    return best;
  }

  [[nodiscard]] std::size_t divide(std::size_t begin, std::size_t end, int level) {
    if (end - begin <= kWide) return end;
    Box middles;
    for (std::size_t i = begin; i < end; ++i) middles.add(middles_[order_[i]]);
    const Cut cut = best_cut(begin, end, middles);
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    if (!std::isfinite(cut.cost) || level > kDeep) {  // all in one place, or one after another
      const std::size_t half = begin + (end - begin) / 2;
      std::nth_element(at(begin), at(half), at(end), [&](unsigned a, unsigned b) {
        return std::pair(middles_[a][cut.axis], a) < std::pair(middles_[b][cut.axis], b);
      });
      return half;
    }
    const auto middle = std::stable_partition(at(begin), at(end), [&](unsigned i) {
      return bin_of(middles_[i][cut.axis], middles.low[cut.axis], middles.high[cut.axis]) <=
             cut.bin;
    });
    return static_cast<std::size_t>(middle - order_.begin());
  }

  int node(std::size_t begin, std::size_t end, int level) {
    const auto number = static_cast<int>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    const std::size_t middle = divide(begin, end, level);
    const std::array<std::size_t, 5> ends = {begin, divide(begin, middle, level), middle,
                                             divide(middle, end, level), end};
    Node made;
    for (int c = 0; c < kWide; ++c) {
      const std::size_t from = ends[static_cast<std::size_t>(c)],
                        to = ends[static_cast<std::size_t>(c) + 1];
      Box box;
      for (std::size_t i = from; i < to; ++i) box.add(boxes_[order_[i]]);
      for (std::size_t k = 0; k < 3; ++k) {
        // Rounded outward.
        made.low[k][c] =
            from == to ? detail::kNoBox : std::nextafter(static_cast<float>(box.low[k]), -1e30F);
        made.high[k][c] =
            from == to ? detail::kNoBox : std::nextafter(static_cast<float>(box.high[k]), 1e30F);
      }
      int child = 0;
      if (to > from) child = to - from <= kWide ? ~leaf(from, to) : node(from, to, level + 1);
      made.child[static_cast<std::size_t>(c)] = child;
    }
    tree_.nodes_[static_cast<std::size_t>(number)] = made;
    return number;
  }

  int leaf(std::size_t begin, std::size_t end) {
    Leaf made;
    for (int lane = 0; lane < kWide; ++lane) {
      const std::size_t i = std::min(begin + static_cast<std::size_t>(lane), end - 1);
      const Triangle& one = all_[order_[i]];
      tree_.triangles_.push_back(one);
      const Vector3<double> a = one.corners[0], ab = one.corners[1] - a, ac = one.corners[2] - a;
      for (std::size_t k = 0; k < 3; ++k) {
        made.a[k][lane] = static_cast<float>(a[k]);
        made.ab[k][lane] = static_cast<float>(ab[k]);
        made.ac[k][lane] = static_cast<float>(ac[k]);
      }
      const double bb = ab.squaredNorm(), cc = ac.squaredNorm(), bc = ab.dot(ac);
      const double determinant = ab.cross(ac).squaredNorm();
      made.g00[lane] = static_cast<float>(cc / determinant);
      made.g01[lane] = static_cast<float>(-bc / determinant);
      made.g11[lane] = static_cast<float>(bb / determinant);
      made.ab_ab[lane] = static_cast<float>(1.0 / bb);
      made.ac_ac[lane] = static_cast<float>(1.0 / cc);
      made.bc_bc[lane] = static_cast<float>(1.0 / (ac - ab).squaredNorm());
    }
    tree_.leaves_.push_back(made);
    return static_cast<int>(tree_.leaves_.size()) - 1;
  }

  TriangleTree& tree_;
  std::vector<Triangle> all_;
  std::vector<Box> boxes_;
  std::vector<Vector3<double>> middles_;
  std::vector<unsigned> order_;
};

TriangleTree::TriangleTree(const std::vector<Vector3<double>>& vertices,
                           const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Triangle> all;
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& triangle : triangles) {
    Triangle one;
    for (std::size_t k = 0; k < 3; ++k) one.corners[k] = vertices[triangle[k]];
    const Vector3<double> ab = one.corners[1] - one.corners[0],
                          ac = one.corners[2] - one.corners[0];
    const Vector3<double> across = ab.cross(ac);
    // The height over the longest edge, in parts of it: less is rounding of what the file holds.
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    constexpr double kThin = 1e-6;
    kept.push_back(triangle);
    if (!(across.norm() > kThin * longest && across.norm() > 1e-16)) {
      ++facts_.without_area;
      continue;
    }
    one.normal = across.normalized();
    all.push_back(one);
  }
  facts_.triangles = all.size();
  if (all.empty()) return;
  Box box;
  for (const Triangle& one : all) {
    for (const Vector3<double>& corner : one.corners) box.add(corner);
    facts_.volume += one.corners[0].dot(one.corners[1].cross(one.corners[2])) / 6.0;
  }
  facts_.low = box.low;
  facts_.high = box.high;
  // Files repeat vertices: those at one place are one.
  std::vector<std::uint32_t> order(vertices.size()), place(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto coordinates = [&](std::uint32_t v) {
    return std::tuple(vertices[v].x(), vertices[v].y(), vertices[v].z());
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return coordinates(a) < coordinates(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && coordinates(order[i]) == coordinates(order[i - 1]);
    place[order[i]] = same ? place[order[i - 1]] : order[i];
  }
  for (auto& triangle : kept) {
    for (std::uint32_t& corner : triangle) corner = place[corner];
  }
  std::erase_if(kept, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  find_facts(kept);
  (void)Build(*this, std::move(all));
}

void TriangleTree::find_facts(std::span<const std::array<std::uint32_t, 3>> corners) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& triangle : corners) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(triangle[k], triangle[(k + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  facts_.closed =
      std::adjacent_find(edges.begin(), edges.end()) == edges.end() &&
      std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
        return std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
      });
}

SurfacePoint TriangleTree::on_triangle(const Vector3<double>& p, int triangle) const {
  const Triangle& of = triangles_[static_cast<std::size_t>(triangle)];
  const Vector3<double>& a = of.corners[0];
  const Vector3<double> ab = of.corners[1] - a, ac = of.corners[2] - a, ap = p - a;
  SurfacePoint found{.normal = of.normal, .triangle = triangle};
  const Vector3<double> inside = of.normal.cross(ap);
  const double area = of.normal.dot(ab.cross(ac));
  const double v = inside.dot(ac) / area, w = -inside.dot(ab) / area;
  if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
    found.point = p - of.normal.dot(ap) * of.normal;
  } else {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3<double>& from = of.corners[k];
      const Vector3<double> edge = of.corners[(k + 1) % 3] - from;
      const double t = std::clamp(edge.dot(p - from) / edge.squaredNorm(), 0.0, 1.0);
      const Vector3<double> q = from + t * edge;
      const double squared = (p - q).squaredNorm();
      if (squared >= least) continue;
      least = squared;
      found.point = q;
    }
  }
  found.distance = (p - found.point).norm();
  return found;
}

double TriangleTree::away(const Vector3<double>& p) const {
  return (facts_.low - p).cwiseMax(p - facts_.high).cwiseMax(0.0).norm();
}

TriangleTree::Lanes TriangleTree::squares(const std::array<Lanes, 3>& at, const Leaf& leaf) {
  std::array<Lanes, 3> ap, off, bp, bc;
  for (std::size_t k = 0; k < 3; ++k) ap[k] = at[k] - leaf.a[k];
  const Lanes b = detail::dot_of(leaf.ab, ap), c = detail::dot_of(leaf.ac, ap);
  const Lanes v = leaf.g00 * b + leaf.g01 * c, w = leaf.g01 * b + leaf.g11 * c;
  for (std::size_t k = 0; k < 3; ++k) {
    off[k] = ap[k] - v * leaf.ab[k] - w * leaf.ac[k];
    bp[k] = ap[k] - leaf.ab[k];
    bc[k] = leaf.ac[k] - leaf.ab[k];
  }
  const auto to_edge = [](const std::array<Lanes, 3>& edge, const std::array<Lanes, 3>& from,
                          Lanes along) {
    const Lanes t = detail::lower_of(detail::higher_of(along, Lanes{}), Lanes{} + 1.0F);
    Lanes squared{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes rest = from[k] - t * edge[k];
      squared += rest * rest;
    }
    return squared;
  };
  const Lanes squared = detail::lower_of(
      detail::lower_of(to_edge(leaf.ab, ap, b * leaf.ab_ab), to_edge(leaf.ac, ap, c * leaf.ac_ac)),
      to_edge(bc, bp, detail::dot_of(bc, bp) * leaf.bc_bc));
  const auto is_inside = (v >= 0.0F) & (w >= 0.0F) & (v + w <= 1.0F);
  return is_inside ? detail::lower_of(squared, detail::dot_of(off, off)) : squared;
}

std::optional<SurfacePoint> TriangleTree::closest(const Vector3<double>& p, double bound,
                                                  int guess) const {
  if (nodes_.empty()) return std::nullopt;
  int best = -1;
  float least = std::min(1e30F, static_cast<float>(bound * bound) * detail::kSlack);
  const std::array<Lanes, 3> at = {Lanes{} + static_cast<float>(p.x()),
                                   Lanes{} + static_cast<float>(p.y()),
                                   Lanes{} + static_cast<float>(p.z())};
  const auto search_leaf = [&](int leaf) {
    const Lanes squared = squares(at, leaves_[static_cast<std::size_t>(leaf)]);
    for (unsigned bits = detail::bits_of(squared < least); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      if (!(squared[lane] < least)) continue;
      least = squared[lane];
      best = kWide * leaf + lane;
    }
  };
  const int first = guess < 0 ? -1 : guess / kWide;  // a leaf
  if (first >= 0) search_leaf(first);
  Open open;
  open.add(0.0F, 0, 0);
  while (open.any()) {
    auto [nearest, number] = open.take();
    if (nearest > least) continue;
    while (number >= 0) {
      const Node& node = nodes_[static_cast<std::size_t>(number)];
      Lanes squared{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Lanes beyond = detail::higher_of(
            detail::higher_of(node.low[k] - at[k], at[k] - node.high[k]), Lanes{});
        squared += beyond * beyond;
      }
      unsigned bits = detail::bits_of(squared <= least);
      if (bits == 0) break;
      if ((bits & (bits - 1)) != 0) {
        const std::size_t below = open.count();
        for (; bits != 0; bits &= bits - 1) {
          const int c = std::countr_zero(bits);
          open.add(squared[c], node.child[static_cast<std::size_t>(c)], below);
        }
        number = open.take().number;
      } else {
        number = node.child[static_cast<std::size_t>(std::countr_zero(bits))];
      }
    }
    if (number < 0 && ~number != first) search_leaf(~number);
  }
  if (best < 0) return std::nullopt;
  const SurfacePoint found = on_triangle(p, best);
  if (found.distance > bound) return std::nullopt;
  return found;
}

std::optional<SurfacePoint> TriangleTree::cast(const Vector3<double>& origin,
                                               const Vector3<double>& direction,
                                               double bound) const {
  if (nodes_.empty()) return std::nullopt;
  std::array<Lanes, 3> from, inverse;
  for (std::size_t k = 0; k < 3; ++k) {
    constexpr double kFlat = 1e-30;  // a ray along a side of a box
    const double along = std::abs(direction[k]) < kFlat ? kFlat : direction[k];
    from[k] = Lanes{} + static_cast<float>(origin[k]);
    inverse[k] = Lanes{} + static_cast<float>(std::clamp(1.0 / along, -1e30, 1e30));
  }
  double least = bound;
  int best = -1;
  Open open;
  open.add(0.0F, 0, 0);
  while (open.any()) {
    const auto [nearest, number] = open.take();
    if (nearest > least) continue;
    if (number >= 0) {
      const Node& node = nodes_[static_cast<std::size_t>(number)];
      Lanes enter{}, leave = Lanes{} + 1e30F;
      for (std::size_t k = 0; k < 3; ++k) {
        const Lanes one = (node.low[k] - from[k]) * inverse[k],
                    other = (node.high[k] - from[k]) * inverse[k];
        enter = detail::higher_of(enter, detail::lower_of(one, other));
        leave = detail::lower_of(leave, detail::higher_of(one, other));
      }
      const std::size_t below = open.count();
      for (int c = 0; c < kWide; ++c) {
        constexpr float kGrown = 1e-5F;  // of rounding in floats
        const bool is_there = node.low[0][c] < detail::kNoBox;
        if (!is_there || !(enter[c] <= leave[c] * (1.0F + kGrown) + kGrown) || enter[c] > least)
          continue;
        open.add(enter[c] * (1.0F - kGrown) - kGrown, node.child[static_cast<std::size_t>(c)],
                 below);
      }
      continue;
    }
    for (int lane = 0; lane < kWide; ++lane) {
      const int triangle = kWide * ~number + lane;
      const auto& [a, b, c] = triangles_[static_cast<std::size_t>(triangle)].corners;
      const Vector3<double> ab = b - a, ac = c - a, across = direction.cross(ac), ao = origin - a;
      const double determinant = ab.dot(across);
      if (determinant == 0.0) continue;
      const double v = ao.dot(across) / determinant;
      const Vector3<double> turned = ao.cross(ab);
      const double w = direction.dot(turned) / determinant, t = ac.dot(turned) / determinant;
      if (v < 0.0 || w < 0.0 || v + w > 1.0 || t < 0.0 || t >= least) continue;
      least = t;
      best = triangle;
    }
  }
  if (best < 0) return std::nullopt;
  return SurfacePoint{.point = origin + least * direction,
                      .normal = triangles_[static_cast<std::size_t>(best)].normal,
                      .triangle = best,
                      .distance = least};
}

}  // namespace kinecal
