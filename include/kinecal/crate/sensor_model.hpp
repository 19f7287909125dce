// A sensor on its robot: its parameters and the chains from the base to what it observes.
//
// A feature is given in the sensor's own frame or in a virtual frame (a checkerboard, a tracker)
// beyond it; each of these frames has its own chain.  An observation is packed once: sine and
// cosine of the joints, measurements as the sensor needs them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/crate/packed_sample.hpp"
#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A sample that cannot be used with this robot and these sensors.
struct SampleError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A sensor with its chains and the table indices of its parameters.
class SensorModel {
 public:
  /// @param frames  names of all free frames: names of joints correct these joints, the others are
  ///                virtual frames
  /// @throws RobotError  if no chain leads from the base to the sensor's frame
  SensorModel(const Robot& robot, const std::string& base, Sensor sensor,
              const ParameterTable& table, const std::set<std::string>& frames)
      : sensor_(std::move(sensor)), camera_parameters_(sensor_parameters(sensor_.type), -1) {
    const RuntimeChain chain = make_chain(robot, base, sensor_.frame, frames);
    add_chain(chain, table);
    for (const std::string& frame : frames) {
      if (!robot.has_joint(frame)) add_chain(with_virtual_frame(chain, frame), table);
    }
    for (std::size_t i = 0; i < camera_parameters_.size(); ++i) {
      camera_parameters_[i] =
          table.find(parameter_name(sensor_.parameter_prefix(), kCameraParameters[i]));
    }
  }

  /// The sensor itself.
  [[nodiscard]] const Sensor& sensor() const { return sensor_; }
  /// The chain to the sensor's frame, then those to virtual frames.
  [[nodiscard]] const std::vector<RuntimeChain>& chains() const { return chains_; }
  /// Table indices of each chain's parameters.
  [[nodiscard]] const std::vector<std::vector<JointIndices>>& parameters() const {
    return parameters_;
  }
  /// Table indices of the sensor's own parameters; -1 if the table does not have them.
  [[nodiscard]] const std::vector<int>& camera_parameters() const { return camera_parameters_; }

  /// Prepares what the sensor observed in a sample.
  /// @throws SampleError  with what is missing or wrong
  [[nodiscard]] PackedObservation<double> pack(const Sample& sample,
                                               const Observation& observation) const {
    PackedObservation<double> packed;
    packed.motions.resize(chains_.size());
    if (sensor_.type != SensorType::chain3d) pack_camera(observation, packed);
    for (const Feature& feature : observation.features) {
      const std::size_t chain = chain_to(feature.frame);
      if (!packed.motions[chain]) packed.motions[chain] = motions(sample, chains_[chain]);
      const bool usable = std::isfinite(feature.point.x()) && std::isfinite(feature.point.y()) &&
                          std::isfinite(feature.point.z());
      packed.chain.push_back(chain);
      packed.usable.push_back(usable ? 1.0 : 0.0);
      packed.measured.push_back(usable ? measurement(feature.point, packed) : feature.point);
    }
    replace_unusable(packed);
    return packed;
  }

 private:
  void add_chain(const RuntimeChain& chain, const ParameterTable& table) {
    chain_by_frame_.emplace(chain.tip, chains_.size());
    chains_.push_back(chain);
    parameters_.push_back(chain_parameters(chain, table));
  }

  [[nodiscard]] std::size_t chain_to(const std::string& frame) const {
    if (frame.empty()) return 0;  // a header without frame_id: the sensor's own frame
    const auto it = chain_by_frame_.find(frame);
    const bool is_camera = sensor_.type != SensorType::chain3d;
    if (it != chain_by_frame_.end() && !(is_camera && it->second != 0)) return it->second;
    std::vector<std::string> known;
    for (const auto& [name, chain] : chain_by_frame_) known.push_back(name);
    throw SampleError("sensor '" + sensor_.name + "': a feature is in frame '" + frame +
                      "', which is not the sensor's frame '" + sensor_.frame + "'" +
                      (is_camera ? "" : " and not a free frame") + did_you_mean(frame, known));
  }

  [[nodiscard]] std::vector<Motion<double>> motions(const Sample& sample,
                                                    const RuntimeChain& chain) const {
    return measured_motions(chain, [&](const std::string& joint) {
      const std::optional<double> position = sample.position(joint);
      if (!position) {
        throw SampleError("joint '" + joint + "' is not in the sample; sensor '" + sensor_.name +
                          "' needs it" + did_you_mean(joint, sample.joint_names));
      }
      if (!std::isfinite(*position)) {
        throw SampleError("the position of joint '" + joint + "' is not a number");
      }
      return *position;
    });
  }

  /// Replaces NaN features, whose weight is zero, by another one: zero times NaN is NaN.
  static void replace_unusable(PackedObservation<double>& packed) {
    const auto first = std::find(packed.usable.begin(), packed.usable.end(), 1.0);
    if (first == packed.usable.end()) return;  // no error block uses the observation then
    const auto stand_in = packed.measured[static_cast<std::size_t>(first - packed.usable.begin())];
    for (std::size_t i = 0; i < packed.usable.size(); ++i) {
      if (packed.usable[i] == 0.0) packed.measured[i] = stand_in;
    }
  }

  void pack_camera(const Observation& observation, PackedObservation<double>& packed) const {
    if (!observation.camera) {
      throw SampleError("sensor '" + sensor_.name + "' is a camera but has no camera_info");
    }
    const CameraInfo& info = *observation.camera;
    if (sensor_.type == SensorType::camera3d) {
      const DepthCamera<>& c =
          *(packed.depth_camera = std::make_unique<DepthCamera<>>(DepthCamera<>::from(info)));
      check_numbers({c.fx, c.fy, c.cx, c.cy, c.z_offset, c.z_scaling});
    } else {
      const PinholeCamera<>& c =
          *(packed.pinhole_camera = std::make_unique<PinholeCamera<>>(PinholeCamera<>::from(info)));
      check_numbers({c.fx, c.fy, c.cx, c.cy, 0.0, 1.0});
      check_distortion(info);
    }
  }

  /// @param numbers  fx fy cx cy z_offset z_scaling
  void check_numbers(const std::array<double, 6>& numbers) const {
    for (const double number : numbers) {
      if (!std::isfinite(number)) {
        throw SampleError("sensor '" + sensor_.name +
                          "': camera_info has a value that is not a number");
      }
    }
    if (!(numbers[0] > 0.0 && numbers[1] > 0.0)) {
      throw SampleError("sensor '" + sensor_.name +
                        "': the focal lengths in camera_info are not positive");
    }
    if (!(numbers[5] > 0.0)) {
      throw SampleError("sensor '" + sensor_.name + "': z_scaling is not positive");
    }
  }

  void check_distortion(const CameraInfo& info) const {
    for (std::size_t i = 0; i < info.d.size(); ++i) {
      if (info.d[i] == 0.0) continue;
      if (!info.distortion_model.empty() && info.distortion_model != "plumb_bob") {
        throw SampleError("sensor '" + sensor_.name + "': distortion model '" +
                          info.distortion_model +
                          "' is not supported; rectify the images or use plumb_bob");
      }
      if (i >= 5 || !std::isfinite(info.d[i])) {
        throw SampleError("sensor '" + sensor_.name +
                          "': plumb_bob has five distortion coefficients, each a number");
      }
    }
  }

  [[nodiscard]] Vector3<double> measurement(const Vector3<double>& point,
                                            const PackedObservation<double>& packed) const {
    if (sensor_.type != SensorType::camera3d) return point;
    if (point.z() <= 0.0) {
      throw SampleError("sensor '" + sensor_.name + "': a point is behind the camera (z = " +
                        std::to_string(point.z()) + " m)");
    }
    return packed.depth_camera->measurement(point);
  }

  Sensor sensor_;
  std::vector<int> camera_parameters_;
  std::vector<RuntimeChain>
      chains_;  ///< [0] ends at the sensor's frame, the others at virtual frames
  std::vector<std::vector<JointIndices>> parameters_;
  std::map<std::string, std::size_t> chain_by_frame_;
};

}  // namespace kinecal
