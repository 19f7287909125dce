#include "kinecal/procedure/session_end.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/trust/uncertainty/pose_elsewhere.hpp"
#include "support/alike_samples.hpp"

namespace kinecal::test {
namespace {

using ::testing::HasSubstr;

/// A session whose samples have been calibrated.
struct CalibratedSession {
  NoisyScene& scene;
  Assessment step = scene.solve_and_assess();
  Eigen::VectorXd values = scene.values();
  Judgement judgement = judge(scene.calibration, scene.result, {step});

  /// @param wanted  metres
  [[nodiscard]] std::string why(double wanted, const std::vector<Sample>& ahead = {}) const {
    Accuracy accuracy;
    accuracy.position = wanted;
    return why_go_on(accuracy,
                     {scene.solved(), NoisyScene::span(values), step, judgement, scene.samples},
                     ahead);
  }
  [[nodiscard]] double held_out() const {
    return pose_held_out(scene.solved(), step, NoisyScene::span(values), scene.samples,
                         {step.compared[0].frame}, {step.compared[0].in})
        .position;
  }
};

TEST(SessionEnd, NeedsHalfAsManyNumbersAgainAsThereAreFreeParameters) {
  NoisyScene scene(2);
  EXPECT_THAT(CalibratedSession{scene}.why(1.0),
              HasSubstr("10 free parameters need 15 measured numbers; these samples have 12"));
  NoisyScene more(3);
  EXPECT_THAT(CalibratedSession{more}.why(1e-6), Not(HasSubstr("measured numbers")));
}

TEST(SessionEnd, IsThereWhenThePoseIsKnownEverywhere) {
  NoisyScene scene(40);
  const CalibratedSession session{scene};
  EXPECT_EQ(session.why(0.02, NoisyScene(10, 5).samples), "");
  EXPECT_THAT(session.why(0.9 * session.step.compared[0].position),
              AllOf(HasSubstr("'hand' in 'camera_optical_frame' is known to"),
                    HasSubstr("at the captured poses")));
}

TEST(SessionEnd, AsksHowEachPoseIsKnownByTheOthers) {
  NoisyScene scene(8);
  CalibratedSession session{scene};
  session.step.held_out.clear();
  const double between = 0.5 * (session.step.compared[0].position + session.held_out());
  EXPECT_THAT(session.why(between), HasSubstr("at each pose by the samples of the others"));
}

TEST(SessionEnd, AsksHowThePosesAreKnownThatAreLeft) {
  AlikeSamples alike(12);
  const CalibratedSession session{alike.scene};
  const double enough = 1.3 * session.held_out();
  EXPECT_EQ(session.why(enough), "");
  EXPECT_THAT(session.why(enough, alike.others), HasSubstr("at the poses that are left"));
}

TEST(SessionEnd, IsNotThereWhileTheRemainingPosesWouldDetermineAParameter) {
  AlikeSamples alike(6);
  CalibratedSession session{alike.scene};
  session.step.held_out.clear();
  EXPECT_EQ(session.why(1.0, alike.others), "");
  // As if the sensor were so much worse that one parameter is just not known well enough.
  double most = 0.0;
  std::size_t worst = 0;
  for (std::size_t c = 0; c < session.step.parameters.size(); ++c) {
    const int parameter = session.step.parameters[c];
    const double share = *session.step.deviation(parameter) /
                         useful_deviation(session.scene.solved().table()[parameter]);
    if (share <= most) continue;
    most = share;
    worst = c;
  }
  const std::string name = session.scene.solved().table()[session.step.parameters[worst]].name;
  session.step.uncertainty.deviation =
      PlainMatrix((1.1 / most) * session.step.uncertainty.deviation.matrix());
  EXPECT_THAT(session.why(1.0, alike.others),
              AllOf(HasSubstr("is known to +- "), HasSubstr("only"),
                    HasSubstr("the poses that are left determine more")));
  // Without a list of poses a person moves the robot.
  session.step.weak.parameters = {session.step.parameters[worst]};
  EXPECT_THAT(session.why(1.0), AllOf(HasSubstr("'" + name + "' is known to +- "),
                                      HasSubstr("move the joints that differ least so far")));
}

TEST(SessionEnd, IsNotThereWithACalibrationThatIsNotToBeUsed) {
  NoisyScene scene(40);
  CalibratedSession session{scene};
  session.judgement.add(Grade::do_not_use, "something is wrong");
  EXPECT_EQ(session.why(1.0), "the verdict is 'do not use': something is wrong");
}

TEST(SessionEnd, TakesThePoseForLessWellKnownIfSamplesHeldOutAreFurtherOff) {
  NoisyScene scene(40);
  CalibratedSession session{scene};
  const double enough = 2.0 * session.held_out();
  EXPECT_EQ(session.why(enough), "");
  HeldOutError& error = session.step.held_out[0];
  error.held_out = 10.0 * error.fitted;
  EXPECT_THAT(session.why(enough), HasSubstr("at the captured poses"));
}

}  // namespace
}  // namespace kinecal::test
