// Feeds the reader of images with damaged files: PNG, JPEG, BMP and TIFF, by their first bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "kinecal/files/images/read_image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const kinecal::GrayImage image = kinecal::decode_image(bytes, "image");
    const auto pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (image.width <= 0 || image.height <= 0 || image.pixels.size() != pixels) std::abort();
  } catch (const kinecal::InputError&) {  // what is expected of most
  }
  return 0;
}
