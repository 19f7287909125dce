// Blocks of poses, rays, readings, three points, and with parameters of their own: rows against the
// oracle, normal equations against rows multiplied out, zero at the truth.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/open_scene.hpp"
#include "support/oracle_problem.hpp"
#include "support/sums.hpp"

namespace kinecal {
namespace {

std::vector<double> open_values(const ParameterTable& table) {
  std::vector<double> x = test::random_values(table, 0.05, 4);
  for (const char* name :
       {"block_u", "block_v", "block_length", "block_radius", "block_expansion"}) {
    if (const int i = table.find(name); i >= 0) x[static_cast<std::size_t>(i)] = 0.3;
  }
  return x;
}

template <ErrorBlock B>
void check_block(const B& block, const std::vector<std::string>& sensors,
                 const std::string& arm_frame = "hand") {
  TermOptions options;
  options.weight = 1.7;
  options.loss = {LossType::cauchy, 0.5};
  Problem packets = test::open_problem<Packet>(block, sensors, options);
  BasicProblem<double> numbers = test::open_problem<double>(block, sensors, options);
  test::OracleProblem oracle = test::oracle_of(packets);
  oracle.add_block("block", block, sensors, options);
  const std::vector<double> x = open_values(packets.table());
  std::vector<Sample> samples = test::open_samples(packets, x, 9, arm_frame);
  samples[2].observations[4].features[1].point.x() = std::numeric_limits<double>::quiet_NaN();
  for (const Sample& sample : samples) {
    packets.add_sample(sample);
    numbers.add_sample(sample);
    oracle.add_sample(sample);
  }
  const FreeSet all = test::all_free(packets.table());
  const test::OracleRows expected = oracle.rows(x);
  for (const auto& found : {test::rows_of(packets, x, &all), test::rows_of(numbers, x, &all)}) {
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, rows] : expected) {
      ASSERT_TRUE(found.contains(key));
      test::expect_rows_of_oracle(found.at(key), rows, 1e-11 * (1.0 + rows.residual.norm()), 1e-11);
    }
  }
  const test::OracleRows same = test::rows_of(packets, x, nullptr);
  for (const auto& [key, rows] : expected) {
    EXPECT_LE((same.at(key).residual - rows.residual).norm(), 1e-11 * (1 + rows.residual.norm()));
  }
  const int count = packets.table().size();
  std::vector<int> some;
  for (int p = 0; p < count; p += 2) some.push_back(p);
  for (const FreeSet& free : {all, FreeSet(some, count)}) {
    const NormalEquations reference = oracle.multiplied_out(expected, x, free);
    EXPECT_GT(reference.hessian.norm(), 0.0);
    test::expect_same(normal_equations(packets, x, &free), reference, 1e-10);
    test::expect_same(normal_equations(numbers, x, &free), reference, 1e-10);
  }
}

TEST(OpenBlocks, PoseToPose) {
  check_block(PoseToPose{2.0, 0.7}, {"body", "tracker"});
  check_block(PoseToPose{2.0, 0.7}, {"tracker", "body"});
}
TEST(OpenBlocks, RayToRay) {
  check_block(RayToRay{}, {"eye", "left"});
}
TEST(OpenBlocks, PointToRay) {
  check_block(PointToRay{}, {"camera", "left"});
}
TEST(OpenBlocks, PointDistance) {
  check_block(PointDistance{0.3}, {"camera", "elbow_point"});
}
TEST(OpenBlocks, PointToSphere) {
  check_block(PointToSphere{{0.1, 0.2, 0.3}, 0.4}, {"camera"});
}
TEST(OpenBlocks, PointToLine) {
  check_block(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5}), {"arm"});
}
TEST(OpenBlocks, AReadingOfAUsersSensor) {
  check_block(test::WireLength{}, {"camera", "wire"});
}
TEST(OpenBlocks, ThreeSensors) {
  check_block(test::BetweenPoints{}, {"camera", "elbow_point", "arm"});
}
TEST(OpenBlocks, PixelsWithAParameter) {
  check_block(test::ShiftedPixel{}, {"camera", "eye"});
}

TEST(OpenBlocks, ParametersAndConditions) {
  check_block(test::ThermalBar{}, {"camera", "elbow_point"});
}
TEST(OpenBlocks, PixelsWithACondition) {
  check_block(test::WarmPixel{}, {"camera", "eye"});
}

TEST(OpenBlocks, PlanesWithAParameterAndACondition) {
  check_block(test::WarmGap{}, {"camera", "elbow_point"});
}

/// The number of a line of sight's pixels by which it misses a point, at the truth.
TEST(OpenBlocks, RaysToOnePointMeet) {
  Problem problem = test::open_problem<Packet>(RayToRay{}, {"eye", "left"});
  const std::vector<double> x = open_values(problem.table());
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
  const std::vector<double> x = open_values(problem.table());
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
    const std::vector<double> x = open_values(problem.table());
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
