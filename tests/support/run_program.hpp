// Runs programs as users do, each in its own folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/temporary_folder.hpp"

namespace kinecal::test {

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// Runs a program with arguments through the shell, in a folder.
inline Outcome run_in(const std::filesystem::path& folder, const std::string& call) {
  const auto read = [&](const char* name) {
    std::ifstream file(folder / name, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string command = "cd " + folder.string() + " && " + call + " > out.txt 2> err.txt";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out.txt"), read("err.txt")};
}

class ProgramTest : public FolderTest {
 protected:
  /// Runs a program with arguments through the shell.
  [[nodiscard]] Outcome run(const std::string& call) const { return run_in(folder_, call); }
};

}  // namespace kinecal::test
