// What the page knows of a calibration.
#include "kinecal/report/report_data.hpp"

#include <gtest/gtest.h>

#include "kinecal/report/html.hpp"
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

}  // namespace
}  // namespace kinecal
