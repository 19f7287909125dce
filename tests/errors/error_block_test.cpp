#include "kinecal/errors/error_block.hpp"

#include <gtest/gtest.h>

#include "kinecal/errors.hpp"

namespace kinecal {
namespace {

struct Height {
  static constexpr const char* kUnit = "m";
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
    return Eigen::Matrix<S, 1, 1>(p_base.z());
  }
};
struct NotTemplated {
  Eigen::Matrix<double, 1, 1> operator()(const Vector3<double>& p) const {
    return Eigen::Matrix<double, 1, 1>(p.z());
  }
};
struct DynamicSize {
  template <class S>
  Eigen::Matrix<S, Eigen::Dynamic, 1> operator()(const Vector3<S>& p) const {
    return p;
  }
};
struct Expression {
  template <class S>
  auto operator()(const Vector3<S>& a, const Vector3<S>& b) const {
    return a - b;
  }
};
struct Numbers {
  template <class S>
  std::array<S, 2> operator()(const PixelObservation<S>& pixel) const {
    return {pixel.predicted.x(), pixel.predicted.y()};
  }
};
struct NoCall {};

/// Own parameters and conditions after the features, also for a scalar that is not templated.
struct HeightOfWarmFloor {
  static constexpr const char* kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"height", "m"}};
  static constexpr std::array kConditions = {"temperature", "load"};  // words of any kind
  template <class S, class Q>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p, const std::array<S, 1>& own,
                                    const std::array<Q, 2>& conditions) const {
    return Eigen::Matrix<S, 1, 1>(p.z() - own[0] * (1.0 + conditions[0]) + conditions[1]);
  }
};
struct WithoutItsConditions : Height {
  static constexpr std::array<std::string_view, 1> kConditions = {"temperature"};
};
static_assert(PointBlock<HeightOfWarmFloor> && kResiduals<HeightOfWarmFloor> == 1);
static_assert(kConditionsOfBlock<HeightOfWarmFloor>[1] == "load");
static_assert(kConditionsOfBlock<Height>.empty());
static_assert(!ErrorBlock<WithoutItsConditions>, "a block takes what it names");

static_assert(PointBlock<Height> && !PointPairBlock<Height>);
static_assert(PointPairBlock<PointToPoint> && !PointBlock<PointToPoint>);
static_assert(PixelBlock<PointToPixel> && PlanePairBlock<PlaneToPlane>);
static_assert(kResiduals<PointToPoint> == 3 && kResiduals<PointToPixel> == 2);
static_assert(PointBlock<PointToPlane> && kResiduals<PointToPlane> == 1);
static_assert(kResiduals<PlaneToPlane> == 4);
static_assert(kSensors<PointToPixel> == 2 && kSensors<PlaneToPlane> == 2);
static_assert(!ErrorBlock<NotTemplated>, "a block must take jets");
static_assert(!ErrorBlock<DynamicSize>, "a residual has a fixed size");
static_assert(!ErrorBlock<Expression> && !ErrorBlock<Numbers>, "a residual is a matrix");
static_assert(!ErrorBlock<NoCall>);

// The built-in blocks: figures worked out by hand.

TEST(ErrorBlock, PointToPointIsTheFirstLessTheSecond) {
  EXPECT_EQ(PointToPoint{}(Vector3<double>(1, 2, 3), Vector3<double>(0.5, 4, -1)),
            Vector3<double>(0.5, -2, 4));
}

TEST(ErrorBlock, PointToPlaneIsTheDistanceOnTheSideOfTheNormal) {
  const PointToPlane plane(2, -4, 4, 12);  // |(2, -4, 4)| = 6
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(0, 0, 0))(0), 2.0);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(3, 0, 0))(0), 3.0);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(0, 3, 0))(0), 0.0);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(0, 0, 3))(0), 4.0);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(3, 6, -3))(0), -3.0);
  EXPECT_DOUBLE_EQ(PointToPlane()(Vector3<double>(5, 6, 0.7))(0), 0.7) << "the floor";
}

TEST(ErrorBlock, PointToPixelIsThePredictedPixelLessTheObservedOne) {
  const PixelObservation<double> pixel{{595, 20}, {590, 30}};
  EXPECT_LE((PointToPixel{}(pixel)-Eigen::Vector2d(5, -10)).norm(), 1e-12);
}

TEST(ErrorBlock, PlaneToPlaneIsTheTurnOfTheNormalsAndTheDistanceToTheSecond) {
  const PlaneToPlane block{2.0, 3.0};
  const Plane<double> a{{1, 2, 4}, {0, 0, 1}}, b{{1, 1, 1}, {0, 0.6, 0.8}};
  const Eigen::Vector4d expected(0, 2 * -0.6, 2 * 0.2, 3 * (0.6 * 1 + 0.8 * 3));
  EXPECT_LE((block(a, b) - expected).norm(), 1e-14);
  EXPECT_LE((block(a, Plane<double>{b.centroid, -b.normal}) - expected).norm(), 1e-14);
  EXPECT_LE((block(Plane<double>{a.centroid, -a.normal}, b) + expected).norm(), 1e-14);
}

TEST(Jet, DifferentiatesItsFunctionsLikeTheirFormulas) {
  using J = Jet<double, 2>;
  const double x = 0.7, y = 1.3;
  const J jx(x, 0), jy(y, 1);
  const auto expect = [](const J& j, double value, double by_x, double by_y) {
    EXPECT_NEAR(j.a, value, 1e-15 * (1 + std::abs(value)));
    EXPECT_NEAR(j.v(0), by_x, 4e-15 * (1 + std::abs(by_x)));
    EXPECT_NEAR(j.v(1), by_y, 4e-15 * (1 + std::abs(by_y)));
  };
  expect(jx * jy - jx / jy, x * y - x / y, y - 1 / y, x + x / (y * y));
  expect(2.0 - jx, 2 - x, -1, 0);
  expect(3.0 / jy, 3 / y, 0, -3 / (y * y));
  expect(jx / 4.0 + 1.0, x / 4 + 1, 0.25, 0);
  expect(sqrt(jx), std::sqrt(x), 0.5 / std::sqrt(x), 0);
  expect(sin(jx) + cos(jy), std::sin(x) + std::cos(y), std::cos(x), -std::sin(y));
  expect(exp(jx) + log(jy), std::exp(x) + std::log(y), std::exp(x), 1 / y);
  expect(atan2(jy, jx), std::atan2(y, x), -y / (x * x + y * y), x / (x * x + y * y));
  expect(abs(-jx), x, 1, 0);
  J sum = jx;
  sum += jy;
  sum *= jx;
  sum -= jy;
  sum /= jy;
  expect(sum, ((x + y) * x - y) / y, (2 * x + y) / y, -(x * x) / (y * y));
}

}  // namespace
}  // namespace kinecal
