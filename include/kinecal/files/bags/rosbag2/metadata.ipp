// metadata.yaml of a ROS 2 bag, which lists the bag's files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"

namespace kinecal::detail {

struct Ros2Metadata {
  std::vector<std::string> files;  ///< as listed, in the order of recording
  std::string compression;         ///< "zstd", or empty
};

/// @throws InputError  "file:line: ..." if it cannot be read or is not a metadata.yaml
[[nodiscard]] inline Ros2Metadata read_ros2_metadata(const std::string& path) {
  constexpr std::uint64_t kMost = 1 << 24;
  constexpr const char* kTop = "rosbag2_bagfile_information";
  try {
    std::ifstream in = open_bytes(path);
    ByteFile file(in);
    if (file.size() > kMost) throw BytesError("has more bytes than the 16 MiB that it may have");
    std::vector<std::byte> buffer;
    const Bytes bytes = file.read(file.size(), buffer);
    const std::string text(ByteReader(bytes).text(bytes.size()));
    const std::vector<YamlNode> documents = parse_yaml(text, path);
    const YamlNode* bag = documents.empty() ? nullptr : documents.front().find(kTop);
    if (bag == nullptr || !bag->is_map())
      throw BytesError(std::string("has no map '") + kTop + "'");
    const YamlNode* paths = bag->find("relative_file_paths");
    if (paths == nullptr || !paths->is_list()) {
      throw BytesError("has no list 'relative_file_paths'");
    }
    Ros2Metadata metadata;
    const YamlNode* compression = bag->find("compression_format");
    if (compression != nullptr) metadata.compression = compression->text;
    for (const YamlNode& listed : paths->items) {
      if (!listed.is_scalar())
        throw InputError(SourceLocation{path, listed.line}.str() + ": is not the name of a file");
      metadata.files.push_back(listed.text);
    }
    return metadata;
  } catch (const BytesError& e) {
    throw InputError(path + ": " + e.what());
  }
}

}  // namespace kinecal::detail
