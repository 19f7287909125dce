// The module kinecal._kinecal: what the Python package calls.  Its classes are those of the library, with arrays in the place of
// vectors; shapes, names and defaults are the package's (kinecal/*.py).
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <stdexcept>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/python/arrays.ipp"

namespace kinecal::python {
namespace {

/// What the library throws of the user's input becomes KinecalError.
void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::builtin_exception&) {
      throw;
    } catch (const py::error_already_set&) {
      throw;
    } catch (const std::exception& error) {
      const bool is_of_input = dynamic_cast<const InputError*>(&error) != nullptr ||
                               dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
      if (!is_of_input) throw;
      const py::object type = py::module_::import("kinecal.errors").attr("KinecalError");
      PyErr_SetString(type.ptr(), error.what());
    }
  });
}

}  // namespace
}  // namespace kinecal::python

PYBIND11_MODULE(_kinecal, module) {
  using namespace kinecal::python;
  module.attr("__version__") = KINECAL_VERSION;
  module.def(
      "instruction_set",
      [] {
        const kinecal::Evaluation evaluation = kinecal::evaluation_of_library();
        return std::pair(std::string(evaluation.instruction_set), evaluation.lanes);
      },
      "Instruction set of the evaluation, and samples evaluated at once.");
  translate_errors();
  bind_robot(module);
  bind_samples(module);
  bind_calibration(module);
}
