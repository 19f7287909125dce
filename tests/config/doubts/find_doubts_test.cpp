// All checks together: in their order, and without alarms for what is right.
#include "kinecal/config/doubts/find_doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/config/doubts/check_offsets.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "support/arm_scene.hpp"
#include "support/data.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class FindDoubts : public test::ArmScene {};

TEST_F(FindDoubts, AreNoneWhereAllIsRight) {
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
  EXPECT_THAT(diagnostics.warnings, IsEmpty());
}

TEST_F(FindDoubts, WorkWithoutSamples) {
  samples.clear();
  EXPECT_THAT(found().errors, IsEmpty());
  replace(urdf, "0 1.5707963267948966 0", "0 90 0");
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("degrees")));
}

TEST_F(FindDoubts, AWrongUnitIsReportedOnceAndNotWhatFollowsFromIt) {
  replace(urdf, "0.4 0 0", "400 0 0");
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("origin of joint 'elbow'")));
}

struct RealCase {
  const char *urdf, *config, *samples;
  bool determined = true;  ///< the samples determine all offsets
};

class RealData : public testing::TestWithParam<RealCase> {};

TEST_P(RealData, RaisesNeitherErrorNorDoubt) {
  const auto& [urdf, config_file, samples_file, determined] = GetParam();
  const std::string set = std::string(urdf).substr(0, std::string(urdf).find('/'));
  KINECAL_NEEDS_DATA(set);
  const auto path = [](const char* file) { return (test::data_folder() / file).string(); };
  Diagnostics diagnostics;
  const std::string text = read_urdf_text(path(urdf)), name = path(urdf);
  const Robot robot = parse_urdf(text, name);
  const Config config = read_config(path(config_file), diagnostics);
  const auto samples = read_recording(path(samples_file), diagnostics).samples;
  const Calibration calibration = assemble(config, robot, samples, diagnostics);
  const CalibrationInput input{config, robot, text, name, samples, calibration};
  find_doubts(input, diagnostics);
  if (determined) check_offsets(input, calibrate(calibration).table, diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  EXPECT_THAT(diagnostics.doubts, IsEmpty());
}

constexpr const char *kFetch = "fetch/synth/fetch_arm_head.urdf", *kUr5 = "ur5_tracker/ur5.urdf",
                     *kPanda = "mukca_panda/panda.urdf";

INSTANTIATE_TEST_SUITE_P(
    FindDoubts, RealData,
    testing::Values(
        RealCase{kFetch, "fetch/synth/calibrate.yaml", "fetch/synth/samples.yaml"},
        RealCase{kFetch, "fetch/calibrate.yaml", "fetch/synth/calibration_data.bag"},
        RealCase{kUr5, "ur5_tracker/base_tool.yaml", "ur5_tracker/grid.yaml"},
        RealCase{kUr5, "ur5_tracker/offsets.yaml", "ur5_tracker/grid.yaml"},
        RealCase{kUr5, "ur5_tracker/full.yaml", "ur5_tracker/grid.yaml"},
        RealCase{kUr5, "ur5_tracker/full.yaml", "ur5_tracker/random.yaml", false},
        RealCase{kUr5, "ur5_tracker/weak.yaml", "ur5_tracker/random.yaml", false},
        RealCase{kUr5, "ur5_tracker/redundant.yaml", "ur5_tracker/grid.yaml", false},
        RealCase{kPanda, "mukca_panda/panda_6/minimal.yaml", "mukca_panda/panda_6/front.yaml"},
        RealCase{kPanda, "mukca_panda/panda_6/frames.yaml", "mukca_panda/panda_6/front.yaml"},
        RealCase{kPanda, "mukca_panda/panda_6/redundant.yaml", "mukca_panda/panda_6/front.yaml"},
        RealCase{kPanda, "mukca_panda/panda_6/right_fixture.yaml",
                 "mukca_panda/panda_6/right.yaml"},
        RealCase{kPanda, "mukca_panda/panda_2/stable.yaml",
                 "mukca_panda/panda_2/front_center.yaml"},
        RealCase{kPanda, "mukca_panda/panda_2/frames.yaml",
                 "mukca_panda/panda_2/front_center.yaml"},
        RealCase{kPanda, "mukca_panda/panda_2/back_left_fixture.yaml",
                 "mukca_panda/panda_2/back_left.yaml"}));

}  // namespace
}  // namespace kinecal
