// Arrays of NumPy at the border: shapes are checked here, numbers in arrays.py.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>

namespace kinecal::python {

namespace py = pybind11;

/// Numbers in rows; another layout or type is copied.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// All numbers of an array, row by row.
[[nodiscard]] inline std::span<const double> numbers_of(const Numbers& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}
[[nodiscard]] inline std::span<double> numbers_of(Numbers& array) {
  return {array.mutable_data(), static_cast<std::size_t>(array.size())};
}

/// Size of an array along an axis.
[[nodiscard]] inline std::size_t size_of(const Numbers& array, int axis) {
  return static_cast<std::size_t>(array.shape(axis));
}

void bind_robot(py::module_& module);
void bind_samples(py::module_& module);
void bind_calibration(py::module_& module);

}  // namespace kinecal::python
