// Built-in error blocks of points, pixels and planes: rows and their derivatives; zero at the truth.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/check_rows.hpp"

namespace kinecal {
namespace {

/// Distance to a sphere: a block as a user would write one.
struct PointToSphere {
  static constexpr const char* kUnit = "m";
  Vector3<double> center{0.5, 0.1, 1.0};
  double radius = 0.3;
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
    using std::sqrt;
    const Vector3<S> d(p_base.x() - center.x(), p_base.y() - center.y(), p_base.z() - center.z());
    return Eigen::Matrix<S, 1, 1>(sqrt(d.squaredNorm()) - radius);
  }
};
static_assert(ErrorBlock<PointToSphere> && kSensors<PointToSphere> == 1);

TEST(Derivatives, PointToPoint) {
  test::check_rows_of(PointToPoint{}, {"camera", "arm"}, "hand");
}

TEST(Derivatives, PointToPointThroughAVirtualFrame) {
  test::check_rows_of(PointToPoint{}, {"camera", "arm"}, "board");
}

TEST(Derivatives, PointToPointWithTheBaseOnTheMovingArm) {
  test::check_rows_of(PointToPoint{}, {"arm", "camera"}, "hand", "forearm");
}

TEST(Derivatives, PointToPixel) {
  test::check_rows_of(PointToPixel{}, {"arm", "eye"}, "hand");
}

TEST(Derivatives, PointToPixelOfADepthCamerasPoint) {
  test::check_rows_of(PointToPixel{}, {"camera", "eye"}, "hand", "hand");
}

TEST(Derivatives, PointToPlane) {
  test::check_rows_of(PointToPlane(0.1, 0.2, 2, -0.4), {"camera"}, "hand");
}

TEST(Derivatives, PlaneToPlane) {
  test::check_rows_of(PlaneToPlane{2.0, 3.0}, {"camera", "arm"}, "board");
}

TEST(Derivatives, ABlockWrittenByAUser) {
  test::check_rows_of(PointToSphere{}, {"camera"}, "hand");
}

/// Residuals at the parameters with which the samples were made.
template <ErrorBlock B>
double largest_at_truth(const B& block, const std::vector<std::string>& sensors) {
  Problem problem = test::scene_problem();
  problem.add_block("block", block, sensors, {});
  const std::vector<double> truth = test::random_values(problem.table(), 0.05, 8);
  for (const Sample& s : test::exact_samples(problem, truth, 5)) problem.add_sample(s);
  double largest = 0.0;
  int visited = 0;
  (void)evaluate(problem, truth, nullptr, [&](int, int, const TermResiduals& out) {
    ++visited;
    largest = std::max(largest, out.residual.cwiseAbs().maxCoeff());
  });
  EXPECT_EQ(visited, 5);
  return largest;
}

TEST(Residuals, AreZeroAtTheTruth) {
  EXPECT_LE(largest_at_truth(PointToPoint{}, {"camera", "arm"}), 1e-14);
  EXPECT_LE(largest_at_truth(PointToPixel{}, {"arm", "eye"}), 1e-11);  // pixels: 1e3 times larger
  EXPECT_LE(largest_at_truth(PointToPixel{}, {"camera", "eye"}), 1e-11);
  EXPECT_LE(largest_at_truth(PlaneToPlane{}, {"camera", "arm"}), 1e-12);
}

TEST(Residuals, PointToPlaneIsTheSignedDistance) {
  const PointToPlane plane(0, 0, 2, -1);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(3, 4, 0.75))(0), 0.25);
  EXPECT_DOUBLE_EQ(plane(Vector3<double>(3, 4, 0.25))(0), -0.25);
  EXPECT_THROW(PointToPlane(0, 0, 0, 1), std::invalid_argument);
}

TEST(Residuals, PlaneToPlaneDoesNotFlipWhereThePlanePassesThroughTheOrigin) {
  const Vector3<double> n = Vector3<double>(1, 2, 3).normalized();
  const auto r = PlaneToPlane{}(Plane<double>{{0, 0, 0}, n}, Plane<double>{{0, 0, 0}, -n});
  EXPECT_LE(r.norm(), 1e-15);
}

TEST(Residuals, APointBehindACameraIsUndefinedAndNamed) {
  Problem problem = test::scene_problem();
  problem.add_block("reprojection", PointToPixel{}, {"arm", "eye"}, {});
  const std::vector<double> zero(static_cast<std::size_t>(problem.table().size()), 0.0);
  Sample sample = test::exact_samples(problem, zero, 1)[0];
  for (Feature& f : sample.observations[0].features) f.point += Vector3<double>(50, 50, 50);
  sample.source = "s.yaml:7";
  problem.add_sample(sample);
  std::vector<double> behind = zero;
  bool found = false;
  for (double pan = 0.0; pan < 6.3 && !found; pan += 0.5) {
    behind[static_cast<std::size_t>(problem.table().index("head_pan"))] = pan;
    const auto undefined = evaluate(problem, behind, nullptr, [](int, int, const auto&) {});
    if (!undefined) continue;
    found = true;
    EXPECT_EQ(undefined->term, "reprojection");
    EXPECT_EQ(undefined->source, "s.yaml:7");
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace kinecal
