// Definitions of xacro_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/xacro_files.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "kinecal/files/ros_package.ipp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/files/urdf/xacro_joints.ipp"

namespace kinecal {

namespace detail {
namespace {

/// All <xacro:include>, in macros and conditions as well.
[[nodiscard]] std::vector<pugi::xml_node> xacro_includes(pugi::xml_node element) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node child : element.children()) {
    if (std::string_view(child.name()).ends_with(":include")) found.push_back(child);
    for (const pugi::xml_node inside : xacro_includes(child)) found.push_back(inside);
  }
  return found;
}

/// The file of a package among the parents of a folder; nullopt if absent.
[[nodiscard]] std::optional<fs::path> in_package(const fs::path& folder, const std::string& package,
                                                 const std::string& inside) {
  for (const fs::path& parent : with_parents(folder)) {
    std::error_code missing;
    if (!is_package(parent, package)) continue;
    if (fs::is_regular_file(parent / inside, missing)) return parent / inside;
  }
  return std::nullopt;
}

/// The included file; nullopt if it is not found.
/// @param why  receives the reason
[[nodiscard]] std::optional<fs::path> included_file(const fs::path& includes,
                                                    const std::string& filename, std::string& why) {
  constexpr std::string_view kFind = "$(find ", kFolder = "$(dirname)/";
  const fs::path folder = includes.parent_path();
  std::string package, inside = filename;
  if (filename.starts_with(kFind)) {
    const std::size_t end = filename.find(')');
    package = filename.substr(kFind.size(), end - kFind.size());
    inside = end == std::string::npos ? "" : filename.substr(end + 1);
    inside.erase(0, inside.find_first_not_of('/'));
  } else if (filename.starts_with(kFolder)) {
    inside = filename.substr(kFolder.size());
  }
  if (inside.empty() || is_expression(inside) || is_expression(package)) {
    why = "its name is an expression";
    return std::nullopt;
  }
  if (!package.empty()) {
    const auto found = in_package(folder, package, inside);
    if (!found) why = "no folder above is package '" + package + "' and has it";
    return found;
  }
  std::error_code missing;
  const fs::path found = (folder / inside).lexically_normal();
  if (fs::is_regular_file(found, missing)) return found;
  why = "there is no such file";
  return std::nullopt;
}

/// Reads files, each once.
class XacroReader {
 public:
  explicit XacroReader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void read(const std::string& file) {
    if (!known_.insert(canonical_path(file).value_or(file)).second) return;
    XacroFile read{file, read_text_file(file)};
    const UrdfText source(read.text, file);
    files_.push_back(std::move(read));
    for (const pugi::xml_node include : xacro_includes(source.robot())) {
      follow(source.place(include), file, include.attribute("filename").value(),
             std::string_view(include.attribute("optional").value()) == "true");
    }
  }

  [[nodiscard]] std::vector<XacroFile> take() { return std::move(files_); }

 private:
  void follow(const SourceLocation& place, const std::string& file, const std::string& filename,
              bool may_be_missing) {
    std::string why;
    const std::optional<fs::path> included = included_file(file, filename, why);
    if (included) {
      try {
        return read(included->string());
      } catch (const InputError& error) {
        why = error.what();
      }
    }
    if (may_be_missing && !included) return;
    diagnostics_.warning(place, "'" + filename + "' is included and not patched: " + why);
  }

  Diagnostics& diagnostics_;
  std::set<fs::path> known_;
  std::vector<XacroFile> files_;
};

}  // namespace
}  // namespace detail

std::vector<XacroFile> read_xacro_files(const std::string& file, Diagnostics& diagnostics) {
  detail::XacroReader reader(diagnostics);
  reader.read(file);
  return reader.take();
}

}  // namespace kinecal
