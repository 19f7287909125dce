// A lens whose polynomial turns over where no feature held it.
#include "kinecal/trust/systematic/folded_lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A camera with k1 that sees points on its stand.
/// @param k1  recorded; with k1 alone, x (1 + k1 x^2) is largest at 1 / sqrt(-3 k1)
struct Stand {
  /// @param reach  of the points, in x / z
  explicit Stand(double k1, bool has_size = true, double reach = 0.4) {
    info.width = has_size ? 640 : 0;
    info.height = has_size ? 480 : 0;
    info.distortion_model = "plumb_bob";
    info.d = {k1, 0, 0, 0, 0};
    info.k = {400, 0, 320, 0, 400, 240, 0, 0, 1};
    ParameterTable table;
    for (const char* name : {"camera_fx", "camera_k1"}) table.add({.name = name, .unit = "1"});
    problem = make_problem(
        Robot("stand", {{"mount", JointType::fixed, "base", "optical", {}, {}, {}, {}}}), "base",
        table, {});
    problem->add_built_in(ChainPoint{}, {"points", "base"});
    problem->add_built_in(lens_camera("plumb_bob"), {"camera", "optical"});
    problem->add_built_in("pixels", PointToPixel{}, {"points", "camera"}, {});
    const auto camera = any_built_in(lens_camera("plumb_bob"));
    for (int n = 0; n < 3; ++n) {
      Sample& sample = samples.emplace_back();
      Observation points{"points", {}, {}}, seen{"camera", {}, info};
      for (int i = -4; i <= 4; ++i) {
        const double x = 0.25 * reach * i;
        const Vector3<double> p(x, 0.3 * x + 0.05 * n, 1.0);
        const Eigen::Vector2d pixel = camera->predict(p, camera->settings(seen));
        points.features.push_back({"base", p});
        seen.features.push_back({"optical", {pixel.x(), pixel.y(), 0.0}});
      }
      sample.observations = {points, seen};
      problem->add_sample(sample);
    }
  }
  [[nodiscard]] std::vector<FoldedLens> folds(const std::vector<int>& free) const {
    const std::vector<double> values(2, 0.0);
    return folded_lenses(*problem, FreeSet(free, 2), values, samples);
  }

  CameraInfo info;
  std::unique_ptr<AnyProblem> problem;
  std::vector<Sample> samples;
};

TEST(FoldedLens, IsFoundWhereItTurnsOver) {
  // k1 = -0.5 turns over at x = 0.816, whose image is at 400 * 0.544 = 218 px
  const std::vector<FoldedLens> folds = Stand(-0.5).folds({0, 1});
  ASSERT_EQ(folds.size(), 1U);
  EXPECT_EQ(folds[0].sensor, "camera");
  EXPECT_NEAR(folds[0].radius, 400.0 * std::sqrt(1.0 / 1.5) * 2.0 / 3.0, 0.01);
  EXPECT_NEAR(folds[0].corner, 400.0, 1.0);
  EXPECT_LT(folds[0].farthest, folds[0].radius);
  EXPECT_THAT(Stand(-0.5).folds({0}), IsEmpty()) << "as it was given";
  EXPECT_THAT(Stand(-0.1).folds({0, 1}), IsEmpty()) << "beyond the corners of the image";
  EXPECT_THAT(Stand(0.2).folds({0, 1}), IsEmpty());
  EXPECT_THAT(Stand(-0.5, false).folds({0, 1}), IsEmpty()) << "before it, and no size is known";
}

Judgement judged(Stand stand) {
  Calibration calibration{stand.problem->table(), {}};
  calibration.steps.push_back(
      {"calibrate", 100, std::move(stand.problem), FreeSet({0, 1}, 2), {}, {}});
  return calibrate_and_judge(calibration, stand.samples).judgement;
}

TEST(FoldedLens, IsNoResultWhereFeaturesAreAndToBeUsedWithCareBeyondThem) {
  const auto says = testing::Contains(HasSubstr(
      "the lens of 'camera' folds over inside the image, 218 px from the center; its corners are "
      "at 400 px"));
  const Judgement among = judged(Stand(-0.5, true, 0.8)), beyond = judged(Stand(-0.5));
  EXPECT_EQ(among.verdict, Grade::do_not_use);
  EXPECT_THAT(among.reasons, says);
  EXPECT_EQ(beyond.verdict, Grade::use_with_care);
  EXPECT_THAT(beyond.reasons, says);
}

}  // namespace
}  // namespace kinecal
