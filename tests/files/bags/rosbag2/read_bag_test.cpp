#include "kinecal/files/bags/rosbag2/read_bag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/bags/rosbag2/metadata.ipp"
#include "support/bags.hpp"
#include "support/temporary_folder.hpp"

#ifdef KINECAL_HAVE_SQLITE
#include <sqlite3.h>
#endif

namespace kinecal {
namespace {

using namespace detail;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

namespace fs = std::filesystem;

class Ros2Bag : public test::FolderTest {
 protected:
  Ros2Bag() { fs::create_directory(bag_); }

  [[nodiscard]] BagReading read(const std::string& folder = "") const {
    return read_bag({}, [&](const BagReader& reader, Diagnostics& diagnostics) {
      read_ros2_bag(folder.empty() ? bag_.string() : folder, reader, diagnostics);
    });
  }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(bag_ / name, std::ios::binary) << content;
  }

  /// With one message.
  void write_mcap(const std::string& name, const std::string& data) const {
    std::ofstream out(bag_ / name, std::ios::binary);
    McapWriter writer(out);
    const auto topic = writer.add_topic({"said", "std_msgs/String", "", Encoding::cdr});
    writer.write(topic, 1, as_bytes(data));
    writer.close();
  }

  void write_metadata(const std::vector<std::string>& files, const std::string& more = "") const {
    std::string text =
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
        "  duration:\n    nanoseconds: 1\n  relative_file_paths:\n";
    for (const std::string& file : files) text += "    - " + file + "\n";
    write("metadata.yaml", text + more);
  }

  fs::path bag_ = folder_ / "bag";
};

TEST_F(Ros2Bag, FilesAreReadInTheOrderOfTheMetadata) {
  write_mcap("b.mcap", "1");
  write_mcap("a.mcap", "2");
  write_mcap("not_listed.mcap", "3");
  write_metadata({"b.mcap", "a.mcap"}, "  compression_format: \"\"\n  compression_mode: \"\"\n");
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
  EXPECT_THAT(reading.messages, ElementsAre("said 1 1", "said 1 2"));
  EXPECT_THAT(read(bag_.string() + "/").messages, SizeIs(2));
}

TEST_F(Ros2Bag, WithoutMetadataFilesAreReadAsPeopleCount) {
  for (const std::string number : {"0", "1", "2", "10", "11"}) {
    write_mcap("bag_" + number + ".mcap", number);
  }
  write("notes.txt", "");
  fs::create_directory(bag_ / "folder.mcap");
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, ElementsAre(HasSubstr("there is no metadata.yaml")));
  EXPECT_THAT(reading.messages,
              ElementsAre("said 1 0", "said 1 1", "said 1 2", "said 1 10", "said 1 11"));
}

TEST_F(Ros2Bag, OldVersionsListFilesFromTheFolderAbove) {
  write_mcap("bag_0.mcap", "1");
  write_metadata({"bag/bag_0.mcap"});
  EXPECT_THAT(read().messages, SizeIs(1));
  fs::rename(bag_, folder_ / "renamed");
  EXPECT_THAT(read((folder_ / "renamed").string()).messages, SizeIs(1));
}

TEST_F(Ros2Bag, AMissingFileIsAnErrorAndNothingIsRead) {
  write_mcap("bag_0.mcap", "1");
  write_metadata({"bag_0.mcap", "bag_1.mcap"});
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, ElementsAre(HasSubstr("file 'bag_1.mcap' is missing")));
  EXPECT_THAT(reading.messages, IsEmpty());
}

TEST_F(Ros2Bag, OfUnknownCompressionIsAnError) {
  write_mcap("bag_0.mcap", "1");
  write_metadata({"bag_0.mcap"}, "  compression_format: lz4\n  compression_mode: MESSAGE\n");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("compression_format 'lz4' is not known")));
}

#ifdef KINECAL_HAVE_ZSTD

/// Compressed as in ROS 2's mode FILE.  TMPDIR is a folder of this test.
class CompressedRos2Bag : public Ros2Bag {
 protected:
  CompressedRos2Bag() {
    fs::create_directory(temporary_);
    setenv("TMPDIR", temporary_.c_str(), 1);
  }
  ~CompressedRos2Bag() override {
    EXPECT_TRUE(fs::is_empty(temporary_)) << "what was unpacked is left";
    unsetenv("TMPDIR");
  }

  [[nodiscard]] static std::string packed(const std::string& bytes) {
    const auto all = pack(as_bytes(bytes), Compression::zstd);
    return {reinterpret_cast<const char*>(all.data()), all.size()};
  }
  /// "name.zstd" in place of "name"
  void pack_file(const std::string& name) const {
    write(name + ".zstd", packed(FolderTest::read("bag/" + name)));
    fs::remove(bag_ / name);
  }

  fs::path temporary_ = folder_ / "temporary";
};

TEST_F(CompressedRos2Bag, IsReadAsIfItWereNot) {
  write_mcap("bag_0.mcap", "1");
  pack_file("bag_0.mcap");
  write_mcap("bag_1.mcap", std::string(3 << 20, 'x'));
  pack_file("bag_1.mcap");
  EXPECT_THAT(read().messages, SizeIs(2)) << "without metadata.yaml";
  write_metadata({"bag_0.mcap.zstd", "bag_1.mcap.zstd"},
                 "  compression_format: zstd\n  compression_mode: FILE\n");
  const BagReading reading = read();
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_THAT(reading.warnings, IsEmpty());
  EXPECT_THAT(reading.messages, ElementsAre("said 1 1", "said 1 " + std::string(3 << 20, 'x')));
}

TEST_F(CompressedRos2Bag, IsReadOnceIfItIsDecompressedBesideIt) {
  write_mcap("bag_0.mcap", "1");
  pack_file("bag_0.mcap");
  write_mcap("bag_0.mcap", "2");
  EXPECT_THAT(read().messages, ElementsAre("said 1 2")) << "without metadata.yaml";
  write_metadata({"bag_0.mcap.zstd"});
  EXPECT_THAT(read().messages, ElementsAre("said 1 2"));
}

TEST_F(CompressedRos2Bag, ThatIsDamagedIsAnErrorOfTheFileThatIsThere) {
  write_mcap("bag_0.mcap", "1");
  pack_file("bag_0.mcap");
  const std::string whole = FolderTest::read("bag/bag_0.mcap.zstd");
  const auto refusal = [&](const std::string& bytes) {
    write("bag_0.mcap.zstd", bytes);
    const BagReading reading = read();
    EXPECT_THAT(reading.messages, IsEmpty());
    return reading.errors.size() == 1 ? reading.errors[0] : "not one error";
  };
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THAT(refusal(whole.substr(0, size)), HasSubstr("bag/bag_0.mcap.zstd: ")) << size;
  }
  EXPECT_THAT(refusal(whole.substr(0, whole.size() - 1)), HasSubstr("is it cut off?"));
  EXPECT_THAT(refusal(packed("no MCAP")), HasSubstr("bag_0.mcap.zstd: is neither"));
  EXPECT_THAT(refusal(packed("")), HasSubstr("bag_0.mcap.zstd: is empty"));
  EXPECT_THAT(refusal(packed(whole)), HasSubstr("is neither")) << "not twice";
}

TEST_F(CompressedRos2Bag, ThatCannotBeUnpackedSaysWhy) {
  write_mcap("bag_0.mcap", "1");
  pack_file("bag_0.mcap");
  setenv("TMPDIR", "/no/such/folder", 1);
  EXPECT_THAT(
      read().errors,
      ElementsAre(HasSubstr("bag_0.mcap.zstd: cannot be unpacked: TMPDIR is not a folder")));
}

#else

TEST_F(Ros2Bag, ThatIsCompressedSaysWhatToInstall) {
  write("bag_0.mcap.zstd", std::string(kZstdMagic) + " and so on");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("install libzstd-dev and build again")));
}

#endif

TEST_F(Ros2Bag, EndlessMetadataIsNotRead) {
  write_mcap("bag_0.mcap", "1");
  write_metadata({"bag_0.mcap"});
  fs::resize_file(bag_ / "metadata.yaml", std::uintmax_t{1} << 40);
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("metadata.yaml: has more bytes than")));
}

TEST_F(Ros2Bag, WrongMetadataIsAnErrorWithItsPlace) {
  write_mcap("bag_0.mcap", "1");
  const auto errors_of = [&](const std::string& metadata) {
    write("metadata.yaml", metadata);
    return read().errors;
  };
  EXPECT_THAT(errors_of(""), ElementsAre(HasSubstr("has no map 'rosbag2_bagfile_information'")));
  EXPECT_THAT(errors_of(std::string(200'000, '[')), SizeIs(1));
  EXPECT_THAT(errors_of(std::string(200'000, '{')), SizeIs(1));
  EXPECT_THAT(errors_of("[1, 2"), ElementsAre(HasSubstr("metadata.yaml:")));
  EXPECT_THAT(errors_of("rosbag2_bagfile_information: [1]"), SizeIs(1));
  EXPECT_THAT(errors_of("rosbag2_bagfile_information: {version: 1}"),
              ElementsAre(HasSubstr("has no list 'relative_file_paths'")));
  EXPECT_THAT(errors_of("rosbag2_bagfile_information: {relative_file_paths: []}"),
              ElementsAre(HasSubstr("lists no files")));
  EXPECT_THAT(errors_of("rosbag2_bagfile_information:\n  relative_file_paths:\n  - [a]\n"),
              ElementsAre(HasSubstr("metadata.yaml:3: ")));
}

TEST_F(Ros2Bag, AFolderThatIsNotABagIsAnError) {
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("is not a ROS 2 bag")));
  EXPECT_THAT(read("/no/such/folder").errors, ElementsAre(HasSubstr("is not a ROS 2 bag")));
  write("bag_0.mcap", "no MCAP");
  EXPECT_THAT(read().errors, ElementsAre(HasSubstr("it begins like neither")));
}

#ifdef KINECAL_HAVE_SQLITE

TEST_F(Ros2Bag, FilesMayBeOfTwoKinds) {
  write_mcap("bag_0.mcap", "1");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((bag_ / "bag_1.db3").c_str(), &database), SQLITE_OK);
  const char* statements =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);"
      "INSERT INTO topics VALUES(1, '/said', 'std_msgs/msg/String', 'cdr');"
      "INSERT INTO messages VALUES(1, 1, 2, CAST('2' AS BLOB));";
  EXPECT_EQ(sqlite3_exec(database, statements, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  write_metadata({"bag_0.mcap", "bag_1.db3"});
  EXPECT_THAT(read().messages, ElementsAre("said 1 1", "said 2 2"));
}

#endif

TEST(Ros2Formats, AreKnownByTheirFirstBytes) {
  EXPECT_TRUE(is_mcap(as_bytes(kMcapMagic)));
  EXPECT_FALSE(is_mcap(as_bytes(kMcapMagic.substr(0, 7))));
  EXPECT_TRUE(is_sqlite(as_bytes(kSqliteMagic)));
  EXPECT_FALSE(is_sqlite(as_bytes("SQLite format 2")));
  EXPECT_FALSE(is_sqlite({}));
}

TEST(Ros2Formats, TypesAreCalledAsInRos1) {
  EXPECT_EQ(plain_type("sensor_msgs/msg/JointState"), "sensor_msgs/JointState");
  EXPECT_EQ(plain_type("sensor_msgs/JointState"), "sensor_msgs/JointState");
  EXPECT_EQ(ros2_type("sensor_msgs/JointState"), "sensor_msgs/msg/JointState");
  EXPECT_EQ(ros2_type("sensor_msgs/msg/JointState"), "sensor_msgs/msg/JointState");
  EXPECT_EQ(ros2_type("plain"), "plain");
}

}  // namespace
}  // namespace kinecal
