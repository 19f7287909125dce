// Recorded points against the size of the robot.
#include "kinecal/config/doubts/sensor_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SensorPoints : public test::ArmScene {
 protected:
  void scale(std::size_t sensor, double factor) {
    for (Sample& sample : samples) {
      for (Feature& feature : sample.observations[sensor].features) feature.point *= factor;
    }
  }
};

TEST_F(SensorPoints, InMillimetresAreAnError) {
  scale(1, 1000.0);
  EXPECT_THAT(found().errors, ElementsAre(AllOf(HasSubstr("points of sensor 'tracker' are"),
                                                HasSubstr("m apart"), HasSubstr("millimetres"))));
}

TEST_F(SensorPoints, InAnyOtherUnitAreAnErrorThatNamesIt) {
  scale(1, 1.0 / 0.0254);
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("inches")));
  scale(1, 0.0254 * 1e-3);
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("kilometres")));
}

TEST_F(SensorPoints, OneFarAwayDoesNotDecideTheUnit) {
  samples[6].observations[1].features[0].point.x() += 20.0;
  EXPECT_THAT(found().errors, IsEmpty());
}

TEST_F(SensorPoints, OfATargetInMillimetresAreADoubtAtLeast) {
  scale(0, 1000.0);  // (0, 0, 30) and (50, 20, 0)
  const Diagnostics diagnostics = found();
  EXPECT_THAT(diagnostics.errors, ElementsAre(HasSubstr("points of sensor 'arm'")));
  scale(0, 0.25);
  EXPECT_THAT(found().doubts, testing::Contains(HasSubstr("points of sensor 'arm' are")));
}

TEST_F(SensorPoints, OfATrackerFarAwayAreRight) {
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.point.x() += 60.0;
  }
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, IsEmpty());
}

/// What a controller says of the point of the tool, in the digits of its screen.
TEST_F(SensorPoints, ThatTheControllerComputedAreADoubt) {
  const Robot robot = parse_urdf(test::kArmUrdf, "arm.urdf");
  const RuntimeChain arm = make_chain(robot, "base_link", "tool");
  const auto computed = [&](double zero, double step, const Pose<double>& table_T_base) {
    for (Sample& sample : samples) {
      for (double& q : sample.joint_positions) q = 1e-5 * std::round(1e5 * q);
      const Pose<double> base_T_tool = forward_kinematics(arm, [&](const std::string& joint) {
        return *sample.position(joint) + (joint == "lift" ? zero : 0.0);
      });
      const Vector3<double> p = table_T_base * (base_T_tool * Vector3<double>(0.1, 0.0, 0.15));
      sample.observations[0].features = {{"tool", Vector3<double>::Zero()}};
      sample.observations[1].features = {
          {"tracker_frame", step * Vector3<double>((p / step).array().round().matrix())}};
    }
    return found().doubts;
  };
  const Pose<double> table{rotation_from_rpy(Vector3<double>(0.0, 0.0, 0.4)), {0.5, -0.2, 0.1}};
  const auto is_computed = HasSubstr("they were computed from the joints, not measured");
  EXPECT_THAT(computed(0.0, 1e-6, {}),
              ElementsAre(AllOf(is_computed, HasSubstr("in the robot's base"))));
  EXPECT_THAT(computed(0.0, 1e-5, table), ElementsAre(is_computed)) << "in a table's frame";
  EXPECT_THAT(computed(0.02, 1e-6, {}), IsEmpty()) << "a zero that is wrong";
}

TEST_F(SensorPoints, ThatNeverChangeAreAnErrorIfTheArmMoves) {
  for (Sample& sample : samples) sample.observations[1] = samples[0].observations[1];
  EXPECT_THAT(found().errors,
              ElementsAre(AllOf(HasSubstr("records the same features"), HasSubstr("has stopped"))));
}

TEST_F(SensorPoints, ThatNeverChangeAreRightIfOnlyTheirDistanceIsKnown) {
  replace(config_text, "type: chain3d_to_chain3d", "type: point_distance, length: 0.5");
  for (Sample& sample : samples) sample.observations[1] = samples[0].observations[1];
  EXPECT_THAT(found().errors, IsEmpty());
}

TEST_F(SensorPoints, ThatNeverChangeAreRightIfTheArmReachesOnePlace) {
  for (Sample& sample : samples) {
    sample.observations[1] = samples[0].observations[1];
    for (std::size_t j = 0; j < 5; ++j) {
      sample.joint_positions[j] =
          samples[0].joint_positions[j] +
          0.02 * std::sin(static_cast<double>(j + 3) * sample.joint_positions[j]);
    }
  }
  EXPECT_THAT(found().errors, IsEmpty());
}

TEST_F(SensorPoints, ThatAreAbsurdAreNamedWithTheirPlace) {
  samples[6].observations[1].features[0].point.z() = 1e200;
  EXPECT_THAT(found().errors,
              ElementsAre(HasSubstr("s.yaml:61: sensor 'tracker' has a feature with the number "
                                    "1e+200; correct or remove the sample")));
}

TEST_F(SensorPoints, OfACameraThatHasStoppedAreAnError) {
  config_text = R"(base_link: base_link
models:
 - {name: arm, type: chain3d, frame: tool}
 - {name: camera, type: camera2d, frame: l1}
free_params: [elbow, flex]
error_blocks:
 - {name: seen, type: chain3d_to_camera2d, model_3d: arm, model_2d: camera}
)";
  CameraInfo info;
  info.width = 640, info.height = 480;
  info.k = {550, 0, 320, 0, 550, 240, 0, 0, 1};
  info.p = {550, 0, 320, 0, 0, 550, 240, 0, 0, 0, 1, 0};
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Observation& seen = samples[s].observations[1];
    seen.sensor = "camera", seen.camera = info;
    for (Feature& feature : seen.features) {
      feature.frame = "l1";
      feature.point = {200.0 + static_cast<double>(s), 300.0, 0.0};
    }
  }
  EXPECT_THAT(found().errors, IsEmpty());
  EXPECT_THAT(found().doubts, IsEmpty());
  for (Sample& sample : samples) sample.observations[1].camera->k[2] = 641;
  EXPECT_THAT(found().doubts,
              ElementsAre(AllOf(HasSubstr("principal point of sensor 'camera' is (641, 240) by K"),
                                HasSubstr("image of 640x480 pixels"))));
  for (Sample& sample : samples) sample.observations[1].camera->k[2] = 320;
  auto changing = samples;
  for (Sample& sample : samples) sample.observations[1] = samples[0].observations[1];
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("sensor 'camera' records the same features")));
  samples = changing;
  for (Sample& sample : samples) {
    for (Feature& feature : sample.observations[1].features) feature.point /= 550.0;
  }
  EXPECT_THAT(found().errors, ElementsAre(HasSubstr("look like metres or normalized")));
  samples = changing;
  samples[4].observations[1].features[0].point.x() = 1200.0;
  EXPECT_THAT(found().doubts, testing::Contains(HasSubstr("outside its image of 640x480 pixels")));
}

}  // namespace
}  // namespace kinecal
