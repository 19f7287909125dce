// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/point_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <tuple>

#include "kinecal/files/bags/bytes.hpp"
#include "support/error_of.hpp"

namespace kinecal::detail {
namespace {

using test::error_of;
using testing::HasSubstr;

constexpr const char* kTable = "x,y,z,i\n0.25,-1.5,3,7\n1,2,-4,255\n";

/// The points of kTable, four bytes a number, in either order.
std::string binary(bool is_big) {
  std::string bytes;
  const auto add = [&](float number, unsigned char i, bool ends) {
    std::string four;
    append_number(four, std::bit_cast<std::uint32_t>(number));
    if (is_big) std::reverse(four.begin(), four.end());
    bytes += four;
    if (ends) bytes += static_cast<char>(i);
  };
  for (const auto& [x, y, z, i] : {std::tuple{0.25F, -1.5F, 3.0F, 7}, {1.0F, 2.0F, -4.0F, 255}}) {
    add(x, 0, false);
    add(y, 0, false);
    add(z, static_cast<unsigned char>(i), true);
  }
  return bytes;
}

std::string ply(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float32 z\nproperty uchar i\nelement face 0\n"
         "property list uchar int vertex_index\nend_header\n";
}

std::string pcd(const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 1\n"
         "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
         "DATA " +
         data + "\n";
}

TEST(PointFile, ReadsPlyAndPcdAsTables) {
  const std::string text = "0.25 -1.5 3 7\n1 2 -4 255\n";
  EXPECT_EQ(point_file_table(ply("ascii") + text, "a.ply"), kTable);
  EXPECT_EQ(point_file_table(ply("binary_little_endian") + binary(false), "a.ply"), kTable);
  EXPECT_EQ(point_file_table(ply("binary_big_endian") + binary(true), "a.ply"), kTable);
  EXPECT_EQ(point_file_table(pcd("ascii") + text, "a.pcd"), kTable);
  EXPECT_EQ(point_file_table(pcd("binary") + binary(false), "a.pcd"), kTable);
  EXPECT_FALSE(point_file_table("x,y,z\n1,2,3\n", "a.csv"));
}

TEST(PointFile, RefusesWhatIsDamagedOrCompressed) {
  const auto error = [](const std::string& content) {
    return error_of([&] { (void)point_file_table(content, "a.ply"); });
  };
  EXPECT_THAT(error(ply("ascii") + "1 2 3 4\n1 2"), HasSubstr("a.ply: it ends at point 2 of 2"));
  EXPECT_THAT(error(ply("binary_little_endian") + "abc"), HasSubstr("is it cut off?"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 2\n"), HasSubstr("header does not end"));
  EXPECT_THAT(error(pcd("binary_compressed")), HasSubstr("save it as binary or ascii"));
  EXPECT_THAT(error("ply\nelement face 1\nend_header\n"), HasSubstr("'vertex', must be first"));
}

/// A header that promises more than there is takes no memory.
TEST(PointFile, RefusesPointsWithoutNumbers) {
  const auto error = [](const std::string& content) {
    return error_of([&] { (void)point_file_table(content, "a.ply"); });
  };
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 999999999999\nend_header\n"),
              HasSubstr("a.ply: its points have no field of one number"));
  EXPECT_THAT(error("VERSION 0.7\nFIELDS x\nSIZE 4\nTYPE F\nCOUNT 0\nPOINTS 999999999999\n"
                    "DATA ascii\n"),
              HasSubstr("its points have no field of one number"));
}

TEST(PointFile, RefusesNumbersThatItDoesNotKnow) {
  const auto error = [](std::string content, const std::string& from, const std::string& to) {
    content.replace(content.find(from), from.size(), to);
    return error_of([&] { (void)point_file_table(content, "a.ply"); });
  };
  EXPECT_THAT(error(ply("ascii"), "property uchar i", "property list uchar int near"),
              HasSubstr("property 'near' of vertex is a list, which is not read"));
  EXPECT_THAT(error(ply("binary_middle_endian"), "x", "x"),
              HasSubstr("its format is 'binary_middle_endian', which is not read"));
  EXPECT_THAT(error(pcd("binary"), "TYPE F", "TYPE C"), HasSubstr("has the TYPE 'C'"));
  EXPECT_THAT(error(pcd("binary"), "SIZE 4", "SIZE 2"),
              HasSubstr("its field 'x' has floating-point numbers of 2 bytes"));
  EXPECT_THAT(error(pcd("binary"), "SIZE 4", "SIZE 0"), HasSubstr("numbers of 0 bytes"));
}

}  // namespace
}  // namespace kinecal::detail
