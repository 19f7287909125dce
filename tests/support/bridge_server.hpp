// A Foxglove bridge on loopback with a simulated robot behind it: the reference server of the protocol,
// from npm (tests/robots/server).  It is started and ended with this object.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

#include "kinecal/robots/child_process.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"

namespace kinecal::test {

/// Empty if the server can be started; else why not.  The first call installs its packages.
inline std::string why_no_bridge_server() {
  static const std::string why = [] {
    const std::string folder = bridge_folder();
    if (std::system("command -v npm node flock > /dev/null") != 0) {
      return std::string("node and npm are not installed");
    }
    const std::string call = source_folder() + "/tests/robots/server/install.sh " + folder + " > " +
                             folder + ".log 2>&1";
    return std::system(call.c_str()) == 0
               ? std::string()
               : "npm cannot install the server's packages: see " + folder + ".log";
  }();
  return why;
}

/// The command that starts server.mjs.
/// @param options  JSON
inline std::string server_command(const std::string& options) {
  return "cd " + bridge_folder() + " && exec node server.mjs '" + options + "'";
}

/// Where a server that has just been started is.
inline std::string url_of(detail::ChildProcess& server) {
  constexpr std::chrono::seconds kStart{20};
  const std::string line = server.read_line(kStart).value_or("nothing");
  const std::size_t port = line.find("\"port\":");
  if (port == std::string::npos) throw std::runtime_error("the server printed: " + line);
  return "ws://127.0.0.1:" + std::to_string(std::stoi(line.substr(port + 7)));
}

class BridgeServer {
 public:
  /// @param options  JSON for server.mjs, such as {"encoding": "cdr"}
  explicit BridgeServer(const std::string& options = "{}")
      : process_(server_command(options)), url_(url_of(process_)) {}

  [[nodiscard]] const std::string& url() const { return url_; }

  /// Makes a fault of server.mjs, such as {"fault": "close"}; returns when it was made, with what it printed.
  std::string make(const std::string& fault) {
    process_.write_line(fault, kStart);
    const auto line = process_.read_line(kStart);
    if (!line) throw std::runtime_error("no answer to " + fault);
    return *line;
  }

  /// Ends the server without a goodbye.
  void kill() {
    process_.write_line(R"({"fault": "die"})", kStart);
    try {
      (void)process_.read_line(kStart);
    } catch (const std::runtime_error&) {
      return;  // it has ended
    }
  }

 private:
  static constexpr std::chrono::seconds kStart{20};

  detail::ChildProcess process_;
  std::string url_;
};

}  // namespace kinecal::test

/// Skips the test and says why if the server cannot be started; fails with KINECAL_REQUIRE_DATA=1.
#define KINECAL_NEEDS_BRIDGE_SERVER()                      \
  if (!kinecal::test::why_no_bridge_server().empty()) {    \
    if (kinecal::test::data_required()) {                  \
      FAIL() << kinecal::test::why_no_bridge_server();     \
    }                                                      \
    GTEST_SKIP() << kinecal::test::why_no_bridge_server(); \
  }
