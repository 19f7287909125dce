// The cost of including a header: seconds, memory and lines of translation units.
//
//   include_cost_bench <compiler> <flag>... -- <translation unit>...
//
// Each is compiled three times.  Seconds are processor time, which other programs on the machine do
// not change, and the median of the three.  Memory is the compiler's largest resident set.  Lines
// are the non-empty ones after preprocessing.
// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Command = std::vector<std::string>;

struct Usage {
  double seconds;    ///< of the processor, user and system
  double megabytes;  ///< largest resident set of the command and its children
};

Command operator+(Command command, const Command& more) {
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// @throws std::runtime_error  if the command fails
Usage run(const Command& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    execvp(words[0], words.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) {
    throw std::runtime_error("'" + command.front() + "' fails on " + command.back());
  }
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) / 1024.0};
}

Usage median_of_three(const Command& command) {
  std::array<Usage, 3> usages{run(command), run(command), run(command)};
  std::sort(usages.begin(), usages.end(),
            [](const Usage& a, const Usage& b) { return a.seconds < b.seconds; });
  return usages[1];
}

long preprocessed_lines(const Command& compile, const std::string& unit) {
  const auto file =
      std::filesystem::temp_directory_path() / ("include_cost_" + std::to_string(getpid()) + ".ii");
  run(compile + Command{"-E", "-P", "-o", file.string(), unit});
  std::ifstream in(file);
  long lines = 0;
  for (std::string line; std::getline(in, line);) lines += !line.empty();
  std::filesystem::remove(file);
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  const Command arguments(argv + 1, argv + argc);
  const auto separator = std::find(arguments.begin(), arguments.end(), "--");
  if (separator == arguments.begin() || separator == arguments.end()) {
    std::fprintf(stderr,
                 "usage: include_cost_bench <compiler> <flag>... -- <translation unit>...\n");
    return 1;
  }
  const Command compile(arguments.begin(), separator);
  try {
    std::printf("%-24s %8s %8s %8s\n", "translation unit", "seconds", "MB", "lines");
    for (auto unit = separator + 1; unit != arguments.end(); ++unit) {
      const Usage usage = median_of_three(compile + Command{"-c", "-o", "/dev/null", *unit});
      std::printf("%-24s %8.2f %8.0f %8ld\n", std::filesystem::path(*unit).stem().c_str(),
                  usage.seconds, usage.megabytes, preprocessed_lines(compile, *unit));
      std::fflush(stdout);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
