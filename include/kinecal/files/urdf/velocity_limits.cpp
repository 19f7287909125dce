// Definitions of velocity_limits.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/velocity_limits.hpp"

#include <map>
#include <string>

#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal {

std::map<std::string, double> velocity_limits(const std::string& text,
                                              const std::string& name_for_messages) {
  const detail::UrdfText urdf(text, name_for_messages);
  Diagnostics diagnostics;
  std::map<std::string, double> limits;
  for (const pugi::xml_node joint : urdf.robot().children("joint")) {
    const double limit = urdf.numbers(joint.child("limit"), "velocity", 1, diagnostics).front();
    if (limit > 0.0) limits[joint.attribute("name").value()] = limit;
  }
  diagnostics.throw_if_errors();
  return limits;
}

}  // namespace kinecal
