// Definitions of patch_xacro.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/patch_xacro.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>
#include <utility>

#include "kinecal/files/urdf/changed_numbers.ipp"
#include "kinecal/files/urdf/joint_editor.ipp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/files/urdf/xacro_matches.ipp"

namespace kinecal {

namespace detail {
namespace {

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
