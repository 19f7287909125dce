// Definitions of ignored_urdf.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/ignored_urdf.hpp"

#include <algorithm>
#include <string>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

void check_ignored_urdf(const Robot& robot, const std::string& text,
                        const std::string& name_for_messages, Diagnostics& diagnostics) {
  const UrdfText source(text, name_for_messages);
  for (const pugi::xml_node node : source.robot().children("joint")) {
    const std::string name = node.attribute("name").value();
    if (!robot.has_joint(name)) continue;
    const Joint& joint = robot.joint(name);
    const std::string mimicked = node.child("mimic").attribute("joint").value();
    if (!mimicked.empty() && !joint.mimic) {
      const std::string missing = "joint '" + name + "' is not in the sample";
      const bool is_cause =
          std::any_of(diagnostics.errors.begin(), diagnostics.errors.end(),
                      [&](const std::string& e) { return e.find(missing) != std::string::npos; });
      const std::string sentence =
          "joint '" + name + "' mimics '" + mimicked +
          (robot.has_joint(mimicked) ? "', which mimics it" : "', which does not exist") +
          "; it counts as a joint with its own position" +
          (is_cause ? ", which the samples do not have: correct <mimic>" : "") +
          (robot.has_joint(mimicked) ? "" : did_you_mean(mimicked, robot.joint_names()));
      if (is_cause) {
        diagnostics.error(source.place(node), sentence);
      } else {
        diagnostics.warning(source.place(node), sentence);
      }
    }
    if (to_string(joint.type) != node.attribute("type").value()) {
      diagnostics.warning(source.place(node), "joint '" + name +
                                                  "' has an axis of length zero; it is taken as "
                                                  "planar, so no chain can contain it");
    }
  }
}

}  // namespace kinecal::detail
