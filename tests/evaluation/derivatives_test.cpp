// Every error block: zero at the truth; twists and small jets against the oracle and against
// central differences, at zero, at 1e-8, at random and near pi.
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/oracle_problem.hpp"

namespace kinecal {
namespace {

// 7 offsets, 4 frames, 6 and 4 camera parameters
constexpr int kParameters = 7 + 24 + 10;

/// Distance to a sphere: a block as a user would write one.
struct PointToSphere {
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

FreeSet all_free() {
  std::vector<int> all(kParameters);
  for (int i = 0; i < kParameters; ++i) all[static_cast<std::size_t>(i)] = i;
  return FreeSet(all, kParameters);
}

/// Parameter values where derivatives could go wrong.
std::vector<double> values_at(const std::string& where, const ParameterTable& table) {
  if (where == "zero") return std::vector<double>(kParameters, 0.0);
  if (where == "tiny") return test::random_values(table, 1e-8, 3);
  std::vector<double> values = test::random_values(table, 0.05, 4);
  if (where == "near_pi") {
    for (const char* frame : {"head_pan", "elbow_mount", "board"}) {
      const Vector3<double> w = Vector3<double>(1, -2, 0.5).normalized() * (M_PI - 1e-6);
      for (int k = 0; k < 3; ++k) {
        const auto name = parameter_name(frame, kFrameAxes[static_cast<std::size_t>(3 + k)]);
        values[static_cast<std::size_t>(table.index(name))] = w(k);
      }
    }
  }
  return values;
}

template <ErrorBlock B>
void check_block(const B& block, const std::vector<std::string>& sensors,
                 const std::string& arm_frame, const std::string& base = "base_link") {
  for (const std::string where : {"zero", "tiny", "random", "near_pi"}) {
    SCOPED_TRACE(where + ", features of the arm in " + arm_frame + ", base " + base);
    Problem problem = test::scene_problem(base);
    problem.add_block("block", block, sensors, {});
    test::OracleProblem oracle = test::oracle_of(problem);
    oracle.add_block("block", block, sensors);
    const std::vector<double> x = values_at(where, problem.table());
    // Made near x and not at x: residuals that are zero would hide errors.
    std::vector<double> truth = x;
    for (std::size_t i = 0; i < truth.size(); ++i) truth[i] += 1e-3 * static_cast<double>(i % 3);
    std::vector<Sample> samples = test::exact_samples(problem, truth, 3, arm_frame);
    samples[1].observations[2].camera->d = {-0.2, 0.1, 2e-3, -1e-3, 0.05};  // a distorted image
    for (const Sample& sample : samples) {
      problem.add_sample(sample);
      oracle.add_sample(sample);
    }
    const FreeSet free = all_free();
    const test::OracleRows expected = oracle.rows(x);
    ASSERT_EQ(expected.size(), 3u);

    int visited = 0;
    const auto undefined = evaluate(problem, x, &free, [&](int t, int n, const TermResiduals& out) {
      ++visited;
      const TermResiduals& of_sample = expected.at({t, n});
      EXPECT_GT(of_sample.residual.norm(), 0.0);
      test::expect_rows_of_oracle(out, of_sample, 1e-12 * (1.0 + of_sample.residual.norm()), 1e-12,
                                  PlanePairBlock<B>);
      // Central differences: good to 1e-8 of the derivative's size, at a step of 1e-6.
      for (int p = 0; p < kParameters; ++p) {
        constexpr double kStep = 1e-6;
        std::vector<double> up = x, down = x;
        up[static_cast<std::size_t>(p)] += kStep;
        down[static_cast<std::size_t>(p)] -= kStep;
        const auto at = [&](const std::vector<double>& values) {
          Eigen::VectorXd r;
          (void)evaluate(problem, values, nullptr, [&](int, int m, const TermResiduals& o) {
            if (m == n) r = o.residual;
          });
          return r;
        };
        const Eigen::VectorXd numeric = (at(up) - at(down)) / (2 * kStep);
        EXPECT_LE((numeric - out.jacobian.col(p)).norm(), 1e-7 * (1 + out.jacobian.norm()))
            << problem.table()[p].name;
      }
    });
    EXPECT_FALSE(undefined.has_value());
    EXPECT_EQ(visited, 3);

    // Residuals without derivatives are the same numbers.
    std::vector<double> with, without;
    const auto collect = [](std::vector<double>& all) {
      return [&all](int, int, const TermResiduals& out) {
        all.insert(all.end(), out.residual.begin(), out.residual.end());
      };
    };
    (void)evaluate(problem, x, &free, collect(with));
    (void)evaluate(problem, x, nullptr, collect(without));
    ASSERT_EQ(with.size(), without.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
      EXPECT_NEAR(with[i], without[i], 1e-13 * (1 + std::abs(with[i])));
    }
  }
}

TEST(Derivatives, PointToPoint) {
  check_block(PointToPoint{}, {"camera", "arm"}, "hand");
}

TEST(Derivatives, PointToPointThroughAVirtualFrame) {
  check_block(PointToPoint{}, {"camera", "arm"}, "board");
}

TEST(Derivatives, PointToPointWithTheBaseOnTheMovingArm) {
  check_block(PointToPoint{}, {"arm", "camera"}, "hand", "forearm");
}

TEST(Derivatives, PointToPixel) {
  check_block(PointToPixel{}, {"arm", "eye"}, "hand");
}

TEST(Derivatives, PointToPixelOfADepthCamerasPoint) {
  check_block(PointToPixel{}, {"camera", "eye"}, "hand", "hand");
}

TEST(Derivatives, PointToPlane) {
  check_block(PointToPlane(0.1, 0.2, 2, -0.4), {"camera"}, "hand");
}

TEST(Derivatives, PlaneToPlane) {
  check_block(PlaneToPlane{2.0, 3.0}, {"camera", "arm"}, "board");
}

TEST(Derivatives, ABlockWrittenByAUser) {
  check_block(PointToSphere{}, {"camera"}, "hand");
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
  const std::vector<double> zero(kParameters, 0.0);
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
