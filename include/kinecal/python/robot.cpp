// Robots and their kinematics in Python.
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <utility>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/kinematics/pose_batch.hpp"
#include "kinecal/python/arrays.ipp"

namespace kinecal::python {
namespace {

/// A robot with the text that it was read from.
struct RobotText {
  Robot robot;
  std::string text, name;  ///< of the URDF; its file or "robot.urdf"
};

RobotText read_robot(const std::string& text, const std::string& name) {
  return {parse_urdf(text, name), text, name};
}

py::list joints_of(const RobotText& of) {
  py::list joints;
  for (const Joint& joint : of.robot.joints()) {
    py::dict item;
    item["name"] = joint.name;
    item["type"] = std::string(to_string(joint.type));
    item["parent"] = joint.parent;
    item["child"] = joint.child;
    item["axis"] = py::make_tuple(joint.axis.x(), joint.axis.y(), joint.axis.z());
    item["mimic"] = joint.mimic ? py::object(py::str(joint.mimic->joint)) : py::none();
    item["limits"] = joint.limits
                         ? py::object(py::make_tuple(joint.limits->lower, joint.limits->upper))
                         : py::none();
    joints.append(std::move(item));
  }
  return joints;
}

Numbers matrices(std::size_t rows, std::size_t height, std::size_t width) {
  return Numbers(std::vector<py::ssize_t>{static_cast<py::ssize_t>(rows),
                                          static_cast<py::ssize_t>(height),
                                          static_cast<py::ssize_t>(width)});
}

/// Poses, and Jacobians if wanted, of each row.
py::tuple kinematics(const ChainOfColumns& chain, const Numbers& positions, bool with_jacobians) {
  const std::size_t rows = size_of(positions, 0);
  Numbers poses = matrices(rows, 4, 4);
  Numbers jacobians =
      matrices(with_jacobians ? rows : 0, 6, static_cast<std::size_t>(chain.columns));
  const std::span<const double> in = numbers_of(positions);
  const std::span<double> out = numbers_of(poses), derivatives = numbers_of(jacobians);
  {
    const py::gil_scoped_release others_may_run;
    forward_kinematics(chain, in, out, derivatives);
  }
  return py::make_tuple(std::move(poses), std::move(jacobians));
}

}  // namespace

void bind_robot(py::module_& module) {
  py::class_<RobotText>(module, "Robot")
      .def(py::init(&read_robot), py::arg("text"), py::arg("name"))
      .def_property_readonly("name", [](const RobotText& of) { return of.robot.name(); })
      .def_readonly("text", &RobotText::text)
      .def_readonly("file", &RobotText::name)
      .def_property_readonly("links", [](const RobotText& of) { return of.robot.link_names(); })
      .def_property_readonly("joints", &joints_of)
      .def(
          "chain",
          [](const RobotText& of, const std::string& base, const std::string& tip,
             const std::vector<std::string>& names) {
            return make_chain_of_columns(of.robot, base, tip, names);
          },
          py::arg("base"), py::arg("tip"), py::arg("names"));
  py::class_<ChainOfColumns>(module, "Chain")
      .def_property_readonly("joints",
                             [](const ChainOfColumns& of) {
                               std::vector<std::string> names;
                               for (const ChainJoint& joint : of.chain.joints)
                                 names.push_back(joint.name);
                               return names;
                             })
      .def("kinematics", &kinematics, py::arg("positions"), py::arg("jacobians"));
  module.def("read_urdf_text", &read_urdf_text, py::arg("path"));
}

}  // namespace kinecal::python
