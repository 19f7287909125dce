#include "kinecal/procedure/surface_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/surface/surface_match.hpp"
#include "support/mask_robot.hpp"
#include "support/mesh_robot_test.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The arm in poses that nobody has captured.
class SurfaceViewsOfAnArm : public test::MeshRobotTest {
 protected:
  /// Views by a configuration, which gets the links.
  PoseSamples views(CalibrationSetup& setup, int poses = 5) {
    for (const Sample& sample : test::mesh_robot_samples(setup.robot, {.samples = poses})) {
      poses_.push_back({sample.joint_names, sample.joint_positions, {}, sample.source});
    }
    camera_.frame = "camera";
    camera_.info = test::mask_camera();
    const SurfaceInput input{setup.robot, setup.urdf_text, setup.urdf, {}};
    return surface_views(input, camera_, *setup.config, poses_, found_);
  }
  /// The largest residual where the configuration puts the camera.
  double largest(const CalibrationSetup& setup, std::span<const Sample> samples) {
    const Calibration calibration = assemble(*setup.config, setup.robot, samples, found_);
    EXPECT_THAT(found_.errors, IsEmpty());
    Eigen::VectorXd values = calibration.table.values();
    for (const auto& [index, value] : calibration.steps[0].assignments) values[index] = value;
    values_ = values;
    double most = 0.0;
    const AnyProblem& problem = *calibration.steps[0].problem;
    const auto undefined =
        evaluate(problem, {values.data(), static_cast<std::size_t>(values.size())}, nullptr,
                 [&](int, int, const TermResiduals& rows) {
                   if (rows.residual.size() > 0)
                     most = std::max(most, rows.residual.cwiseAbs().maxCoeff());
                   rows_ += rows.residual.size();
                 });
    EXPECT_FALSE(undefined);
    return most;
  }

  std::vector<CapturePose> poses_;
  SimulatedCamera camera_;
  Diagnostics found_;
  Eigen::VectorXd values_;
  Eigen::Index rows_ = 0;
};

TEST_F(SurfaceViewsOfAnArm, HaveNoResidual) {
  CalibrationSetup clouds = setup_of(test::mesh_config(test::kStart));
  const PoseSamples seen = views(clouds);
  ASSERT_THAT(found_.errors, IsEmpty());
  ASSERT_EQ(seen.samples.size(), 5U);
  EXPECT_LT(largest(clouds, seen.samples), 1e-9);
  EXPECT_GT(rows_, 5 * 100) << "enough of the arm is in view";
}

TEST_F(SurfaceViewsOfAnArm, AreOfTheLinksThatAreNearest) {
  CalibrationSetup clouds = setup_of(test::mesh_config(test::kStart));
  const PoseSamples seen = views(clouds);
  (void)largest(clouds, seen.samples);
  Diagnostics quiet;
  const Calibration empty = assemble(*clouds.config, clouds.robot, {}, quiet);
  const RobotSurface surface = test::mesh_robot_surface();
  SurfaceHits hits;
  associate(surface, {"camera", "camera_surface"}, *empty.steps[0].problem, values_, seen.samples,
            0.1, 1, hits);
  int same = 0, all = 0;
  for (std::size_t s = 0; s < hits.size(); ++s) {
    const auto& on_links = seen.samples[s].observation("camera_surface")->features;
    for (std::size_t i = 0; i < hits[s].size(); ++i) {
      const SurfaceHit& hit = hits[s][i];
      EXPECT_LT(hit.distance, 1e-6) << "vertices of files are floats";
      ++all;
      same += surface.links()[static_cast<std::size_t>(hit.link)].name == on_links[i].frame ? 1 : 0;
    }
  }
  EXPECT_GT(same, 0.99 * all) << "but where links touch";
}

TEST_F(SurfaceViewsOfAnArm, OfMasksHaveNoResidualEither) {
  CalibrationSetup masks = setup_of(test::mask_config(test::kStart));
  camera_.has_depth = false;
  const PoseSamples seen = views(masks);
  ASSERT_THAT(found_.errors, IsEmpty());
  ASSERT_EQ(seen.samples.size(), 5U);
  EXPECT_LT(largest(masks, seen.samples), 1e-3) << "pixels";
  EXPECT_GT(rows_, 5 * 100);
}

/// Else a study would take the surface for a measurement, too.
TEST_F(SurfaceViewsOfAnArm, HaveOtherPointsInEachSample) {
  CalibrationSetup clouds = setup_of(test::mesh_config(test::kStart));
  std::set<int> ids;
  std::size_t count = 0;
  for (const Sample& sample : views(clouds).samples) {
    for (const Feature& feature : sample.observation("camera")->features) {
      ids.insert(feature.id.value());
      ++count;
    }
  }
  EXPECT_EQ(ids.size(), count);
}

TEST_F(SurfaceViewsOfAnArm, RefuseOtherBlocks) {
  std::string text = test::mesh_config(test::kStart);
  text.replace(text.find("models:\n"), 8, "models:\n- {name: arm, type: chain3d, frame: hand}\n");
  text += "- {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm}\n";
  CalibrationSetup both = setup_of(text);
  EXPECT_THAT(views(both).samples, IsEmpty());
  EXPECT_THAT(found_.errors, ElementsAre(HasSubstr("'hand_eye' compares something else")));
}

TEST_F(SurfaceViewsOfAnArm, SkipPosesWithoutTheRobot) {
  CalibrationSetup away = setup_of(test::mesh_config("x: -1.3, y: -0.6, z: 0.75, roll: 1.5"));
  const PoseSamples seen = views(away, 2);
  EXPECT_THAT(seen.samples, IsEmpty());
  EXPECT_THAT(
      seen.skipped,
      ElementsAre(HasSubstr("sample 0: the camera sees nearly nothing of the robot"), testing::_));
}

}  // namespace
}  // namespace kinecal
