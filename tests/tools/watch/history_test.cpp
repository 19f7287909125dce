#include "kinecal/tools/watch/history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "kinecal/files/diagnostics.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

#ifdef KINECAL_HAVE_SQLITE
#include <sqlite3.h>

namespace kinecal {
namespace {

using testing::HasSubstr;

class HistoryTest : public test::FolderTest {
 protected:
  const std::string file_ = (folder_ / "history.sqlite").string();

  [[nodiscard]] static WatchedRecording recording(const std::string& name, double time) {
    WatchedRecording of{.name = name,
                        .checksum = "sum of " + name,
                        .size = 7,
                        .modified = 11,
                        .time = time,
                        .state = RecordingState::holds};
    of.samples = 6;
    of.statistic = 30.5;
    of.freedom = 36.0;
    of.probability = 0.7;
    of.changes = {{"elbow", false, {"elbow"}, {"rad"}, {1e-3}, {4e-8}, 32.5, true},
                  {"flange",
                   true,
                   {"flange_x", "flange_a"},
                   {"m", "rad"},
                   {1e-4, 2e-4},
                   {1, 2, 3, 4},
                   31.0,
                   false}};
    return of;
  }
  void execute(const char* sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }
};

TEST_F(HistoryTest, KeepsRecordingsByEpoch) {
  std::int64_t epoch = 0;
  {
    History history(file_);
    epoch = history.epoch("arm", "structure", "result 1");
    EXPECT_FALSE(history.follows_another(epoch));
    history.add(epoch, std::vector{recording("b", 20.0), recording("a", 10.0)});
  }
  History history(file_);
  EXPECT_EQ(history.epoch("arm", "structure", "result 1"), epoch);
  const std::vector<WatchedRecording> kept = history.recordings(epoch);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].name, "a");
  const WatchedRecording& b = kept[1];
  EXPECT_EQ(b.time, 20.0);
  EXPECT_EQ(b.state, RecordingState::holds);
  EXPECT_EQ(b.samples, 6);
  EXPECT_EQ(b.probability, 0.7);
  ASSERT_EQ(b.changes.size(), 2u);
  EXPECT_TRUE(b.changes[1].is_of(recording("b", 0.0).changes[1]));
  EXPECT_THAT(b.changes[1].units, testing::ElementsAre("m", "rad"));
  EXPECT_THAT(b.changes[1].covariance, testing::ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(b.changes[0].score, 32.5);
  EXPECT_TRUE(b.changes[0].explains);

  const std::int64_t later = history.epoch("arm", "structure", "result 2");
  EXPECT_NE(later, epoch);
  EXPECT_TRUE(history.follows_another(later));
  EXPECT_TRUE(history.recordings(later).empty());
  EXPECT_TRUE(history.knows(later, recording("a", 0.0)))
      << "it was looked at with the earlier result";
  EXPECT_EQ(history.epoch("arm", "structure", "result 1"), epoch) << "which was restored";
}

TEST_F(HistoryTest, CountsAContentOnce) {
  History history(file_);
  const std::int64_t epoch = history.epoch("arm", "s", "r"),
                     other = history.epoch("other", "s", "r");
  history.add(epoch, std::vector{recording("a", 10.0)});
  WatchedRecording copy = recording("a", 10.0);
  copy.name = "copy";
  history.add(epoch, std::vector{copy});
  EXPECT_EQ(history.recordings(epoch).size(), 1u);
  EXPECT_TRUE(history.knows(epoch, copy));
  EXPECT_FALSE(history.knows(other, copy));
  const auto same = history.with_content("sum of a");
  ASSERT_TRUE(same);
  EXPECT_EQ(same->robot, "arm");
  copy.size = 8;
  EXPECT_FALSE(history.knows(epoch, copy)) << "it has changed";
}

TEST_F(HistoryTest, ReplacesARefusedFileThatChanged) {
  History history(file_);
  const std::int64_t epoch = history.epoch("arm", "s", "r");
  WatchedRecording bad{
      .name = "a", .checksum = "cut off", .size = 3, .modified = 1, .reason = "is cut off"};
  history.add(epoch, std::vector{bad});
  ASSERT_EQ(history.recordings(epoch).size(), 1u);
  EXPECT_EQ(history.recordings(epoch)[0].reason, "is cut off");
  EXPECT_FALSE(history.with_content("cut off"));
  EXPECT_TRUE(history.knows(epoch, bad)) << "it is not tried again";
  history.add(epoch, std::vector{recording("a", 10.0)});
  ASSERT_EQ(history.recordings(epoch).size(), 1u);
  EXPECT_EQ(history.recordings(epoch)[0].state, RecordingState::holds);
}

/// A mesh was missing, memory was short: a new start may read it.
TEST_F(HistoryTest, LooksAgainAtWhatWasRefused) {
  WatchedRecording refused{
      .name = "a", .checksum = "1", .size = 3, .modified = 1, .reason = "a mesh is missing"};
  const WatchedRecording good = recording("b", 10.0);
  std::int64_t epoch = 0;
  {
    History history(file_);
    epoch = history.epoch("arm", "s", "r");
    history.add(epoch, std::vector{refused, good});
    EXPECT_TRUE(history.knows(epoch, refused));
  }
  History history(file_);
  EXPECT_FALSE(history.knows(epoch, refused));
  EXPECT_TRUE(history.knows(epoch, good));
  EXPECT_TRUE(history.knows(history.epoch("arm", "s", "later"), refused)) << "of an earlier result";
  history.add(epoch, std::vector{refused});
  EXPECT_TRUE(history.knows(epoch, refused)) << "once is enough";
  EXPECT_EQ(history.recordings(epoch).size(), 2u);
  refused.may_pass = true;
  history.add(epoch, std::vector{refused});
  EXPECT_FALSE(history.knows(epoch, refused)) << "it is tried at the next look";
}

TEST_F(HistoryTest, IsNotThatOfAnotherRobot) {
  History history(file_);
  (void)history.epoch("arm", "six joints", "r");
  EXPECT_THAT(test::thrown<InputError>([&] { (void)history.epoch("arm", "seven joints", "r"); }),
              HasSubstr("history.sqlite: robot 'arm' there has other links or joints"));
}

TEST_F(HistoryTest, RefusesWhatIsNoHistory) {
  write("history.sqlite",
        "not a database at all, but long enough to be read as the header of one, which it is not");
  EXPECT_THAT(test::thrown<InputError>([&] { History history(file_); }),
              HasSubstr("is not a history of 'kinecal watch'"));
  std::filesystem::remove(file_);
  execute("CREATE TABLE messages(id INTEGER)");
  EXPECT_THAT(test::thrown<InputError>([&] { History history(file_); }),
              HasSubstr("is not a history of 'kinecal watch'"));
  std::filesystem::remove(file_);
  { const History made(file_); }
  execute("PRAGMA user_version = 2");
  EXPECT_THAT(test::thrown<InputError>([&] { History history(file_); }), HasSubstr("version 2"));
  EXPECT_THAT(test::thrown<InputError>([&] { History history((folder_ / "no" / "x").string()); }),
              HasSubstr("cannot be written"));
}

TEST_F(HistoryTest, OfTwoWatchersTheSecondWaitsAndSaysSo) {
  History first(file_), second(file_, 0.02);
  const std::int64_t epoch = first.epoch("arm", "s", "r");
  EXPECT_EQ(second.epoch("arm", "s", "r"), epoch);
  first.add(epoch, std::vector{recording("a", 1.0)});
  second.add(epoch, std::vector{recording("a", 1.0), recording("b", 2.0)});  // it saw a, too
  EXPECT_EQ(first.recordings(epoch).size(), 2u);
  sqlite3* writing = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &writing), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(writing, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_THAT(
      test::thrown<InputError>([&] { second.add(epoch, std::vector{recording("c", 3.0)}); }),
      HasSubstr("another 'kinecal watch' is writing to it"));
  sqlite3_close(writing);
  second.add(epoch, std::vector{recording("c", 3.0)});
  EXPECT_EQ(second.recordings(epoch).size(), 3u);
}

TEST_F(HistoryTest, StaysWholeOnAFullDisk) {
  History history(file_);
  const std::int64_t epoch = history.epoch("arm", "s", "r");
  history.add(epoch, std::vector{recording("a", 1.0)});
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;  // what is written beyond fails
  full.rlim_cur = std::filesystem::file_size(file_);
  setrlimit(RLIMIT_FSIZE, &full);
  std::vector<WatchedRecording> many;
  for (int i = 0; i < 300; ++i) many.push_back(recording("b" + std::to_string(i), 2.0));
  const std::string said = test::thrown<InputError>([&] { history.add(epoch, many); });
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(said, HasSubstr("is the disk full?  What was found last is not in the history"));
  EXPECT_EQ(History(file_).recordings(epoch).size(), 1u);
  history.add(epoch, many);
  EXPECT_EQ(history.recordings(epoch).size(), 301u);
}

}  // namespace
}  // namespace kinecal

#endif
