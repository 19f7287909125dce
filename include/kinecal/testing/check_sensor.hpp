// Checks a sensor against the laws of CONCEPTS.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/sensor_checks.hpp"
#include "kinecal/testing/field_of_view.hpp"
#include "kinecal/testing/sensor_input.hpp"
#include "kinecal/testing/typical_observations.hpp"

namespace kinecal {

namespace detail {

/// The checks of a sensor.
template <Sensor M>
class SensorCheck {
  using Input = SensorInput<M, double>;
  using InPackets = SensorInput<M, Packet>;
  static constexpr int kOwn = Input::kOwn;

 public:
  explicit SensorCheck(const M& sensor) : sensor_(sensor) {}

  /// Checks what place() delivers.
  [[nodiscard]] Verdict places(std::span<const Input> inputs) const {
    const auto values = [](const auto& input, const M& m) { return input.placed(m); };
    const auto jets = [](const auto& input, const M& m) { return input.placed_jets(m); };
    for (const Input& input : inputs) {
      if (const Verdict v = is_recorded(input); !v) return v;
      if (const Verdict v = derivatives("place(): ", input, values, jets); !v) return v;
      if constexpr (Input::kGivesDerivatives) {
        if (const Verdict v = corrected(input); !v) return v;
      }
    }
    return packets("place(): ", inputs, values, jets);
  }
  /// Checks the pixels of predict(), and that rays lead back to the point.
  [[nodiscard]] Verdict predicts(std::span<const Input> inputs) const {
    const auto values = [](const auto& input, const M& m) { return input.pixel(m); };
    const auto jets = [](const auto& input, const M& m) { return input.pixel_jets(m); };
    for (const Input& input : inputs) {
      if (const Verdict v = derivatives("predict(): ", input, values, jets); !v) return v;
      if constexpr (PlacesOne<M, Quantity::ray>) {
        if (const Verdict v = ray_leads_back(input); !v) return v;
      }
    }
    if (const Verdict v = packets("predict(): ", inputs, values, jets); !v) return v;
    if (const Verdict v = check_field_of_view(whose("predict(): "), sensor_, inputs); !v) return v;
    const std::vector<Input> around = seen_around(sensor_, inputs);
    for (const Input& input : around) {
      if (const Verdict v = derivatives("predict(): ", input, values, jets, true); !v) return v;
      if constexpr (PlacesOne<M, Quantity::ray> && !HasFieldOfView<M>) {
        if (const Verdict v = ray_leads_back(input); !v) return v;
      }
    }
    return packets("predict(): ", around, values, jets);
  }

 private:
  [[nodiscard]] std::string whose(const std::string& function) const {
    return "sensor '" + std::string(M::kType) + "', " + function;
  }

  /// Checks that place() with the initial parameters gives the recorded value.
  [[nodiscard]] Verdict is_recorded(const Input& input) const {
    if constexpr (PlacesOne<M, Quantity::point> || PlacesOne<M, Quantity::pose>) {
      const auto [recorded, again] = input.recorded_and_placed(sensor_);
      return compare(whose("place(): with the initial parameters it is not what was recorded"),
                     {"recorded", recorded}, {"placed", again}, 1e-9 * (1.0 + largest(recorded)));
    }
    return kLawsHold;
  }
  /// @param smooth  where steps of two sizes disagree, the function bends too much to be checked
  template <class Values, class Jets>
  [[nodiscard]] Verdict derivatives(const std::string& function, const Input& input,
                                    const Values& values, const Jets& jets,
                                    bool smooth = false) const {
    const auto by_jets = jets(input, sensor_);
    using AsJets = std::decay_t<decltype(by_jets)>;
    const Eigen::MatrixXd value = values(input, sensor_), said = by_jets.derivatives;
    if (!value.allFinite()) return {whose(function + "it is not a number") + input.text()};
    if (!said.allFinite()) {
      return {whose(function + "a derivative is not a number, though the value is one") +
              Named{"by jets", said}.text() + input.text()};
    }
    const auto at = [&](int k, double step) -> Eigen::MatrixXd {
      return values(input.moved(k + kOwn - AsJets::kN, step), sensor_);
    };
    const auto twice = [&](int k, double step) { return Eigen::MatrixXd(at(k, 2.0 * step) / 2.0); };
    const Eigen::MatrixXd found = central_differences<AsJets::kM, AsJets::kN>(at);
    const Verdict v =
        compare_derivatives(whose(function), {"by jets", said}, found, largest(value));
    if (!v && smooth) {
      const Eigen::MatrixXd other = central_differences<AsJets::kM, AsJets::kN>(twice);
      if (!compare_derivatives("", {"", other}, found, largest(value))) return kLawsHold;
    }
    return v ? v : Verdict{v.text + input.text()};
  }
  template <class Values, class Jets>
  [[nodiscard]] Verdict packets(const std::string& function, std::span<const Input> inputs,
                                const Values& values, const Jets& jets) const {
    for (std::size_t first = 0; first < inputs.size(); first += kLanes<Packet>) {
      const InPackets packed = InPackets::packed(inputs, first);
      const auto by_jets = jets(packed, sensor_);
      const auto plain = values(packed, sensor_);
      for (int i = 0; i < kLanes<Packet>; ++i) {
        const Input& input = inputs[(first + static_cast<std::size_t>(i)) % inputs.size()];
        const Verdict v = jets(input, sensor_).is_lane_of(i, whose(function), by_jets, plain);
        if (!v) return {v.text + input.text()};
      }
    }
    return kLawsHold;
  }
  /// Compares the derivatives that a sensor supplies with its values and with place().
  [[nodiscard]] Verdict corrected(const Input& input) const {
    const auto given = input.corrected(), placed = input.placed_in_base(sensor_);
    const Eigen::MatrixXd value = given.value, said = given.derivatives, of_place = placed.value,
                          by_jets = placed.derivatives;
    const double rounding = kOfRounding * (1.0 + largest(of_place) + largest(by_jets));
    Verdict v = compare(whose("Corrected: values differ from those of place()"),
                        {"Corrected", value}, {"place()", of_place}, rounding);
    if (v) {
      const auto at = [&](int k, double step) { return input.moved(k, step).corrected().value; };
      v = compare_derivatives(whose("Corrected: "), {"given", said},
                              central_differences<3, kOwn>(at), largest(value));
    }
    if (v) {
      v = compare(whose("Corrected: derivatives differ from those of place()"), {"given", said},
                  {"place() by jets", by_jets}, rounding);
    }
    for (int k = 0; k < kOwn && v; ++k) {
      Eigen::MatrixXd others = said;
      others.col(k).setZero();
      const Eigen::MatrixXd found = input.corrected(k).derivatives;
      v = compare(whose("Corrected: derivatives by some parameters differ from those by all"),
                  {"without parameter " + std::to_string(k), found}, {"by all", others}, rounding);
    }
    if (v) v = corrected_in_packets(input, given);
    return v ? v : Verdict{v.text + input.text()};
  }
  /// The same input in all lanes: Corrected uses one set of parameters for all samples.
  [[nodiscard]] Verdict corrected_in_packets(const Input& input,
                                             const typename Input::Given& given) const {
    const InPackets packed = InPackets::packed(std::span(&input, 1), 0);
    const auto packets = packed.corrected();
    for (int i = 0; i < kLanes<Packet>; ++i) {
      const Verdict v = given.is_lane_of(i, whose("Corrected: "), packets, packets.value);
      if (!v) return v;
    }
    return kLawsHold;
  }
  /// Checks that the ray to the pixel of a point passes through the point.
  [[nodiscard]] Verdict ray_leads_back(const Input& input) const {
    Input seen = input;
    const Eigen::Vector2d pixel = input.pixel(sensor_);
    seen.measurement.point = {pixel.x(), pixel.y(), 0.0};
    const auto ray = sensor_.place(seen.measurement, seen.own);
    const Vector3<double> way = input.point - ray.origin, d = ray.direction;
    const Eigen::MatrixXd nearest = ray.origin + d * (way.dot(d) / d.squaredNorm()),
                          point = input.point;
    const Verdict v =
        compare(whose("place(): the ray to the pixel of predict() does not go through the point"),
                {"point", point}, {"nearest point of the ray", nearest}, 1e-6 * way.norm());
    return v ? v : Verdict{v.text + input.text()};
  }

  const M& sensor_;
};

}  // namespace detail

/// Checks a sensor:
///
/// - Derivatives of place() by parameters, and of predict() by point and parameters, equal central
///   differences (1e-6 of the largest derivative or value).  The same holds for Corrected, if it
///   has one, and its values equal those of place().
/// - Each lane of a packet equals the result in double (1e-10), with all derivatives.
/// - place() with the initial parameters gives the recorded point or pose (1e-9).
/// - The ray to the pixel that predict() gives passes through the point (1e-6 of its distance).
/// - predict() is checked all around the camera where the camera sees the point, and on its axis.  Where it does
///   not, sees() is false or the pixel is not a number: a point and the opposite one have different pixels.
///
/// Parameters are within 0.05 of their initial values.
/// @param seen  recorded observations.  Default: two with 16 features each: points 0.5 to 2 m in
///              front of the sensor, pixels, readings of 0.5 to 2; with a camera of 640 x 480
///              pixels, once without distortion and once distorted.
/// @throws SettingsError  if the sensor cannot use an observation
template <class M>
[[nodiscard]] Verdict check_sensor(
    const M& sensor, const std::vector<Observation>& seen = detail::typical_observations<M>()) {
  [[maybe_unused]] const detail::CheckSensorType<M> check_of_type{};
  if constexpr (Sensor<M>) {
    const auto inputs = detail::SensorInput<M, double>::of(sensor, seen);
    const detail::SensorCheck<M> check(sensor);
    if constexpr (PlacingSensor<M>) {
      if (const Verdict v = check.places(inputs); !v) return v;
    }
    if constexpr (PredictingSensor<M>) return check.predicts(inputs);
  }
  return kLawsHold;
}

}  // namespace kinecal
