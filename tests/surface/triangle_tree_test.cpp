#include "kinecal/surface/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "support/shapes.hpp"

namespace kinecal {
namespace {

using test::ball;
using test::box;
using test::Shape;

TriangleTree tree_of(const Shape& shape) {
  return {shape.vertices, shape.triangles};
}

/// The distance of a point from a triangle, by the regions about it (Ericson 5.1.5).
double distance_of(const Vector3<double>& p, const std::array<Vector3<double>, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vector3<double> ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0.0 && d2 <= 0.0) return ap.norm();
  if (d3 >= 0.0 && d4 <= d3) return bp.norm();
  if (d6 >= 0.0 && d5 <= d6) return cp.norm();
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - d1 / (d1 - d3) * ab).norm();
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - d2 / (d2 - d6) * ac).norm();
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).norm();
  }
  return (ap - vb / (va + vb + vc) * ab - vc / (va + vb + vc) * ac).norm();
}

Vector3<double> random_point(std::mt19937& engine, double size) {
  std::uniform_real_distribution<double> along(-size, size);
  return {along(engine), along(engine), along(engine)};
}

TEST(TriangleTree, FindsTheNearestPointOfAllTriangles) {
  const TriangleTree tree = tree_of(ball({0.1, -0.2, 0.3}, 0.4, 24, 0.2));
  std::mt19937 engine(1);
  int guess = -1;
  for (int i = 0; i < 500; ++i) {
    const Vector3<double> p = random_point(engine, 1.0);
    double least = 1e9;
    for (int t = 0; t < tree.count(); ++t) least = std::min(least, distance_of(p, tree.corners(t)));
    const auto found = tree.closest(p);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, least, 1e-7 * (1.0 + least)) << "floats choose the triangle";
    EXPECT_NEAR((p - found->point).norm(), found->distance, 1e-15);
    EXPECT_NEAR(distance_of(found->point, tree.corners(found->triangle)), 0.0, 1e-15);
    const auto again = tree.closest(p, 2.0 * least, guess);
    ASSERT_TRUE(again) << "a guess only narrows the search";
    EXPECT_NEAR(again->distance, found->distance, 1e-7);
    EXPECT_FALSE(tree.closest(p, 0.99 * least - 1e-9));
    guess = found->triangle;
  }
}

TEST(TriangleTree, PointsOfATriangleAreNearestInAllRegionsAboutIt) {
  const TriangleTree tree({{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.3, 1.0, 0.0}}, {{0, 1, 2}});
  std::mt19937 engine(2);
  for (int i = 0; i < 500; ++i) {
    const Vector3<double> p = random_point(engine, 3.0);
    EXPECT_NEAR(tree.on_triangle(p, 0).distance, distance_of(p, tree.corners(0)), 1e-14);
  }
  EXPECT_TRUE(tree.on_triangle({0.5, 0.2, -1.0}, 0).normal.isApprox(Vector3<double>::UnitZ()));
}

TEST(TriangleTree, IsNotNearerThanTheBoxAboutIt) {
  const TriangleTree tree = tree_of(ball({0.1, -0.2, 0.3}, 0.4, 24, 0.2));
  std::mt19937 engine(4);
  for (int i = 0; i < 500; ++i) {
    const Vector3<double> p = random_point(engine, 1.0);
    EXPECT_LE(tree.away(p), tree.closest(p)->distance + 1e-12);
  }
  const TriangleTree side = tree_of(box({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}));
  EXPECT_NEAR(side.away({4.0, 0.5, -5.0}), 5.0, 1e-12);
  EXPECT_EQ(side.away({0.5, -0.5, 0.9}), 0.0) << "inside";
}

TEST(TriangleTree, CastsRaysOnTheFirstOfAllTriangles) {
  const Shape shape = ball({0.0, 0.0, 0.0}, 0.4, 20, 0.25);
  const TriangleTree tree = tree_of(shape);
  std::mt19937 engine(3);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3<double> origin = random_point(engine, 1.0),
                          direction = random_point(engine, 0.4) - origin;
    double least = 1e9;
    for (const auto& corners : shape.triangles) {
      Matrix3<double> sides;
      const Vector3<double>& a = shape.vertices[corners[0]];
      sides << shape.vertices[corners[1]] - a, shape.vertices[corners[2]] - a, -direction;
      const Vector3<double> x = sides.inverse() * (origin - a);
      if (x.x() >= 0.0 && x.y() >= 0.0 && x.x() + x.y() <= 1.0 && x.z() >= 0.0) {
        least = std::min(least, x.z());
      }
    }
    const auto found = tree.cast(origin, direction);
    ASSERT_EQ(found.has_value(), least < 1e9) << i;
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(found->distance, least, 1e-9);
    EXPECT_NEAR((found->point - origin - least * direction).norm(), 0.0, 1e-9);
    EXPECT_FALSE(tree.cast(origin, direction, 0.99 * least));
  }
  EXPECT_GT(hits, 200);
}

TEST(TriangleTree, RaysAlongAxesHitBoxes) {
  const TriangleTree tree = tree_of(box({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}));
  const auto found = tree.cast({0.25, 0.5, 3.0}, {0.0, 0.0, -1.0});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, 2.0, 1e-12);
  EXPECT_TRUE(found->normal.isApprox(Vector3<double>::UnitZ()));
  EXPECT_FALSE(tree.cast({0.25, 1.5, 3.0}, {0.0, 0.0, -1.0}));
}

TEST(TriangleTree, KnowsWhetherASurfaceIsClosedAndOutward) {
  Shape shape = ball({0.0, 0.0, 0.5}, 0.5, 40);
  const SurfaceFacts ball_facts = tree_of(shape).facts();
  EXPECT_TRUE(ball_facts.closed);
  EXPECT_NEAR(ball_facts.volume, 4.0 / 3.0 * 3.14159265 * 0.125, 0.005);
  EXPECT_NEAR(ball_facts.high.z(), 1.0, 1e-12);
  for (auto& corners : shape.triangles) std::swap(corners[0], corners[1]);
  EXPECT_TRUE(tree_of(shape).facts().closed);
  EXPECT_LT(tree_of(shape).facts().volume, 0.0) << "inside out";
  std::swap(shape.triangles.front()[0], shape.triangles.front()[1]);
  EXPECT_FALSE(tree_of(shape).facts().closed) << "a triangle that turns the other way";
  shape.triangles.erase(shape.triangles.begin());
  EXPECT_FALSE(tree_of(shape).facts().closed) << "a hole";
}

TEST(TriangleTree, JoinsVerticesThatFilesRepeat) {
  const Shape once = box({0.0, 0.0, 0.0}, {0.1, 0.2, 0.3});
  Shape repeated;
  for (const auto& corners : once.triangles) {
    const auto first = static_cast<std::uint32_t>(repeated.vertices.size());
    for (const std::uint32_t corner : corners) repeated.vertices.push_back(once.vertices[corner]);
    repeated.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_TRUE(tree_of(repeated).facts().closed);
  EXPECT_NEAR(tree_of(repeated).facts().volume, 0.006, 1e-12);
}

TEST(TriangleTree, LeavesOutTrianglesWithoutArea) {
  const TriangleTree tree(
      {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}},
      {{0, 1, 2}, {0, 1, 3}, {1, 4, 2}});
  EXPECT_EQ(tree.facts().triangles, 1U);
  EXPECT_EQ(tree.facts().without_area, 2U);
  EXPECT_NEAR(tree.closest({2.0, 0.0, 0.0})->distance, 1.0, 1e-12);
  EXPECT_FALSE(TriangleTree({}, {}).closest({0.0, 0.0, 0.0}));
  EXPECT_FALSE(TriangleTree({}, {}).cast({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace kinecal
