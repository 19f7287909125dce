// Any bytes as a ROS 1 bag: nothing crashes, hangs or grows, and two readings agree.
//
// Bags of the corpus have no padding after their bag header, so that they are small.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "kinecal/files/bags/ros1/read_bag.hpp"

namespace {

/// @param every  of how many topics one is wanted
/// @return       bytes of all messages that are handled, whatever they are
std::size_t read(const std::string& bag, int every) {
  std::istringstream in(bag);
  kinecal::Diagnostics diagnostics;
  std::size_t sum = 0;
  int asked = 0;
  const kinecal::BagReader reader{[&](const kinecal::BagTopic&) { return asked++ % every == 0; },
                                  [&](const kinecal::BagMessage& message) {
                                    for (const std::byte byte : message.data)
                                      sum += static_cast<std::size_t>(byte);
                                    sum += message.topic.name.size() +
                                           static_cast<std::size_t>(message.time >= 0);
                                  }};
  kinecal::read_ros1_bag(in, "fuzz.bag", reader, diagnostics);
  if (diagnostics.errors.size() > 21 || diagnostics.warnings.size() > 1) std::abort();
  return sum;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bag(reinterpret_cast<const char*>(data), size);
  const std::size_t all = read(bag, 1);
  if (read(bag, 1) != all) std::abort();
  (void)read(bag, 2);
  return 0;
}
