#include "kinecal/files/bags/ros1/read_bag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/files/bags/ros1/record_text.ipp"
#include "kinecal/files/bags/ros1/records.ipp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/ros1_bags.hpp"

namespace kinecal {
namespace {

using detail::Ros1Op;
using detail::Ros1Text;
using test::bag_of;
using test::BagContents;
using test::compressions_of_ros1;
using test::Recorded;
using test::some_messages;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr std::size_t kFirstRecord = 13 + 4 + 4096 + 4;  ///< after the bag header

std::string bag_header(std::uint64_t index_place, std::uint32_t connections, std::uint32_t chunks,
                       const std::string& encryptor = "") {
  Ros1Text header;
  header.number("chunk_count", chunks).number("conn_count", connections);
  if (!encryptor.empty()) header.field("encryptor", encryptor);
  header.number("index_pos", index_place).op(Ros1Op::bag);
  return std::string(detail::kRos1Magic) +
         detail::ros1_record(header, std::string(4096 - header.text().size(), ' '));
}

std::string connection(std::uint32_t number, const std::string& topic, const std::string& type) {
  Ros1Text header, data;
  header.number("conn", number).op(Ros1Op::connection).field("topic", topic);
  data.field("type", type);
  return detail::ros1_record(header, data.text());
}

std::string of_connection(std::uint32_t connection, std::uint32_t seconds,
                          const std::string& data) {
  Ros1Text header;
  header.number("conn", connection).op(Ros1Op::message);
  header.number("time", std::uint64_t{seconds});
  return detail::ros1_record(header, data);
}

std::string chunk(const std::string& compression, std::uint32_t size, const std::string& data) {
  Ros1Text header;
  header.field("compression", compression).op(Ros1Op::chunk).number("size", size);
  return detail::ros1_record(header, data);
}

std::string open_bag(const std::string& records) {
  return bag_header(0, 0, 0) + records;
}

/// A bag without its index, like an interrupted recording.
std::string without_index(std::string bag) {
  const std::size_t place = bag.find("index_pos=") + 10;
  return bag.replace(place, 8, 8, '\0');
}

/// Where chunks and the indices after them end, and how many messages stand before that.
std::vector<std::pair<std::size_t, std::size_t>> ends_of_chunks(const std::string& bag) {
  std::vector<std::pair<std::size_t, std::size_t>> ends;
  detail::ByteReader reader(std::as_bytes(std::span(bag)));
  reader.skip(13);
  std::size_t end = 0, count = 0;
  while (!reader.at_end()) {
    const detail::Ros1Record record = detail::next_ros1_record(reader);
    if (record.fields.op() == Ros1Op::chunk) end = reader.read();
    if (record.fields.op() != Ros1Op::index) continue;
    count += record.fields.number<std::uint32_t>("count");
    if (!ends.empty() && ends.back().first == end) ends.pop_back();
    ends.emplace_back(end, count);
  }
  return ends;
}

TEST(Ros1Bag, WhatIsNotWantedIsLeftOut) {
  const std::vector<Recorded> messages = some_messages(50);
  for (const Compression c : compressions_of_ros1()) {
    const BagContents robot = test::read_bag(bag_of(messages, c), {"robot_description"});
    EXPECT_THAT(robot.messages, ElementsAre(messages[0]));
    EXPECT_EQ(robot.topics.size(), 2u);
    EXPECT_EQ(test::read_bag(bag_of(messages, c), {"joint_states"}).messages.size(), 49u);
    EXPECT_THAT(test::read_bag(bag_of(messages, c), {"other"}).messages, IsEmpty());
  }
}

/// Chunks without wanted messages are damaged here, which is not noticed.
TEST(Ros1Bag, ChunksThatHoldNothingWantedAreNotRead) {
  const std::vector<Recorded> messages = some_messages(50);
  std::string bag = bag_of(messages);
  const auto ends = ends_of_chunks(bag);
  ASSERT_GT(ends.size(), 3u);
  for (std::size_t i = 1; i < ends.size(); ++i) bag.replace(ends[i].first - 50, 50, 50, '\xff');
  const BagContents robot = test::read_bag(bag, {"robot_description"});
  EXPECT_THAT(robot.errors, IsEmpty());
  EXPECT_THAT(robot.messages, ElementsAre(messages[0]));
  EXPECT_EQ(test::read_bag(bag).errors.size(), ends.size() - 1);
}

TEST(Ros1Bag, FromFrontToEndItIsTheSameAsWithItsIndex) {
  for (const Compression c : compressions_of_ros1()) {
    const std::string bag = bag_of(some_messages(50), c);
    for (const std::string& damaged : {without_index(bag), bag.substr(0, bag.size() - 1)}) {
      const BagContents read = test::read_bag(damaged);
      EXPECT_EQ(read.messages, some_messages(50));
      EXPECT_THAT(read.errors, IsEmpty());
      EXPECT_THAT(read.warnings,
                  ElementsAre(AllOf(StartsWith("a.bag: the recording was interrupt"),
                                    HasSubstr("relevant messages read: 50, up to byte "))));
    }
  }
}

TEST(Ros1Bag, ABagCutOffAnywhereGivesItsWholeChunks) {
  const std::vector<Recorded> messages = some_messages(40);
  for (const Compression c : compressions_of_ros1()) {
    const std::string bag = bag_of(messages, c);
    const auto ends = ends_of_chunks(bag);
    for (std::size_t size = 0; size < bag.size(); ++size) {
      const BagContents read = test::read_bag(bag.substr(0, size));
      if (size < kFirstRecord) {
        EXPECT_EQ(read.errors.size(), 1u) << size;
        continue;
      }
      EXPECT_THAT(read.errors, IsEmpty()) << size;
      ASSERT_EQ(read.warnings.size(), 1u) << size;
      EXPECT_THAT(read.warnings[0], HasSubstr("the recording was interrupted")) << size;
      std::size_t whole = 0;
      for (const auto& [end, count] : ends) whole = end <= size ? count : whole;
      ASSERT_GE(read.messages.size(), whole) << size;
      ASSERT_LE(read.messages.size(), messages.size()) << size;
      const auto last = messages.begin() + std::ssize(read.messages);
      EXPECT_TRUE(std::equal(messages.begin(), last, read.messages.begin())) << size;
    }
  }
}

TEST(Ros1Bag, WholeMessagesOfAChunkThatIsCutOffAreRead) {
  const std::string bag = bag_of(some_messages(40), Compression::none, 1 << 20);
  ASSERT_EQ(ends_of_chunks(bag).size(), 1u);
  EXPECT_EQ(test::read_bag(bag.substr(0, ends_of_chunks(bag)[0].first - 1)).messages.size(), 39u);
}

/// While a chunk is being recorded its sizes are 0, and its records follow.
TEST(Ros1Bag, AChunkThatIsStillOpenIsReadWhereItCanBe) {
  const std::string records = connection(7, "/a", "std_msgs/String") + of_connection(7, 1, "one");
  const BagContents read = test::read_bag(open_bag(chunk("none", 0, "") + records));
  EXPECT_THAT(read.messages, ElementsAre(Recorded{"a", 1'000'000'000, "one"}));
  EXPECT_THAT(read.errors, IsEmpty());
  EXPECT_EQ(read.warnings.size(), 1u);
  const BagContents cut = test::read_bag(open_bag(chunk("none", 0, "") + records).substr(0, 4250));
  EXPECT_THAT(cut.errors, IsEmpty());
  const BagContents packed = test::read_bag(open_bag(chunk("bz2", 0, "") + "BZh91AY&SY and more"));
  EXPECT_THAT(packed.errors, IsEmpty());
  EXPECT_EQ(packed.warnings.size(), 1u);
}

TEST(Ros1Bag, MessagesOutsideOfChunksAreRead) {
  const std::string records = of_connection(3, 4, "x") + of_connection(3, 5, "");
  const std::string defined = connection(3, "a", "std_msgs/String");
  const std::string bag = bag_header(kFirstRecord + records.size(), 1, 0) + records + defined;
  const BagContents read = test::read_bag(bag);
  EXPECT_THAT(read.errors, IsEmpty());
  EXPECT_THAT(read.warnings, IsEmpty());
  EXPECT_THAT(read.messages,
              ElementsAre(Recorded{"a", 4'000'000'000, "x"}, Recorded{"a", 5'000'000'000, ""}));
  EXPECT_THAT(test::read_bag(bag, {"b"}).messages, IsEmpty());
}

TEST(Ros1Bag, ConnectionsThatSayTheSameAreOneTopic) {
  const std::string records = connection(0, "/a", "T/A") + connection(1, "a", "T/A") +
                              connection(2, "a", "T/B") + of_connection(0, 1, "x") +
                              of_connection(1, 2, "y") + of_connection(2, 3, "z");
  const BagContents read = test::read_bag(open_bag(records));
  EXPECT_THAT(read.errors, IsEmpty());
  EXPECT_EQ(read.messages.size(), 3u);
  ASSERT_EQ(read.topics.size(), 2u);
  EXPECT_EQ(read.topics[1].type, "T/B");
}

TEST(Ros1Bag, ErrorsOfMessagesHaveTheirPlace) {
  const std::string records = connection(0, "a", "T/A") + of_connection(5, 1, "x") +
                              of_connection(5, 1, "x") + connection(0, "a", "T/B") +
                              of_connection(0, 1, "y");
  const BagContents outside = test::read_bag(open_bag(records));
  EXPECT_THAT(
      outside.errors,
      ElementsAre(AllOf(StartsWith("a.bag: byte 4"), HasSubstr("of connection 5")),
                  AllOf(StartsWith("a.bag: byte 4"), HasSubstr("stands in the bag twice"))));
  EXPECT_EQ(outside.messages.size(), 1u);
  const auto size = static_cast<std::uint32_t>(records.size());
  const BagContents inside = test::read_bag(open_bag(chunk("none", size, records)));
  EXPECT_EQ(inside.errors.size(), 2u);
  EXPECT_EQ(inside.messages.size(), 1u);
}

TEST(Ros1Bag, ARecordOfUnknownKindIsLeftOutAndNoOther) {
  std::string unknown = of_connection(0, 1, "x");
  unknown[unknown.find("op=") + 3] = '\x55';
  const std::string records = connection(0, "a", "T/A") + unknown + of_connection(0, 1, "y");
  for (const std::string& all : {records, chunk("none", std::uint32_t(records.size()), records)}) {
    const BagContents read = test::read_bag(open_bag(all));
    EXPECT_THAT(read.errors, ElementsAre(HasSubstr("a record of unknown kind")));
    EXPECT_THAT(read.messages, ElementsAre(Recorded{"a", 1'000'000'000, "y"}));
  }
}

TEST(Ros1Bag, WhatIsNotABagIsAnError) {
  const auto error = [](const std::string& text) { return test::read_bag(text).errors.at(0); };
  EXPECT_EQ(error(""), "a.bag: is empty");
  EXPECT_EQ(error("#ROSBAG"), "a.bag: is cut off within its first line");
  EXPECT_THAT(error("joint_states: {}\n"), HasSubstr("is not a ROS 1 bag"));
  EXPECT_THAT(error("#ROSBAG V1.2\nx"), HasSubstr("'rosbag fix'"));
  EXPECT_THAT(error("#ROSBAG V2.0\n"), HasSubstr("cut off before its first message"));
  EXPECT_THAT(error(std::string(detail::kRos1Magic) + of_connection(0, 0, "")),
              HasSubstr("byte 13: the bag header is missing"));
  EXPECT_THAT(error(bag_header(0, 0, 0, "rosbag/AesCbcEncryptor")), HasSubstr("encrypted"));
}

std::vector<std::string> errors_of_file(const std::string& path) {
  Diagnostics diagnostics;
  read_ros1_bag(path, {[](const BagTopic&) { return true; }, [](const BagMessage&) {}},
                diagnostics);
  return diagnostics.errors;
}

TEST(Ros1Bag, WhatCannotBeOpenedIsAnError) {
  EXPECT_THAT(errors_of_file("/absent.bag"),
              ElementsAre(HasSubstr("/absent.bag: cannot be opene")));
  EXPECT_THAT(errors_of_file("/"), ElementsAre("/: is a folder, not a file"));
  EXPECT_THAT(errors_of_file("/dev/null"), ElementsAre("/dev/null: is empty"));
}

TEST(Ros1Bag, WhatTheUsersFunctionsThrowPassesThrough) {
  const auto read = [](bool wants) {
    std::istringstream in(bag_of(some_messages(3)));
    Diagnostics diagnostics;
    const auto fail = [] { throw detail::BytesError("mine"); };
    const BagReader reader{[&](const BagTopic&) { return wants || (fail(), true); },
                           [&](const BagMessage&) { fail(); }};
    EXPECT_THROW(read_ros1_bag(in, "a.bag", reader, diagnostics), detail::BytesError);
    EXPECT_THAT(diagnostics.errors, IsEmpty());
  };
  read(true);
  read(false);
}

/// The second chunk of a bag is damaged.
/// @param lost  messages of that chunk; those of the others are all read
void expect_loss(const std::string& damaged, std::size_t lost, const std::string& expected_error) {
  const BagContents read = test::read_bag(damaged);
  ASSERT_FALSE(read.errors.empty()) << expected_error;
  EXPECT_THAT(read.errors[0], HasSubstr(expected_error));
  EXPECT_THAT(read.warnings, IsEmpty());
  std::vector<Recorded> expected = some_messages(50);
  const auto first = expected.begin() + std::ptrdiff_t(ends_of_chunks(bag_of(expected))[0].second);
  expected.erase(first, first + std::ptrdiff_t(lost));
  EXPECT_EQ(read.messages, expected) << expected_error;
}

TEST(Ros1Bag, DamageOfAChunkLosesNoOther) {
  const std::string bag = bag_of(some_messages(50));
  const auto ends = ends_of_chunks(bag);
  const std::size_t all = ends[1].second - ends[0].second;
  const std::size_t second = bag.find("compression=none", ends[0].first) - 8;
  const auto damaged = [&](std::size_t at, const std::string& bytes) {
    return std::string(bag).replace(at, bytes.size(), bytes);
  };
  const std::string place = "byte " + std::to_string(second) + ": ";
  const std::size_t size = bag.find("size=", second) + 5, data_size = size + 4;
  expect_loss(damaged(second, "\xff\xff\xff\xff"), all, place + "no record begins here");
  expect_loss(damaged(second + 20, "five"), all, place + "the chunk is compressed in a way");
  expect_loss(damaged(bag.find("op=", second) + 3, "\x77"), all, "a record of unknown kind");
  expect_loss(damaged(size, "\xff\xff\xff\x7f"), all, "bytes, not the 2147483647 that it claims");
  expect_loss(damaged(data_size, "\xff\xff\xff\x7f"), all, "the most that is read is 1073741824");
  expect_loss(damaged(data_size, "\xff\xff\xff\x0f"), all, "expected 268435455 bytes, ");
  expect_loss(damaged(data_size, std::string("\0\x10\0\0", 4)), all, "the chunk has 4096 bytes");
  // Its records then stand outside of it, and are read there.
  expect_loss(damaged(data_size, std::string(4, '\0')), 0, "the chunk has 0 bytes, not the");
}

TEST(Ros1Bag, AnIndexThatIsWrongIsNotTrusted) {
  const std::string bag = bag_of(some_messages(50));
  for (const std::uint64_t place :
       {std::uint64_t{1}, kFirstRecord + 100, bag.size() - 1, bag.size(), ~std::uint64_t{0}}) {
    std::string text, wrong = bag;
    detail::append_number(text, place);
    wrong.replace(bag.find("index_pos=") + 10, 8, text);
    const BagContents read = test::read_bag(wrong);
    EXPECT_EQ(read.messages, some_messages(50)) << place;
    EXPECT_THAT(read.errors, IsEmpty()) << place;
    EXPECT_EQ(read.warnings.size(), 1u) << place;
  }
}

TEST(Ros1Bag, ChunkInfosThatPointElsewhereLoseNoMessage) {
  std::string bag = bag_of(some_messages(50));
  const std::size_t info = bag.rfind("chunk_pos=") + 10;
  bag[info] = static_cast<char>(bag[info] + 3);
  const BagContents read = test::read_bag(bag);
  EXPECT_EQ(read.messages, some_messages(50));
  EXPECT_FALSE(read.errors.empty());
}

TEST(Ros1Bag, IncompleteChunkInfosLoseNoMessage) {
  std::string bag = bag_of(some_messages(50));
  for (std::size_t at = bag.rfind("chunk_pos="), i = 0; i < 2;
       at = bag.rfind("chunk_pos=", at - 1), ++i) {
    bag.replace(bag.find("count=", at) + 6, 4, 4, '\0');
  }
  const BagContents all = test::read_bag(bag);
  EXPECT_EQ(all.messages, some_messages(50));
  EXPECT_THAT(all.errors, IsEmpty());
  EXPECT_THAT(all.warnings, ElementsAre(HasSubstr("more topics than its chunk info lists")));
  EXPECT_THAT(test::read_bag(bag, {"robot_description"}).warnings, IsEmpty());
}

TEST(Ros1Bag, DefinitionsHaveNoMoreBytesThanArePlausible) {
  std::string records;
  for (std::uint32_t i = 0; i < 10; ++i) {
    Ros1Text header, data;
    header.number("conn", i).op(Ros1Op::connection).field("topic", "a");
    data.field("type", "T/A").field("message_definition", std::string(5 << 20, char('a' + i)));
    records += detail::ros1_record(header, data.text()) + of_connection(i, 1, "x");
  }
  const BagContents read = test::read_bag(open_bag(records));
  EXPECT_EQ(read.topics.size(), 6u);
  EXPECT_EQ(read.messages.size(), 6u);
  ASSERT_EQ(read.errors.size(), 4u);
  EXPECT_THAT(read.errors[0], HasSubstr("more topics and definitions than are plausible"));
}

TEST(Ros1Bag, ABombIsAnError) {
  for (const Compression c : compressions_of_ros1()) {
    if (c == Compression::none) continue;
    const std::vector<std::byte> packed = detail::pack(std::vector<std::byte>(48 << 20), c);
    const std::string data(reinterpret_cast<const char*>(packed.data()), packed.size());
    for (const std::uint32_t size : {1000U, 1U << 25, 0xffffffffU}) {
      const BagContents read =
          test::read_bag(open_bag(chunk(std::string(to_string(c)), size, data)));
      EXPECT_THAT(read.errors, ElementsAre(HasSubstr("byte 4117: the chunk "))) << size;
    }
  }
}

TEST(Ros1Bag, AMissingLibraryIsReportedOnce) {
  for (const Compression c : {Compression::bz2, Compression::lz4}) {
    if (is_available(c)) continue;
    const std::string packed = chunk(std::string(to_string(c)), 100, "12345");
    EXPECT_THAT(test::read_bag(open_bag(packed + packed)).errors,
                ElementsAre("a.bag: byte 4117: the chunk " + detail::not_available(c)));
  }
}

TEST(Ros1Bag, TooManyErrorsEndTheReading) {
  std::string records;
  for (std::uint32_t i = 0; i < 100; ++i) records += of_connection(i, 0, "");
  const BagContents read = test::read_bag(open_bag(records));
  ASSERT_EQ(read.errors.size(), 21u);
  EXPECT_THAT(read.errors[20], HasSubstr("more than 20 errors"));
}

/// Only sanitizers see a failure here: each byte is damaged, each in several ways.
TEST(Ros1Bag, DamageAnywhereDoesNoHarm) {
  for (const Compression c : compressions_of_ros1()) {
    const std::string bag = bag_of(some_messages(12), c, 150);
    for (std::size_t i = 0; i < bag.size(); i = i == 100 ? kFirstRecord - 30 : i + 1) {
      for (const int bits : {0x01, 0x7f, 0xff}) {
        std::string damaged = bag;
        damaged[i] = static_cast<char>(damaged[i] ^ bits);
        EXPECT_LE(test::read_bag(damaged).messages.size(), 100u);
      }
    }
  }
}

TEST(Ros1Bag, BagsThatTheFuzzerBeginsWithAreRead) {
  const auto folder = std::filesystem::path(test::source_folder()) / "tests/fuzz/corpus/ros1_bag";
  std::size_t count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    std::ifstream in(file.path(), std::ios::binary);
    (void)test::read_bag(in);
    ++count;
  }
  EXPECT_GE(count, 7u);
  std::ifstream in(folder / "none.bag", std::ios::binary);
  EXPECT_EQ(test::read_bag(in).messages, some_messages(7));
}

struct Genuine {
  std::string file, topic;
  std::size_t count, bytes;
  std::int64_t first, last;
};

/// The figures come from rosbag.
TEST(Ros1Bag, BagsThatRosRecordedAreReadAsRosReadsThem) {
  KINECAL_NEEDS_DATA("fetch");
  for (const Genuine& g :
       std::vector<Genuine>{{"calibration_poses.bag", "calibration_joint_states", 101, 46'662,
                             1433708778910334110, 1433714707500500917},
                            {"calibration_poses_ground.bag", "calibration_joint_states", 130,
                             62'661, 1435613243697416067, 1435621401352535009},
                            {"checkerboard_poses.bag", "calibration_joint_states", 21, 9'702,
                             1435446295314866065, 1435446470006783008},
                            {"synth/calibration_data.bag", "calibration_data", 101, 170'368,
                             1500000000000000000, 1500000500000000000}}) {
    std::ifstream in(test::data_folder() / "fetch" / g.file, std::ios::binary);
    if (g.file.starts_with("synth") && !is_available(Compression::bz2)) continue;
    const BagContents read = test::read_bag(in);
    EXPECT_THAT(read.errors, IsEmpty()) << g.file;
    EXPECT_THAT(read.warnings, IsEmpty()) << g.file;
    ASSERT_EQ(read.messages.size(), g.count) << g.file;
    EXPECT_EQ(read.messages.back().topic, g.topic) << g.file;
    std::size_t bytes = 0;
    for (const Recorded& m : read.messages) bytes += m.data.size();
    EXPECT_EQ(bytes, g.bytes) << g.file;
    EXPECT_EQ(read.messages.front().time, g.first) << g.file;
    EXPECT_EQ(read.messages.back().time, g.last) << g.file;
  }
}

}  // namespace
}  // namespace kinecal
