// Blocks that compare a camera with the robot's own surface, and the meshes that they need.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/surface/surface_match.hpp"

namespace kinecal {

/// What rounds of association need beside a configuration and its samples.
struct SurfaceInput {
  const Robot& robot;
  std::string urdf_text;                ///< of the robot
  std::string urdf;                     ///< its name: meshes are relative to it
  std::vector<std::string> mesh_paths;  ///< further folders of packages
  std::vector<int> exclude = {};        ///< numbers of samples that have no say, from 1
  int threads = 0;                      ///< zero: one per core; does not affect the result
};

/// A block that compares a camera with the surface of the robot.
struct SurfaceBlock {
  std::string name;  ///< of the error block
  SurfacePair pair;
  RobotSurface surface;
  bool is_whole = true;     ///< no other link has a mesh, whose points may be near these
  bool is_outline = false;  ///< of masks (camera2d_to_mesh), not of points
  bool is_view =
      true;  ///< of a camera that measures all it sees; false: of a laser, which sees lines
};

/// Reads the surfaces that the blocks of a configuration need, and names their links in its models.
/// @returns  the blocks of each step
[[nodiscard]] std::vector<std::vector<SurfaceBlock>> read_surface_blocks(const SurfaceInput& input,
                                                                         Config& config,
                                                                         Diagnostics& diagnostics);

/// True if no block leaves out a link whose points may be near its own.
[[nodiscard]] bool are_whole(const std::vector<std::vector<SurfaceBlock>>& blocks);

/// The error block of this name, which is in the step.
/// @{
[[nodiscard]] const BlockConfig& block_of(const StepConfig& step, const std::string& name);
[[nodiscard]] BlockConfig& block_of(StepConfig& step, const std::string& name);
/// @}

/// The samples without those that are excluded.
/// @param exclude  numbers, from 1
[[nodiscard]] std::vector<Sample> heard_samples(std::span<const Sample> samples,
                                                const std::vector<int>& exclude);

/// The frame of a camera whose pose is searched for: the chain to the camera in two parts.
class SearchedFrame {
 public:
  /// @param frame    with six free axes
  /// @param problem  of the step
  SearchedFrame(const UnknownFrame& frame, const AnyProblem& problem, const std::string& camera);

  /// False if no pose can be searched for.
  [[nodiscard]] bool is_usable() const { return before_.has_value(); }
  /// The camera, and its number in the problem.
  /// @{
  [[nodiscard]] const MountedSensor& camera() const;
  [[nodiscard]] int camera_number() const { return camera_; }
  /// @}

  /// Values with the frame at its origin.
  [[nodiscard]] Eigen::VectorXd zeroed(Eigen::VectorXd values) const;
  /// Values with the frame in a pose.
  [[nodiscard]] Eigen::VectorXd with(const Pose<double>& pose, Eigen::VectorXd values) const;
  /// base_T_frame in a sample.
  /// @param values  zeroed()
  [[nodiscard]] Pose<double> before(const Sample& sample, const Eigen::VectorXd& values) const;
  /// Links of a surface in the frame, in a sample.
  /// @param values  zeroed()
  [[nodiscard]] std::vector<Pose<double>> links(const SurfaceBlock& block, const Sample& sample,
                                                const Eigen::VectorXd& values) const;

 private:
  const UnknownFrame& frame_;
  const AnyProblem& problem_;
  int camera_ = 0;
  std::optional<SampledChain> before_;
};

/// Where rounds ended that began at a pose which a search suggested.
struct SearchEnd {
  Eigen::VectorXd values;  ///< of all parameters of the table
  double cost = 0.0;       ///< the same of all ends: of the same samples and gate
};

/// Says that the robot looks alike from the best pose of a frame and from another one.
/// @returns  nullopt if no other pose fits nearly as well
[[nodiscard]] std::optional<std::string> look_alike(const UnknownFrame& frame,
                                                    std::span<const SearchEnd> ends);

}  // namespace kinecal
