#include "kinecal/io/results/file_set.hpp"

#include <gtest/gtest.h>

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

TEST_F(FileSet, WritesNothingWhenOneFileCannotBePlaced) {
  OutputFolder(folder_).write({{"a", "old"}});
  fs::create_directory(folder_ / "b");
  EXPECT_THROW(OutputFolder(folder_).write({{"a", "new"}, {"b", "new"}}), OutputError);
  EXPECT_EQ(read("a"), "old");
  EXPECT_EQ(count(), 2);
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
