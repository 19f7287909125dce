// Adds your own types of sensors and error blocks to the registry.
//
// They are compiled here, in packets for your program's flags.  So link kinecal's static libraries,
// not those for several instruction sets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/config/registry.hpp"
#include "kinecal/evaluation/problem.hpp"

namespace kinecal {

/// The numbers of an error block in a configuration, by key.
using BlockNumbers = std::map<std::string, double>;

namespace detail {

/// @throws std::invalid_argument  if a library with other flags evaluates the problem
[[nodiscard]] inline Problem& problem_of_program(AnyProblem& problem) {
  if (auto* own = dynamic_cast<Problem*>(&problem)) return *own;
  throw std::invalid_argument("the problem is evaluated for another instruction set");
}

}  // namespace detail

/// Adds a type of sensor: configurations name it M::kType, and the lens of a LensCamera in `lens:`.
/// @throws std::invalid_argument  if the name is taken
template <class M>
void register_sensor(const M& model) {
  [[maybe_unused]] const detail::CheckSensorType<M> check_of_type{};
  if constexpr (Sensor<M>) {
    registry().add(detail::sensor_entry_of(
        model, [](AnyProblem& problem, const M& sensor, const Mount& mount) {
          detail::problem_of_program(problem).add_sensor(sensor, mount);
        }));
  }
}

/// Adds a type of error block: configurations name it B::kType.
/// @param keys     of each sensor, in the order of the block's arguments: {{"model_a"},
///                 {"model_b"}}
/// @param numbers  keys of its numbers and their defaults
/// @param make     makes the block from its numbers; may throw std::invalid_argument
/// @throws std::invalid_argument  if the name is taken, or there is not one entry of keys per
///                                sensor
template <ErrorBlock B>
void register_block(
    const std::vector<std::vector<std::string>>& keys,
    std::vector<std::pair<std::string, double>> numbers = {},
    std::function<B(const BlockNumbers&)> make = [](const BlockNumbers&) { return B{}; }) {
  if (keys.size() != kQuantities<B>.size()) {
    throw std::invalid_argument(std::string(B::kType) + ": keys of " + std::to_string(keys.size()) +
                                " sensors for a block of " + std::to_string(kQuantities<B>.size()));
  }
  BlockEntry entry;
  entry.type = entry.read_as = B::kType;
  entry.unit = "1";
  if constexpr (requires { B::kUnit; }) entry.unit = B::kUnit;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    entry.sensors.push_back({keys[i], kQuantities<B>[i]});
  }
  entry.looks_before = detail::conditions_before<B>();
  entry.numbers = std::move(numbers);
  entry.parameters = [make](const BlockConfig& config) {
    const auto infos = parameters_of(make(config.numbers));
    return std::vector<ParameterInfo>(infos.begin(), infos.end());
  };
  entry.add = [make](AnyProblem& problem, const BlockConfig& config, const TermOptions& options) {
    detail::problem_of_program(problem).add_block(config.name, make(config.numbers), config.models,
                                                  options);
  };
  registry().add(std::move(entry));
}

}  // namespace kinecal
