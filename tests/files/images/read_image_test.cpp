// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/images/read_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iterator>
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
TEST(ReadImage, WebPIsNamed) {
  const std::string bytes = std::string("RIFF\x1a\0\0\0WEBPVP8L", 16) + std::string(20, 'x');
  EXPECT_NE(error_of([&] { (void)decode_image(bytes, "a.webp"); }).find("a.webp: is WebP"),
            std::string::npos);
}

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

/// Appends a number, its lowest byte first.
void append_number(std::string& to, std::uint32_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(static_cast<char>(number >> (8 * i)));
}

struct BmpKind {
  int bits = 24;
  bool top_down = false;
  std::uint32_t compression = 0;
  std::uint32_t header = 40;
  std::uint32_t colours = 0;  ///< of the palette; 0: 256
};

/// A BMP of an image in which blue is the brightness, green its half and red 255 less it; of 8 bits, the
/// palette is of grey levels from white down.
std::string bmp_bytes(const GrayImage& image, const BmpKind& kind) {
  const std::uint32_t masks = kind.compression == 3 && kind.header == 40 ? 12 : 0,
                      palette = kind.bits == 8 ? 4 * (kind.colours == 0 ? 256 : kind.colours) : 0,
                      offset = 14 + kind.header + masks + palette;
  std::string file = "BM";
  append_number(file, 0, 4);  // the size, which nobody reads
  append_number(file, 0, 4);
  append_number(file, offset, 4);
  append_number(file, kind.header, 4);
  append_number(file, static_cast<std::uint32_t>(image.width), 4);
  append_number(file, static_cast<std::uint32_t>(kind.top_down ? -image.height : image.height), 4);
  append_number(file, 1, 2);
  append_number(file, static_cast<std::uint32_t>(kind.bits), 2);
  append_number(file, kind.compression, 4);
  for (int i = 0; i < 3; ++i) append_number(file, 0, 4);
  append_number(file, kind.colours, 4);
  append_number(file, 0, 4);
  if (kind.compression == 3) {
    for (const std::uint32_t mask : {0xff0000U, 0xff00U, 0xffU}) append_number(file, mask, 4);
  }
  if (kind.header > 40) file.resize(14 + kind.header);
  for (std::uint32_t i = 0; i < palette / 4; ++i) append_number(file, (255 - i) * 0x010101U, 4);
  for (int row = 0; row < image.height; ++row) {
    const int v = kind.top_down ? row : image.height - 1 - row;
    std::string line;
    for (int u = 0; u < image.width; ++u) {
      const std::uint8_t value = image(u, v);
      if (kind.bits == 8) {
        append_number(line, 255U - value, 1);
        continue;
      }
      append_number(line, value, 1);
      append_number(line, value / 2U, 1);
      append_number(line, 255U - value, 1);
      if (kind.bits == 32) append_number(line, 7, 1);
    }
    while (line.size() % 4 != 0) line.push_back('x');
    file += line;
  }
  return file;
}

/// An odd width, so that rows are padded.
GrayImage odd_ramp() {
  GrayImage image(13, 5);
  for (int v = 0; v < 5; ++v) {
    for (int u = 0; u < 13; ++u) image(u, v) = static_cast<std::uint8_t>(10 + 13 * u + 20 * v);
  }
  return image;
}

TEST(ReadImage, ABmpReadsBackBottomUpAndTopDown) {
  for (const bool top_down : {false, true}) {
    for (const BmpKind& kind : {BmpKind{8, top_down}, BmpKind{24, top_down}, BmpKind{32, top_down},
                                BmpKind{32, top_down, 3}, BmpKind{32, top_down, 3, 124},
                                BmpKind{24, top_down, 0, 108}, BmpKind{8, top_down, 0, 124, 250}}) {
      GrayImage truth = odd_ramp();
      const GrayImage image = decode_image(bmp_bytes(truth, kind), "a.bmp");
      ASSERT_EQ(image.width, 13);
      ASSERT_EQ(image.height, 5);
      for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
        const double blue = truth.pixels[i], green = truth.pixels[i] / 2, red = 255 - blue;
        const double level = kind.bits == 8 ? blue : 0.299 * red + 0.587 * green + 0.114 * blue;
        EXPECT_NEAR(image.pixels[i], level, 0.51) << kind.bits << " bits, pixel " << i;
      }
    }
  }
}

TEST(ReadImage, ABmpCutAnywhereIsAnErrorWithItsName) {
  for (const BmpKind& kind : {BmpKind{8}, BmpKind{24, true}, BmpKind{32, false, 3}}) {
    const std::string bytes = bmp_bytes(odd_ramp(), kind);
    for (std::size_t size = 2; size < bytes.size(); ++size) {
      const std::string cut = bytes.substr(0, size);
      EXPECT_EQ(error_of([&] { (void)decode_image(cut, "a.bmp"); }),
                "a.bmp: the BMP is damaged: it ends early")
          << size;
    }
  }
}

TEST(ReadImage, HostileNumbersInABmpAreErrors) {
  const std::string bytes = bmp_bytes(odd_ramp(), BmpKind{8});
  const auto with = [&](std::size_t at, std::uint32_t number, int count) {
    std::string file = bytes, put;
    append_number(put, number, count);
    file.replace(at, put.size(), put);
    return error_of([&] { (void)decode_image(file, "a.bmp"); });
  };
  EXPECT_NE(with(18, 0xffffffffU, 4).find("its width is negative"), std::string::npos);
  EXPECT_NE(with(18, 0, 4).find("0x5 pixels"), std::string::npos);
  EXPECT_NE(with(22, 0x80000000U, 4).find("at most 100 megapixels"), std::string::npos);
  EXPECT_NE(with(18, 0x7fffffffU, 4).find("at most 100 megapixels"), std::string::npos);
  EXPECT_NE(with(28, 4, 2).find("is a BMP of 4 bits, which is not read"), std::string::npos);
  EXPECT_NE(with(30, 1, 4).find("with compression"), std::string::npos);
  EXPECT_NE(with(46, 257, 4).find("palette has 257 colours"), std::string::npos);
  EXPECT_NE(with(46, 3, 4).find("that its palette lacks"), std::string::npos);
  EXPECT_NE(with(10, 20, 4).find("its pixels are in its header"), std::string::npos);
  EXPECT_NE(with(10, 0xfffffff0U, 4).find("it ends early"), std::string::npos);
  EXPECT_NE(with(14, 0xfffffff0U, 4).find("a.bmp: "), std::string::npos);
  EXPECT_NE(with(14, 12, 4).find("before Windows 3"), std::string::npos);
}

/// A TIFF of one strip, lowest bytes first, and so many bits a pixel.
std::string tiff_bytes(const GrayImage& image, std::uint32_t bits, std::uint32_t samples = 1) {
  const std::uint32_t width = static_cast<std::uint32_t>(image.width),
                      height = static_cast<std::uint32_t>(image.height),
                      size = width * height * samples * bits / 8;
  std::string pixels;
  for (const std::uint8_t value : image.pixels) {
    for (std::uint32_t k = 0; k < samples; ++k) {
      append_number(pixels, bits == 16 ? value * 256U + 77U : value, static_cast<int>(bits / 8));
    }
  }
  std::string file = "II*";
  file.push_back('\0');
  append_number(file, 8 + size, 4);
  file += pixels;
  const std::uint32_t entries[][3] = {// tag, type (3: 2 bytes, 4: 4 bytes), value
                                      {256, 4, width},
                                      {257, 4, height},
                                      {258, 3, bits},
                                      {259, 3, 1},
                                      {262, 3, samples == 3 ? 2U : 1U},
                                      {273, 4, 8},
                                      {277, 3, samples},
                                      {278, 4, height},
                                      {279, 4, size}};
  append_number(file, std::size(entries), 2);
  for (const auto& entry : entries) {
    append_number(file, entry[0], 2);
    append_number(file, entry[1], 2);
    append_number(file, 1, 4);
    append_number(file, entry[2], 4);
  }
  append_number(file, 0, 4);
  return file;
}

#ifdef KINECAL_HAVE_TIFF
TEST(ReadImage, ATiffReadsBackExactlyAndOfSixteenBitsTheUpperEight) {
  for (const std::uint32_t bits : {8U, 16U}) {
    const GrayImage image = decode_image(tiff_bytes(ramp(), bits), "a.tif");
    EXPECT_EQ(image.width, 40);
    EXPECT_EQ(image.height, 30);
    EXPECT_EQ(image.pixels, ramp().pixels) << bits << " bits";
  }
  EXPECT_EQ(decode_image(tiff_bytes(ramp(), 8, 3), "a.tif").pixels, ramp().pixels);
}

TEST(ReadImage, ADamagedTiffIsAnErrorWithItsName) {
  const std::string bytes = tiff_bytes(ramp(), 8);
  for (std::size_t size = 4; size + 4 < bytes.size(); size += 7) {
    const std::string cut = bytes.substr(0, size);
    EXPECT_EQ(error_of([&] { (void)decode_image(cut, "a.tif"); }).find("a.tif: the TIFF is"), 0u)
        << size;
  }
  std::string large = bytes;
  const std::size_t width = 8 + ramp().pixels.size() + 2 + 8;  // the value of the first entry
  large.replace(width, 4, "\x7f\x7f\x7f\x7f");
  EXPECT_NE(error_of([&] { (void)decode_image(large, "a.tif"); }).find("at most 100 megapixels"),
            std::string::npos);
  large.replace(width, 4, std::string("\0\0\x20\0", 4));  // 2 097 152 x 30 pixels
  EXPECT_NE(
      error_of([&] { (void)decode_image(large, "a.tif"); }).find("too few bytes for its pixels"),
      std::string::npos);
}
#else
TEST(ReadImage, ATiffNamesTheMissingLibrary) {
  EXPECT_NE(
      error_of([] { (void)decode_image(tiff_bytes(ramp(), 8), "a.tif"); }).find("libtiff-dev"),
      std::string::npos);
}
#endif

TEST(ReadImage, OtherFormatsAreNamedAsSuch) {
  EXPECT_EQ(error_of([] { (void)decode_image("GIF89a", "a.gif"); }),
            "a.gif: is not a PNG, JPEG, BMP or TIFF; convert the image to one of them");
}

}  // namespace
}  // namespace kinecal
