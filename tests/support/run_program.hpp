// Runs programs as users do, each in its own folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal::test {

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// How a program ended that ran in a folder.
inline Outcome outcome_of(const std::filesystem::path& folder, int status) {
  const auto read = [&](const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out.txt"), read("err.txt")};
}

/// Runs a program with arguments through the shell, in a folder.
inline Outcome run_in(const std::filesystem::path& folder, const std::string& call) {
  const std::string command = "cd " + folder.string() + " && " + call + " > out.txt 2> err.txt";
  return outcome_of(folder, std::system(command.c_str()));
}

/// The same, and sends the program a signal as soon as something has happened that it can be seen to do.
inline Outcome run_and_send(const std::filesystem::path& folder, const std::string& call,
                            int signal, const std::function<bool()>& has_happened) {
  const std::string command =
      "cd " + folder.string() + " && exec " + call + " > out.txt 2> err.txt";
  const pid_t program = fork();
  if (program == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  while (waitpid(program, &status, WNOHANG) == 0) {
    if (!has_happened()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    kill(program, signal);
    waitpid(program, &status, 0);
    break;
  }
  return outcome_of(folder, status);
}

class ProgramTest : public FolderTest {
 protected:
  /// Runs a program with arguments through the shell.
  [[nodiscard]] Outcome run(const std::string& call) const { return run_in(folder_, call); }
  /// Runs kinecal with nobody to ask, for ten minutes at most.
  [[nodiscard]] Outcome kinecal(const std::string& arguments) const {
    return run("timeout 600 " + kinecal_program() + " " + arguments + " < /dev/null");
  }
};

/// In a folder with the example of a tracker: its table, the meaning of its columns, and the robot.
class TrackerExampleTest : public ProgramTest {
 protected:
  TrackerExampleTest() {
    const std::filesystem::path examples = std::filesystem::path(source_folder()) / "examples";
    for (const char* file : {"csv/tracker.csv", "csv/columns.yaml", "robots/ur5e/ur5e.urdf"}) {
      std::filesystem::copy(examples / file, folder_);
    }
  }
};

}  // namespace kinecal::test
