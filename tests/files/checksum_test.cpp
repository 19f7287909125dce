#include "kinecal/files/checksum.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(Checksum, IsThatOfThePublishedExamples) {
  // Source: FIPS 180-2, appendix B, and the digest of nothing.
  EXPECT_EQ(sha256_text(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_text("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_text(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Checksum, WritesBase64OfEachRemainder) {
  // Source: RFC 4648, 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Checksum, ReadsBase64WithLineEndsAndWithoutPadding) {
  for (const std::string bytes : {"", "f", "fo", "foo", "foob", "fooba", "foobar"}) {
    EXPECT_EQ(from_base64(base64(bytes)), bytes);
  }
  EXPECT_EQ(from_base64("Zg"), "f");
  EXPECT_EQ(from_base64("Zm9v\r\nYmFy\n"), "foobar");
  EXPECT_EQ(from_base64("/wD+"), std::string("\xff\x00\xfe", 3));
}

TEST(Checksum, RefusesWhatIsNotBase64) {
  for (const char* text :
       {"?", "Zm9vYm*y", "Zm9v-", "Zm9v----", "Zg ==", " Zm9v", "Zm9v    ", "Z"}) {
    EXPECT_EQ(from_base64(text), std::nullopt) << "'" << text << "'";
  }
}

}  // namespace
}  // namespace kinecal
