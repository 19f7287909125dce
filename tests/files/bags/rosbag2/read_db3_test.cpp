#include "kinecal/files/bags/rosbag2/read_db3.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/rosbag2/db3_messages.ipp"
#include "support/bags.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

namespace fs = std::filesystem;

class Db3 : public test::FolderTest {
 protected:
  [[nodiscard]] BagReading read(std::vector<std::string> wanted = {}) const {
    return read_bag(wanted, [&](const BagReader& reader, Diagnostics& diagnostics) {
      read_db3(path_.string(), reader, diagnostics);
    });
  }

  void write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// "path: message"
  [[nodiscard]] std::string in_file(const std::string& message) const {
    return path_.string() + ": " + message;
  }

  fs::path path_ = folder_ / "bag_0.db3";
};

TEST_F(Db3, AFileThatIsNotADatabaseIsAnError) {
  EXPECT_THAT(read().errors, ElementsAre(in_file("cannot be opened: No such file or directory")));
  write("");
  EXPECT_THAT(read().errors, ElementsAre(in_file("is empty")));
  write("SQLite for");
  EXPECT_THAT(read().errors,
              ElementsAre(in_file("is not an SQLite database: it does not begin as one")));
  path_ = folder_;
  EXPECT_THAT(read().errors, ElementsAre(in_file("is a folder, not a file")));
}

#ifndef KINECAL_HAVE_SQLITE

TEST_F(Db3, SaysWhatToInstall) {
  write(std::string(detail::kSqliteMagic));
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("install libsqlite3-dev and build again")));
}

#else

/// As ROS 2 Foxy records.
const std::string kOldTables =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
    "NOT NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);";
/// As ROS 2 Jazzy records, except that the hash of a topic may be left out.
const std::string kNewTables =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata "
    "TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, type_description_hash TEXT DEFAULT '', "
    "offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding "
    "TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
    "NOT NULL, data BLOB NOT NULL);"
    "INSERT INTO message_definitions VALUES(1, 'sensor_msgs/msg/JointState', 'ros2msg', "
    "'string[] name', 'h'), (2, 'sensor_msgs/msg/Image', 'ros2idl', 'module', 'h');";
const std::string kTopics =
    "INSERT INTO topics(id, name, type, serialization_format, offered_qos_profiles) VALUES"
    "(1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr', ''),"
    "(2, '/camera/image', 'sensor_msgs/msg/Image', 'cdr', '');";
/// Not in the order of time; two at the same time.
const std::string kMessages =
    "INSERT INTO messages(topic_id, timestamp, data) VALUES"
    "(1, 30, CAST('third' AS BLOB)), (2, 20, CAST('image' AS BLOB)), (1, 10, CAST('first' AS "
    "BLOB)), (1, 10, CAST('second' AS BLOB)), (2, 40, x'');";

void run(const fs::path& path, const std::string& statements) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, &error), SQLITE_OK)
      << error;
  sqlite3_free(error);
  sqlite3_close(database);
}

TEST_F(Db3, MessagesAreReadInTheOrderOfTimeThenOfRecording) {
  run(path_, kOldTables + kTopics + kMessages);
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
  EXPECT_THAT(reading.topics, ElementsAre("joint_states sensor_msgs/JointState cdr ",
                                          "camera/image sensor_msgs/Image cdr "));
  EXPECT_THAT(reading.messages,
              ElementsAre("joint_states 10 first", "joint_states 10 second",
                          "camera/image 20 image", "joint_states 30 third", "camera/image 40 "));
}

TEST_F(Db3, NewerVersionsHaveDefinitions) {
  run(path_, kNewTables + kTopics + kMessages);
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.topics, ElementsAre("joint_states sensor_msgs/JointState cdr string[] name",
                                          "camera/image sensor_msgs/Image cdr "));
  EXPECT_THAT(reading.messages, SizeIs(5));
}

TEST_F(Db3, OnlyWhatIsWantedIsHandled) {
  run(path_, kOldTables + kTopics + kMessages);
  EXPECT_THAT(read({"camera/image"}).messages,
              ElementsAre("camera/image 20 image", "camera/image 40 "));
  EXPECT_THAT(read({"nothing"}).messages, IsEmpty());
}

TEST_F(Db3, NothingIsChangedOrLeftBesideIt) {
  run(path_, kOldTables + kTopics + kMessages);
  fs::permissions(path_, fs::perms::owner_read);
  const std::string before = bytes();
  EXPECT_THAT(read().errors, IsEmpty());
  EXPECT_EQ(bytes(), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Db3, PathsMayHaveAnyCharacter) {
  path_ = folder_ / "50% of #1? yes & no=.db3";
  run(path_, kOldTables + kTopics + kMessages);
  EXPECT_THAT(read().errors, IsEmpty());
  EXPECT_THAT(read().messages, SizeIs(5));
}

TEST_F(Db3, MessagesOfTheWriteAheadLogAreReadToo) {
  sqlite3* recorder = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &recorder), SQLITE_OK);
  const std::string all = "PRAGMA journal_mode=WAL;" + kOldTables + kTopics + kMessages;
  ASSERT_EQ(sqlite3_exec(recorder, all.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  const BagReading reading = read();  // while it is being recorded
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, ElementsAre(HasSubstr("the recording was interrupted")));
  EXPECT_THAT(reading.messages, SizeIs(5));
  sqlite3_close(recorder);
  EXPECT_THAT(read().warnings, IsEmpty());
  EXPECT_THAT(read().messages, SizeIs(5));
}

TEST_F(Db3, ADatabaseThatIsNotABagIsAnError) {
  run(path_, "CREATE TABLE robots(id INTEGER);");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("has no table 'topics'")));
  run(path_, "CREATE TABLE topics(id INTEGER, name, type);");
  EXPECT_THAT(read().errors,
              ElementsAre(HasSubstr("table 'topics' has no column 'serialization_format'")));
  run(path_, "DROP TABLE topics;" + kOldTables + "DROP TABLE messages;");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("has no table 'messages'")));
  run(path_, kTopics +
                 "CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 1 AS timestamp, x'' AS "
                 "data;");
  EXPECT_THAT(read().errors, SizeIs(1));
}

TEST_F(Db3, TopicsThatAreNotInCdrAreLeftOut) {
  run(path_, kOldTables + kTopics + kMessages +
                 "UPDATE topics SET serialization_format = 'protobuf' WHERE id = 2;");
  const BagReading reading = read();
  EXPECT_THAT(reading.messages, SizeIs(3));
  EXPECT_THAT(reading.warnings,
              ElementsAre(in_file("topics not in CDR are left out: 'camera/image' "
                                  "as 'protobuf'")));
}

TEST_F(Db3, AFileThatIsCutOffAnywhereIsAnError) {
  const std::string many =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 400) INSERT INTO "
      "messages(topic_id, timestamp, data) SELECT 1 + i % 2, 1000 + i, CAST('message ' || i AS "
      "BLOB) FROM n;";
  run(path_, "PRAGMA page_size=512;" + kOldTables + kTopics + many);
  const std::string whole = bytes();
  ASSERT_THAT(read().messages, SizeIs(400));
  for (std::size_t size = 0; size < whole.size(); size += size < 2048 ? 13 : 257) {
    write(whole.substr(0, size));
    EXPECT_THAT(read().errors, SizeIs(1)) << size << " bytes of " << whole.size();
  }
}

TEST_F(Db3, WhateverByteIsWrongNothingCrashes) {
  run(path_, "PRAGMA page_size=512;" + kNewTables + kTopics + kMessages);
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); at += 3) {
    std::string wrong = whole;
    wrong[at] = static_cast<char>(~wrong[at]);
    write(wrong);
    EXPECT_LE(read().messages.size(), 100u) << at;
  }
}

TEST_F(Db3, AComputedColumnIsNotAccepted) {
  run(path_,
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data AS "
      "(zeroblob(900000000)));"
      "INSERT INTO topics VALUES(1, '/a', 'b/msg/C', 'cdr');"
      "INSERT INTO messages(topic_id, timestamp) VALUES(1, 1);");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("table 'messages' has no column 'data'")));
}

TEST_F(Db3, MessagesThatAreCompressedOneByOneAreUnpacked) {
  if (!is_available(Compression::zstd)) GTEST_SKIP() << "built without zstd";
  std::string hex;
  for (const std::byte byte :
       detail::pack(std::as_bytes(std::span("hello", 5)), Compression::zstd)) {
    hex += fmt::format("{:02x}", std::to_integer<int>(byte));
  }
  run(path_, kOldTables + kTopics +
                 fmt::format("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, 10, "
                             "x'{}'), (1, 20, x'{}00'), (1, 30, x'00');",
                             hex, hex));
  const BagReading reading = read();
  EXPECT_THAT(reading.messages, ElementsAre("joint_states 10 hello"));
  EXPECT_THAT(reading.errors,
              ElementsAre(HasSubstr("bag_0.db3: a message of topic 'joint_states' ")));
}

TEST_F(Db3, DefinitionsHaveNoMoreBytesThanArePlausible) {
  run(path_, kNewTables + kTopics + kMessages +
                 "UPDATE message_definitions SET encoded_message_definition = "
                 "CAST(randomblob(1) || zeroblob(40000000) AS TEXT), encoding = 'ros2msg';");
  EXPECT_THAT(read().errors,
              ElementsAre(HasSubstr("more topics and definitions than are plausible")));
}

/// Pages that are part of many messages make a small file endless.
TEST_F(Db3, MessagesWithMoreBytesThanTheFileAreDamaged) {
  run(path_, kOldTables + kTopics + kMessages);
  const std::string uri = "file:" + path_.string() + "?mode=ro&immutable=1";
  const BagReading reading = read_bag({}, [&](const BagReader& reader, Diagnostics& diagnostics) {
    detail::read_db3_database([&] { return detail::SqliteDatabase(uri, 12); }, "a.db3", reader,
                              diagnostics);
  });
  EXPECT_THAT(reading.messages, ElementsAre("joint_states 10 first", "joint_states 10 second"));
  EXPECT_THAT(reading.errors, ElementsAre(HasSubstr("its messages have more bytes than it")));
}

TEST_F(Db3, WhatHasNoEndIsInterrupted) {
  const detail::SqliteDatabase database("file::memory:", 0);
  detail::SqliteRows rows(database,
                          "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT "
                          "count(*) FROM n");
  EXPECT_THAT([&] { (void)rows.next(); },
              ThrowsMessage<detail::BytesError>(HasSubstr("more rows than its size allows")));
}

TEST_F(Db3, WhatTheReaderThrowsIsNotCaught) {
  run(path_, kOldTables + kTopics + kMessages);
  BagReader reader;
  reader.wants = [](const BagTopic&) { return true; };
  reader.handle = [](const BagMessage&) { throw detail::BytesError("mine"); };
  Diagnostics diagnostics;
  EXPECT_THROW(read_db3(path_.string(), reader, diagnostics), detail::BytesError);
}

#endif

}  // namespace
}  // namespace kinecal
