// Feeds parse_urdf(), patch_urdf() and visuals() with text that is not a URDF.  A patched URDF must be a URDF
// again, with the same joints.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/urdf/visuals.hpp"

namespace {

using namespace kinecal;

std::vector<JointPatch> patches_for(const Robot& robot) {
  std::vector<JointPatch> patches;
  for (const Joint& joint : robot.joints()) {
    JointPatch patch;
    patch.joint = joint.name;
    patch.correction.translation.x() = 0.001;
    if (moves(joint.type) && !joint.mimic) patch.offset = 0.01;
    if (joint.mimic) {
      patch.mimic_multiplier = 0.01;
      patch.mimic_offset = 0.02;
    }
    patches.push_back(patch);
  }
  return patches;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const OffsetStyle style : {OffsetStyle::rising, OffsetStyle::origin, OffsetStyle::as_read,
                                  OffsetStyle::ros2_control}) {
    std::string patched;
    Robot robot;
    try {
      Diagnostics diagnostics;
      (void)visuals(text, "fuzz.urdf", diagnostics);
      robot = parse_urdf(text, "fuzz.urdf");
      patched = patch_urdf(text, "fuzz.urdf", robot, patches_for(robot), style);
    } catch (const InputError&) {  // what is expected of most
      return 0;
    }
    if (parse_urdf(patched, "fuzz.urdf").joint_names() != robot.joint_names()) std::abort();
  }
  return 0;
}
