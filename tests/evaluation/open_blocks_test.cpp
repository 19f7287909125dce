// Blocks of poses, rays, readings, three points, and with parameters of their own: rows and their
// derivatives; zero at the truth.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/check_rows.hpp"

namespace kinecal {
namespace {

TEST(OpenBlocks, PoseToPose) {
  test::check_rows_of(PoseToPose{2.0, 0.7}, {"body", "tracker"});
  test::check_rows_of(PoseToPose{2.0, 0.7}, {"tracker", "body"});
}
TEST(OpenBlocks, RayToRay) {
  test::check_rows_of(RayToRay{}, {"eye", "left"});
}
TEST(OpenBlocks, PointToRay) {
  test::check_rows_of(PointToRay{}, {"camera", "left"});
}
TEST(OpenBlocks, PointDistance) {
  test::check_rows_of(PointDistance{0.3}, {"camera", "elbow_point"});
}
TEST(OpenBlocks, PointToSphere) {
  test::check_rows_of(PointToSphere{{0.1, 0.2, 0.3}, 0.4}, {"camera"});
}
TEST(OpenBlocks, PointToLine) {
  test::check_rows_of(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5}), {"arm"});
}
TEST(OpenBlocks, PointOnPlane) {
  test::check_rows_of(PointOnPlane{}, {"arm", "tracker"});
  test::check_rows_of(PointOnPlane{}, {"camera", "body"});
}
TEST(OpenBlocks, PointOnLine) {
  test::check_rows_of(PointOnLine{}, {"arm", "tracker"});
  test::check_rows_of(PointOnLine{}, {"camera", "body"});
}
TEST(OpenBlocks, GravitySeen) {
  test::check_rows_of(GravitySeen{{0.1, -0.2, 9.8}}, {"body"});
  test::check_rows_of(GravitySeen{{0.1, -0.2, 9.8}}, {"tracker"});
}
TEST(OpenBlocks, AReadingOfAUsersSensor) {
  test::check_rows_of(test::WireLength{}, {"camera", "wire"});
}
TEST(OpenBlocks, ThreeSensors) {
  test::check_rows_of(test::BetweenPoints{}, {"camera", "elbow_point", "arm"});
}
TEST(OpenBlocks, PixelsWithAParameter) {
  test::check_rows_of(test::ShiftedPixel{}, {"camera", "eye"});
}

TEST(OpenBlocks, ParametersAndConditions) {
  test::check_rows_of(test::ThermalBar{}, {"camera", "elbow_point"});
}
TEST(OpenBlocks, PixelsWithACondition) {
  test::check_rows_of(test::WarmPixel{}, {"camera", "eye"});
}

TEST(OpenBlocks, PlanesWithAParameterAndACondition) {
  test::check_rows_of(test::WarmGap{}, {"camera", "elbow_point"});
}

/// The number of a line of sight's pixels by which it misses a point, at the truth.
TEST(OpenBlocks, RaysToOnePointMeet) {
  Problem problem = test::open_problem<Packet>(RayToRay{}, {"eye", "left"});
  const std::vector<double> x = test::values_at("random", problem.table());
  const test::OracleValues<double> value(problem.table(), x);
  std::vector<Sample> samples = test::open_samples(problem, x, 5);
  for (Sample& sample : samples) {
    sample.observations[2].camera->d = {-0.2, 0.1, 2e-3, -1e-3, 0.05};
    const Pose<double> eye = test::tip_pose(problem, 2, "camera_optical_frame", sample, x),
                       left = test::tip_pose(problem, 4, "forearm", sample, x);
    for (std::size_t i = 0; i < 4; ++i) {
      // A point in front of both: a ray need not point forwards.
      const Vector3<double> p = left * Vector3<double>(0.1 * static_cast<double>(i), 0.2, 1.1);
      const auto look = [&](std::size_t which, const Pose<double>& pose, const char* name) {
        Observation& seen = sample.observations[which];
        const Vector3<double> q = pose.inverse() * p;
        const Eigen::Vector2d pixel = test::oracle_pixel(
            *seen.camera, Vector3<double>(q.x() / q.z() * 0.1, q.y() / q.z() * 0.1, 0.1), name,
            value);
        seen.features[i].point = {pixel.x(), pixel.y(), 0.0};
      };
      look(4, left, "left");
      sample.observations[2].camera->d = {};  // far from the axis no lens model holds
      look(2, eye, "eye");
    }
    problem.add_sample(sample);
  }
  (void)evaluate(problem, x, nullptr, [](int, int, const TermResiduals& rows) {
    EXPECT_LE(rows.residual.cwiseAbs().maxCoeff(), 1e-8) << "pixels";
  });
}

TEST(OpenBlocks, OnePoseSeenTwiceIsTheSame) {
  Problem problem = test::open_problem<Packet>(PoseToPose{}, {"body", "tracker"});
  const std::vector<double> x = test::values_at("random", problem.table());
  for (Sample& sample : test::open_samples(problem, x, 5)) {
    const Pose<double> hand = test::tip_pose(problem, 5, "hand", sample, x),
                       board = test::tip_pose(problem, 6, "board", sample, x);
    for (std::size_t i = 0; i < 4; ++i) {
      const Feature& body = sample.observations[5].features[i];
      const Pose<double> of_body{*body.rotation, body.point};
      const Pose<double> again = board.inverse() * (hand * of_body);
      sample.observations[6].features[i] = {"board", again.translation, again.rotation};
    }
    problem.add_sample(sample);
  }
  (void)evaluate(problem, x, nullptr, [](int, int, const TermResiduals& rows) {
    EXPECT_LE(rows.residual.cwiseAbs().maxCoeff(), 1e-13);
  });
}

/// A rotation by any angle below 180 degrees is measured by that angle.
TEST(OpenBlocks, PoseToPoseIsTheAngleBetween) {
  for (const double angle : {1e-9, 1e-4, 1e-3, 0.5, 2.0, 3.1}) {
    const Vector3<double> w = angle * Vector3<double>(1.0, -2.0, 0.5).normalized();
    const Pose<double> a{exp(w), Vector3<double>(1.0, 2.0, 3.0)}, b;
    const auto r = PoseToPose{2.0, 3.0}(a, b);
    EXPECT_LE((r.head<3>() - Vector3<double>(2.0, 4.0, 6.0)).norm(), 1e-14);
    EXPECT_LE((r.tail<3>() - 3.0 * w).norm(), 1e-13 * (1.0 + angle)) << angle;
  }
}

/// Measurements replaced by the model's prediction: the residual is gone where the block is linear,
/// and a twentieth of it is left where it is not.
TEST(OpenBlocks, WithoutErrorsTheResidualIsGone) {
  const auto check = [](const auto& block, const std::vector<std::string>& sensors, double left) {
    Problem problem = test::open_problem<Packet>(block, sensors);
    const std::vector<double> x = test::values_at("random", problem.table());
    for (const Sample& s : test::open_samples(problem, x, 3)) problem.add_sample(s);
    const FreeSet all = test::all_free(problem.table());
    double before = 0.0, after = 0.0;
    (void)evaluate(problem, x, &all,
                   [&](int, int, const TermResiduals& rows) { before += rows.residual.norm(); });
    (void)evaluate(
        problem, x, &all,
        [&](int, int, const TermResiduals& rows) {
          after += rows.residual.norm();
          EXPECT_TRUE(rows.jacobian.allFinite());
        },
        Linearization::error_free);
    EXPECT_GT(before, 0.1);
    EXPECT_LE(after, left * before);
  };
  check(test::WireLength{}, {"arm", "wire"}, 1e-12);
  check(test::BetweenPoints{}, {"camera", "elbow_point", "arm"}, 1e-12);
  check(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5}), {"arm"}, 1e-12);
  check(PointToSphere{{0.1, 0.2, 0.3}, 0.4}, {"arm"}, 1e-12);
}

}  // namespace
}  // namespace kinecal
