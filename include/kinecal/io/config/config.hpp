// A calibration as its configuration file describes it: models, what is free, error blocks, steps.
//
// Plain values with the place they came from; both dialects of robot_calibration are read into
// this (read_config.hpp).  Names are checked against the robot and the samples in assemble.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

/// `models:`  what observes features, and the link it is fixed to.
struct ModelConfig {
  std::string name;
  std::string type;        ///< chain3d, camera3d or camera2d ("chain" is read as chain3d)
  std::string frame;       ///< link of the URDF
  std::string param_name;  ///< prefix of the camera's parameters; the model's name by default
  Place place;
};

/// `free_params:`  a joint offset or a camera parameter.
struct FreeParamConfig {
  std::string name;
  Place place;
};

/// `free_frames:`  a joint's frame or a virtual frame, and which axes of it are free.
struct FreeFrameConfig {
  std::string name;
  std::array<bool, 6> axes{};  ///< x y z roll pitch yaw
  Place place;
};

/// `free_frames_initial_values:`
struct FrameInitialValueConfig {
  std::string name;
  Vector3<double> xyz = Vector3<double>::Zero();  ///< metres
  Vector3<double> rpy = Vector3<double>::Zero();  ///< radians
  Place place;
};

/// `initial_values:`  (kinecal's own) a value for any parameter, free or held.
struct InitialValueConfig {
  std::string name;
  double value = 0.0;
  Place place;
};

/// `bounds:`  (kinecal's own) lower and upper bound of a free parameter.
struct BoundConfig {
  std::string name;
  double lower = 0.0, upper = 0.0;
  Place place;
};

/// `loss: {type: none|huber|cauchy|tukey, scale: ...}`
struct LossConfig {
  std::string type = "none";
  double scale = 1.0;  ///< units of the block's residual after division by sigma
};

/// `error_blocks:`
struct BlockConfig {
  std::string name;
  std::string type;                 ///< chain3d_to_chain3d, chain3d_to_camera2d, chain3d_to_plane,
                                    ///< plane_to_plane or outrageous
  std::vector<std::string> models;  ///< a, b | 3d, 2d | the one model; none for outrageous
  std::string param;                ///< outrageous: joint or frame
  std::map<std::string, double> numbers;  ///< a b c d scale normal_scale offset_scale joint_scale
                                          ///< position_scale rotation_scale; defaults filled in
  bool alone = false;  ///< `samples: alone`: only samples in which no other model observes
  double sigma = 1.0;  ///< standard deviation, units of the residual
  LossConfig loss;
  Place place;
};

/// One optimization; several follow one another, each starting where the last one ended.
struct StepConfig {
  std::string name;
  int max_num_iterations = 1000;
  std::vector<ModelConfig> models;
  std::vector<FreeParamConfig> free_params;
  std::vector<FreeFrameConfig> free_frames;
  std::vector<FrameInitialValueConfig> frame_initial_values;
  std::vector<InitialValueConfig> initial_values;
  std::vector<BoundConfig> bounds;
  std::vector<BlockConfig> error_blocks;
  Place place;
};

struct Config {
  std::string base_link = "base_link";
  std::optional<Place> base_link_place = {};  ///< nothing where the default stands
  std::vector<StepConfig> steps;
  Place place;
};

}  // namespace kinecal
