// What urdfdom has to say, gathered instead of printed: a library never prints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <console_bridge/console.h>

#include <mutex>
#include <string>

namespace kinecal::detail {

/// While it lives, what urdfdom says is gathered here instead of being printed.  The output of
/// console_bridge is one for the whole process: a second thread waits.
class UrdfdomMessages : public console_bridge::OutputHandler {
 public:
  UrdfdomMessages()
      : lock_(mutex()),
        previous_(console_bridge::getOutputHandler()),
        previous_level_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    console_bridge::useOutputHandler(this);
  }
  ~UrdfdomMessages() override {
    console_bridge::useOutputHandler(previous_);
    console_bridge::setLogLevel(previous_level_);
  }
  UrdfdomMessages(const UrdfdomMessages&) = delete;
  UrdfdomMessages& operator=(const UrdfdomMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    all += (all.empty() ? "" : "; ") + text;
  }

  std::string all;

 private:
  [[nodiscard]] static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  console_bridge::LogLevel previous_level_;
};

}  // namespace kinecal::detail
