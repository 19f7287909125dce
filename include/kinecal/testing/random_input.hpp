// Random input for checks, with a fixed seed; the arguments of error blocks as vectors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <random>

#include "kinecal/errors/error_block.hpp"

namespace kinecal::detail {

/// Random numbers, the same in each run and with each standard library.
class RandomInput {
 public:
  /// A number between two bounds.
  double operator()(double lower, double upper) {
    return lower + (upper - lower) * (static_cast<double>(random_()) / 4294967295.0);
  }
  /// (3) each component from -1 to 1.
  Vector3<double> vector() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }
  /// A rotation by at most 1.7 radians, and a translation with components from -1 to 1 m.
  Pose<double> pose() { return {exp(vector()), vector()}; }

 private:
  std::mt19937 random_{20240601u};
};

/// The argument of a block as vectors of three numbers.
template <Quantity Q>
struct InputOf : VectorsOf<Q> {};

/// The predicted pixel and the observed one; only the first is differentiated.
template <>
struct InputOf<Quantity::pixel> {
  static constexpr std::array kVariables = {Change::number};
  static constexpr std::size_t kValues = 2;

  static void to_base(const Pose<double>&, const PixelObservation<double>& pixel,
                      Vector3<double>* out) {
    out[0] = {pixel.predicted.x(), pixel.predicted.y(), 0.0};
    out[1] = {pixel.observed.x(), pixel.observed.y(), 0.0};
  }
  template <class J, class S>
  static PixelObservation<J> jets(const Vector3<S>* values, int first) {
    return {{J(values[0].x(), first), J(values[0].y(), first + 1)}, {values[1].x(), values[1].y()}};
  }
  template <class S>
  static PixelObservation<S> plain(const Vector3<S>* values) {
    return {{values[0].x(), values[0].y()}, {values[1].x(), values[1].y()}};
  }
};

/// Centroid and normal.
template <>
struct InputOf<Quantity::plane> {
  static constexpr std::array kVariables = {Change::number, Change::number};
  static constexpr std::size_t kValues = 2;

  static void to_base(const Pose<double>&, const Plane<double>& plane, Vector3<double>* out) {
    out[0] = plane.centroid;
    out[1] = plane.normal;
  }
  template <class J, class S>
  static Plane<J> jets(const Vector3<S>* values, int first) {
    return {point_jets<J>(values[0], first), point_jets<J>(values[1], first + 3)};
  }
  template <class S>
  static Plane<S> plain(const Vector3<S>* values) {
    return {values[0], values[1]};
  }
};

/// Number of variables of an argument.
template <Quantity Q>
inline constexpr int kInputVariables = 3 * static_cast<int>(InputOf<Q>::kVariables.size());

/// A random argument: points within 1 m, directions roughly along z, pixels of 0 to 500.
template <Quantity Q>
void randomize(RandomInput& random, Vector3<double>* values) {
  for (std::size_t i = 0; i < InputOf<Q>::kValues; ++i) values[i] = random.vector();
  if constexpr (Q == Quantity::ray) values[1].z() += 2.0;
  if constexpr (Q == Quantity::plane) values[1] = exp(values[1]).col(2);
  if constexpr (Q == Quantity::pose) VectorsOf<Q>::to_base(random.pose(), Pose<double>{}, values);
  if constexpr (Q == Quantity::pixel) {
    for (int i = 0; i < 2; ++i) values[i] = {random(0, 500), random(0, 500), 0.0};
  }
}

/// Moves variable k of an argument.
template <Quantity Q>
void move_variable(Vector3<double>* values, int k, double step) {
  const auto which = static_cast<std::size_t>(k / 3);
  if (InputOf<Q>::kVariables[which] != Change::rotation) {
    values[which](k % 3) += step;
    return;
  }
  const Matrix3<double> turn = exp(Vector3<double>(step * Vector3<double>::Unit(k % 3)));
  for (int c = 1; c <= 3; ++c) values[c] = Vector3<double>(turn * values[c]);
}

/// Arguments on which two sensors agree: the same one twice, or two rays to one point.
template <Quantity Q>
void make_agree(RandomInput& random, const Vector3<double>* a, Vector3<double>* b) {
  if constexpr (Q == Quantity::ray) {
    randomize<Q>(random, b);
    b[1] = (a[0] + 1.5 * a[1] - b[0]) * 0.7;
  } else {
    for (std::size_t i = 0; i < InputOf<Q>::kValues; ++i) b[i] = a[i];
  }
}

}  // namespace kinecal::detail
