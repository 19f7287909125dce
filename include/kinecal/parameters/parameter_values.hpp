// Values of all parameters of a table, as functions take them: from a std::vector, an array, a span or a vector of
// Eigen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <span>

#include "kinecal/geometry/eigen_layout.hpp"

namespace kinecal {

namespace detail {

/// Doubles of Eigen that lie in memory one after the other: a vector, or a part of one.
template <class V>
concept EigenNumbers = std::same_as<typename V::Scalar, double> && bool(V::IsVectorAtCompileTime) &&
                       int(V::InnerStrideAtCompileTime) == 1 && requires(const V& v) {
  { v.data() } -> std::convertible_to<const double*>;
};

}  // namespace detail

/// (parameters of the table) values, not owned.  What they come from must outlive the call.
struct ParameterValues : std::span<const double> {
  using std::span<const double>::span;

  /// The values of a span.
  ParameterValues(std::span<const double> values) : span(values) {}  // NOLINT: the same
  /// The values of a container: std::vector, std::array.
  template <class C>
  requires(!detail::EigenNumbers<C> && std::convertible_to<const C&, std::span<const double>>)
      ParameterValues(const C& values)
      : span(values) {}  // NOLINT: the same
  /// The values of an Eigen::VectorXd, or of a Map or segment of one.
  template <detail::EigenNumbers V>
  ParameterValues(const V& values)  // NOLINT: the same
      : span(values.data(), static_cast<std::size_t>(values.size())) {}
};

}  // namespace kinecal
