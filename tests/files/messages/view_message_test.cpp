// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/view_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "kinecal/files/images/png_bytes.hpp"
#include "kinecal/files/messages/make.hpp"
#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// An Image message; it views its data.
MessageFields image(const std::string& encoding, std::int64_t width, std::int64_t height,
                    std::int64_t step, const std::string& data, std::int64_t big_endian = 0) {
  return fields("height", height, "width", width, "encoding", std::string_view(encoding),
                "is_bigendian", big_endian, "step", step, "data", as_bytes(data));
}

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes.push_back(static_cast<char>(value));
  return bytes;
}

GrayImage gray(const std::string& encoding, int width, std::initializer_list<int> values,
               int big_endian = 0) {
  const std::string data = bytes_of(values);
  return gray_image(
      image(encoding, width, 1, static_cast<std::int64_t>(data.size()), data, big_endian));
}

TEST(ViewMessage, ColoursBecomeBrightnessInTheOrderOfTheEncoding) {
  EXPECT_THAT(gray("rgb8", 2, {255, 0, 0, 0, 0, 255}).pixels, ElementsAre(76, 29));
  EXPECT_THAT(gray("bgr8", 2, {255, 0, 0, 0, 0, 255}).pixels, ElementsAre(29, 76));
  EXPECT_THAT(gray("rgba8", 1, {0, 255, 0, 9}).pixels, ElementsAre(150));
  EXPECT_THAT(gray("bgra8", 1, {255, 0, 0, 9}).pixels, ElementsAre(29));
}

TEST(ViewMessage, OfYuvOnlyBrightnessIsRead) {
  for (const char* name : {"yuv422", "uyvy"}) {
    EXPECT_THAT(gray(name, 2, {128, 10, 127, 20}).pixels, ElementsAre(10, 20)) << name;
  }
  for (const char* name : {"yuv422_yuy2", "yuyv"}) {
    EXPECT_THAT(gray(name, 2, {10, 128, 20, 127}).pixels, ElementsAre(10, 20)) << name;
  }
  const std::string planes = bytes_of({10, 20, 30, 40, 128, 127});
  EXPECT_THAT(gray_image(image("nv12", 2, 2, 2, planes)).pixels, ElementsAre(10, 20, 30, 40));
}

TEST(ViewMessage, SixteenBitsAreReadInEitherOrderOfBytes) {
  EXPECT_THAT(gray("mono16", 2, {1, 255, 2, 128}).pixels, ElementsAre(255, 128));
  EXPECT_THAT(gray("mono16", 2, {255, 1, 128, 2}, 1).pixels, ElementsAre(255, 128));
  EXPECT_THAT(gray("rgb16", 1, {0, 255, 0, 0, 0, 0}).pixels, ElementsAre(76));
  EXPECT_THAT(gray("rgba16", 1, {0, 0, 0, 255, 0, 0, 0, 0}).pixels, ElementsAre(149));
}

TEST(ViewMessage, ACameraOfTwelveBitsIsNotDark) {
  // 4095 and 2048
  EXPECT_THAT(gray("mono16", 2, {255, 15, 0, 8}).pixels, ElementsAre(255, 128));
}

/// A scene of one colour through a mosaic.
std::string mosaic(const std::string& pattern, int size, int red, int green, int blue) {
  std::string data;
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) {
      const char c = pattern[static_cast<std::size_t>(2 * (v % 2) + u % 2)];
      data.push_back(static_cast<char>(c == 'r' ? red : c == 'g' ? green : blue));
    }
  }
  return data;
}

TEST(ViewMessage, AMosaicOfOneColourIsOneBrightness) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    const std::string data = mosaic(pattern, 6, 200, 100, 40);
    const GrayImage seen = gray_image(image("bayer_" + pattern + "8", 6, 6, 6, data));
    EXPECT_THAT(seen.pixels, testing::Each(110)) << pattern;  // 50 + 50 + 10
    std::string wide;
    for (const char c : data) wide += {'\0', c};
    EXPECT_THAT(gray_image(image("bayer_" + pattern + "16", 6, 6, 12, wide)).pixels,
                testing::Each(110))
        << pattern;
  }
}

TEST(ViewMessage, AMosaicDoesNotShiftAnEdge) {
  std::string data;  // bright from column 4 on: the edge is at 3.5
  for (int i = 0; i < 64; ++i) data.push_back(static_cast<char>(i % 8 < 4 ? 0 : 200));
  const GrayImage seen = gray_image(image("bayer_rggb8", 8, 8, 8, data));
  for (int v = 0; v < 8; ++v) {
    EXPECT_EQ(seen(3, v) + seen(4, v), 200) << v;
    EXPECT_EQ(seen(2, v), 0) << v;
    EXPECT_EQ(seen(5, v), 200) << v;
  }
}

TEST(ViewMessage, UnknownEncodingsAndShortDataAreErrors) {
  EXPECT_THAT(test::error_of([] { (void)gray("32FC3", 1, {0}); }), HasSubstr("'32FC3'"));
  EXPECT_THAT(test::error_of([] { (void)gray("bayer_rggb12", 1, {0}); }),
              HasSubstr("not supported"));
  EXPECT_THAT(test::error_of([] { (void)gray("rgb8", 2, {1, 2, 3}); }), HasSubstr("does not fit"));
}

TEST(ViewMessage, DepthIsInMetres) {
  const std::string millimetres = bytes_of({0xe8, 3, 0, 0});
  const DepthImage depth = depth_image(image("16UC1", 2, 1, 4, millimetres));
  EXPECT_FLOAT_EQ(depth(0, 0), 1.0F);
  EXPECT_TRUE(std::isnan(depth(1, 0)));
}

/// A message of compressedDepth by RVL: settings, size, then words of eight groups.
DepthImage rvl(const std::string& format, int width, int height,
               const std::vector<std::uint32_t>& words, float a = 0.0F, float b = 0.0F) {
  const std::uint32_t size[] = {static_cast<std::uint32_t>(width),
                                static_cast<std::uint32_t>(height)};
  const float settings[] = {0.0F, a, b};
  std::string data(sizeof settings + sizeof size + 4 * words.size(), '\0');
  std::memcpy(data.data(), settings, sizeof settings);
  std::memcpy(data.data() + sizeof settings, size, sizeof size);
  std::memcpy(data.data() + sizeof settings + sizeof size, words.data(), 4 * words.size());
  return depth_image(fields("format", std::string_view(format), "data", as_bytes(data)));
}

TEST(ViewMessage, RunsOfDepthAreRead) {
  // 1 without; 2 with: 1000 is 2000 by sign, 0 2 7 3 in octal; then 3 less, which is 5; 1 without, 0
  // with.
  const std::string of = "16UC1; compressedDepth rvl";
  const DepthImage depth = rvl(of, 2, 2, {0x12'8A'F3'51, 0x00'00'00'00});
  EXPECT_TRUE(std::isnan(depth(0, 0)));
  EXPECT_FLOAT_EQ(depth(1, 0), 1.0F);
  EXPECT_FLOAT_EQ(depth(0, 1), 0.997F);
  EXPECT_TRUE(std::isnan(depth(1, 1)));
  const DepthImage inverse =
      rvl("32FC1; compressedDepth rvl", 2, 2, {0x12'8A'F3'51, 0}, 1000.0F, 0.0F);
  EXPECT_FLOAT_EQ(inverse(1, 0), 1.0F);
  EXPECT_FLOAT_EQ(inverse(0, 1), 1000.0F / 997.0F);
  EXPECT_TRUE(std::isnan(rvl(of, 1, 1, {0x01000000})(0, 0))) << "a depth of zero is none";
  EXPECT_THAT(test::error_of([&] { (void)rvl(of, 2, 2, {0x128AF351}); }), testing::Not(""));
  EXPECT_THAT(test::error_of([&] { (void)rvl(of, 1, 1, {0x12000000}); }),
              HasSubstr("does not fit"));
  EXPECT_THAT(test::error_of([&] { (void)rvl(of, 1, 1, {0}); }), HasSubstr("does not fit"));
  EXPECT_THAT(test::error_of([&] {
                (void)rvl(of, 1, 1, {0xFFFFFFFF, 0xFFFFFFFF});
              }),
              HasSubstr("32 bits"));
  EXPECT_THAT(test::error_of([&] { (void)rvl(of, -1, 1, {0}); }), HasSubstr("4294967295 x 1"));
}

#ifdef KINECAL_HAVE_PNG
TEST(ViewMessage, CompressedDepthOfMetresIsAnInverse) {
  Image<std::uint16_t> inverse(3, 1);
  inverse.pixels = {1010, 510, 0};
  const float settings[] = {0.0F, 1000.0F, 10.0F};  // pixel = 1000 / z + 10
  std::string file(sizeof settings, '\0');
  std::memcpy(file.data(), settings, sizeof settings);
  file += png_bytes(inverse);
  const DepthImage depth = depth_image(
      fields("format", std::string_view("32FC1; compressedDepth png"), "data", as_bytes(file)));
  EXPECT_FLOAT_EQ(depth(0, 0), 1.0F);
  EXPECT_FLOAT_EQ(depth(1, 0), 2.0F);
  EXPECT_TRUE(std::isnan(depth(2, 0)));
  const auto cut = [&] {
    (void)depth_image(fields("format", std::string_view("16UC1; compressedDepth"), "data",
                             as_bytes(std::string_view("abc"))));
  };
  EXPECT_THAT(test::error_of(cut), testing::Not(""));
}
#endif

TEST(ViewMessage, VideoIsNamed) {
  const auto video = [] {
    (void)gray_image(fields("format", std::string_view("h264"), "data",
                            as_bytes(std::string_view("\0\0\0\1", 4))));
  };
  EXPECT_THAT(test::error_of(video), testing::HasSubstr("its images are video, 'h264'"));
}

TEST(ViewMessage, CloudsOfDoublesAreReadAsThoseOfFloats) {
  const auto cloud_of = [](std::int64_t type, auto number, std::int64_t width) {
    constexpr std::size_t kBytes = sizeof(number);
    MessageValue::List xyz;
    std::int64_t offset = 0;
    for (const std::string_view name : {"x", "y", "z"}) {
      xyz.emplace_back(fields("name", name, "offset", offset, "datatype", type));
      offset += static_cast<std::int64_t>(kBytes);
    }
    std::string data;
    for (int i = 0; i < 3 * width; ++i) {
      const decltype(number) value = static_cast<decltype(number)>(0.25 * i);
      data.append(reinterpret_cast<const char*>(&value), kBytes);
    }
    PointCloud points;
    GrayImage none;
    read_cloud(fields("height", std::int64_t{1}, "width", width, "fields", xyz, "is_bigendian",
                      std::int64_t{0}, "point_step", offset, "row_step", offset * width, "data",
                      as_bytes(data)),
               points, none);
    return points;
  };
  for (const PointCloud& points : {cloud_of(7, 0.0F, 2), cloud_of(8, 0.0, 2)}) {
    ASSERT_EQ(points.width, 2);
    EXPECT_EQ(points(0, 0), Eigen::Vector3f(0.0F, 0.25F, 0.5F));
    EXPECT_EQ(points(1, 0), Eigen::Vector3f(0.75F, 1.0F, 1.25F));
  }
  EXPECT_EQ(cloud_of(7, 0.0F, 640 * 480).width, 640 * 480);  // a list, as drivers send it
  EXPECT_THAT(test::error_of([&] { (void)cloud_of(5, 0, 2); }), HasSubstr("float32 or float64"));
}

}  // namespace
}  // namespace kinecal::detail
