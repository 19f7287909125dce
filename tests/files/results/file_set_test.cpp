#include "kinecal/files/results/file_set.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <thread>

#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;

class FileSet : public test::FolderTest {
 protected:
  [[nodiscard]] std::ptrdiff_t count() const {
    return std::distance(fs::directory_iterator(folder_), {});
  }
};

TEST_F(FileSet, ReplacesFilesAndLeavesNothingElse) {
  OutputFolder(folder_).write({{"a", "1"}, {"b", "2"}});
  OutputFolder(folder_).write({{"a", "3"}, {"b", "4"}});
  EXPECT_EQ(read("a"), "3");
  EXPECT_EQ(read("b"), "4");
  EXPECT_EQ(count(), 2);
}

TEST_F(FileSet, KeepsFilesThatAppearMeanwhileIfItIsToKeepThem) {
  OutputFolder folder(folder_);
  write("b", "of somebody");
  EXPECT_THROW(folder.write({{"a", "1"}, {"b", "2"}}, Existing::kept), OutputError);
  EXPECT_EQ(read("b"), "of somebody");
  EXPECT_EQ(count(), 1) << "all files or none";
  fs::remove(folder_ / "b");
  folder.write({{"a", "1"}, {"b", "2"}}, Existing::kept);
  EXPECT_EQ(read("b"), "2");
  EXPECT_EQ(count(), 2);
}

TEST_F(FileSet, ASingleFileThatAppearsMeanwhileIsKeptToo) {
  const std::string file = folder_ / "report.html";
  write("report.html", "of somebody");
  EXPECT_THROW(write_text_file(file, "1", Existing::kept), OutputError);
  EXPECT_EQ(read("report.html"), "of somebody");
  write_text_file(file, "2");
  EXPECT_EQ(read("report.html"), "2");
  EXPECT_EQ(count(), 1);
}

TEST_F(FileSet, SweepsTheFoldersOfRunsThatWereKilled) {
  for (const char* name : {".kinecal-abc123", ".kinecal-def456"}) {
    fs::create_directory(folder_ / name);
    write(std::string(name) + "/half", "written");
  }
  write(".kinecal-file12", "not a folder");
  fs::create_directory(folder_ / ".kinecal-of-somebody");
  const int alive = ::open((folder_ / ".kinecal-def456").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(alive, LOCK_EX), 0);
  OutputFolder(folder_).write({{"a", "1"}});
  EXPECT_FALSE(fs::exists(folder_ / ".kinecal-abc123"));
  EXPECT_TRUE(fs::exists(folder_ / ".kinecal-def456/half")) << "a run that is alive holds its lock";
  EXPECT_TRUE(fs::exists(folder_ / ".kinecal-file12"));
  EXPECT_TRUE(fs::exists(folder_ / ".kinecal-of-somebody"));
  ::close(alive);
  OutputFolder(folder_).write({{"a", "2"}});
  EXPECT_FALSE(fs::exists(folder_ / ".kinecal-def456"));
  EXPECT_EQ(read("a"), "2");
}

/// Each run sweeps while others make their folders.
TEST_F(FileSet, RunsThatSweepDoNotDisturbEachOther) {
  std::vector<std::thread> runs;
  for (int r = 0; r < 4; ++r) {
    runs.emplace_back([&, r] {
      for (int i = 0; i < 50; ++i) {
        EXPECT_NO_THROW(
            OutputFolder(folder_).write({{"f" + std::to_string(r), std::to_string(i)}}));
      }
    });
  }
  for (std::thread& run : runs) run.join();
  EXPECT_EQ(count(), 4);
}

TEST_F(FileSet, WritesNothingWhenOneFileCannotBePlaced) {
  OutputFolder(folder_).write({{"a", "old"}});
  fs::create_directory(folder_ / "b");
  EXPECT_THROW(OutputFolder(folder_).write({{"a", "new"}, {"b", "new"}}), OutputError);
  EXPECT_EQ(read("a"), "old");
  EXPECT_EQ(count(), 2);
}

TEST_F(FileSet, OfSeveralFoldersIsWrittenWholeOrNotAtAll) {
  const auto a = folder_ / "a", b = folder_ / "b";
  write_file_sets({{a, {{"x", "1"}}}, {b, {{"y", "2"}}}, {folder_ / "b/../a", {{"z", "3"}}}});
  const auto content = [](const std::filesystem::path& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(content(a / "x") + content(b / "y") + content(a / "z"), "123");
  std::filesystem::create_directories(b / "y2");
  EXPECT_THROW(write_file_sets({{a, {{"x", "4"}}}, {b, {{"y", "5"}, {"y2", "6"}}}}), OutputError);
  EXPECT_EQ(content(a / "x") + content(b / "y"), "12");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(a), {}), 2) << "nothing else is left";
  const std::string no_room_for_a_second_name(250, 'n');  // which it has while it is replaced
  write_file_sets({{b, {{no_room_for_a_second_name, "7"}}}});
  EXPECT_THROW(
      write_file_sets({{a, {{"x", "8"}, {"new", "9"}}}, {b, {{no_room_for_a_second_name, "10"}}}}),
      OutputError);
  EXPECT_EQ(content(a / "x") + content(b / no_room_for_a_second_name), "17") << "a is put back";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(a), {}), 2);
}

TEST_F(FileSet, WritesNothingWhenANameCannotBeUsed) {
  OutputFolder(folder_).write({{"a", "old"}});
  EXPECT_THROW(OutputFolder(folder_).write({{"a", "new"}, {"no/such/folder", "new"}}), OutputError);
  EXPECT_EQ(read("a"), "old");
  EXPECT_EQ(count(), 1);
}

TEST_F(FileSet, RemovesOnlyTheEmptyFoldersThatItMade) {
  { const OutputFolder made(folder_ / "x/y"); }
  EXPECT_EQ(count(), 0);
  OutputFolder(folder_ / "x/y").write({{"a", "1"}});
  EXPECT_EQ(read("x/y/a"), "1");
}

/// Processes that share a calibration begin together: each checks that it can write.
TEST_F(FileSet, RunsThatRemoveAnEmptyFolderDoNotDisturbEachOther) {
  std::vector<std::thread> runs;
  for (int r = 0; r < 4; ++r) {
    runs.emplace_back([&] {
      for (int i = 0; i < 100; ++i) EXPECT_NO_THROW(OutputFolder(folder_ / "x/y"));
    });
  }
  for (std::thread& run : runs) run.join();
  OutputFolder(folder_ / "x/y").write({{"a", "1"}});
  EXPECT_EQ(read("x/y/a"), "1");
}

TEST_F(FileSet, TwoWritersNeverMixTheirFilesNorLeaveAGap) {
  OutputFolder(folder_).write({{"a", "0"}, {"b", "0"}});
  const auto write = [&](const std::string& content) {
    for (int i = 0; i < 20; ++i) OutputFolder(folder_).write({{"a", content}, {"b", content}});
  };
  std::thread one(write, "1"), two(write, "2");
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(fs::exists(folder_ / "a"));
  one.join();
  two.join();
  EXPECT_EQ(read("a"), read("b"));
  EXPECT_EQ(count(), 2);
}

}  // namespace
}  // namespace kinecal
