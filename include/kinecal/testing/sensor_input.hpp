// The input of a sensor as numbers: measurement and parameters; recorded, moved, in packets, in
// jets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/testing/comparison.hpp"
#include "kinecal/testing/random_input.hpp"

namespace kinecal::detail {

/// Input of a sensor: a measurement and its parameters; a point for a camera to see; a pose.
template <Sensor M, class S>
struct SensorInput {
  using Vectors = VectorsOf<placed_quantity<M>().value_or(Quantity::point)>;
  static constexpr int kOwn = static_cast<int>(kParametersOf<M>);
  static constexpr int kPlaced = 3 * static_cast<int>(Vectors::kValues);
  static constexpr bool kGivesDerivatives = requires { typename M::template Corrected<S>; };
  using Own = std::array<S, kParametersOf<M>>;
  using Given = Differentiated<S, 3, kOwn>;

  Measurement<M, S> measurement;
  Own own = {};                      ///< values of the parameters
  Feature feature = {};              ///< as recorded
  std::vector<double> initial = {};  ///< values of the parameters
  Vector3<S> point;                  ///< (3) metres, in front of the sensor
  Pose<S> pose;                      ///< of the sensor in the base

  /// One for each feature.
  [[nodiscard]] static std::vector<SensorInput> of(const M& sensor,
                                                   std::span<const Observation> observations) {
    const SensorOfType<M> any(sensor);
    RandomInput random;
    std::vector<SensorInput> all;
    for (const Observation& seen : observations) {
      const std::vector<double> settings = any.settings(seen);
      for (const Feature& feature : seen.features) {
        SensorInput& input = all.emplace_back();
        input.feature = feature;
        input.initial = any.initial(settings);
        input.measurement.point = any.measurement(feature.point, settings);
        input.measurement.rotation = feature.rotation.value_or(Matrix3<double>::Identity());
        input.measurement.settings = array_of<kSettingsOf<M>>(settings);
        for (std::size_t k = 0; k < kParametersOf<M>; ++k) {
          const ParameterInfo& info = any.parameters()[k];
          input.own[k] = std::clamp(input.initial[k] + random(-0.05, 0.05), info.lower, info.upper);
        }
        const double z = random(0.5, 2.0);
        input.point = {random(-0.4, 0.4) * z, random(-0.4, 0.4) * z, z};
        input.pose = random.pose();
      }
    }
    return all;
  }
  /// One input per lane: from `first` on, wrapping around.
  [[nodiscard]] static SensorInput packed(std::span<const SensorInput<M, double>> inputs,
                                          std::size_t first) {
    SensorInput all;
    for (int i = 0; i < kLanes<S>; ++i) {
      const auto& in_lane = inputs[(first + static_cast<std::size_t>(i)) % inputs.size()];
      const auto set = [&](S* to, const double* from, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) set_lane(to[n], i, from[n]);
      };
      const auto& m = in_lane.measurement;
      set(all.measurement.point.data(), m.point.data(), 3);
      set(all.measurement.rotation.data(), m.rotation.data(), 9);
      set(all.measurement.settings.data(), m.settings.data(), m.settings.size());
      set(all.own.data(), in_lane.own.data(), in_lane.own.size());
      set(all.point.data(), in_lane.point.data(), 3);
      set(all.pose.rotation.data(), in_lane.pose.rotation.data(), 9);
      set(all.pose.translation.data(), in_lane.pose.translation.data(), 3);
    }
    return all;
  }
  /// The input with parameter k moved by a step; -3, -2, -1 are x, y, z of the point.
  [[nodiscard]] SensorInput moved(int k, double step) const {
    SensorInput input = *this;
    (k < 0 ? input.point(k + 3) : input.own[static_cast<std::size_t>(k)]) += step;
    return input;
  }
  /// Feature, point and parameters.
  [[nodiscard]] std::string text() const {
    const Eigen::MatrixXd recorded = feature.point.transpose(), seen = point.transpose(),
                          parameters = Eigen::Map<const Eigen::RowVectorXd>(own.data(), kOwn);
    return Named{"recorded", recorded}.text() +
           (PredictingSensor<M> ? Named{"point of predict()", seen}.text() : "") +
           (kOwn > 0 ? Named{"parameters", parameters}.text() : "");
  }

  /// All numbers that place() delivers, in the sensor's frame.
  [[nodiscard]] Eigen::Matrix<S, kPlaced, 1> placed(const M& sensor) const {
    return numbers(sensor.place(measurement, own));
  }
  /// The same with derivatives by the parameters, from jets.
  [[nodiscard]] Differentiated<S, kPlaced, kOwn> placed_jets(const M& sensor) const {
    if constexpr (kOwn == 0) {
      Differentiated<S, kPlaced, 0> same;
      same.value = placed(sensor);
      return same;
    } else {
      return Differentiated<S, kPlaced, kOwn>(
          numbers(sensor.place(measurement, jets<Jet<S, kOwn>>(0))));
    }
  }
  /// The camera's pixel of the point.
  [[nodiscard]] Eigen::Matrix<S, 2, 1> pixel(const M& sensor) const {
    return sensor.predict(point, measurement.settings, own);
  }
  /// The same with derivatives by the point and the parameters, from jets.
  [[nodiscard]] Differentiated<S, 2, 3 + kOwn> pixel_jets(const M& sensor) const {
    using J = Jet<S, 3 + kOwn>;
    const Eigen::Matrix<J, 2, 1> seen =
        sensor.predict(point_jets<J>(point, 0), measurement.settings, jets<J>(3));
    return Differentiated<S, 2, 3 + kOwn>(seen);
  }
  /// The result of Corrected: a point in the base and its derivatives by all parameters, or by all
  /// but one, whose column is zero.
  [[nodiscard]] Given corrected(int left_out = -1) const {
    std::array<double, kParametersOf<M>> parameters;
    std::vector<int> chosen;
    for (int k = 0; k < kOwn; ++k) {
      parameters[static_cast<std::size_t>(k)] = lane(own[static_cast<std::size_t>(k)], 0);
      if (k != left_out) chosen.push_back(k);
    }
    const typename M::template Corrected<S> model(pose, measurement.settings, parameters);
    std::array<Vector3<S>, kParametersOf<M>> changes;
    Given given;
    given.value = model.place(measurement.point, chosen, changes.data());
    given.derivatives.setZero();
    for (std::size_t n = 0; n < chosen.size(); ++n) given.derivatives.col(chosen[n]) = changes[n];
    return given;
  }
  /// The point of place() in the base, with derivatives by the parameters, from jets.
  [[nodiscard]] Given placed_in_base(const M& sensor) const {
    Given placed = placed_jets(sensor);
    placed.value = pose * Vector3<S>(placed.value);
    placed.derivatives = pose.rotation * placed.derivatives;
    return placed;
  }
  /// The recorded point or pose, and the result of place() with the initial parameters.
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> recorded_and_placed(
      const M& sensor) const {
    const auto again = sensor.place(measurement, array_of<kParametersOf<M>>(initial));
    if constexpr (PlacesOne<M, Quantity::pose>) {
      return {numbers(Pose<S>{measurement.rotation, feature.point}), numbers(again)};
    } else {
      return {feature.point, again};
    }
  }

 private:
  template <class J>
  [[nodiscard]] std::array<J, kParametersOf<M>> jets(int first) const {
    std::array<J, kParametersOf<M>> variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      variables[i] = J(own[i], first + static_cast<int>(i));
    }
    return variables;
  }
  template <class Placed>
  [[nodiscard]] static auto numbers(const Placed& placed) {
    using T = std::decay_t<decltype(scalar_of(placed))>;
    std::array<Vector3<T>, Vectors::kValues> vectors;
    Vectors::to_base(Pose<T>{}, placed, vectors.data());
    Eigen::Matrix<T, kPlaced, 1> all;
    for (int i = 0; i < kPlaced; ++i) all(i) = vectors[static_cast<std::size_t>(i / 3)](i % 3);
    return all;
  }
  template <template <class> class Placed, class T>
  static T scalar_of(const Placed<T>&);
  template <class T>
  static T scalar_of(const Vector3<T>&);
};

}  // namespace kinecal::detail
