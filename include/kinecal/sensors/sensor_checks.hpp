// What is wrong with a type that is not a Sensor, as a sentence of the compiler.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/sensor.hpp"
#include "kinecal/text/sentence.hpp"

namespace kinecal::detail {

template <class M, bool kIsNamed = false>
struct TypeOfSensor {
  static_assert(kIsNamed,
                "kinecal: this sensor has no name; write in it static constexpr std::string_view "
                "kType = \"my_sensor\"");
};
template <class M, bool kIsQuantity = false>
struct PlaceOfSensor {
  static_assert(kIsQuantity,
                "kinecal: place() of this sensor does not return a Vector3<S>, Ray<S>, Pose<S> or "
                "Reading<S> in the scalar S of its parameters; write one of them, not auto, which "
                "may be an expression");
};
template <class M, bool kIsPixel = false>
struct PredictionOfSensor {
  static_assert(
      kIsPixel,
      "kinecal: predict() of this sensor does not return an Eigen::Matrix<S, 2, 1> in the "
      "scalar S of the point; write it, not auto, which may be an expression");
};
template <class M, bool kHasFunctions = false>
struct FunctionsOfSensor {
  static_assert(
      kHasFunctions,
      "kinecal: this sensor has neither place(measurement, parameters) nor predict(point, "
      "settings, parameters), templated on scalars; sensors/sensor.hpp shows both");
};

/// Holds, or what is wrong with a type that is not a Sensor.
template <class M>
using CheckSensorType = FirstOf<Unless<HasTypeName<M>, TypeOfSensor<M>>,
                                Unless<PlacesQuantityIfAnything<M>, PlaceOfSensor<M>>,
                                Unless<PredictsPixelIfAnything<M>, PredictionOfSensor<M>>,
                                Unless<Sensor<M>, FunctionsOfSensor<M>>>;

}  // namespace kinecal::detail
