// Measured poses of a flange and corners of a board, from tables: no joints, no guess of any pose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/files/csv/read_csv_samples.hpp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::data_folder;

const char* const kUrdf = R"(<robot name="hand_eye">
  <link name="base_link"/>
  <link name="flange"/>
  <joint name="flange_joint" type="floating"><parent link="base_link"/><child link="flange"/></joint>
  <link name="camera"/>
  <joint name="camera_joint" type="fixed"><parent link="base_link"/><child link="camera"/></joint>
</robot>
)";

const char* const kConfig = R"(base_link: base_link
models:
 - {name: arm, type: chain3d, frame: flange}
 - {name: camera, type: camera2d, frame: camera}
free_params: [PARAMS]
free_frames:
 - {name: camera_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
 - {name: target, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: corners, type: chain3d_to_camera2d, model_3d: arm, model_2d: camera, scale: 1.0}
)";

std::string columns_of(const std::filesystem::path& folder) {
  return R"(poses:
  flange_joint: {form: quaternion_xyzw, columns: [x, y, z, qx, qy, qz, qw]}
observations:
 - {sensor: arm, frame: target, table: )" +
         (folder / "target.csv").string() + R"(, points: [[x, y, z]], id_columns: [id]}
 - {sensor: camera, frame: camera, match: image, table: )" +
         (folder / "corners.csv").string() + R"(, pixels: [[u, v]], id_columns: [id]}
)";
}

class HandEye : public test::FolderTest {
 protected:
  /// Calibrates the samples, with further parameters free.
  test::Calibrated calibrated(const std::string& free) {
    const auto data = data_folder() / "hand_eye_charuco";
    write("columns.yaml", columns_of(data));
    write("hand_eye.urdf", kUrdf);
    std::string config = kConfig;
    config.replace(config.find("PARAMS"), 6, free);
    write("c.yaml", config);
    Diagnostics diagnostics;
    std::vector<Sample> samples = read_csv_samples(
        (data / "poses.csv").string(), (folder_ / "columns.yaml").string(), diagnostics);
    diagnostics.throw_if_errors();
    CameraInfo camera;
    camera.width = 1600;
    camera.height = 1200;
    camera.k = {1352.02747, 0, 789.67065, 0, 1356.14287, 627.2995, 0, 0, 1};
    camera.p = {1352.02747, 0, 789.67065, 0, 0, 1356.14287, 627.2995, 0, 0, 0, 1, 0};
    for (Sample& sample : samples) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor == "camera") seen.camera = camera;
      }
    }
    return test::calibrate_samples(read_urdf((folder_ / "hand_eye.urdf").string()),
                                   folder_ / "c.yaml", std::move(samples));
  }
};

TEST_F(HandEye, ReachesTheReferenceCostFromNoGuess) {
  KINECAL_NEEDS_DATA("hand_eye_charuco");
  const auto found = calibrated("");
  EXPECT_TRUE(found.result.converged) << found.result.termination;
  EXPECT_NEAR(found.cost() / 949.8420064, 1.0, 1e-9);
  EXPECT_EQ(found.result.blocks.front().count, 284);
  EXPECT_NEAR(1e-3 * found.rms_mm(), 2.586316, 1e-6) << "px";
  EXPECT_EQ(found.result.steps[0].num_parameters, 12);
  for (const Parameter& parameter : found.result.table) {
    EXPECT_FALSE(floating_coordinate(parameter.name)) << parameter.name;
  }
}

TEST_F(HandEye, ReachesTheReferenceCostWithFreeIntrinsics) {
  KINECAL_NEEDS_DATA("hand_eye_charuco");
  const auto found = calibrated("camera_fx, camera_fy, camera_cx, camera_cy");
  EXPECT_TRUE(found.result.converged) << found.result.termination;
  EXPECT_NEAR(found.cost() / 434.349822, 1.0, 1e-8);
  EXPECT_LT(std::abs(found.result.table["camera_fx"].value), 0.1)
      << "not the camera turned by half a turn, whose focal lengths are negative";
}

}  // namespace
}  // namespace kinecal
