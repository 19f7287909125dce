// A crate as a configuration: what finds mistakes by changing a configuration serves crates, too.
//
// Error blocks and sensors of your own keep their types: a Config can hold them (BlockConfig::own).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "kinecal/config/config.hpp"
#include "kinecal/config/loss_names.hpp"
#include "kinecal/config/register.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/crate/crate.hpp"

namespace kinecal {

namespace detail {

/// The numbers of an error block's type at their defaults, with its scale; empty for an unknown type.
[[nodiscard]] std::map<std::string, double> default_numbers(const std::string& type, double scale);
/// Gives each block that compares a camera with the surface of the robot the links of its sensor.
void add_surfaces(StepConfig& step);
/// Takes it from those whose samples say what belongs together.
void keep_associations(std::span<const Sample> samples, Config& config);
/// The free axes of a frame, and initial values that are not zero.
void add_free(const std::string& name, const std::string& frame, StepConfig& step);
/// The values at which parameters begin, where they are not zero.
void add_initial_values(const ParameterTable& table, StepConfig& step);

/// The model of a crate's sensor.
template <SensorPart P>
[[nodiscard]] ModelConfig model_config() {
  using M = typename P::Model;
  const Mount mount = P::mount();
  ModelConfig model{mount.name, std::string(M::kType), mount.frame, mount.param_name, {}};
  model.links = mount.links;
  if constexpr (requires { M::kLens; }) model.lens = M::kLens;
  if constexpr (!std::constructible_from<BuiltInSensor, M>) {
    model.own = std::make_shared<SensorEntry>(
        sensor_entry_of(M{}, [](AnyProblem& problem, const M& sensor, const Mount& at) {
          problem_of_program(problem).add_sensor(sensor, at);
        }));
  }
  return model;
}

/// The type of an error block of a crate, with the numbers that it has there.
template <ErrorBlock B>
[[nodiscard]] BlockEntry entry_of_block(const B& block, const std::string& type) {
  const BlockEntry* known = registry().block(type);
  BlockEntry entry;
  entry.type = entry.read_as = type;
  if (known != nullptr) entry = *known;
  if constexpr (requires { B::kUnit; }) entry.unit = B::kUnit;
  for (std::size_t i = entry.sensors.size(); i < kQuantities<B>.size(); ++i) {
    entry.sensors.push_back({{"model_" + std::to_string(i + 1)}, kQuantities<B>[i]});
  }
  entry.parameters = [block](const BlockConfig&) {
    const auto infos = parameters_of(block);
    return std::vector<ParameterInfo>(infos.begin(), infos.end());
  };
  entry.add = [block](AnyProblem& problem, const BlockConfig& config, const TermOptions& options) {
    if constexpr (std::constructible_from<BuiltInBlock, B>) {
      problem.add_built_in(config.name, block, config.models, options);
    } else {
      problem_of_program(problem).add_block(config.name, block, config.models, options);
    }
  };
  return entry;
}

/// What a crate's block or prior says of its weight, loss and samples.
template <class P>
[[nodiscard]] BlockConfig block_config(const P& part, const std::string& type) {
  BlockConfig block;
  block.name = P::kName;
  block.type = type;
  block.exclusive = part.options.exclusive;
  block.ground = part.options.beside;
  block.sigma = part.options.sigma;
  block.loss = {loss_name(part.options.loss.type), part.options.loss.scale};
  block.numbers = default_numbers(type, part.options.scale);
  return block;
}

template <BlockPart P>
[[nodiscard]] BlockConfig config_of_part(const P& part) {
  using B = typename P::Error;
  std::string type = part.options.type;
  if constexpr (requires { B::kType; }) {
    if (type.empty()) type = B::kType;
  }
  if (type.empty()) type = P::kName;
  BlockConfig block = block_config(part, type);
  block.models.assign(P::kSensorNames.begin(), P::kSensorNames.end());
  block.numbers["scale"] = part.options.scale;
  block.own = std::make_shared<BlockEntry>(entry_of_block(part.error, type));
  return block;
}

template <PriorPart P>
[[nodiscard]] BlockConfig config_of_part(const P& part) {
  BlockConfig block = block_config(part, "outrageous");
  block.param = P::kOf;
  block.numbers["joint_scale"] = part.joint_scale;
  block.numbers["position_scale"] = part.position_scale;
  block.numbers["rotation_scale"] = part.rotation_scale;
  for (std::size_t i = 0; i < part.mean.size(); ++i) block.numbers[kPriorMeans[i]] = part.mean[i];
  return block;
}

}  // namespace detail

/// The configuration of the calibration that a crate describes.
/// @param table  its parameters with initial values and bounds
template <class... Parts>
[[nodiscard]] Config config_of(const Crate<Parts...>& crate, const ParameterTable& table) {
  using C = Crate<Parts...>;
  Config config;
  config.base_link = C::base();
  config.place = {"the crate", 0};
  StepConfig step;
  step.name = "calibration";
  step.place = config.place;
  C::Sensors::for_each(
      [&]<class P>(std::type_identity<P>) { step.models.push_back(detail::model_config<P>()); });
  C::Parameters::for_each([&]<class P>(std::type_identity<P>) {
    for (const ParameterId& id : P::kIds) {
      detail::add_free(id.name(), is_frame(P::kKind) ? std::string(P::kOwner) : "", step);
    }
  });
  C::Blocks::for_each([&]<class P>(std::type_identity<P>) {
    step.error_blocks.push_back(detail::config_of_part(crate.template part<P>()));
  });
  C::Priors::for_each([&]<class P>(std::type_identity<P>) {
    step.error_blocks.push_back(detail::config_of_part(crate.template part<P>()));
  });
  detail::add_surfaces(step);
  detail::add_initial_values(table, step);
  config.steps.push_back(std::move(step));
  for (StepConfig& one : config.steps) {
    for (ModelConfig& model : one.models) model.place = config.place;
    for (BlockConfig& block : one.error_blocks) block.place = config.place;
  }
  return config;
}

}  // namespace kinecal
