// Definitions of child_process.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal::detail {

/// A pair of connected sockets; unlike a pipe, writing to one after the other end has closed raises
/// no signal.
[[nodiscard]] inline std::array<int, 2> socket_pair() {
  std::array<int, 2> ends{-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw ConnectionError(std::string("a process cannot be started: ") + std::strerror(errno));
  }
  return ends;
}

[[nodiscard]] inline int milliseconds_left(std::chrono::steady_clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
      deadline - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
}

ChildProcess::ChildProcess(std::string command, std::function<bool()> interrupted)
    : command_(std::move(command)), interrupted_(std::move(interrupted)) {
  const auto [input, its_input] = socket_pair();
  const auto [output, its_output] = socket_pair();
  input_ = input;
  output_ = output;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, its_input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, its_output, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // kills its children with it
  std::array<std::string, 3> words{"sh", "-c", command_};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  const int error = posix_spawn(&child_, "/bin/sh", &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  close(its_input);
  close(its_output);
  if (error == 0) return;
  close(input_);
  close(output_);
  throw ConnectionError("'" + command_ + "' cannot be started: " + std::strerror(error));
}

ChildProcess::~ChildProcess() {
  close(input_);
  close(output_);
  constexpr std::chrono::milliseconds kGrace{500};
  for (const int signal : {SIGTERM, SIGKILL}) {
    if (wait_for_end(kGrace)) return;
    kill(-child_, signal);
  }
  waitpid(child_, &status_, 0);
}

bool ChildProcess::wait_for_end(std::chrono::milliseconds time_limit) {
  const auto deadline = std::chrono::steady_clock::now() + time_limit;
  constexpr std::chrono::milliseconds kStep{5};
  while (child_ > 0) {
    if (waitpid(child_, &status_, WNOHANG) == child_) {
      child_ = -1;
    } else if (std::chrono::steady_clock::now() > deadline) {
      return false;
    } else {
      std::this_thread::sleep_for(kStep);
    }
  }
  return true;
}

void ChildProcess::fail_ended() {
  constexpr std::chrono::milliseconds kGrace{500};
  std::string how = "closed its output";
  if (wait_for_end(kGrace)) {
    how = WIFSIGNALED(status_) ? "was ended by signal " + std::to_string(WTERMSIG(status_))
                               : "ended with exit code " + std::to_string(WEXITSTATUS(status_));
  }
  throw ConnectionError("'" + command_ + "' " + how);
}

/// Waits in short steps, because a signal in another thread does not end a wait.
/// @returns  false if the deadline has passed
bool ChildProcess::wait_until_ready(int socket, short event,
                                    std::chrono::steady_clock::time_point deadline) const {
  constexpr int kStep = 100;  // milliseconds
  while (true) {
    if (interrupted_ && interrupted_()) throw ConnectionError("interrupted");
    const int left = milliseconds_left(deadline);
    pollfd ready{socket, event, 0};
    if (poll(&ready, 1, interrupted_ ? std::min(left, kStep) : left) > 0) return true;
    if (left == 0) return false;
  }
}

void ChildProcess::write_line(const std::string& line, std::chrono::milliseconds time_limit) {
  const auto deadline = std::chrono::steady_clock::now() + time_limit;
  const std::string bytes = line + "\n";
  for (std::size_t sent = 0; sent < bytes.size();) {
    if (!wait_until_ready(input_, POLLOUT, deadline)) {
      throw ConnectionError("'" + command_ + "' does not read what is sent to it");
    }
    const ssize_t n =
        ::send(input_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n >= 0) {
      sent += static_cast<std::size_t>(n);
    } else if (errno != EINTR && errno != EAGAIN) {
      fail_ended();
    }
  }
}

std::optional<std::string> ChildProcess::read_line(std::chrono::milliseconds time_limit) {
  const auto deadline = std::chrono::steady_clock::now() + time_limit;
  while (true) {
    const std::size_t end = received_.find('\n', searched_);
    if (end != std::string::npos) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      searched_ = 0;
      return line;
    }
    searched_ = received_.size();
    if (received_.size() > kMostOfALine) {
      throw ConnectionError("'" + command_ + "' sent a line of more than " +
                            std::to_string(kMostOfALine >> 20) + " MiB, the limit");
    }
    if (!wait_until_ready(output_, POLLIN, deadline)) return std::nullopt;
    std::array<char, std::size_t{1} << 16> bytes;
    const ssize_t n = ::recv(output_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (n > 0) {
      received_.append(bytes.data(), static_cast<std::size_t>(n));
    } else if (n == 0 || (errno != EINTR && errno != EAGAIN)) {
      fail_ended();
    }
  }
}

}  // namespace kinecal::detail
