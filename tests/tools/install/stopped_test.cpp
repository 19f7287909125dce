// An installation that is stopped, or meets a full disk, at any of its steps.
//
// The calls that change the disk are taken over here: at the n-th one the process ends, as in a
// crash, or the call fails, as on a full disk; for every n.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <optional>

#include "kinecal/tools/install/install.hpp"
#include "support/launch_scene.hpp"

namespace {

enum class Fault { none, crash, full_disk };
Fault fault = Fault::none;
int calls_left = 0;

constexpr int kCrashed = 42;

bool fails() {
  if (fault == Fault::none || calls_left-- > 0) return false;
  if (fault == Fault::crash) _exit(kCrashed);
  fault = Fault::none;  // what cleans up works
  errno = ENOSPC;
  return true;
}

}  // namespace

extern "C" {
int rename(const char* from, const char* to) noexcept {
  return fails() ? -1 : static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}
int link(const char* from, const char* to) noexcept {
  return fails() ? -1 : static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int mkdir(const char* path, mode_t mode) noexcept {
  return fails() ? -1 : static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}
int fsync(int file) {
  return fails() ? -1 : static_cast<int>(syscall(SYS_fsync, file));
}
ssize_t write(int file, const void* bytes, size_t size) {
  return file > 2 && fails() ? -1 : static_cast<ssize_t>(syscall(SYS_write, file, bytes, size));
}
}

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;

class Stopped : public test::InstallScene {
 protected:
  void install() {
    Diagnostics ignored;
    (void)kinecal::install(read_result_folder(folder_ / "out"), folder_ / "robot", "robot.launch",
                           fetch_launch_names(), ignored);
  }
  void restore() { (void)restore_installed(folder_ / "robot", "robot.launch"); }

  /// Starts from an untouched robot.
  void reset() {
    fs::remove_all(folder_ / "robot");
    fs::create_directory(folder_ / "robot");
    write("robot/robot.launch", test::kLaunch);
  }

  /// Ends a process at its n-th call.  @return  whether it came so far
  static bool crashes(int n, const std::function<void()>& run) {
    const pid_t child = fork();
    if (child == 0) {
      calls_left = n;
      fault = Fault::crash;
      run();
      _exit(0);
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status) == kCrashed;
  }

  /// Fails at the n-th call.  @return  whether that was reported; nothing if there are fewer calls
  static std::optional<bool> fails_at(int n, const std::function<void()>& run) {
    calls_left = n;
    fault = Fault::full_disk;
    bool reported = false;
    try {
      run();
    } catch (const OutputError&) {
      reported = true;
    }
    const bool reached = fault == Fault::none;
    fault = Fault::none;
    return reached ? std::optional(reported) : std::nullopt;
  }
};

constexpr int kMostCalls = 100;  // an installation has about 25

TEST_F(Stopped, ARobotCanBeStartedAfterACrashAtAnyStep) {
  install();
  const auto done = robot();
  int n = 0;
  for (; n < kMostCalls; ++n) {
    reset();
    if (!crashes(n, [&] { install(); })) break;
    EXPECT_THAT(launch(), AnyOf(test::kLaunch, done.at("robot.launch"))) << n;
    if (launch() != test::kLaunch) {
      for (const auto& [name, content] : done) EXPECT_EQ(read("robot/" + name), content) << n;
    }
    install();  // nothing is in its way, and one command takes it back
    EXPECT_EQ(robot(), done) << n;
    restore();
    EXPECT_EQ(launch(), test::kLaunch) << n;
    EXPECT_THROW(restore(), InputError) << n;
  }
  EXPECT_GT(n, 15);
  EXPECT_LT(n, kMostCalls);
}

TEST_F(Stopped, AFullDiskLeavesTheFolderAsItWas) {
  install();
  const auto done = robot();
  int failures = 0;
  for (int n = 0; n < kMostCalls; ++n) {
    reset();
    const auto before = robot();
    const auto reported = fails_at(n, [&] { install(); });
    if (!reported) break;
    if (*reported) ++failures;
    // Not reported: a link that failed became a copy.  Done: the wait after the last rename failed.
    EXPECT_THAT(robot(), AnyOf(before, done)) << n;
    EXPECT_TRUE(*reported || robot() == done) << n;
  }
  EXPECT_GT(failures, 15);
}

TEST_F(Stopped, RestoringCanBeStoppedAtAnyStep) {
  int n = 0;
  for (; n < kMostCalls; ++n) {
    reset();
    install();
    const std::string installed = launch();
    if (!crashes(n, [&] { restore(); })) break;
    EXPECT_THAT(launch(), AnyOf(test::kLaunch, installed)) << n;
    if (launch() == installed) restore();
    EXPECT_EQ(launch(), test::kLaunch) << n;
    EXPECT_THROW(restore(), InputError) << n;
    EXPECT_EQ(read("robot/robot.launch.undone_1"), installed);
  }
  EXPECT_GT(n, 4);
}

TEST_F(Stopped, AFullDiskLeavesAVersionThatWorksWhenRestoring) {
  int failures = 0;
  for (int n = 0; n < kMostCalls; ++n) {
    reset();
    install();
    const std::string installed = launch();
    const auto reported = fails_at(n, [&] { restore(); });
    if (!reported) break;
    if (*reported) ++failures;
    EXPECT_THAT(launch(), AnyOf(test::kLaunch, installed)) << n;
  }
  EXPECT_GT(failures, 2);
}

}  // namespace
}  // namespace kinecal
