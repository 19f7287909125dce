// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"

#include <csignal>
#include <initializer_list>

namespace kinecal::cli {
namespace {

volatile std::sig_atomic_t stop_asked = 0;

extern "C" void ask_to_stop(int signal) {
  stop_asked = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Interruption::Interruption() {
  stop_asked = 0;
  struct sigaction action {};
  action.sa_handler = ask_to_stop;  // without SA_RESTART: reading a line ends, too
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

Interruption::~Interruption() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

bool Interruption::is_asked() {
  return stop_asked != 0;
}

}  // namespace kinecal::cli
