#include "kinecal/robots/child_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "support/error_of.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::detail {
namespace {

using std::chrono::milliseconds;
using test::error_of;
using testing::HasSubstr;

constexpr milliseconds kLimit{5000};

TEST(ChildProcess, SpeaksInLines) {
  ChildProcess child("cat");
  child.write_line("one", kLimit);
  child.write_line("", kLimit);
  EXPECT_EQ(child.read_line(kLimit), "one");
  EXPECT_EQ(child.read_line(kLimit), "");
  EXPECT_EQ(child.read_line(milliseconds(20)), std::nullopt);
}

TEST(ChildProcess, TakesLongLines) {
  ChildProcess child("head -c 3000000 /dev/zero | tr '\\0' x; echo; echo end");
  EXPECT_EQ(child.read_line(kLimit), std::string(3'000'000, 'x'));
  EXPECT_EQ(child.read_line(kLimit), "end");
}

TEST(ChildProcess, ItsEndIsReportedWithItsKind) {
  const auto error = [](const char* command) {
    ChildProcess child(command);
    return error_of([&] {
      while (child.read_line(kLimit)) {
      }
    });
  };
  EXPECT_THAT(error("echo last; exit 3"),
              HasSubstr("connection: 'echo last; exit 3' ended with exit code 3"));
  EXPECT_THAT(error("kill -9 $$"), HasSubstr("was ended by signal 9"));
  EXPECT_THAT(error("no-such-command-here 2> /dev/null"), HasSubstr("exit code 127"));
}

TEST(ChildProcess, WritingToOneThatHasEndedIsReported) {
  ChildProcess child("exit 4");
  EXPECT_THAT(error_of([&] {
                for (int i = 0; i < 1000; ++i) child.write_line("x", kLimit);
              }),
              HasSubstr("connection: 'exit 4' ended with exit code 4"));
}

TEST(ChildProcess, OneThatDoesNotReadIsReported) {
  ChildProcess child("sleep 100");
  EXPECT_THAT(error_of([&] { child.write_line(std::string(5'000'000, 'x'), milliseconds(100)); }),
              HasSubstr("connection: 'sleep 100' does not read"));
}

TEST(ChildProcess, EndsWithItsChildren) {
  const test::TemporaryFolder folder;
  const std::string alive = (folder.path() / "alive").string();
  {
    ChildProcess child("(trap '' PIPE; while :; do touch " + alive + "; sleep 0.01; done) & wait");
    while (!std::filesystem::exists(alive)) std::this_thread::sleep_for(milliseconds(5));
  }
  std::filesystem::remove(alive);
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_FALSE(std::filesystem::exists(alive));
}

}  // namespace
}  // namespace kinecal::detail
