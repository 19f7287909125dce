// Definitions of mounted_sensor.hpp: a sample's observation as numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kinecal/problem/mounted_sensor.hpp"
#include "kinecal/problem/sample_reading.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace detail {

/// Replaces NaN features, which count zero times, by valid ones: zero times NaN is NaN.
inline void replace_unusable(ObservationNumbers& all) {
  const auto first = std::find(all.usable.begin(), all.usable.end(), 1.0);
  if (first == all.usable.end()) return;  // then no error block uses the observation
  const auto width = std::ssize(all.measured) / std::ssize(all.usable);
  const auto stand_in = all.measured.begin() + (first - all.usable.begin()) * width;
  for (std::ptrdiff_t i = 0; i < std::ssize(all.usable); ++i) {
    if (all.usable[static_cast<std::size_t>(i)] > 0.0) continue;
    std::copy_n(stand_in, width, all.measured.begin() + i * width);
  }
}

}  // namespace detail

KINECAL_INLINE MountedSensor::MountedSensor(const Robot& robot, const std::string& base,
                                            Mount mount, std::shared_ptr<const AnySensor> sensor,
                                            const ParameterTable& table,
                                            const std::set<std::string>& frames)
    : mount_(std::move(mount)), sensor_(std::move(sensor)) {
  const RuntimeChain chain = make_chain(robot, base, mount_.frame, frames);
  mount_.frame = chain.tip;  // as the robot spells it
  lag_ = table.find(parameter_name(mount_.parameter_prefix(), kLag.name));
  for (const ParameterInfo& info : sensor_->parameters()) {
    parameters_.push_back(table.find(parameter_name(mount_.parameter_prefix(), info.name)));
    if (parameters_.back() == lag_) lag_ = -1;  // it has one of its own
  }
  add_chain(robot, chain, table);
  for (const std::string& frame : frames) {
    if (!robot.has_joint(frame)) add_chain(robot, with_virtual_frame(chain, frame), table);
  }
  for (const std::string& link : mount_.links) {
    if (chain_by_frame_.contains(std::string(plain_frame(link)))) continue;
    add_chain(robot, make_chain(robot, base, link, frames), table);
  }
}

KINECAL_INLINE std::vector<double> MountedSensor::own_values(ParameterValues values) const {
  std::vector<double> own;
  for (const int p : parameters_) own.push_back(p < 0 ? 0.0 : values[static_cast<std::size_t>(p)]);
  return own;
}

KINECAL_INLINE detail::ObservationNumbers MountedSensor::numbers(const Sample& sample,
                                                                 const Observation& seen) const {
  detail::ObservationNumbers all = measurements(seen);
  for (const std::size_t chain : all.chain) {
    if (!all.joints[chain]) all.joints[chain] = joints(sample, chain);
  }
  return all;
}

KINECAL_INLINE detail::ObservationNumbers MountedSensor::measurements(
    const Observation& seen) const {
  detail::ObservationNumbers all;
  all.joints.resize(chains_.size());
  try {
    all.settings = sensor_->settings(seen);
    for (const Feature& feature : seen.features) {
      all.chain.push_back(chain_to(feature.frame));
      add_feature(feature, all);
    }
  } catch (const SettingsError& e) {
    throw SampleError("sensor '" + mount_.name + "': " + e.what());
  }
  add_sigmas(seen, all);
  detail::replace_unusable(all);
  return all;
}

KINECAL_INLINE void MountedSensor::add_chain(const Robot& robot, const RuntimeChain& chain,
                                             const ParameterTable& table) {
  chain_by_frame_.emplace(plain_frame(chain.tip), chains_.size());
  chains_.emplace_back(robot, chain, table, lag_);
}

KINECAL_INLINE void MountedSensor::add_feature(const Feature& feature,
                                               detail::ObservationNumbers& all) const {
  bool usable = feature.point.allFinite();
  Matrix3<double> rotation = Matrix3<double>::Identity();
  if (sensor_->is_oriented()) {
    if (!feature.rotation) throw SettingsError("a feature has no orientation");
    usable = usable && feature.rotation->allFinite();
    rotation = *feature.rotation;
  }
  const Vector3<double> point =
      usable ? sensor_->measurement(feature.point, all.settings) : feature.point;
  all.usable.push_back(usable ? 1.0 : 0.0);
  all.measured.insert(all.measured.end(), point.begin(), point.end());
  if (sensor_->is_oriented()) {
    all.measured.insert(all.measured.end(), rotation.data(), rotation.data() + rotation.size());
  }
}

KINECAL_INLINE void MountedSensor::add_sigmas(const Observation& seen,
                                              detail::ObservationNumbers& all) const {
  const auto& features = seen.features;
  const auto has_one = [](const Feature& feature) { return feature.sigma.has_value(); };
  if (std::none_of(features.begin(), features.end(), has_one)) return;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const double sigma = features[i].sigma.value_or(0.0), variance = sigma * sigma;
    if (features[i].sigma && !(sigma > 0.0 && std::isnormal(variance))) {
      std::ostringstream message;
      const FeatureLabel label{static_cast<int>(i), features[i].id};
      message << "sensor '" << mount_.name << "': the sigma of " << label.text()
              << " must be positive and finite, is " << sigma;
      throw SampleError(message.str());
    }
    all.variance.push_back(variance);
  }
}

KINECAL_INLINE std::size_t MountedSensor::chain_to(const std::string& frame) const {
  if (frame.empty()) return 0;  // a header without frame_id: the sensor's own frame
  const auto it = chain_by_frame_.find(std::string(plain_frame(frame)));
  const bool own = sensor_->in_own_frame();
  if (it != chain_by_frame_.end() && !(own && it->second != 0)) return it->second;
  std::vector<std::string> known;
  for (const auto& [name, chain] : chain_by_frame_) known.push_back(name);
  throw SampleError(
      "sensor '" + mount_.name + "': a feature is in frame '" + frame +
      "', which is not the sensor's frame '" + mount_.frame + "'" +
      (own ? "; correct the frame of the sensor's model, or the frame_id of the feature"
           : ", nor a free or fixed frame; declare it under fixed_frames, if its "
             "pose in '" +
                 mount_.frame +
                 "' is known, or free_frames; or correct "
                 "the frame_id of the feature") +
      did_you_mean(frame, known));
}

KINECAL_INLINE std::vector<double> MountedSensor::joints(const Sample& sample,
                                                         std::size_t c) const {
  const SampledChain& chain = chains_[c];
  const std::size_t effects = most_effects(chain.parameters());
  for (const ChainJoint& joint : chain.chain().joints) {
    const std::string& name = joint.drive.joint;
    if (!moves(joint.type) || sample.position(name)) continue;
    throw SampleError(
        detail::missing_text(sample, name, "; sensor '" + mount_.name + "' needs it"));
  }
  const ModelledMotions motions = chain.motions(sample, SampledChain::Unknown::refused);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < motions.measured.size(); ++i) {
    const JointState<double>& state = motions[i];
    numbers.push_back(turns(chain.chain().joints[i].type) ? state.cos : state.position);
    numbers.push_back(state.sin);
    numbers.insert(numbers.end(), motions.all_effects[i].begin(), motions.all_effects[i].end());
    numbers.insert(numbers.end(), effects - motions.all_effects[i].size(), 0.0);
  }
  return numbers;
}

}  // namespace kinecal
