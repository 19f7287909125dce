// Feeds decode() with bytes that are not messages, and parse_definition() with texts that are not
// definitions.
//
// The first byte selects a message of ROS 1, one in CDR, or a definition and a message of it with a
// NUL between.  What can be decoded is encoded, decoded and encoded: the bytes must be the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/encode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/recordings/message_samples.ipp"

namespace {

using namespace kinecal;

void decode_all(const detail::MessageDefinition& definition, Encoding encoding, Bytes bytes,
                bool samples) {
  try {
    const MessageFields message = detail::decode(definition, encoding, bytes);
    const std::vector<std::byte> once = detail::encode(message, definition, encoding);
    const std::vector<std::byte> twice =
        detail::encode(detail::decode(definition, encoding, once), definition, encoding);
    if (once != twice) std::abort();
    if (!samples) return;
    detail::MessageSamples read("fuzz.bag");
    read.add(message, 1);
    Diagnostics diagnostics;
    if (read.take(diagnostics).empty() && diagnostics.errors.empty()) std::abort();
  } catch (const detail::BytesError&) {  // what is expected of most
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string type = "robot_calibration_msgs/CalibrationData";
  const Bytes bytes = std::as_bytes(std::span(data + 1, size - 1));
  const int kind = data[0] % 3;
  if (kind < 2) {
    const Encoding encoding = kind == 0 ? Encoding::ros1 : Encoding::cdr;
    decode_all(detail::parse_definition(type, detail::known_definition(type, encoding)), encoding,
               bytes, true);
    return 0;
  }
  const std::string all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t end = std::min(all.find('\0'), all.size());
  try {
    const detail::MessageDefinition definition =
        detail::parse_definition("a/Type", all.substr(0, end));
    decode_all(definition, Encoding::cdr, bytes.subspan(std::min(end + 1, bytes.size())), false);
  } catch (const detail::DefinitionError&) {  // what is expected of most
  }
  return 0;
}
