// A calibration as described by a configuration file: models, free parameters, blocks, steps.
//
// Plain values with source locations.  read_config.hpp fills them from both dialects of
// robot_calibration; assemble.hpp checks the names against the robot and the samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/parameters/parameter.hpp"
#include "kinecal/sensors/camera_image.hpp"

namespace kinecal {

struct BlockEntry;
struct SensorEntry;

/// `lens: auto`  the simplest lens with which the samples agree.
inline constexpr std::string_view kAnyLens = "auto";

/// `models:`  a sensor or arm that observes features, and the link it is fixed to.
struct ModelConfig {
  std::string name;        ///< sensor_name in the samples
  std::string type;        ///< of the registry: "chain3d" ("chain" is read as chain3d)
  std::string frame;       ///< link of the URDF
  std::string param_name;  ///< prefix of the camera's parameters; the model's name by default
  SourceLocation place;    ///< where the file defines it
  ImageKind image = ImageKind::automatic;  ///< (kinecal only) of a camera2d: the kind of its image
  /// (kinecal only) of a camera2d: its lens by lens_names(), "auto", or empty: as camera_info says
  std::string lens = {};
  /// Its type, where a program brings its own; nullptr: the one that the registry has by this name.
  std::shared_ptr<const SensorEntry> own = nullptr;
  /// Further links in which its features may be given: those of the surface of the robot.
  std::vector<std::string> links = {};
  /// It is no sensor of the samples but the surface of the robot where another model observes it.
  bool is_surface = false;

  /// Where its features may be: the link it is fixed to, and further links.
  [[nodiscard]] std::vector<std::string> frames() const {
    std::vector<std::string> all = {frame};
    all.insert(all.end(), links.begin(), links.end());
    return all;
  }
};

/// `free_params:`  a joint offset or a camera parameter.
struct FreeParamConfig {
  std::string name;      ///< of the parameter: "elbow_flex_joint", "head_camera_fx"
  SourceLocation place;  ///< where the file frees it
};

/// `free_frames:`  a joint's frame or a virtual frame, and its free axes; or `fixed_frames:`
/// (kinecal only), a virtual frame with a known pose.
struct FreeFrameConfig {
  std::string name;            ///< joint of the URDF or virtual frame
  std::array<bool, 6> axes{};  ///< x y z roll pitch yaw
  SourceLocation place;        ///< where the file frees it
  bool is_fixed = false;       ///< of fixed_frames: no axis is free, initial_values give its pose
};

/// `free_frames_initial_values:`  where a free frame starts.
struct FrameInitialValueConfig {
  std::string name;                               ///< of the free frame
  Vector3<double> xyz = Vector3<double>::Zero();  ///< metres
  Vector3<double> rpy = Vector3<double>::Zero();  ///< radians
  SourceLocation place;                           ///< where the file sets it
};

/// `initial_values:`  (kinecal only) a value of any parameter, free or not.
struct InitialValueConfig {
  std::string name;      ///< of the parameter
  double value = 0.0;    ///< radians, metres, or a relative change of an intrinsic
  SourceLocation place;  ///< where the file sets it
};

/// `bounds:`  (kinecal only) lower and upper bound of a free parameter.
struct BoundConfig {
  std::string name;      ///< of the parameter
  double lower = 0.0;    ///< smallest value, in the unit of the parameter
  double upper = 0.0;    ///< largest value, in the unit of the parameter
  SourceLocation place;  ///< where the file sets it
};

/// `loss: {type: none|huber|cauchy|tukey, scale: ...}`
struct LossConfig {
  std::string type = "none";  ///< none, huber, cauchy or tukey
  double scale = 1.0;         ///< units of the block's residual after division by sigma
};

/// The surface of the robot with which chain3d_to_mesh compares points, camera2d_to_mesh masks.
struct SurfaceConfig {
  std::vector<std::string> links = {};  ///< `link_name`, `links`; empty: all that have a mesh
  std::string geometry = {};            ///< visual or collision; empty: visual, if it has meshes
  int points = 5000;                    ///< of a cloud, at most; evenly from its list
  /// Beyond it nothing counts, metres or pixels: as rounds of association found it; not in files.
  std::optional<double> gate = {};
};

/// `error_blocks:`  a comparison, or a prior.
struct BlockConfig {
  std::string name;                 ///< for reports and messages
  std::string type;                 ///< of the registry: "chain3d_to_chain3d"
  std::vector<std::string> models;  ///< in the order of the registry's keys; empty for outrageous
  std::string param;                ///< outrageous: joint, frame or parameter
  std::map<std::string, double> numbers;  ///< by key; defaults filled in
  std::set<std::string> given = {};       ///< keys of those that the file has
  /// `samples: exclusive` (or alone): only samples without observations of other models; nullopt:
  /// not given.
  std::optional<bool> exclusive = {};
  std::string ground;  ///< camera3d_to_ground: only samples with an observation of this sensor
  std::optional<double> sigma =
      {};           ///< standard deviation, units of the residual; empty: not given
  LossConfig loss;  ///< of each feature
  std::optional<SurfaceConfig> surface = {};  ///< of blocks of the surface of the robot
  SourceLocation place;                       ///< where the file defines it
  /// Its type, where a program brings its own; nullptr: the one that the registry has by this name.
  std::shared_ptr<const BlockEntry> own = nullptr;
};

/// One optimization.  Each step starts from the result of the step before it.
struct StepConfig {
  std::string name;                                           ///< key of the step in the file
  int max_num_iterations = 1000;                              ///< of the solver
  std::vector<ModelConfig> models;                            ///< `models:`
  std::vector<FreeParamConfig> free_params;                   ///< `free_params:`
  std::vector<FreeFrameConfig> free_frames;                   ///< also those of `fixed_frames:`
  std::vector<FrameInitialValueConfig> frame_initial_values;  ///< `free_frames_initial_values:`
  std::vector<InitialValueConfig> initial_values;             ///< `initial_values:`
  std::vector<BoundConfig> bounds;                            ///< `bounds:`
  std::vector<BlockConfig> error_blocks;                      ///< `error_blocks:`
  SourceLocation place;                                       ///< where the step begins
};

/// Whether a step may free nothing.
enum class NothingFree {
  is_error,
  without_lists,  ///< it may, if it has neither `free_params` nor `free_frames`: both were left open
  is_allowed
};

/// Names of a step's free parameters, each with the place that frees it: first free_params, then
/// the free axes of its frames.
[[nodiscard]] inline std::vector<FreeParamConfig> free_parameters(const StepConfig& step) {
  std::vector<FreeParamConfig> all = step.free_params;
  for (const FreeFrameConfig& frame : step.free_frames) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (frame.axes[i]) all.push_back({parameter_name(frame.name, kFrameAxes[i]), frame.place});
    }
  }
  return all;
}

/// A configuration file.
struct Config {
  std::string base_link = "base_link";                 ///< link in which measurements are compared
  std::optional<SourceLocation> base_link_place = {};  ///< empty if the file does not set base_link
  std::optional<Vector3<double>> gravity = {};  ///< (3) m/s^2, in the root link; empty: down its z
  std::string payload_link;  ///< carries the condition `payload` of a sample, kg; empty: none
  /// `per_sample:`  (kinecal only) frames with a pose of their own in each sample: fixed or floating joints, or
  /// virtual frames; each with the place that names it.
  std::vector<FreeParamConfig> per_sample;
  std::vector<StepConfig> steps;  ///< in the order in which they are solved
  SourceLocation place;           ///< the file
};

}  // namespace kinecal
