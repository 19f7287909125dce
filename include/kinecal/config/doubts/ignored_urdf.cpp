// Definitions of ignored_urdf.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/ignored_urdf.hpp"

#include <algorithm>
#include <string>

#include "kinecal/files/urdf/urdf_places.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

void check_ignored_urdf(const Robot& robot, const std::string& text,
                        const std::string& name_for_messages, Diagnostics& diagnostics) {
  for (const JointElement& element : UrdfPlaces(text, name_for_messages).joints()) {
    const std::string& name = element.name;
    if (!robot.has_joint(name)) continue;
    const Joint& joint = robot.joint(name);
    const std::string& mimicked = element.mimicked;
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
        diagnostics.error(element.place, sentence);
      } else {
        diagnostics.warning(element.place, sentence);
      }
    }
    if (to_string(joint.type) != element.type) {
      diagnostics.warning(element.place, "joint '" + name +
                                             "' has an axis of length zero; it is taken as "
                                             "planar, so no chain can contain it");
    }
  }
}

}  // namespace kinecal::detail
