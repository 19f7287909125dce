// Programs run as their users run them, in a folder of their own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace kinecal::test {

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// A program and its arguments, by way of the shell, in a folder.
inline Outcome run_in(const std::filesystem::path& folder, const std::string& call) {
  const auto read = [&](const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string command = "cd " + folder.string() + " && " + call + " > out.txt 2> err.txt";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out.txt"), read("err.txt")};
}

class ProgramTest : public testing::Test {
 protected:
  ProgramTest() {
    char folder[] = "/tmp/kinecal_program_XXXXXX";
    folder_ = mkdtemp(folder);
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// A program and its arguments, by way of the shell.
  [[nodiscard]] Outcome run(const std::string& call) const { return run_in(folder_, call); }

  std::filesystem::path folder_;
};

}  // namespace kinecal::test
