// Definitions of launch_nodes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/launch/launch_nodes.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/xml/xml_text.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Words of args="...", as a shell splits them.
[[nodiscard]] std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  char quote = '\0';
  bool is_open = false;
  for (const char c : text) {
    if (quote == '\0' && (c == ' ' || c == '\t' || c == '\n')) {
      is_open = false;
    } else {
      if (!is_open) words.emplace_back();
      is_open = true;
      if (c == quote) {
        quote = '\0';
      } else if (quote == '\0' && (c == '"' || c == '\'')) {
        quote = c;
      } else {
        words.back() += c;
      }
    }
  }
  return words;
}

/// A name below a namespace; "/name" stands alone.  Without a leading slash.
[[nodiscard]] std::string in_namespace(const std::string& space, std::string name) {
  if (name.starts_with('/')) return name.substr(1);
  if (name.starts_with('~')) name.erase(0, 1);
  return space.empty() || name.empty() ? space + name : space + "/" + name;
}

class LaunchReader {
 public:
  LaunchReader(const std::string& path, const std::map<std::string, std::string>& given,
               const std::vector<std::string>& packages, Diagnostics& diagnostics)
      : xml_(read_text_file(path), path, {"a launch file", "launch"}),
        places_(mesh_places(path)),
        given_(given),
        packages_(packages),
        diagnostics_(diagnostics) {}

  [[nodiscard]] LaunchNodes read() {
    read_arguments();
    read_children(xml_.root(), "");
    for (const Setting& setting : settings_) assign(setting);
    return std::move(launch_);
  }

 private:
  /// A <param> or <rosparam>, and the namespace around it.
  struct Setting {
    pugi::xml_node element;
    std::string space;
  };

  void error(pugi::xml_node element, const std::string& message) {
    diagnostics_.error(xml_.place(element), message);
  }

  /// Arguments are taken when they are used: those of other packages' nodes may need what is not here.
  void read_arguments() {
    std::vector<std::string> names;
    for (const pugi::xml_node arg : xml_.root().children("arg")) {
      if (!holds(arg)) continue;
      const std::string name = arg.attribute("name").value();
      names.push_back(name);
      const auto own = given_.find(name);
      if (own != given_.end() && !arg.attribute("value")) {
        arguments_[name] = own->second;
      } else if (const auto value = arg.attribute(arg.attribute("value") ? "value" : "default")) {
        arguments_[name] = value.value();
      }
    }
    for (const auto& [name, value] : given_) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      error({}, "has no argument '" + name + "'" + did_you_mean(name, names));
    }
  }

  void read_children(pugi::xml_node parent, const std::string& space) {
    for (const pugi::xml_node child : parent.children()) {
      const std::string_view kind = child.name();
      if (kind == "include") launch_.included.emplace_back(child.attribute("file").value());
      if (kind != "group" && kind != "node" && kind != "param" && kind != "rosparam") continue;
      if (!holds(child)) continue;
      if (kind == "group") {
        read_children(child, in_namespace(space, text(child, "ns")));
      } else if (kind == "node") {
        read_node(child, in_namespace(space, text(child, "ns")));
      } else {
        settings_.push_back({child, space});
      }
    }
  }

  void read_node(pugi::xml_node element, const std::string& space) {
    const std::string package = element.attribute("pkg").value();
    if (std::find(packages_.begin(), packages_.end(), package) == packages_.end()) return;
    LaunchNode node;
    node.package = package;
    node.type = text(element, "type");
    node.name = in_namespace(space, text(element, "name"));
    node.arguments = words_of(text(element, "args"));
    node.place = xml_.place(element);
    for (const pugi::xml_node child : element.children()) {
      const std::string_view kind = child.name();
      if (kind == "remap" && holds(child)) node.remaps[text(child, "from")] = text(child, "to");
      if ((kind == "param" || kind == "rosparam") && holds(child)) {
        settings_.push_back({child, node.name});
      }
    }
    launch_.nodes.push_back(std::move(node));
  }

  /// Gives a setting to the node that is meant.
  void assign(const Setting& setting) {
    const pugi::xml_node element = setting.element;
    if (element.name() == std::string_view("rosparam")) return assign_file(setting);
    const std::string name = in_namespace(setting.space, element.attribute("name").value());
    if (name == "robot_description" && element.attribute("textfile")) {
      launch_.robot_description = text(element, "textfile");
    }
    for (LaunchNode& node : launch_.nodes) {
      if (!name.starts_with(node.name + "/") || !element.attribute("value")) continue;
      node.parameters[name.substr(node.name.size() + 1)] = text(element, "value");
    }
  }

  void assign_file(const Setting& setting) {
    const pugi::xml_node element = setting.element;
    const std::string_view command = element.attribute("command").value();
    if (!command.empty() && command != "load") return;  // dump, delete
    const std::string space = in_namespace(setting.space, element.attribute("ns").value());
    const std::string name = in_namespace(space, element.attribute("param").value());
    for (LaunchNode& node : launch_.nodes) {
      if (name == node.name && element.attribute("file")) {
        node.parameter_files.push_back(text(element, "file"));
      } else if (name == node.name || name.starts_with(node.name + "/")) {
        error(element, "parameters of node '" + node.name + "' " +
                           (name == node.name ? "stand in the launch file"
                                              : "are loaded into '" + name + "'") +
                           "; put them into a file that is loaded into '" + node.name + "'");
      }
    }
  }

  /// False if if= or unless= leaves an element out.
  [[nodiscard]] bool holds(pugi::xml_node element) {
    for (const char* key : {"if", "unless"}) {
      if (!element.attribute(key)) continue;
      const std::string value = text(element, key);
      const bool is_true = value == "1" || value == "true" || value == "True";
      if (!is_true && value != "0" && value != "false" && value != "False") {
        error(element, std::string(key) + "=\"" + value + "\" is neither true nor false");
      }
      if (is_true != (key == std::string_view("if"))) return false;
    }
    return true;
  }

  /// The value of an attribute, with what $(...) stands for.
  [[nodiscard]] std::string text(pugi::xml_node element, const char* attribute) {
    return substituted(element, element.attribute(attribute).value(), 0);
  }

  [[nodiscard]] std::string substituted(pugi::xml_node element, const std::string& text,
                                        int depth) {
    constexpr int kDeepest = 20;
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t begin = std::min(text.find("$(", at), text.size());
      result += text.substr(at, begin - at);
      const std::size_t end = text.find(')', begin);
      if (begin == text.size()) break;
      if (end == std::string::npos || depth > kDeepest) {
        error(element, end == std::string::npos ? "'" + text + "' has no ')'"
                                                : "'" + text + "' refers to itself");
        break;
      }
      result += value_of(element, text.substr(begin + 2, end - begin - 2), depth);
      at = end + 1;
    }
    return result;
  }

  /// @param expression  between $( and )
  [[nodiscard]] std::string value_of(pugi::xml_node element, const std::string& expression,
                                     int depth) {
    const std::vector<std::string> words = words_of(expression);
    const std::string what = words.empty() ? "" : words[0];
    const std::string name = words.size() > 1 ? words[1] : "";
    if (what == "arg") {
      const auto argument = arguments_.find(name);
      if (argument != arguments_.end()) return substituted(element, argument->second, depth + 1);
      std::vector<std::string> names;
      for (const auto& known : arguments_) names.push_back(known.first);
      const std::string meant = did_you_mean(name, names);
      error(element, "argument '" + name + "' has no value" +
                         (meant.empty() ? "; give it: " + name + ":=VALUE" : meant));
    } else if (what == "find") {
      try {
        return find_package(name, places_).string();
      } catch (const MeshError& e) {
        error(element, std::string("$(find ") + name + "): " + e.what());
      }
    } else if (what == "dirname") {
      return std::filesystem::absolute(xml_.file()).parent_path().string();
    } else if (what == "env" || what == "optenv") {
      if (const char* value = std::getenv(name.c_str())) return value;
      if (what == "env") error(element, "the environment has no " + name);
      std::string fallback;
      for (std::size_t i = 2; i < words.size(); ++i) fallback += (i > 2 ? " " : "") + words[i];
      return fallback;
    } else {
      error(element, "$(" + expression + ") is not read here; write its value");
    }
    return {};
  }

  XmlText xml_;
  MeshPlaces places_;
  const std::map<std::string, std::string>& given_;
  const std::vector<std::string>& packages_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::string> arguments_;  ///< as they are written
  std::vector<Setting> settings_;
  LaunchNodes launch_;
};

}  // namespace
}  // namespace detail

LaunchNodes read_launch_nodes(const std::string& path,
                              const std::map<std::string, std::string>& given,
                              const std::vector<std::string>& packages, Diagnostics& diagnostics) {
  return detail::LaunchReader(path, given, packages, diagnostics).read();
}

}  // namespace kinecal
