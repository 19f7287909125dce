// The types of sensors and error blocks that a configuration can name.
//
// Built-in types are entries of the registry.  Your program may add its own before it reads a
// configuration (register.hpp); they then work like the others:
//
//   kinecal::register_sensor(DrawWire{});
//   kinecal::register_sensor(LensCamera<Division>{});  // `type: camera2d`, `lens: division`
//   kinecal::register_block<WireLength>({{"wire"}, {"model"}});
//
// Do not change the registry while other threads read configurations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// What a model says of a camera beside its type.
struct SensorOptions {
  ImageKind image = ImageKind::automatic;  ///< `image:`
  std::string lens = {};                   ///< `lens:`; empty: plumb_bob
};

/// A type of sensor in configurations.
struct SensorEntry {
  std::string type;                         ///< `type:` of a model
  std::shared_ptr<const AnySensor> sensor;  ///< what is known of it
  bool has_image = false;                   ///< `image:` says what its pixels are of
  std::vector<std::string> lenses = {};  ///< names that `lens:` may have; empty: it has no such key
  /// A sensor of this type.
  std::function<std::shared_ptr<const AnySensor>(const SensorOptions&)> make;
  /// Adds a sensor of this type to a problem.
  std::function<void(AnyProblem&, const Mount&, const SensorOptions&)> add;
};

namespace detail {

/// True for a sensor with a member `image`.
template <class M>
inline constexpr bool kHasImage = requires(M model) {
  { model.image } -> std::same_as<ImageKind&>;
};

/// The name of a sensor's lens, if it is a camera with one.
template <class M>
[[nodiscard]] std::vector<std::string> lenses_of() {
  if constexpr (requires { M::kLens; }) return {std::string(M::kLens)};
  return {};
}

/// @param add  takes a problem, a sensor and its mount
template <Sensor M, class Add>
[[nodiscard]] SensorEntry sensor_entry_of(const M& model, Add add) {
  const auto with = [model](ImageKind image) {
    M made = model;
    if constexpr (kHasImage<M>) made.image = image;
    return made;
  };
  return {std::string(M::kType),
          behind_interface(model),
          kHasImage<M>,
          lenses_of<M>(),
          [with](const SensorOptions& options) { return behind_interface(with(options.image)); },
          [with, add](AnyProblem& problem, const Mount& mount, const SensorOptions& options) {
            add(problem, with(options.image), mount);
          }};
}

}  // namespace detail

namespace detail {

/// Names of the conditions of the sample before that an error block takes.
template <ErrorBlock B>
[[nodiscard]] std::vector<std::string> conditions_before() {
  std::vector<std::string> names;
  for (const std::string_view name : kConditionsOfBlock<B>) {
    if (name.starts_with(kBefore)) names.emplace_back(name.substr(kBefore.size()));
  }
  return names;
}

}  // namespace detail

/// A sensor of an error block in configurations.
struct BlockSensorEntry {
  std::vector<std::string> keys;  ///< the usual one first: "model_a"; none: the robot's surface
  Quantity quantity = Quantity::point;  ///< the block's input from it
};

/// A type of error block in configurations.
struct BlockEntry {
  std::string type;                                     ///< `type:` of an error block
  std::string read_as;                                  ///< the type that this is an alias of
  std::string unit;                                     ///< of the residual
  std::vector<BlockSensorEntry> sensors;                ///< in the order of the block's arguments
  std::vector<std::pair<std::string, double>> numbers;  ///< keys and defaults; "scale" is a factor
                                                        ///< of the residual in every block
  bool has_param = false;                               ///< true if it has a key `param`: a prior
  /// Names of the conditions of the sample before that it takes: see set_before().
  std::vector<std::string> looks_before = {};
  bool is_upstream = false;  ///< from robot_calibration, whose files may have keys that we ignore
  /// The block's own parameters.
  /// @throws std::exception  if the numbers of the block are impossible
  std::function<std::vector<ParameterInfo>(const BlockConfig&)> parameters;
  /// Adds a block of this type to a problem.
  /// @throws std::exception  if its numbers are impossible or its sensors do not match
  std::function<void(AnyProblem&, const BlockConfig&, const TermOptions&)> add;
};

/// The types of sensors and error blocks, in the order in which they were added.
class Registry {
 public:
  /// The built-in types.
  Registry();

  /// Adds a type; a camera with a lens of a new name, to the type that it has.
  /// @throws std::invalid_argument  if the name is taken
  /// @{
  void add(SensorEntry entry);
  void add(BlockEntry entry);
  /// @}

  /// The type of this name; nullptr if absent.
  /// @{
  [[nodiscard]] const SensorEntry* sensor(const std::string& type) const;
  [[nodiscard]] const BlockEntry* block(const std::string& type) const;
  /// @}
  [[nodiscard]] const std::vector<SensorEntry>& sensors() const { return sensors_; }  ///< all
  [[nodiscard]] const std::vector<BlockEntry>& blocks() const { return blocks_; }     ///< all

 private:
  std::vector<SensorEntry> sensors_;
  std::vector<BlockEntry> blocks_;
};

/// The registry of this program.
[[nodiscard]] Registry& registry();

/// The type of a model or error block: its own, or that of the registry; nullptr if absent.
/// @{
[[nodiscard]] const SensorEntry* entry_of(const ModelConfig& model);
[[nodiscard]] const BlockEntry* entry_of(const BlockConfig& block);
/// @}

}  // namespace kinecal
