// What the page knows of a calibration.
#include "kinecal/report/report_data.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "kinecal/report/html.hpp"
#include "support/mask_robot.hpp"
#include "support/mesh_robot_test.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(ReportData, HasResidualsOfSamplesThatWereLeftOutButNotInItsFigures) {
  test::NoisyScene noisy(20);
  noisy.samples[7].observations[0].features[1].point.x() += 0.2;
  noisy.solve();
  const std::vector<Sample> all = noisy.samples;
  const JudgedResult judged = calibrate_and_judge(noisy.calibration, all);
  ASSERT_EQ(judged.left_out.size(), 1u);
  const std::vector<Sample> used = used_samples(judged, all);
  const Findings findings =
      findings_of(test::mobile_manipulator(), noisy.calibration, judged, used);
  const ReportData without = report_data(noisy.calibration, findings, used);
  const ReportData with =
      report_data(noisy.calibration, findings, used, std::vector<Sample>{all[7]});
  EXPECT_EQ(without.blocks[0].features.size(), 19u * 4u);
  ASSERT_EQ(with.blocks[0].features.size(), 20u * 4u);
  EXPECT_EQ(with.blocks[0].rms_after, without.blocks[0].rms_after);
  EXPECT_EQ(with.blocks[0].rms_before, without.blocks[0].rms_before);
  const ReportedFeature& last = with.blocks[0].features[19 * 4 + 1];
  EXPECT_TRUE(with.samples[static_cast<std::size_t>(last.sample)].left_out);
  EXPECT_NEAR(last.after, 0.2, 0.02);
  EXPECT_NE(html_report(with, "").find("<td>76</td>"), std::string::npos) << "features used";
}

/// The arm with meshes, calibrated by masks.
class ReportOfMasks : public test::MeshRobotTest {
 protected:
  [[nodiscard]] CalibratedRobot calibrated(const std::string& initial) const {
    CalibrationSetup setup = setup_of(test::mask_config(initial));
    setup.samples = test::mask_robot_samples(setup.robot, {.samples = 4, .pixels = 2});
    return calibrate_robot(std::move(setup));
  }
  [[nodiscard]] static ReportData data_of(const CalibratedRobot& of) {
    return report_data(of.setup.calibration, of, of.samples);
  }
};

TEST_F(ReportOfMasks, OutlinesAreAtTheirResidualsFromTheMaskBeforeAndAfter) {
  const CalibratedRobot of = calibrated(test::kStart);
  const ReportData data = data_of(of);
  ASSERT_EQ(data.blocks.size(), 1u);
  EXPECT_EQ(data.blocks[0].image, (std::array<double, 2>{320.0, 240.0}));
  ASSERT_GT(data.blocks[0].features.size(), 1000u);
  for (const ReportedFeature& feature : data.blocks[0].features) {
    const Sample& sample = of.samples[static_cast<std::size_t>(feature.sample)];
    const auto place = static_cast<std::size_t>(feature.feature.place);
    const auto& normal = sample.observation("camera")->features[place].conditions;
    ASSERT_TRUE(feature.pixel && feature.outline_before && feature.outline_after);
    const auto distance = [&](const std::array<double, 2>& outline) {
      return normal.at("nu") * (outline[0] - (*feature.pixel)[0]) +
             normal.at("nv") * (outline[1] - (*feature.pixel)[1]);
    };
    constexpr double kRounding = 1e-9;  // pixels
    EXPECT_NEAR(distance(*feature.outline_after), feature.residual[0], kRounding);
    EXPECT_NEAR(std::abs(distance(*feature.outline_before)), feature.before, kRounding);
  }
  EXPECT_GT(data.blocks[0].rms_before, 5.0 * data.blocks[0].rms_after);
}

TEST_F(ReportOfMasks, APoseThatNobodyGaveHasNoBefore) {
  const ReportData data = data_of(calibrated(""));
  for (const ReportedFeature& feature : data.blocks.at(0).features) {
    ASSERT_FALSE(feature.outline_before);
    ASSERT_TRUE(feature.outline_after);
  }
}

}  // namespace
}  // namespace kinecal
