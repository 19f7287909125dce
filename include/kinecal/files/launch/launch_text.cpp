// Definitions of launch_text.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/launch/launch_text.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <pugixml.hpp>
#include <utility>

#include "kinecal/files/xml/xml_edit.ipp"
#include "kinecal/files/xml/xml_text.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

class LaunchXml : public XmlText {
 public:
  /// @param file  name of the file for messages
  /// @throws InputError  if the text is empty, not XML, not UTF-8 or its root is not <launch>
  LaunchXml(std::string text, std::string file)
      : XmlText(std::move(text), std::move(file), {"a launch file", "launch"}) {}

  /// The element of a setting; an error and a null node if absent or several.
  [[nodiscard]] pugi::xml_node find(const LaunchSetting& setting, Diagnostics& diagnostics) const {
    const std::vector<Named> all = elements(setting.element);
    const std::string what = subject(setting);
    const std::string way_out = name_option(setting.key + "=NAME") + " names another one, " +
                                name_option(setting.key + "=") + " leaves it out";
    std::vector<pugi::xml_node> found;
    for (const bool passed : {false, true}) {
      for (const Named& named : all) {
        if (named.passed != passed || named.name != without_slash(setting.name)) continue;
        found.push_back(named.node);
      }
      if (!found.empty()) break;
    }
    if (found.size() > 1) {
      diagnostics.error(place(found[1]), what + " occurs twice, first in line " +
                                             std::to_string(place(found[0]).line) + "; " + way_out);
    }
    if (found.empty()) {
      std::vector<std::string> names;
      for (const Named& named : all) names.push_back(named.name);
      const std::string meant = did_you_mean(setting.name, names);
      diagnostics.error({file(), 0}, "no " + what + (meant.empty() ? "; " : meant + " ") + way_out);
    }
    return found.size() == 1 ? found[0] : pugi::xml_node();
  }

  [[nodiscard]] bool has(const LaunchSetting& setting) const {
    const std::vector<Named> all = elements(setting.element);
    return std::any_of(all.begin(), all.end(), [&](const Named& named) {
      return named.name == without_slash(setting.name);
    });
  }

  /// The value of an element, in any attribute; empty if absent.
  [[nodiscard]] static std::string value_of(pugi::xml_node element) {
    for (const std::string_view name : kValueAttributes) {
      if (const auto value = element.attribute(name.data())) return value.value();
    }
    return {};
  }

  /// The files that the text names by their full paths.
  [[nodiscard]] std::vector<std::filesystem::path> named_files() const {
    std::vector<std::filesystem::path> files;
    for (const LaunchElement element : {LaunchElement::param, LaunchElement::arg}) {
      for (const Named& named : elements(element)) {
        std::string value = value_of(named.node);
        if (value.starts_with("file://")) value.erase(0, std::string_view("file://").size());
        if (value.starts_with('/')) files.emplace_back(value);
      }
    }
    return files;
  }

  /// Adds the edit that sets an element; does nothing if it already has the value.
  void set(pugi::xml_node element, const LaunchSetting& setting, std::vector<TextEdit>& edits,
           Diagnostics& diagnostics) const {
    const StartTag tag = scan_start_tag(text(), offset(element));
    const AttributeText* old = nullptr;
    for (const AttributeText& attribute : tag.attributes) {
      const auto& all = kValueAttributes;
      if (std::find(all.begin(), all.end(), attribute.name) == all.end()) continue;
      if (old != nullptr) {
        return diagnostics.error(
            place(element), subject(setting) + " has both " + std::string(old->name) + " and " +
                                std::string(attribute.name) + "; keep one of them");
      }
      old = &attribute;
    }
    if (old == nullptr) {
      return diagnostics.error(place(element), subject(setting) + " has no " + setting.attribute +
                                                   "=\"...\" to be replaced");
    }
    if (!can_be_in_launch_file(setting.value)) {
      return diagnostics.error(
          place(element), subject(setting) + ": '" + setting.value +
                              "' cannot stand in a launch file, which has no escape for '$' and "
                              "control characters; rename the file or its folder");
    }
    // An <arg> that is passed to an <include>, or constant, has a value, not a default.
    const bool is_arg = setting.element == LaunchElement::arg;
    const std::string attribute = is_arg ? std::string(old->name) : setting.attribute;
    if (attribute == old->name && value_of(element) == setting.value) return;
    if (attribute != old->name) {
      const auto at = static_cast<std::size_t>(old->name.data() - text().data());
      edits.push_back({at, old->name.size(), attribute});
    }
    edits.push_back({old->begin, old->end - old->begin,
                     xml_attribute_text(setting.value, text()[old->begin - 1])});
  }

  /// The text with all settings; every other byte is unchanged.
  /// @throws InputError  with every setting that has no place in the text, or more than one
  [[nodiscard]] std::string with(const std::vector<LaunchSetting>& settings) const {
    std::vector<TextEdit> edits;
    Diagnostics diagnostics;
    std::map<std::size_t, std::string> keys;  // by the element that they set
    for (const LaunchSetting& setting : settings) {
      const pugi::xml_node element = find(setting, diagnostics);
      if (!element) continue;
      const auto [other, is_first] = keys.emplace(offset(element), setting.key);
      if (is_first) {
        set(element, setting, edits, diagnostics);
      } else {
        diagnostics.error(place(element), setting.key + " and " + other->second + " both set " +
                                              subject(setting) + "; name another one");
      }
    }
    diagnostics.throw_if_errors();
    return apply_edits(text(), std::move(edits));
  }

 private:
  /// Attributes that may hold a value; an element has one of them.
  static constexpr std::array<std::string_view, 5> kValueAttributes = {
      "value", "default", "textfile", "command", "binfile"};

  /// "param 'calibration_date'", for messages.
  [[nodiscard]] static std::string subject(const LaunchSetting& setting) {
    return std::string(to_string(setting.element)) + " '" + setting.name + "'";
  }

  struct Named {
    pugi::xml_node node;
    std::string name;     ///< full, without a leading slash
    bool passed = false;  ///< to an <include>: an <arg> that is not a declaration
  };

  [[nodiscard]] static std::string without_slash(const std::string& name) {
    return name.starts_with('/') ? name.substr(1) : name;
  }

  /// The name of a <param> with the namespaces around it.
  [[nodiscard]] static std::string full_name(pugi::xml_node param) {
    std::string name = param.attribute("name").value();
    const auto put_before = [&](const char* space) {
      if (*space != '\0' && !name.starts_with('/')) name = std::string(space) + "/" + name;
    };
    for (pugi::xml_node at = param.parent(); at; at = at.parent()) {
      if (at.name() == std::string_view("node")) put_before(at.attribute("name").value());
      put_before(at.attribute("ns").value());
    }
    return without_slash(name);
  }

  [[nodiscard]] std::vector<Named> elements(LaunchElement element) const {
    struct Walker : pugi::xml_tree_walker {
      explicit Walker(LaunchElement wanted) : element(wanted) {}
      bool for_each(pugi::xml_node& node) override {
        if (node.name() != to_string(element)) return true;
        const bool is_arg = element == LaunchElement::arg;
        found.push_back({node, is_arg ? node.attribute("name").value() : full_name(node),
                         is_arg && node.parent().name() == std::string_view("include")});
        return true;
      }
      LaunchElement element;
      std::vector<Named> found;
    } walker(element);
    pugi::xml_node(root()).traverse(walker);
    return walker.found;
  }
};

LaunchText::LaunchText(std::string text, std::string file)
    : xml_(std::make_unique<LaunchXml>(std::move(text), std::move(file))) {}

LaunchText::~LaunchText() = default;
LaunchText::LaunchText(LaunchText&&) noexcept = default;
LaunchText& LaunchText::operator=(LaunchText&&) noexcept = default;

const std::string& LaunchText::text() const {
  return xml_->text();
}

std::string LaunchText::value_of(const LaunchSetting& setting, Diagnostics& diagnostics) const {
  return LaunchXml::value_of(xml_->find(setting, diagnostics));
}

bool LaunchText::has(const LaunchSetting& setting) const {
  return xml_->has(setting);
}

std::vector<std::filesystem::path> LaunchText::named_files() const {
  return xml_->named_files();
}

std::string LaunchText::with(const std::vector<LaunchSetting>& settings) const {
  return xml_->with(settings);
}

}  // namespace kinecal::detail
