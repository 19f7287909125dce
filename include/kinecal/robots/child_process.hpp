// A user's command as a child process; exchanges lines with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace kinecal::detail {

/// A running command.  Connected to its standard input and output; its errors go where ours go.
class ChildProcess {
 public:
  /// Largest size of a line, bytes.
  static constexpr std::size_t kMostOfALine = std::size_t{256} << 20;

  /// @param command      for /bin/sh
  /// @param interrupted  returns true to stop waiting for the command; may be empty
  /// @throws ConnectionError  if it cannot be started
  explicit ChildProcess(std::string command, std::function<bool()> interrupted = {});
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Closes its input; kills it and its children if it does not end within half a second.
  ~ChildProcess();

  /// Sends a line.
  /// @param line  without the line end
  /// @throws ConnectionError  if the command has ended, does not read within the time limit, or
  ///                          waiting is interrupted
  void write_line(const std::string& line, std::chrono::milliseconds time_limit);

  /// Its next line, without the line end; nullopt if none comes in time.
  /// @throws ConnectionError  if the command has ended (with the reason), the line is too long, or
  ///                          waiting is interrupted
  [[nodiscard]] std::optional<std::string> read_line(std::chrono::milliseconds time_limit);

  /// The command, as given.
  [[nodiscard]] const std::string& command() const { return command_; }

 private:
  [[noreturn]] void fail_ended();
  [[nodiscard]] bool wait_until_ready(int socket, short event,
                                      std::chrono::steady_clock::time_point deadline) const;
  [[nodiscard]] bool wait_for_end(std::chrono::milliseconds time_limit);

  std::string command_;
  std::function<bool()> interrupted_;
  pid_t child_ = -1;  ///< -1 after its end
  int status_ = 0;    ///< of its end
  int input_ = -1, output_ = -1;
  std::string received_;  ///< an unfinished line
  std::size_t searched_ = 0;
};

}  // namespace kinecal::detail
