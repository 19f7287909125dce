// Passes on the messages of an MCAP file, and reports errors in it.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/mcap/read_mcap.hpp"

#include <fstream>
#include <istream>
#include <optional>
#include <string>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/mcap/messages.ipp"

namespace kinecal {

void read_mcap(std::istream& in, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics) {
  std::optional<detail::ByteFile> file;
  std::optional<detail::McapMessages> messages;
  const auto advance = [&]() -> std::optional<BagMessage> {
    try {
      if (!messages) {
        file.emplace(in);
        file->show_progress(reader.meter, "reading " + name);
        messages.emplace(*file, reader, SourceLocation{name, 0}, diagnostics);
      }
      return messages->next();
    } catch (const detail::BytesError& e) {
      diagnostics.error({name, 0}, e.what());
      return std::nullopt;
    }
  };
  // Exceptions of the reader's functions are not errors of the file.
  while (const std::optional<BagMessage> message = advance()) reader.handle(*message);
}

void read_mcap(const std::string& path, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics) {
  std::ifstream in;
  try {
    in = detail::open_bytes(path);
  } catch (const detail::BytesError& e) {
    diagnostics.error({name, 0}, e.what());
    return;
  }
  read_mcap(in, name, reader, diagnostics);
}

void read_mcap(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  read_mcap(path, path, reader, diagnostics);
}

}  // namespace kinecal
