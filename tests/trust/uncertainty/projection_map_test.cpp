// How well a camera is known over its image: against cameras whose truth is known.
#include "kinecal/trust/uncertainty/projection_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>

#include "kinecal/geometry/median.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/photographs.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using test::Photographs;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kPlumbBob = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
const std::vector<std::string> kEquidistant = {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};

/// A camera calibrated from photographs.
struct Solved {
  Solved(const Photographs& photographs, const std::vector<std::string>& free)
      : calibration(photographs.calibration(free)),
        result(calibrate_and_judge(calibration, photographs.samples)) {
    const Eigen::VectorXd values = result.result.table.values();
    const MountedSensor& camera = calibration.steps.back().problem->sensors()[1];
    own = camera.own_values({values.data(), static_cast<std::size_t>(values.size())});
  }
  [[nodiscard]] const ProjectionMap& map() const { return result.assessments.back().maps.front(); }

  Calibration calibration;
  JudgedResult result;
  std::vector<double> own;  ///< parameters of the camera: zero is the truth
};

/// Where the estimated camera images what the true one images at a pixel, moved so that features agree best.
class Compared {
 public:
  Compared(const Photographs& photographs, const Solved& solved)
      : eye_(any_built_in(lens_camera(photographs.lens))),
        settings_(eye_->settings(photographs.samples[0].observations[1])),
        own_(solved.own),
        distance_(solved.map().distance) {
    std::vector<Vector3<double>> points;
    for (const Sample& sample : photographs.samples) {
      for (const Feature& corner : sample.observations[0].features) {
        points.push_back(sample.poses.at("board") * corner.point);
      }
    }
    constexpr int kSteps = 3;
    for (int step = 0; step < kSteps; ++step) {
      Eigen::Matrix<double, Eigen::Dynamic, 6> by_motion(2 * std::ssize(points), 6);
      Eigen::VectorXd residual(by_motion.rows());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto row = 2 * static_cast<Eigen::Index>(i);
        residual.segment<2>(row) = estimated(points[i]) - truth(points[i]);
        constexpr double kStep = 1e-6;
        for (int k = 0; k < 6; ++k) {
          Eigen::Matrix<double, 6, 1> off = Eigen::Matrix<double, 6, 1>::Unit(k) * kStep;
          const Pose<double> was = motion_;
          move(off);
          by_motion.block<2, 1>(row, k) =
              (estimated(points[i]) - truth(points[i]) - residual.segment<2>(row)) / kStep;
          motion_ = was;
        }
      }
      const Eigen::Matrix<double, 6, 1> by = -by_motion.colPivHouseholderQr().solve(residual);
      move(by);
    }
  }
  [[nodiscard]] Eigen::Vector2d error(const std::array<double, 2>& pixel) const {
    const Vector3<double> ray = eye_->place({pixel[0], pixel[1], 0.0}, settings_);
    const Vector3<double> p = distance_ * ray.normalized();
    return estimated(p) - truth(p);
  }

 private:
  void move(const Eigen::Matrix<double, 6, 1>& by) {
    motion_ = Pose<double>{exp(Vector3<double>(by.tail<3>())), by.head<3>()} * motion_;
  }
  [[nodiscard]] Eigen::Vector2d truth(const Vector3<double>& p) const {
    return eye_->predict(p, settings_);
  }
  [[nodiscard]] Eigen::Vector2d estimated(const Vector3<double>& p) const {
    return eye_->predict(motion_ * p, settings_, own_);
  }

  std::shared_ptr<const AnySensor> eye_;
  std::vector<double> settings_, own_;
  double distance_;
  Pose<double> motion_{Matrix3<double>::Identity(), Vector3<double>::Zero()};
};

struct Lens {
  const char* name;
  CameraInfo info;
  std::vector<std::string> free;
  double aside;
};

/// The true camera is inside the ellipse of 95 % at 95 % of the places, and halves differ as the +- allow.
TEST(ProjectionMap, CoversTheTruth) {
  const int repetitions = test::repetitions_of_study(200, test::kIsSlow ? 4 : 12);
  for (const Lens& lens : {Lens{"plumb_bob", test::distorted_camera(), kPlumbBob, 0.6},
                           Lens{"equidistant", test::fisheye_camera(611.0), kEquidistant, 1.2},
                           Lens{"equidistant", test::fisheye_camera(390.0), kEquidistant, 2.5}}) {
    double inside = 0.0, places = 0.0, squares = 0.0, allowed = 0.0;
    int covered = 0, intervals = 0, apart = 0;
    for (int n = 0; n < repetitions; ++n) {
      const Photographs photographs(
          lens.info, lens.name,
          {.views = 30, .aside = lens.aside, .seed = 100U + static_cast<unsigned>(n)});
      const Solved solved(photographs, lens.free);
      const ProjectionMap& map = solved.map();
      const Compared compared(photographs, solved);
      for (const KnownPixel& cell : map.cells) {
        if (cell.features == 0) continue;
        const auto [uu, vv, uv] = cell.covariance;
        Eigen::Matrix2d covariance;
        covariance << uu, uv, uv, vv;
        const Eigen::Vector2d error = compared.error(cell.pixel);
        constexpr double k95 = 5.991;  // chi-square of two
        inside += error.dot(covariance.inverse() * error) < k95 ? 1.0 : 0.0;
        places += 1.0;
        squares += error.squaredNorm();
        allowed += covariance.trace();
      }
      const Assessment& step = solved.result.assessments.back();
      for (std::size_t i = 0; i < lens.free.size(); ++i) {
        const int p = solved.calibration.table.find("camera_" + lens.free[i]);
        const double error = solved.result.result.table[p].value;
        covered += std::abs(error) < 1.96 * step.deviation(p).value() ? 1 : 0;
        ++intervals;
      }
      ASSERT_TRUE(map.halves);
      apart += map.halves->chance < 0.05 ? 1 : 0;
      EXPECT_THAT(solved.result.judgement.reasons, Not(Contains(HasSubstr("halves"))));
      EXPECT_THAT(solved.result.judgement.reasons, Not(Contains(HasSubstr("depend on the place"))));
    }
    std::printf(
        "%s, f %.0f px: %.1f %% of the places inside 95 %%, errors %.2f of +-; parameters inside "
        "95 %%: %.1f %%; halves apart beyond 5 %%: %d of %d\n",
        lens.name, lens.info.k[0], 1e2 * inside / places, std::sqrt(squares / allowed),
        1e2 * covered / intervals, apart, repetitions);
    // Places and parameters of one camera err together: as many independent trials as cameras, or a few times more.
    EXPECT_NEAR(inside / places, 0.95, 2.5 * std::sqrt(0.05 * 0.95 / repetitions));
    EXPECT_NEAR(static_cast<double>(covered) / intervals, 0.95,
                2.5 * std::sqrt(0.05 * 0.95 / repetitions));
    EXPECT_TRUE(test::binomial_band(repetitions, 0.05, 1e-3).contains(apart)) << apart;
  }
}

TEST(ProjectionMap, IsWorstWhereNoFeatureIs) {
  const Photographs middle(test::distorted_camera(), "plumb_bob", {.aside = 0.1});
  const ProjectionMap map = Solved(middle, kPlumbBob).map();
  EXPECT_EQ(map.columns, 16);
  EXPECT_EQ(map.rows, 12);
  EXPECT_GT(map.at(10.0, 10.0)->deviation(), 5.0 * map.at(640.0, 480.0)->deviation());
  EXPECT_EQ(map.at(10.0, 10.0)->features, 0);
  EXPECT_EQ(map.at(-1.0, 10.0), nullptr);
  EXPECT_NEAR(map.distance, 0.5, 0.1);
  const KnownPixel& center = *map.at(640.0, 480.0);
  EXPECT_NEAR(center.metres, center.deviation() * map.distance / 800.0, 0.05 * center.metres);
}

TEST(ProjectionMap, ALensThatIsTooSimpleShowsInTheResiduals) {
  CameraInfo info = test::distorted_camera();
  info.d = {-0.25, 0.12, 0.0, 0.0, -0.02};
  Photographs photographs(info, "plumb_bob", {.views = 40, .noise = 0.05, .aside = 0.6});
  const Solved right(photographs, kPlumbBob);
  EXPECT_GT(right.result.assessments.back().alike.front().chance, 0.01);
  for (Sample& sample : photographs.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.camera) seen.camera->d = {-0.15, 0.0, 0.0, 0.0, 0.0};
    }
  }
  const Solved simple(photographs, {"fx", "fy", "cx", "cy", "k1"});
  const AlikePixels& alike = simple.result.assessments.back().alike.front();
  EXPECT_LE(alike.chance, 0.01);
  EXPECT_GT(alike.alike, 0.35 * alike.all);
  EXPECT_THAT(simple.result.judgement.reasons,
              Contains(HasSubstr("depend on the place in its image")));
}

TEST(ProjectionMap, IsOfCamerasOfWhichSomethingIsFree) {
  const Photographs photographs(test::distorted_camera(), "plumb_bob", {.views = 10});
  Calibration calibration = photographs.calibration({"fx"});
  EXPECT_EQ(calibrate_and_judge(calibration, photographs.samples).assessments.back().maps.size(),
            1U);
  Calibration none = photographs.calibration({});
  EXPECT_THROW((void)calibrate(none), std::invalid_argument) << "nothing is free";
}

}  // namespace
}  // namespace kinecal
