#include "kinecal/files/bags/mcap/read_mcap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/records.ipp"
#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "support/bags.hpp"

namespace kinecal {
namespace {

using namespace detail;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

const BagTopic kJoints{"joint_states", "sensor_msgs/JointState", "string[] name\n", Encoding::cdr};
const BagTopic kImage{"camera/image", "sensor_msgs/Image", "uint32 height\n", Encoding::cdr};

/// Messages of two topics by turns, text as their data; the first is at time 1000.
std::string bag_of(int messages, McapOptions options, std::size_t bytes = 10) {
  std::ostringstream out;
  McapWriter writer(out, options);
  const std::uint16_t joints = writer.add_topic(kJoints), image = writer.add_topic(kImage);
  for (int i = 0; i < messages; ++i) {
    std::string data = "message " + std::to_string(i);
    data.resize(std::max(bytes, data.size()), '.');
    writer.write(i % 2 == 0 ? joints : image, 1000 + i, as_bytes(data));
  }
  writer.close();
  return out.str();
}

BagReading read(const std::string& file, std::vector<std::string> wanted = {}) {
  std::istringstream in(file);
  return read_bag(std::move(wanted), [&](const BagReader& reader, Diagnostics& diagnostics) {
    read_mcap(in, "b.mcap", reader, diagnostics);
  });
}

std::vector<Compression> compressions() {
  std::vector<Compression> all{Compression::none};
#ifdef KINECAL_HAVE_LZ4
  all.push_back(Compression::lz4);
#endif
#ifdef KINECAL_HAVE_ZSTD
  all.push_back(Compression::zstd);
#endif
  return all;
}

/// Every way to write a file.
std::vector<McapOptions> all_options() {
  std::vector<McapOptions> all;
  for (const Compression compression : compressions()) {
    for (const std::size_t chunk_bytes : {0, 1, 200, 1 << 20}) {
      for (const bool index : {true, false}) all.push_back({compression, chunk_bytes, index});
    }
  }
  return all;
}

/// A record, for files that our writer does not write.
std::string record(int op, const std::string& content) {
  return McapContent().raw(content).record(static_cast<McapOp>(op));
}
std::string schema(std::uint16_t id, const std::string& name, const std::string& encoding,
                   const std::string& text) {
  return McapContent().number(id).text(name).text(encoding).text(text).record(McapOp::schema);
}
std::string channel(std::uint16_t id, std::uint16_t schema, const std::string& topic,
                    const std::string& encoding) {
  McapContent content;
  content.number(id).number(schema).text(topic).text(encoding).text("");
  return content.record(McapOp::channel);
}
std::string message(std::uint16_t channel, std::uint64_t time, const std::string& data) {
  McapContent content;
  content.number(channel).number(std::uint32_t{0}).number(time).number(time).raw(data);
  return content.record(McapOp::message);
}
std::string chunk(const std::string& compression, std::uint64_t size, std::uint32_t sum,
                  const std::string& records) {
  McapContent content;
  content.number(std::uint64_t{0}).number(std::uint64_t{0}).number(size).number(sum);
  content.text(compression).number(std::uint64_t{records.size()}).raw(records);
  return content.record(McapOp::chunk);
}
/// Without a summary.
std::string whole(const std::string& records) {
  const std::string magic(kMcapMagic);
  return magic + record(1, McapContent().text("").text("").str()) + records +
         record(0x0F, std::string(4, '\0')) + record(2, std::string(20, '\0')) + magic;
}

TEST(Mcap, WhatIsWrittenIsReadWhateverTheCompressionTheChunksAndTheIndex) {
  for (const McapOptions& options : all_options()) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(options.compression) << " chunks of "
                                    << options.chunk_bytes << " index " << options.index);
    const BagReading reading = read(bag_of(40, options));
    EXPECT_THAT(reading.errors, IsEmpty());
    EXPECT_THAT(reading.warnings, IsEmpty());
    ASSERT_THAT(reading.messages, SizeIs(40));
    EXPECT_EQ(reading.messages[0], "joint_states 1000 message 0.");
    EXPECT_EQ(reading.messages[39], "camera/image 1039 message 39");
    EXPECT_THAT(reading.topics, testing::UnorderedElementsAre(
                                    "joint_states sensor_msgs/JointState cdr string[] name\n",
                                    "camera/image sensor_msgs/Image cdr uint32 height\n"));
  }
}

TEST(Mcap, TheSameCallsWriteTheSameBytes) {
  for (const McapOptions& options : all_options()) {
    EXPECT_EQ(bag_of(40, options), bag_of(40, options));
  }
}

TEST(Mcap, OnlyWhatIsWantedIsHandled) {
  for (const McapOptions& options : all_options()) {
    const BagReading reading = read(bag_of(40, options), {"camera/image"});
    EXPECT_THAT(reading.messages, SizeIs(20));
    EXPECT_THAT(reading.topics, SizeIs(2)) << "each is asked for once";
    EXPECT_THAT(reading.warnings, IsEmpty());
  }
}

TEST(Mcap, ChunksWithoutWantedTopicsAreSkippedUnread) {
  // One message a chunk; those of images are destroyed behind the index.
  std::string file = bag_of(40, {Compression::none, 1, true});
  for (int i = 1; i < 40; i += 2) file[file.find("message " + std::to_string(i))] = 'X';
  EXPECT_THAT(read(file, {"joint_states"}).errors, IsEmpty());
  EXPECT_THAT(read(file, {"joint_states"}).messages, SizeIs(20));
  EXPECT_THAT(read(file, {"camera/image"}).errors, ElementsAre(HasSubstr("check sum")));
}

TEST(Mcap, WhateverTheFileIsCutOffAtAllWholeChunksAreRead) {
  for (const McapOptions& options : all_options()) {
    const std::string file = bag_of(8, options);
    std::size_t before = 0;
    for (std::size_t size = 0; size < file.size(); ++size) {
      const BagReading reading = read(file.substr(0, size));
      SCOPED_TRACE(testing::Message()
                   << size << " bytes of " << file.size() << ", chunks of " << options.chunk_bytes);
      if (size < kMcapMagic.size()) {
        EXPECT_THAT(reading.errors, SizeIs(1));
        continue;
      }
      EXPECT_THAT(reading.errors, IsEmpty());
      EXPECT_THAT(reading.warnings, ElementsAre(HasSubstr("the recording was interrupted")));
      EXPECT_GE(reading.messages.size(), before);
      before = reading.messages.size();
    }
    EXPECT_EQ(before, 8u) << "cut off in the index alone";
  }
}

TEST(Mcap, WhateverByteIsWrongNothingIsReadThatWasNotWritten) {
  const McapOptions options{Compression::none, 100, true};
  const std::string file = bag_of(8, options);
  const BagReading right = read(file);
  for (std::size_t at = 0; at < file.size(); ++at) {
    for (const char flip : {'\x01', '\x80', '\xFF'}) {
      std::string wrong = file;
      wrong[at] = static_cast<char>(wrong[at] ^ flip);
      const BagReading reading = read(wrong);
      for (const std::string& one : reading.messages) {
        EXPECT_THAT(right.messages, testing::Contains(one)) << "byte " << at;
      }
      if (reading.messages != right.messages) {
        EXPECT_FALSE(reading.errors.empty() && reading.warnings.empty()) << "byte " << at;
      }
    }
  }
}

TEST(Mcap, ADamagedIndexIsAWarningAndEverythingIsReadWithoutIt) {
  std::string file = bag_of(8, {Compression::none, 100, true});
  file[file.size() - 60] = 'X';  // among the summary's offsets
  const BagReading reading = read(file);
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.messages, SizeIs(8));
  EXPECT_THAT(reading.warnings,
              ElementsAre(AllOf(HasSubstr("b.mcap: byte "), HasSubstr("the index is damaged"))));
}

TEST(Mcap, AnIndexOfMoreBytesThanIsPlausibleIsNotRead) {
  std::string file = whole(channel(1, 0, "/a", "cdr") + message(1, 5, std::string(70 << 20, 'x')));
  file[file.size() - 8 - 20] = '\x08';  // where it begins: at once
  const BagReading reading = read(file);
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.messages, SizeIs(1));
  EXPECT_THAT(reading.warnings,
              ElementsAre(HasSubstr("the footer says that the index begins at byte 8")));
}

/// Where the summary begins, as the footer says; sets its sum to 0, "unknown".
std::size_t start_of_summary(std::string& file) {
  for (std::size_t i = 9; i <= 12; ++i) file[file.size() - i] = '\0';
  ByteReader footer(as_bytes(std::string_view(file).substr(file.size() - 28)));
  return footer.number<std::uint64_t>();
}

TEST(Mcap, AnIndexThatBeginsElsewhereLosesNoMessage) {
  std::string file = bag_of(8, {Compression::none, 100, true});
  const auto first = static_cast<int>(start_of_summary(file) % 256);
  const std::size_t place = file.size() - 8 - 20;
  for (int by = -100; by < 200; ++by) {
    std::string wrong = file;
    wrong[place] = static_cast<char>(first + by);
    const BagReading reading = read(wrong, {"camera/image"});
    EXPECT_THAT(reading.errors, IsEmpty()) << by;
    EXPECT_THAT(reading.messages, SizeIs(4)) << by;
  }
}

TEST(Mcap, DefinitionsHaveNoMoreBytesThanArePlausible) {
  std::string records = schema(1, "a/msg/B", "ros2msg", std::string(20 << 20, ' '));
  for (std::uint16_t i = 1; i < 10; ++i) {
    records += channel(i, 1, "/a", "cdr") + message(i, 5, "x");
  }
  const BagReading reading = read(whole(records));
  EXPECT_THAT(reading.messages, SizeIs(2));
  EXPECT_THAT(reading.errors,
              ElementsAre(HasSubstr("more topics and definitions than are plausible")));
}

TEST(Mcap, AnIndexWithoutSchemasOrChannelsLosesNoMessage) {
  for (const McapOp left_out : {McapOp::schema, McapOp::channel, McapOp::statistics}) {
    std::string file = bag_of(8, {Compression::none, 1, true});
    ByteReader summary(as_bytes(file));
    summary.skip(start_of_summary(file));
    while (summary.left() > 28) {
      const std::size_t at = summary.read();
      if (summary.number<std::uint8_t>() == static_cast<std::uint8_t>(left_out)) file[at] = '\x42';
      summary.skip(summary.number<std::uint64_t>());
    }
    const BagReading reading = read(file, {"camera/image"});
    EXPECT_THAT(reading.errors, IsEmpty()) << static_cast<int>(left_out);
    EXPECT_THAT(reading.warnings, IsEmpty());
    EXPECT_THAT(reading.messages, SizeIs(4));
  }
}

TEST(Mcap, ADamagedChunkIsNamedByItsByte) {
  std::string file = bag_of(8, {Compression::none, 100, true});
  const std::size_t at = file.find("message 0");
  file[at] = 'X';
  EXPECT_THAT(read(file).errors,
              ElementsAre(AllOf(HasSubstr("b.mcap: the chunk at byte 36: byte 85: "),
                                HasSubstr("is damaged"), HasSubstr("check sum"))));
}

/// The sum was computed by another program.
TEST(Mcap, CheckSumsAreCrc32) {
  const std::string records = channel(1, 0, "/a", "cdr") + message(1, 5, "x");
  const BagReading right = read(whole(chunk("", records.size(), 0x54039F12, records)));
  EXPECT_THAT(right.errors, IsEmpty());
  EXPECT_THAT(right.messages, ElementsAre("a 5 x"));
  EXPECT_THAT(read(whole(chunk("", records.size(), 1, records))).errors,
              ElementsAre(HasSubstr("its check sum is 54039f12 and should be 00000001")));
}

TEST(Mcap, ZerosAtTheEndAreARecordingWithoutPower) {
  std::string file = bag_of(8, {Compression::none, 0, false});
  file.resize(file.size() - 8 - 29 - 13);  // up to the end of the data
  const BagReading reading = read(file + std::string(100'000, '\0'));
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.messages, SizeIs(8));
  EXPECT_THAT(reading.warnings, ElementsAre(HasSubstr("the last 100000 bytes")));
  EXPECT_THAT(read(file + std::string(100'000, '\0') + "1").errors,
              ElementsAre(HasSubstr("no record begins here")));
}

TEST(Mcap, WhatHasNoEndAlthoughTheFileHasOneIsDamaged) {
  std::string file = whole(message(1, 0, "data"));
  file[8 + 17 + 5] = '\x7F';  // a length
  EXPECT_THAT(read(file).errors,
              ElementsAre(HasSubstr("byte 25: the record that begins here runs beyond")));
}

TEST(Mcap, UnknownRecordsAndThoseWithoutMessagesAreSkipped) {
  const std::string extras = record(0x09, "attachment") + record(0x0C, "metadata") +
                             record(0x42, "of a later version") +
                             record(0xFF, std::string(9999, 'x'));
  const std::string said = schema(1, "std_msgs/msg/String", "ros2msg", "string data\n") +
                           channel(1, 1, "/said", "cdr") + message(1, 5, "hello");
  EXPECT_THAT(read(whole(extras + said + extras + message(1, 6, "again"))).messages,
              ElementsAre("said 5 hello", "said 6 again"));
  const std::string inside = record(0x42, "?") + said + record(0x42, "?");
  EXPECT_THAT(read(whole(chunk("", inside.size(), 0, inside))).messages,
              ElementsAre("said 5 hello"));
}

TEST(Mcap, SchemasHaveTypesAndTexts) {
  const std::string file = whole(
      schema(1, "std_msgs/String", "ros1msg", "string data\n") +
      schema(2, "std_msgs/msg/String", "ros2idl", "module std_msgs {};") +
      channel(1, 1, "/one", "ros1") + channel(2, 2, "two", "cdr") + channel(3, 0, "/three", "cdr") +
      channel(4, 1, "/four", "json") + channel(5, 1, "/five", "protobuf") + message(1, 1, "1") +
      message(2, 2, "2") + message(3, 3, "3") + message(4, 4, "4") + message(5, 5, "5"));
  const BagReading reading = read(file);
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.topics, ElementsAre("one std_msgs/String ros1 string data\n",
                                          "two std_msgs/String cdr ", "three  cdr "));
  EXPECT_THAT(reading.messages, ElementsAre("one 1 1", "two 2 2", "three 3 3"));
  EXPECT_THAT(reading.warnings,
              ElementsAre("b.mcap: 2 topics are not in an encoding of ROS and left out: '/four' as "
                          "'json' and others"));
}

/// As in ROS 2's compression mode MESSAGE.
TEST(Mcap, MessagesThatAreCompressedOneByOneAreUnpacked) {
  const auto packed_as = [](const std::string& text) {
    const auto bytes = pack(as_bytes(text), Compression::zstd);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const std::string channels = channel(1, 0, "/said", "cdr") + channel(2, 0, "/ros1", "ros1");
  if (!is_available(Compression::zstd)) {
    EXPECT_THAT(read(whole(channels + message(1, 5, std::string(kZstdMagic)))).errors,
                ElementsAre(HasSubstr("a message of topic 'said' is compressed with zstd, and this "
                                      "kinecal was built without")));
    GTEST_SKIP() << "without zstd there is nothing to unpack";
  }
  const std::string hello = packed_as("hello"), data(200, 'x');
  EXPECT_THAT(read(whole(channels + message(1, 5, hello) + message(1, 6, packed_as(data)) +
                         message(1, 7, "plain")))
                  .messages,
              ElementsAre("said 5 hello", "said 6 " + data, "said 7 plain"));
  EXPECT_THAT(read(whole(channels + message(2, 5, hello))).messages, ElementsAre("ros1 5 " + hello))
      << "of ROS 1 they are what they are";
  for (std::size_t size = kZstdMagic.size(); size < hello.size(); ++size) {
    const BagReading reading = read(whole(channels + message(1, 5, hello.substr(0, size))));
    EXPECT_THAT(reading.errors, ElementsAre(HasSubstr("a message of topic 'said' ")));
    EXPECT_THAT(reading.messages, IsEmpty());
  }
  const std::string bomb = packed_as(std::string(40 << 20, '\0'));
  EXPECT_THAT(read(whole(channels + message(1, 5, bomb))).errors,
              ElementsAre(HasSubstr("does not unpack to 33554432 bytes, but to more")));
}

TEST(Mcap, WhatContradictsItselfIsDamaged) {
  const std::string string = schema(1, "std_msgs/msg/String", "ros2msg", "string data\n");
  const auto errors = [](const std::string& records) { return read(whole(records)).errors; };
  EXPECT_THAT(errors(message(7, 0, "")), ElementsAre(HasSubstr("a message is of channel 7")));
  EXPECT_THAT(errors(channel(1, 9, "/a", "cdr") + message(1, 0, "")),
              ElementsAre(HasSubstr("topic '/a' is of schema 9")));
  EXPECT_THAT(errors(string + schema(1, "std_msgs/msg/Bool", "ros2msg", "bool data\n")),
              ElementsAre(HasSubstr("schema 1 is 'std_msgs/msg/Bool' and was")));
  EXPECT_THAT(errors(channel(1, 0, "/a", "cdr") + channel(1, 0, "/b", "cdr")),
              ElementsAre(HasSubstr("channel 1 is '/b' and was '/a'")));
  EXPECT_THAT(errors(string + string + channel(1, 1, "/a", "cdr") + channel(1, 1, "/a", "cdr")),
              IsEmpty());
  EXPECT_THAT(errors(schema(0, "", "", "")), ElementsAre(HasSubstr("number 0")));
  EXPECT_THAT(errors(record(5, "short")), ElementsAre(HasSubstr("is it cut off?")));
}

TEST(Mcap, ChunksThatLieAboutTheirSizeAreErrors) {
  const auto errors = [](const std::string& records) { return read(whole(records)).errors; };
  EXPECT_THAT(errors(chunk("", 5, 0, "four")),
              ElementsAre(HasSubstr("has 4 bytes, not the 5 that it claims")));
  EXPECT_THAT(errors(chunk("rar", 5, 0, "four")), ElementsAre(HasSubstr("compressed with 'rar'")));
  for (const std::string format : {"lz4", "zstd"}) {
    EXPECT_THAT(errors(chunk(format, 5, 0, "four")), SizeIs(1));
    EXPECT_THAT(errors(chunk(format, std::uint64_t{1} << 60, 0, "four")), SizeIs(1));
  }
}

TEST(Mcap, AFileOfAnotherFormatIsAnError) {
  EXPECT_THAT(read("").errors, ElementsAre("b.mcap: is empty"));
  EXPECT_THAT(read("#ROSBAG V2.0\n").errors,
              ElementsAre("b.mcap: is not an MCAP file: it does not begin as one"));
  const auto at = [](const std::string& path) {
    return read_bag({}, [&](const BagReader& reader,
                            Diagnostics& diagnostics) { read_mcap(path, reader, diagnostics); })
        .errors;
  };
  EXPECT_THAT(at("/no/such.mcap"),
              ElementsAre("/no/such.mcap: cannot be opened: No such file or directory"));
  EXPECT_THAT(at("/tmp"), ElementsAre("/tmp: is a folder, not a file"));
}

TEST(Mcap, MessagesThatTheIndexCountsAndTheFileLacksAreAWarning) {
  // The last message is removed, as if its chunk had been cut out, and the sum of the index is set
  // to 0, "unknown".
  const std::string file = bag_of(4, {Compression::none, 0, true});
  const std::size_t at = file.find("message 3") - 31;
  std::string shorter = file.substr(0, at) + file.substr(at + 31 + 10);
  for (std::size_t i = 12; i > 8; --i) shorter[shorter.size() - i] = '\0';
  const std::size_t place = shorter.size() - 8 - 20;
  shorter[place] = static_cast<char>(shorter[place] - 41);
  const BagReading reading = read(shorter);
  EXPECT_THAT(reading.messages, SizeIs(3));
  EXPECT_THAT(reading.warnings,
              ElementsAre("b.mcap: topic 'camera/image': the file has 1 of 2 recorded messages"));
}

TEST(Mcap, WhatTheReaderThrowsIsNotCaught) {
  std::istringstream in(bag_of(2, {}));
  BagReader reader;
  reader.wants = [](const BagTopic&) { return true; };
  reader.handle = [](const BagMessage&) { throw BytesError("mine"); };
  Diagnostics diagnostics;
  EXPECT_THROW(read_mcap(in, "b.mcap", reader, diagnostics), BytesError);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
}

TEST(McapWriter, NamesAndTypesAreThoseOfRos2) {
  std::ostringstream out;
  McapWriter writer(out);
  (void)writer.add_topic({"plain", "std_msgs/String", "", Encoding::cdr});
  (void)writer.add_topic({"/slash", "std_msgs/msg/Bool", "", Encoding::cdr});
  writer.close();
  for (const std::string text : {"/plain", "/slash", "std_msgs/msg/String", "std_msgs/msg/Bool"}) {
    EXPECT_THAT(out.str(), HasSubstr(text));
  }
  EXPECT_THAT(out.str(), Not(HasSubstr("//slash")));
}

TEST(McapWriter, RefusesWhatIsNotOfRos2) {
  std::ostringstream out;
  McapWriter writer(out);
  EXPECT_THROW((void)writer.add_topic({"a", "b/C", "", Encoding::ros1}), std::invalid_argument);
  EXPECT_THROW(writer.write(1, 0, {}), std::out_of_range);
  const auto topic = writer.add_topic(kJoints);
  EXPECT_THROW(writer.write(topic, -1, {}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
