// The common interface of all sensors, for code that does not know their types: problems, readers
// of configurations, reports.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// A sensor of unknown type.
class AnySensor {
 public:
  virtual ~AnySensor() = default;

  /// Its name in configurations: "camera3d".
  [[nodiscard]] virtual std::string_view type() const = 0;
  /// Its own parameters.
  [[nodiscard]] virtual std::span<const ParameterInfo> parameters() const = 0;
  /// True if it can deliver this quantity, as a block asks for it.
  [[nodiscard]] virtual bool delivers(Quantity quantity) const = 0;
  /// True if its features are in its own frame, never in a virtual one.
  [[nodiscard]] virtual bool in_own_frame() const = 0;
  /// True if its features have an orientation.
  [[nodiscard]] virtual bool is_oriented() const = 0;
  /// The settings of an observation.
  /// @throws SettingsError
  [[nodiscard]] virtual std::vector<double> settings(const Observation& seen) const = 0;
  /// Values of its parameters before the first step.
  /// @param settings  of the first observation; empty if absent
  [[nodiscard]] virtual std::vector<double> initial(std::span<const double> settings) const = 0;
  /// The part of a recorded point to keep.
  /// @throws SettingsError
  [[nodiscard]] virtual Vector3<double> measurement(const Vector3<double>& point,
                                                    std::span<const double> settings) const = 0;
  /// What it places in its frame: points, rays, poses or readings; nullopt if it only predicts.
  [[nodiscard]] virtual std::optional<Quantity> places() const = 0;
  /// A measurement as a point of the sensor's frame, metres, or as the direction of a ray; the measurement
  /// itself for a sensor of poses or readings.
  /// @param own  its parameters, in their order; empty: as initial()
  [[nodiscard]] virtual Vector3<double> place(const Vector3<double>& measured,
                                              std::span<const double> settings,
                                              std::span<const double> own = {}) const = 0;
  /// The pixel at which a camera sees a point of its frame; NaN if it does not see the point, or does
  /// not predict.
  /// @param p    (3) metres
  /// @param own  as above
  [[nodiscard]] virtual Eigen::Vector2d predict(const Vector3<double>& p,
                                                std::span<const double> settings,
                                                std::span<const double> own = {}) const = 0;
  /// True for a camera: it gives a calibrated camera_info, and its settings begin with fx fy cx cy, pixels.
  [[nodiscard]] virtual bool is_camera() const = 0;
  /// The camera_info of a camera with its parameters applied; of another sensor as it was.
  /// @param own  its parameters, in their order
  [[nodiscard]] virtual CameraInfo calibrated(const CameraInfo& info,
                                              std::span<const double> own) const = 0;
};

/// True for a camera that measures points: depth.
[[nodiscard]] inline bool measures_depth(const AnySensor& sensor) {
  return sensor.is_camera() && sensor.delivers(Quantity::point);
}

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
    if constexpr (kParametersOf<M> != 0) return M::kParameters;
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
  [[nodiscard]] std::optional<Quantity> places() const override { return placed_quantity<M>(); }
  [[nodiscard]] Vector3<double> place(const Vector3<double>& measured,
                                      std::span<const double> settings,
                                      std::span<const double> own) const override {
    [[maybe_unused]] const Measurement<M, double> m{.point = measured,
                                                    .settings = array_of<kSettingsOf<M>>(settings)};
    if constexpr (PlacesOne<M, Quantity::point>) return model_.place(m, values(settings, own));
    if constexpr (PlacesOne<M, Quantity::ray>)
      return model_.place(m, values(settings, own)).direction;
    return measured;
  }
  [[nodiscard]] Eigen::Vector2d predict(const Vector3<double>& p, std::span<const double> settings,
                                        std::span<const double> own) const override {
    bool seen = PredictingSensor<M>;
    if constexpr (HasFieldOfView<M>) seen = model_.sees(p);
    if constexpr (PredictingSensor<M>) {
      if (seen) return model_.predict(p, array_of<kSettingsOf<M>>(settings), values(settings, own));
    }
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  [[nodiscard]] bool is_camera() const override { return kIsCamera; }
  [[nodiscard]] CameraInfo calibrated(const CameraInfo& info,
                                      std::span<const double> own) const override {
    if constexpr (kIsCamera) return model_.calibrated(info, array_of<kParametersOf<M>>(own));
    return info;
  }

 private:
  static constexpr bool kIsCamera = requires(const M& model, const CameraInfo& info,
                                             const std::array<double, kParametersOf<M>>& own) {
    { model.calibrated(info, own) } -> std::same_as<CameraInfo>;
  };

  [[nodiscard]] std::array<double, kParametersOf<M>> values(std::span<const double> settings,
                                                            std::span<const double> own) const {
    if (!own.empty()) return array_of<kParametersOf<M>>(own);
    return array_of<kParametersOf<M>>(initial(settings));
  }

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
