// Definitions of urdf_places.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/urdf_places.hpp"

#include <pugixml.hpp>

#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal::detail {

UrdfPlaces::UrdfPlaces(const std::string& text, const std::string& file)
    : text_(std::make_unique<UrdfText>(text, file)) {}

UrdfPlaces::~UrdfPlaces() = default;
UrdfPlaces::UrdfPlaces(UrdfPlaces&&) noexcept = default;
UrdfPlaces& UrdfPlaces::operator=(UrdfPlaces&&) noexcept = default;

const std::string& UrdfPlaces::file() const {
  return text_->file();
}

std::vector<JointElement> UrdfPlaces::joints() const {
  std::vector<JointElement> found;
  for (const pugi::xml_node node : text_->robot().children("joint")) {
    found.push_back({node.attribute("name").value(), node.attribute("type").value(),
                     node.child("mimic").attribute("joint").value(), text_->place(node)});
  }
  return found;
}

SourceLocation UrdfPlaces::place(const std::string& joint, const char* element) const {
  return text_->place(text_->joint(joint).child(element));
}

SourceLocation UrdfPlaces::place_or_joint(const std::string& joint, const char* element) const {
  const pugi::xml_node node = text_->joint(joint), child = node.child(element);
  return text_->place(child ? child : node);
}

std::vector<double> UrdfPlaces::numbers(const std::string& joint, const char* element,
                                        const char* attribute, std::size_t count,
                                        Diagnostics& diagnostics) const {
  return text_->numbers(text_->joint(joint).child(element), attribute, count, diagnostics);
}

std::vector<XacroLeft> UrdfPlaces::xacro_left() const {
  const XacroRemnants remnants(text_->robot());
  std::vector<XacroLeft> found;
  for (const XacroRemnant& remnant : remnants.all()) {
    found.push_back({remnant.text, remnant.is_inert, text_->place(remnant.element)});
  }
  return found;
}

}  // namespace kinecal::detail
