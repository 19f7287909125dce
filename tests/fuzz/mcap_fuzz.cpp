// Any bytes as an MCAP file: with what is wanted and without, nothing crashes, hangs or grows.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "kinecal/files/bags/mcap/read_mcap.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  std::size_t topics = 0;
  volatile std::uint64_t read = 0;  // so that the messages' bytes are looked at
  kinecal::BagReader reader;
  reader.wants = [&](const kinecal::BagTopic& topic) {
    return topics++ % 2 == 0 || topic.name.empty();
  };
  reader.handle = [&](const kinecal::BagMessage& message) {
    for (const std::byte byte : message.data) read = read + std::to_integer<std::uint64_t>(byte);
  };
  std::istringstream in(bytes);
  kinecal::Diagnostics diagnostics;
  kinecal::read_mcap(in, "fuzz.mcap", reader, diagnostics);
  return 0;
}
