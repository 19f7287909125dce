// A sensor of any type behind one interface, for those who do not know its type: problems, readers
// of configurations, reports.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// What is known of a sensor without its type.
class AnySensor {
 public:
  virtual ~AnySensor() = default;

  /// Its name in configurations: "camera3d".
  [[nodiscard]] virtual std::string_view type() const = 0;
  /// Its own parameters.
  [[nodiscard]] virtual std::span<const ParameterInfo> parameters() const = 0;
  /// True if it can deliver what a block takes.
  [[nodiscard]] virtual bool delivers(Quantity quantity) const = 0;
  /// True if its features are in its own frame, never in a virtual one.
  [[nodiscard]] virtual bool in_own_frame() const = 0;
  /// True if its features have an orientation.
  [[nodiscard]] virtual bool is_oriented() const = 0;
  /// The settings that come with an observation.
  /// @throws SettingsError
  [[nodiscard]] virtual std::vector<double> settings(const Observation& seen) const = 0;
  /// Values of its parameters before the first step.
  /// @param settings  of the first observation; empty if there is none
  [[nodiscard]] virtual std::vector<double> initial(std::span<const double> settings) const = 0;
  /// What of a recorded point to keep.
  /// @throws SettingsError
  [[nodiscard]] virtual Vector3<double> measurement(const Vector3<double>& point,
                                                    std::span<const double> settings) const = 0;
  /// The point of a measurement with initial parameters, metres, in the sensor's frame; the
  /// measurement itself for a sensor that does not deliver points.
  [[nodiscard]] virtual Vector3<double> point(const Vector3<double>& measured,
                                              std::span<const double> settings) const = 0;
};

namespace detail {

template <std::size_t N>
[[nodiscard]] std::array<double, N> array_of(std::span<const double> numbers) {
  std::array<double, N> all{};
  std::copy_n(numbers.begin(), std::min(N, numbers.size()), all.begin());
  return all;
}

/// A sensor of type M as an AnySensor.
template <Sensor M>
class SensorOfType final : public AnySensor {
 public:
  explicit SensorOfType(M model) : model_(std::move(model)) {}

  [[nodiscard]] std::string_view type() const override { return M::kType; }
  [[nodiscard]] std::span<const ParameterInfo> parameters() const override {
    if constexpr (kParametersOf < M >> 0) return M::kParameters;
    return {};
  }
  [[nodiscard]] bool delivers(Quantity quantity) const override {
    return kinecal::delivers<M>(quantity);
  }
  [[nodiscard]] bool in_own_frame() const override { return kIsInOwnFrame<M>; }
  [[nodiscard]] bool is_oriented() const override { return kIsOriented<M>; }
  [[nodiscard]] std::vector<double> settings(const Observation& seen) const override {
    if constexpr (kSettingsOf < M >> 0) {
      const auto all = model_.settings(seen);
      return {all.begin(), all.end()};
    }
    return {};
  }
  [[nodiscard]] std::vector<double> initial(std::span<const double> settings) const override {
    if constexpr (requires { model_.initial(array_of<kSettingsOf<M>>(settings)); }) {
      if (!settings.empty()) {
        const auto all = model_.initial(array_of<kSettingsOf<M>>(settings));
        return {all.begin(), all.end()};
      }
    }
    std::vector<double> all;
    for (const ParameterInfo& info : parameters()) all.push_back(info.initial);
    return all;
  }
  [[nodiscard]] Vector3<double> measurement(const Vector3<double>& point,
                                            std::span<const double> settings) const override {
    if constexpr (requires { model_.measurement(point, array_of<kSettingsOf<M>>(settings)); }) {
      return model_.measurement(point, array_of<kSettingsOf<M>>(settings));
    }
    return point;
  }
  [[nodiscard]] Vector3<double> point(const Vector3<double>& measured,
                                      std::span<const double> settings) const override {
    if constexpr (PlacesOne<M, Quantity::point>) {
      Measurement<M, double> m{.point = measured, .settings = array_of<kSettingsOf<M>>(settings)};
      const std::vector<double> values = initial(settings);
      return model_.place(m, array_of<kParametersOf<M>>(values));
    }
    return measured;
  }

 private:
  M model_;
};

}  // namespace detail

/// A sensor behind the common interface.
template <Sensor M>
[[nodiscard]] std::shared_ptr<const AnySensor> any_sensor(M model) {
  return std::make_shared<detail::SensorOfType<M>>(std::move(model));
}

/// Adds the parameters of a sensor that a table does not have yet.
/// @param samples  the first observation of the sensor gives their initial values: a camera starts
///                 from the settings that its driver had while recording
void add_sensor_parameters(ParameterTable& table, const AnySensor& sensor, const Mount& mount,
                           std::span<const Sample> samples);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/sensors/any_sensor.ipp"
#endif
