// Which element of which xacro file makes a joint of the URDF: for patch_xacro.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <deque>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/files/urdf/xacro_files.hpp"
#include "kinecal/files/urdf/xacro_joints.ipp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
