// Definitions of patch_xacro.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/patch_xacro.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/urdf/joint_editor.ipp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/files/urdf/xacro_files.hpp"
#include "kinecal/files/urdf/xacro_joints.ipp"

namespace kinecal {

namespace detail {
namespace {

// The numbers of a joint that a calibration has changed in a URDF.

/// A list of numbers in a joint: an attribute of one of its elements.
struct JointNumbers {
  const char *element, *attribute;
  std::size_t size;
};

constexpr std::array<JointNumbers, 10> kPatchedNumbers = {
    {{"origin", "xyz", 3},
     {"origin", "rpy", 3},
     {"limit", "lower", 1},
     {"limit", "upper", 1},
     {"safety_controller", "soft_lower_limit", 1},
     {"safety_controller", "soft_upper_limit", 1},
     {"calibration", "rising", 1},
     {"calibration", "falling", 1},
     {"mimic", "multiplier", 1},
     {"mimic", "offset", 1}}};

/// The values that a joint has after the calibration, and had before, where they differ.
struct ChangedNumbers {
  JointNumbers of;
  std::vector<double> before, after;

  /// `xyz="0.1 0 0" of <origin>`
  [[nodiscard]] std::string text() const {
    std::string all;
    for (const double value : after) all += (all.empty() ? "" : " ") + xml_number(value);
    return fmt::format("{}=\"{}\" of <{}>", of.attribute, all, of.element);
  }
};

[[nodiscard]] std::vector<ChangedNumbers> changed_numbers(const UrdfText& original,
                                                          const UrdfText& calibrated,
                                                          const std::string& joint) {
  std::vector<ChangedNumbers> changes;
  Diagnostics ignored;  // the reader of URDFs has reported them
  for (const JointNumbers& of : kPatchedNumbers) {
    const auto numbers = [&](const UrdfText& source) {
      return source.numbers(source.joint(joint).child(of.element), of.attribute, of.size, ignored);
    };
    ChangedNumbers change{of, numbers(original), numbers(calibrated)};
    if (change.before != change.after) changes.push_back(std::move(change));
  }
  return changes;
}

[[nodiscard]] bool same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kSame = 1e-9;  // of numbers that xacro has rounded
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::abs(x - y) <= kSame * (1.0 + std::abs(y));
  });
}

// Which element of which xacro file makes a joint of the URDF.

/// A xacro file with its edits.
struct XacroSource {
  explicit XacroSource(const XacroFile& file) : source(file.text, file.name) {}
  UrdfText source;
  std::vector<TextEdit> edits = {};
};

/// An element that makes joints, and its file.
struct XacroElement {
  pugi::xml_node joint;
  std::size_t file = 0;
};

/// The joints of xacro files, and those of the URDF that each of them makes.
class XacroMatches {
 public:
  XacroMatches(const std::deque<XacroSource>& files, const UrdfText& urdf) : files_(files) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      for (const pugi::xml_node joint : xacro_joints(files[i].source.robot())) {
        joints_.push_back(joint);
        file_of_[joint] = i;
      }
    }
    for (const pugi::xml_node joint : urdf.robot().children("joint")) {
      const auto found = joints_named(joints_, joint.attribute("name").value());
      if (found.size() == 1) ++made_[found.front()];
    }
  }

  /// The element that makes only this joint; else a null node.
  /// @param why  receives the reason
  [[nodiscard]] XacroElement only_for(const std::string& name, std::string& why) const {
    const auto found = joints_named(joints_, name);
    if (found.empty()) {
      why = fmt::format("{}: no joint '{}'{}", files_.front().source.file(), name,
                        files_.size() == 1 ? "" : ", nor in the files that it includes");
      return {};
    }
    if (found.size() > 1) {
      std::string places;
      for (const pugi::xml_node joint : found) {
        places += (places.empty() ? "" : ", ") + place_of(joint);
      }
      why = fmt::format("{}: several joints that may be '{}'", places, name);
      return {};
    }
    const int made = made_.at(found.front());
    if (made == 1) return {found.front(), file_of_.at(found.front())};
    why = fmt::format("{}: joint '{}' is one of {} that this element makes",
                      place_of(found.front()), name, made);
    return {};
  }

 private:
  [[nodiscard]] std::string place_of(pugi::xml_node joint) const {
    return files_[file_of_.at(joint)].source.place(joint).str();
  }

  const std::deque<XacroSource>& files_;
  std::vector<pugi::xml_node> joints_;
  std::map<pugi::xml_node, std::size_t> file_of_;
  std::map<pugi::xml_node, int> made_;  ///< joints of the URDF
};

/// Patches one joint of a xacro file.
struct XacroJoint {
  const UrdfText& source;
  pugi::xml_node joint;
  std::string name;  ///< in the URDF
  std::vector<TextEdit>& edits;
  std::vector<std::string>& unpatched;

  /// True if the attribute may be set; otherwise names it unless it is set already.
  [[nodiscard]] bool may_set(const ChangedNumbers& change) const {
    const pugi::xml_node element = joint.child(change.of.element);
    const pugi::xml_attribute attribute = element.attribute(change.of.attribute);
    const auto name_it = [&](const std::string& why) {
      unpatched.push_back(fmt::format("{}: joint '{}': {}; it should become {}",
                                      source.place(element ? element : joint).str(), name, why,
                                      change.text()));
      return false;
    };
    if (!element && has_xacro_elements()) {
      return name_it(fmt::format("<{}> is made by xacro", change.of.element));
    }
    const std::string found = attribute.value();
    if (is_expression(found)) {
      return name_it(fmt::format("{}=\"{}\" is an expression", change.of.attribute, found));
    }
    Diagnostics wrong;
    const std::vector<double> value =
        source.numbers(element, change.of.attribute, change.of.size, wrong);
    if (wrong.errors.empty() && same_numbers(value, change.after)) return false;
    if (wrong.errors.empty() && same_numbers(value, change.before)) return true;
    return name_it(
        fmt::format("{}=\"{}\" is not the number in the URDF", change.of.attribute, found));
  }

  [[nodiscard]] bool has_xacro_elements() const {
    const auto children = joint.children();
    return std::any_of(children.begin(), children.end(), [](pugi::xml_node child) {
      return std::string_view(child.name()).find(':') != std::string_view::npos;
    });
  }

  void patch(const std::vector<ChangedNumbers>& changes) {
    std::map<std::string, std::vector<const ChangedNumbers*>> by_element;
    for (const ChangedNumbers& change : changes) {
      if (may_set(change)) by_element[change.of.element].push_back(&change);
    }
    UrdfJointEditor editor{source, joint, edits};
    for (const auto& [element, of_element] : by_element) {
      if (const pugi::xml_node there = joint.child(element.c_str())) {
        XmlTagEditor tag = editor.tag_of(there);
        for (const ChangedNumbers* change : of_element)
          tag.set(change->of.attribute, change->after);
        tag.finish();
      } else if (element == "origin") {
        editor.create_origin(value_of("xyz", of_element), value_of("rpy", of_element));
      } else if (element == "calibration") {
        editor.create_calibration(of_element.front()->after.front());
      }
    }
  }

  [[nodiscard]] static Vector3<double> value_of(std::string_view attribute,
                                                const std::vector<const ChangedNumbers*>& changes) {
    for (const ChangedNumbers* change : changes) {
      const std::vector<double>& value = change->after;
      if (change->of.attribute == attribute) return {value[0], value[1], value[2]};
    }
    return Vector3<double>::Zero();
  }
};

/// Names what changed in <ros2_control>, which is not patched.
void name_ros2_control(const UrdfText& source, const std::string& original,
                       const std::string& calibrated, std::vector<std::string>& unpatched) {
  const auto before = ros2_control_offsets(original, "the URDF");
  for (const auto& [joint, offset] : ros2_control_offsets(calibrated, "the calibrated URDF")) {
    const auto old = before.find(joint);
    if (old != before.end() && old->second == offset) continue;
    unpatched.push_back(fmt::format("{}: joint '{}': its offset in <ros2_control> should become {}",
                                    source.file(), joint, xml_number(offset)));
  }
}

}  // namespace
}  // namespace detail

XacroPatch patch_xacro(const std::vector<XacroFile>& files, const std::string& original,
                       const std::string& calibrated) {
  if (files.empty()) return {};
  std::deque<detail::XacroSource> sources;  // which stay where they are
  XacroPatch patch;
  for (const XacroFile& file : files) {
    sources.emplace_back(file);
    patch.files.push_back({file.name, file.text, {}});
  }
  const detail::UrdfText before(original, "the URDF"), after(calibrated, "the calibrated URDF");
  const detail::XacroMatches matches(sources, before);
  for (const pugi::xml_node of_urdf : before.robot().children("joint")) {
    const std::string name = of_urdf.attribute("name").value();
    const auto changes = detail::changed_numbers(before, after, name);
    if (changes.empty()) continue;
    std::string why, all;
    const detail::XacroElement element = matches.only_for(name, why);
    if (!element.joint) {
      for (const auto& change : changes) all += (all.empty() ? "" : ", ") + change.text();
      patch.unpatched.push_back(why + "; it should get " + all);
      continue;
    }
    const std::size_t named = patch.unpatched.size();
    detail::XacroSource& of = sources[element.file];
    detail::XacroJoint{of.source, element.joint, name, of.edits, patch.unpatched}.patch(changes);
    if (patch.unpatched.size() == named) patch.files[element.file].patched.push_back(name);
  }
  detail::name_ros2_control(sources.front().source, original, calibrated, patch.unpatched);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    patch.files[i].text = detail::apply_edits(files[i].text, std::move(sources[i].edits));
  }
  return patch;
}

}  // namespace kinecal
