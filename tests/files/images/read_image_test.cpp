// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/images/read_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "kinecal/files/images/png_bytes.hpp"
#include "support/error_of.hpp"

#ifdef KINECAL_HAVE_JPEG
#include <cstdio>
#include <cstdlib>
// libjpeg's header needs FILE from before it.
#include <jpeglib.h>
#endif

namespace kinecal {
namespace {

using test::error_of;

GrayImage ramp() {
  GrayImage image(40, 30);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) image(u, v) = static_cast<std::uint8_t>(5 * u + v);
  }
  return image;
}

#ifdef KINECAL_HAVE_PNG
TEST(ReadImage, APngReadsBackExactly) {
  const GrayImage image = decode_image(detail::png_bytes(ramp()), "a.png");
  EXPECT_EQ(image.width, 40);
  EXPECT_EQ(image.height, 30);
  EXPECT_EQ(image.pixels, ramp().pixels);
}

TEST(ReadImage, SixteenBitsBecomeTheUpperEight) {
  Image<std::uint16_t> fine(2, 1);
  fine(0, 0) = 0x1234;
  fine(1, 0) = 0xfedc;
  const GrayImage image = decode_image(detail::png_bytes(fine), "a.png");
  EXPECT_EQ(image(0, 0), 0x12);
  EXPECT_EQ(image(1, 0), 0xfe);
}

TEST(ReadImage, DepthIsInMetresAndZeroWasNotMeasured) {
  Image<std::uint16_t> millimetres(2, 1);
  millimetres(0, 0) = 1234;
  const DepthImage depth = decode_depth(detail::png_bytes(millimetres), "d.png");
  EXPECT_FLOAT_EQ(depth(0, 0), 1.234F);
  EXPECT_TRUE(std::isnan(depth(1, 0)));
}

TEST(ReadImage, DepthOfEightBitsIsRefused) {
  EXPECT_NE(error_of([] {
              (void)decode_depth(detail::png_bytes(ramp()), "d.png");
            }).find("d.png: is not a grey PNG of 16 bits"),
            std::string::npos);
}

TEST(ReadImage, APngCutAnywhereIsAnErrorWithItsName) {
  const std::string bytes = detail::png_bytes(ramp());
  constexpr std::size_t kEndChunk = 12;  // has no pixels
  for (std::size_t size = 0; size < bytes.size() - kEndChunk; size += 7) {
    const std::string cut = bytes.substr(0, size);
    EXPECT_EQ(error_of([&] { (void)decode_image(cut, "a.png"); }).find("a.png: "), 0u) << size;
  }
}

TEST(ReadImage, AHeaderOfFarTooManyPixelsIsRefusedBeforeTheyAreStored) {
  std::string bytes = detail::png_bytes(ramp());
  // Width and height of the header become 2^30; its checksum is wrong then, too.
  bytes[16] = bytes[20] = 0x40;
  EXPECT_EQ(error_of([&] { (void)decode_image(bytes, "a.png"); }).find("a.png: "), 0u);
}
#endif

#ifdef KINECAL_HAVE_JPEG
std::string jpeg_bytes(GrayImage image) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width);
  jpeg.image_height = static_cast<JDIMENSION>(image.height);
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int v = 0; v < image.height; ++v) {
    JSAMPROW row = &image(0, v);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  jpeg_destroy_compress(&jpeg);
  std::free(data);
  return bytes;
}

TEST(ReadImage, AJpegReadsBackNearly) {
  const GrayImage image = decode_image(jpeg_bytes(ramp()), "a.jpg");
  ASSERT_EQ(image.pixels.size(), ramp().pixels.size());
  constexpr int kLoss = 4;  // of quality 95
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_NEAR(image.pixels[i], ramp().pixels[i], kLoss);
  }
}

TEST(ReadImage, AJpegCutAnywhereIsAnErrorWithItsName) {
  const std::string bytes = jpeg_bytes(ramp());
  for (std::size_t size = 0; size + 2 < bytes.size(); size += 5) {
    const std::string cut = bytes.substr(0, size);
    EXPECT_EQ(error_of([&] { (void)decode_image(cut, "a.jpg"); }).find("a.jpg: "), 0u) << size;
  }
}
#endif

TEST(ReadImage, OtherFormatsAreNamedAsSuch) {
  EXPECT_EQ(error_of([] { (void)decode_image("BM123", "a.bmp"); }),
            "a.bmp: is neither a PNG nor a JPEG; convert the image to one of them");
}

}  // namespace
}  // namespace kinecal
