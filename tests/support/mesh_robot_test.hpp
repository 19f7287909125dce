// Tests of the arm with meshes (mesh_robot.hpp) in a folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "kinecal/config/read_config.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/mesh_robot.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::test {

/// The arm's meshes are in a folder.
class MeshRobotTest : public FolderTest {
 protected:
  MeshRobotTest() { write_meshes(folder_); }

  /// A calibration without samples.
  [[nodiscard]] CalibrationSetup setup_of(const std::string& config) const {
    Diagnostics found;
    CalibrationSetup setup{.robot = parse_urdf(urdf_, "arm.urdf"),
                           .config = parse_config(config, "calibrate.yaml", found),
                           .urdf_text = urdf_,
                           .urdf = (folder_ / "arm.urdf").string()};
    EXPECT_THAT(found.errors, testing::IsEmpty());
    return setup;
  }

  std::string urdf_ = mesh_robot_urdf();
};

}  // namespace kinecal::test
