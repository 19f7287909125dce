// The text of a launch file: reads and replaces the values of its <param>s and <arg>s in place.
//
// A <param> is found by its full name, with the namespaces of its groups and its node.  An <arg> is
// found at its declaration, or else where it is passed to an <include>.  Only the value changes in
// the text.  If a <param> was computed (command="...") and is now a file (textfile="..."), the
// attribute is renamed, too.
// Source: ROS wiki, roslaunch/XML.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal::detail {

enum class LaunchElement { param, arg };

[[nodiscard]] constexpr std::string_view to_string(LaunchElement element) {
  return element == LaunchElement::param ? "param" : "arg";
}

/// The option that names a setting, as it is typed: --name KEY=NAME.
[[nodiscard]] inline std::string name_option(const std::string& key_and_name) {
  return ShellCommand().add_option("--name", {key_and_name}).str();
}

/// A value for a <param> or an <arg>.
struct LaunchSetting {
  std::string key;  ///< as users know it: launch_names.hpp
  LaunchElement element = LaunchElement::param;
  std::string name;       ///< in the launch file
  std::string attribute;  ///< holds the value: value, textfile or default
  std::string value;      ///< without escapes
};

/// False for what a launch file cannot contain: roslaunch substitutes $(...) and ${...}, also in file names, and XML does
/// not allow control characters.
[[nodiscard]] inline bool can_be_in_launch_file(std::string_view value) {
  return value.find('$') == std::string_view::npos && one_line(value) == value;
}

class LaunchXml;

/// A launch file, of which values can be read and replaced.
class LaunchText {
 public:
  /// @param file  name of the file for messages
  /// @throws InputError  if the text is empty, not XML, not UTF-8 or its root is not <launch>
  LaunchText(std::string text, std::string file);
  ~LaunchText();
  LaunchText(LaunchText&&) noexcept;
  LaunchText& operator=(LaunchText&&) noexcept;

  [[nodiscard]] const std::string& text() const;

  /// The value of a setting's element, in any attribute; an error and an empty text unless there is exactly one such
  /// element.
  [[nodiscard]] std::string value_of(const LaunchSetting& setting, Diagnostics& diagnostics) const;

  /// False if the text has no element of this name.
  [[nodiscard]] bool has(const LaunchSetting& setting) const;

  /// The files that the text names by their full paths.
  [[nodiscard]] std::vector<std::filesystem::path> named_files() const;

  /// The text with all settings; every other byte is unchanged.
  /// @throws InputError  with every setting that has no place in the text, or more than one
  [[nodiscard]] std::string with(const std::vector<LaunchSetting>& settings) const;

 private:
  std::unique_ptr<LaunchXml> xml_;
};

}  // namespace kinecal::detail
