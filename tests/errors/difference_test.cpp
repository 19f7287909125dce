#include "kinecal/errors/difference.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/blocks.hpp"

namespace kinecal {
namespace {

struct WithAConstant {
  Vector3<double> lever;
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return p_a - p_b + lever.cast<S>();
  }
};
struct Swapped {
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return p_b - p_a;
  }
};
struct Scaled {
  double scale;
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return {p_a.x() - p_b.x(), p_a.y() - p_b.y(), (p_a.z() - p_b.z()) * S(scale)};
  }
};
struct Squared {
  template <class S>
  Vector3<S> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b) const {
    return {p_a.x() - p_b.x(), p_a.y() - p_b.y(), p_a.z() * p_a.z() - p_b.z()};
  }
};

TEST(Difference, IsSeenInBlocksThatSubtractTheirPoints) {
  EXPECT_TRUE(is_difference(PointToPoint{}));
  EXPECT_TRUE(is_difference(test::UnknownDifference{}));
  EXPECT_TRUE(is_difference(WithAConstant{{0.1, 0.2, 0.3}}));
  EXPECT_TRUE(is_difference(Scaled{1.0}));
}

TEST(Difference, IsNotSeenInOthers) {
  EXPECT_FALSE(is_difference(Swapped{}));
  EXPECT_FALSE(is_difference(Scaled{1.0 + 1e-15}));
  EXPECT_FALSE(is_difference(Squared{}));
  EXPECT_FALSE(is_difference(test::HiddenDifference{}));
  EXPECT_FALSE(is_difference(test::Distance{}));
  EXPECT_FALSE(is_difference(test::FiveOfTwo{}));
  EXPECT_FALSE(is_difference(PointToPixel{}));
  EXPECT_FALSE(is_difference(PlaneToPlane{}));
  EXPECT_FALSE(is_difference(PointToPlane(0, 0, 1, 0)));
}

}  // namespace
}  // namespace kinecal
