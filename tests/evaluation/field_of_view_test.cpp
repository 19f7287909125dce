// Which points a camera sees is the camera's own affair.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "kinecal/evaluation/problem.hpp"
#include "support/fisheye.hpp"

namespace kinecal {
namespace {

/// A camera at the base, and an arm that turns about the camera's axis.
template <class M>
Problem problem_of(const M& camera) {
  const Robot robot("r", {{"mount", JointType::fixed, "base", "camera"},
                          {"turn", JointType::revolute, "base", "arm", {}, {0, 0, 1}}});
  ParameterTable table;
  table.add({.name = "turn"});
  if constexpr (kParametersOf<M> != 0) add_parameters(table, "camera", M::kParameters);
  Problem problem(robot, "base", table, {});
  problem.add_sensor(ChainPoint{}, {"arm", "arm"});
  problem.add_sensor(camera, {"camera", "camera"});
  problem.add_block("reprojection", PointToPixel{}, {"arm", "camera"});
  return problem;
}

/// What is undefined if the camera observes a point of the arm at a pixel.
template <class M>
std::optional<UndefinedResidual> undefined_at(const M& camera, const Vector3<double>& p,
                                              const Vector3<double>& pixel = {640, 480, 0}) {
  Problem problem = problem_of(camera);
  const Vector3<double> in_front(0.1, 0.2, 1.0);
  problem.add_sample({{"turn"},
                      {0.0},
                      {{"arm", {{"arm", in_front}, {"arm", p}}},
                       {"camera", {{"camera", {640, 480, 0}}, {"camera", pixel}}, CameraInfo{}}},
                      "a.yaml:7"});
  const auto values = problem.table().values();
  return undefined_residual(problem, std::span<const double>(values.data(), values.size()));
}

TEST(FieldOfView, OfAFisheyeReachesBehindIt) {
  const Vector3<double> p(1.0, 0.0, -0.0875);
  EXPECT_EQ(undefined_at(test::Fisheye{}, p), std::nullopt);
  Problem problem = problem_of(test::Fisheye{});
  const auto pixel = test::Fisheye{}.predict(p, std::array<double, 0>{}, std::array<double, 2>{});
  problem.add_sample(
      {{"turn"},
       {0.0},
       {{"arm", {{"arm", p}}}, {"camera", {{"camera", {pixel.x() + 3.0, pixel.y() + 4.0, 0}}}}},
       {}});
  const std::vector<double> zero(3, 0.0);
  EXPECT_NEAR(normal_equations(problem, zero, nullptr).cost, 12.5, 1e-9);
  const FreeSet free({0, 1, 2}, 3);
  EXPECT_NEAR(normal_equations(problem, zero, &free).cost, 12.5, 1e-9);
}

/// A camera that sees what is in front of it.
struct Ahead : test::Fisheye {
  static constexpr std::string_view kType = "ahead";
  template <class S>
  auto sees(const Vector3<S>& p) const {
    return p.z() > S(0.0);
  }
};
/// The same by its pixels.
struct AheadByPixels : test::Fisheye {
  static constexpr std::string_view kType = "ahead_by_pixels";
  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>& none,
                                 const std::array<S, 2>& v) const {
    const auto pixel = Fisheye::predict(p, none, v);
    const S unseen(std::numeric_limits<double>::quiet_NaN());
    return {select(p.z() > S(0.0), pixel.x(), unseen), pixel.y()};
  }
};

TEST(FieldOfView, EndsWhereTheCameraSaysSo) {
  const Vector3<double> ahead(1.0, 0.0, 0.0875), behind(1.0, 0.0, -0.0875);
  EXPECT_EQ(undefined_at(Ahead{}, ahead), std::nullopt);
  EXPECT_EQ(undefined_at(AheadByPixels{}, ahead), std::nullopt);
  for (const auto& undefined :
       {undefined_at(Ahead{}, behind), undefined_at(AheadByPixels{}, behind)}) {
    ASSERT_TRUE(undefined.has_value());
    EXPECT_EQ(undefined->term, "reprojection");
    EXPECT_EQ(undefined->source, "a.yaml:7");
    EXPECT_FALSE(undefined->has_value);
  }
}

TEST(FieldOfView, HasAHoleWhereThePixelOrItsDerivativeIsNotANumber) {
  const Vector3<double> on_axis(0.0, 0.0, 1.0);
  const auto hollow = undefined_at(test::HollowFisheye{}, on_axis),
             kinked = undefined_at(test::KinkedFisheye{}, on_axis);
  EXPECT_EQ(undefined_at(test::Fisheye{}, on_axis), std::nullopt);
  ASSERT_TRUE(hollow.has_value() && kinked.has_value());
  EXPECT_FALSE(hollow->has_value);
  EXPECT_TRUE(kinked->has_value);
  EXPECT_EQ(kinked->source, "a.yaml:7");
}

TEST(FieldOfView, AnUndefinedDerivativeIsInTheCostButNotInThatWithoutDerivatives) {
  Problem problem = problem_of(test::KinkedFisheye{});
  problem.add_sample({{"turn"},
                      {0.0},
                      {{"arm", {{"arm", {0, 0, 1}}}}, {"camera", {{"camera", {640, 480, 0}}}}},
                      {}});
  const std::vector<double> zero(1, 0.0);
  const FreeSet free({0}, 1);
  EXPECT_TRUE(std::isfinite(normal_equations(problem, zero, nullptr).cost));
  EXPECT_FALSE(std::isfinite(normal_equations(problem, zero, &free).cost));
}

}  // namespace
}  // namespace kinecal
