// The sensor of a model of a configuration: its type, image and lens, its place and its names.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/config/registry.hpp"

namespace kinecal::detail {

/// The type of a model.  An unknown type counts as camera3d: it has the most parameters, so their
/// names are not reported as well.
[[nodiscard]] const SensorEntry& sensor_entry(const ModelConfig& model);
/// What a model says of its camera.
[[nodiscard]] SensorOptions options_of(const ModelConfig& model);
/// A coefficient of a camera2d's lens that some step frees; empty if none is.
[[nodiscard]] std::string free_coefficient(const Config& config, const ModelConfig& camera);
/// The sensor of a model.
[[nodiscard]] std::shared_ptr<const AnySensor> sensor_of(const ModelConfig& model);

/// Where the sensor of a model is mounted, and its names.
[[nodiscard]] Mount mount_from(const ModelConfig& model);
/// Name of the lag of a model's sensor behind the positions of the joints.
[[nodiscard]] std::string lag_name(const ModelConfig& model);

}  // namespace kinecal::detail
