#include "kinecal/files/bags/ros1/write_bag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "support/ros1_bags.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::bag_of;
using test::compressions_of_ros1;
using test::Recorded;
using test::some_messages;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(WriteRos1Bag, WhatIsWrittenReadsBackWithEachCompression) {
  const std::vector<Recorded> messages = some_messages(50);
  for (const Compression c : compressions_of_ros1()) {
    for (const std::size_t chunk_bytes : {std::size_t{1}, std::size_t{300}, std::size_t{1} << 20}) {
      const test::BagContents read = test::read_bag(bag_of(messages, c, chunk_bytes));
      EXPECT_THAT(read.errors, IsEmpty()) << to_string(c);
      EXPECT_THAT(read.warnings, IsEmpty()) << to_string(c);
      EXPECT_EQ(read.messages, messages) << to_string(c) << ", " << chunk_bytes;
    }
  }
}

TEST(WriteRos1Bag, TopicsReadBackWithoutTheirSlash) {
  const test::BagContents read = test::read_bag(bag_of(some_messages(3)));
  ASSERT_EQ(read.topics.size(), 2u);
  EXPECT_EQ(read.topics[0].name, "robot_description");
  EXPECT_EQ(read.topics[1].name, "joint_states");
  EXPECT_EQ(read.topics[1].type, test::kJoints.type);
  EXPECT_EQ(read.topics[1].definition, test::kJoints.definition);
  EXPECT_EQ(read.topics[1].md5, test::kJoints.md5);
  EXPECT_EQ(read.topics[1].encoding, Encoding::ros1);
}

TEST(WriteRos1Bag, LargeMessagesAndLargeBagsReadBack) {
  std::vector<Recorded> messages;
  for (int i = 0; i < 40; ++i) {
    messages.push_back({"joint_states", i, std::string(100'000, static_cast<char>('a' + i % 26))});
  }
  messages.push_back({"joint_states", 40, std::string(3'000'000, 'z')});
  messages.push_back({"joint_states", 41, ""});
  for (const Compression c : compressions_of_ros1()) {
    const auto read = test::read_bag(bag_of(messages, c, Ros1BagWriter::kChunkBytes));
    EXPECT_THAT(read.errors, IsEmpty());
    EXPECT_TRUE(read.messages == messages) << to_string(c);
  }
}

TEST(WriteRos1Bag, ABagWithoutMessagesIsWhole) {
  for (const std::string& bag : {bag_of({}), [] {
                                   std::ostringstream out;
                                   Ros1BagWriter(out).close();
                                   return out.str();
                                 }()}) {
    const test::BagContents read = test::read_bag(bag);
    EXPECT_THAT(read.errors, IsEmpty());
    EXPECT_THAT(read.warnings, IsEmpty());
    EXPECT_THAT(read.messages, IsEmpty());
  }
}

TEST(WriteRos1Bag, TheSameCallsWriteTheSameBytes) {
  for (const Compression c : compressions_of_ros1()) {
    EXPECT_EQ(bag_of(some_messages(50), c), bag_of(some_messages(50), c));
  }
}

TEST(WriteRos1Bag, TheFirstRecordAfterTheHeaderIsWhereRosbagHasIt) {
  const std::string bag = bag_of(some_messages(1));
  EXPECT_EQ(bag.substr(0, 13), "#ROSBAG V2.0\n");
  EXPECT_EQ(bag.substr(13 + 4 + 4096 + 4 + 8, 16), "compression=none");
}

TEST(WriteRos1Bag, WhatStandsInFrontOfItStays) {
  std::ostringstream out;
  out << "before";
  Ros1BagWriter bag(out);
  bag.write(bag.add_topic(test::kJoints), 5, {});
  bag.close();
  EXPECT_EQ(out.str().substr(0, 13), "before#ROSBAG");
  EXPECT_EQ(test::read_bag(out.str().substr(6)).messages.size(), 1u);
}

TEST(WriteRos1Bag, WrongArgumentsAreRefused) {
  std::ostringstream out;
  EXPECT_THROW(Ros1BagWriter(out, Compression::zstd), std::invalid_argument);
  Ros1BagWriter bag(out);
  EXPECT_THROW(bag.write(0, 0, {}), std::invalid_argument);
  const std::uint32_t topic = bag.add_topic(test::kJoints);
  EXPECT_THROW(bag.write(topic, -1, {}), std::invalid_argument);
  EXPECT_THROW(bag.write(topic, std::numeric_limits<std::int64_t>::max(), {}),
               std::invalid_argument);
  bag.close();
  EXPECT_THROW(bag.write(topic, 0, {}), std::invalid_argument);
  EXPECT_THROW((void)bag.add_topic(test::kJoints), std::invalid_argument);
  out.setstate(std::ios::badbit);
  EXPECT_THROW((Ros1BagWriter(out)), std::runtime_error);
}

/// Prints each message as rosbag reads it: topic, type, md5, time, data.
const std::string kPython = R"(
import sys
try:
    import rosbag
except ImportError as e:
    sys.exit('skipped: ' + str(e))
bag = rosbag.Bag(sys.argv[1])
for topic, (kind, data, md5, _, _), time in bag.read_messages(raw=True):
    print(topic, kind, md5, time.to_nsec(), data.decode())
print(sorted(c.header.get('latching', b'0') for c in bag._get_connections()))
)";

/// Copies a bag, compressed as its second argument says.
const std::string kPythonCopy = R"(
import sys
try:
    import rosbag
except ImportError as e:
    sys.exit('skipped: ' + str(e))
with rosbag.Bag('copy.bag', 'w', compression=sys.argv[2], chunk_threshold=300) as copy:
    for topic, message, time in rosbag.Bag(sys.argv[1]).read_messages(raw=True):
        copy.write(topic, message, time, raw=True)
)";

class Rosbag : public test::ProgramTest {
 protected:
  /// @return  why rosbag cannot run; empty if it can
  [[nodiscard]] static std::string absent(const test::Outcome& outcome) {
    const bool skipped = outcome.err.find("skipped: ") != std::string::npos || outcome.code == 127;
    return skipped ? "rosbag cannot run: " + outcome.err : "";
  }
};

TEST_F(Rosbag, ReadsWhatIsWritten) {
  write("read.py", kPython);
  const std::vector<Recorded> messages = some_messages(50);
  std::string expected;
  for (const Recorded& m : messages) {
    const bool robot = m.topic == "robot_description";
    const BagTopic& topic = robot ? test::kRobot : test::kJoints;
    expected += topic.name + " " + topic.type + " " + topic.md5 + " " + std::to_string(m.time) +
                " " + m.data + "\n";
  }
  expected += "[b'0', b'1']\n";
  for (const Compression c : compressions_of_ros1()) {
    write("a.bag", bag_of(messages, c));
    const test::Outcome read = run("/usr/bin/python3 read.py a.bag");
    if (const std::string why = absent(read); !why.empty()) GTEST_SKIP() << why;
    EXPECT_EQ(read.code, 0) << read.err;
    EXPECT_EQ(read.out, expected) << to_string(c);
  }
}

TEST_F(Rosbag, WritesWhatIsRead) {
  write("write.py", kPythonCopy);
  const std::vector<Recorded> messages = some_messages(50);
  write("a.bag", bag_of(messages));
  for (const Compression c : compressions_of_ros1()) {
    const test::Outcome copy = run("/usr/bin/python3 write.py a.bag " + std::string(to_string(c)));
    if (const std::string why = absent(copy); !why.empty()) GTEST_SKIP() << why;
    ASSERT_EQ(copy.code, 0) << copy.err;
    const test::BagContents all = test::read_bag(read("copy.bag"));
    EXPECT_THAT(all.errors, IsEmpty()) << to_string(c);
    EXPECT_THAT(all.warnings, IsEmpty()) << to_string(c);
    EXPECT_EQ(all.messages, messages) << to_string(c);
  }
}

}  // namespace
}  // namespace kinecal
