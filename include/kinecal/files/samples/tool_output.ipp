// Lines that ROS tools print among the messages of a topic in YAML.
//
// ros2 topic echo    A message was lost!!!, with two lines of counts
// rostopic echo      WARNING: no messages received and simulated time is active. / Is /clock being
//                    published?
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/samples/sample_camera.ipp"
#include "kinecal/files/yaml/yaml_pieces.ipp"

namespace kinecal::detail {

/// Blanks the output of a tool in a piece of a file, so that the rest is readable.
/// @return  an error for each output
[[nodiscard]] inline std::vector<SampleErrors::Message> take_tool_output(YamlPiece& piece) {
  struct Output {
    std::string_view begin;
    int lines;
  };
  constexpr Output kOutputs[] = {{"A message was lost!!!", 3},
                                 {"WARNING: no messages received and simulated time", 2}};
  std::string& text = piece.text;
  std::vector<SampleErrors::Message> errors;
  for (const auto& [begin, lines] : kOutputs) {
    for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos; ++at) {
      if (at > 0 && text[at - 1] != '\n') continue;
      const auto line = piece.line + static_cast<int>(std::count(&text[0], &text[at], '\n'));
      errors.push_back({line, fmt::format("lines {} to {} are output of the tool that recorded the "
                                          "file; delete them",
                                          line, line + lines - 1)});
      for (int left = lines; at < text.size() && left > 0; ++at) {
        if (text[at] == '\n') --left;
        if (text[at] != '\n') text[at] = ' ';
      }
      --at;  // the next output may follow at once
    }
  }
  return errors;
}

/// Adds the errors of a tool's output in line order.
inline void add_in_order(SampleErrors& all, std::vector<SampleErrors::Message> outputs) {
  for (SampleErrors::Message& output : outputs) {
    const auto is_later = [&](const SampleErrors::Message& m) { return m.line > output.line; };
    auto place = std::find_if(all.errors.begin(), all.errors.end(), is_later);
    all.errors.insert(place, std::move(output));
  }
}

/// True if a line from this one on begins with `---`: then the document there is not the last one.
[[nodiscard]] inline bool has_marker_from(const YamlPiece& piece, int line) {
  const std::string& text = piece.text;
  std::size_t at = 0;
  for (int before = piece.line; before < line && at < text.size(); ++before) {
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
  for (; (at = text.find("---", at)) != std::string::npos; ++at) {
    if ((at == 0 || text[at - 1] == '\n') && is_yaml_marker(text, at)) return true;
  }
  return false;
}

}  // namespace kinecal::detail
