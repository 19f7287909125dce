// Definitions of xacro_left.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/xacro_left.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "kinecal/files/urdf/urdf_places.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal::detail {

std::string xacro_command(const std::string& file) {
  std::filesystem::path stem = std::filesystem::path(file).filename();
  if (!stem.has_extension()) return {};
  while (stem.has_extension()) stem = stem.stem();  // robot.urdf.xacro
  std::string expanded = stem.string() + "_expanded.urdf";
  std::error_code failed;
  for (int n = 2; std::filesystem::exists(expanded, failed); ++n) {
    expanded = fmt::format("{}_expanded_{}.urdf", stem.string(), n);
  }
  return ShellCommand{"xacro", shell_file(file)}.str() + " > " + shell_word(shell_file(expanded));
}

/// Error: remnants that may hold a part of the robot.
inline void report_missing(const std::string& file, const std::vector<XacroLeft>& remnants,
                           Diagnostics& diagnostics) {
  const auto missing = [](const XacroLeft& remnant) { return !remnant.is_inert; };
  const auto first = std::find_if(remnants.begin(), remnants.end(), missing);
  if (first == remnants.end()) return;
  const auto count = std::count_if(remnants.begin(), remnants.end(), missing);
  const std::string command = xacro_command(file);
  diagnostics.error(
      first->place,
      fmt::format(
          "{} is xacro that was not expanded{}; links, joints or numbers of the robot may be "
          "missing; "
          "{}{}",
          first->text, count == 1 ? "" : fmt::format(", and so are {} more places", count - 1),
          command.empty() ? "expand its file with xacro into another file" : "run: " + command,
          first->text.starts_with('<') ? ", or remove it if the robot is complete without it"
                                       : ""));
}

/// Warning: remnants that nothing depends on.
inline void report_inert(const std::vector<XacroLeft>& remnants, Diagnostics& diagnostics) {
  constexpr std::size_t kMost = 5;  // number to list
  std::vector<XacroLeft> inert;
  std::copy_if(remnants.begin(), remnants.end(), std::back_inserter(inert),
               [](const XacroLeft& remnant) { return remnant.is_inert; });
  if (inert.empty()) return;
  std::string others;
  for (std::size_t i = 1; i < std::min(inert.size(), kMost); ++i) {
    others += fmt::format(", {} in line {}", inert[i].text, inert[i].place.line);
  }
  if (inert.size() > kMost) others += fmt::format(" and {} more", inert.size() - kMost);
  diagnostics.warning(inert[0].place,
                      fmt::format("xacro left {}{}; ignored, for no link or joint depends on {}",
                                  inert[0].text, others, inert.size() == 1 ? "it" : "them"));
}

void check_xacro(const std::string& text, const std::string& name_for_messages,
                 Diagnostics& diagnostics) {
  const std::vector<XacroLeft> left = UrdfPlaces(text, name_for_messages).xacro_left();
  report_missing(name_for_messages, left, diagnostics);
  report_inert(left, diagnostics);
}

}  // namespace kinecal::detail
