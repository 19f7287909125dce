// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "kinecal/text/printable.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// "3 s", "2 min".
std::string duration(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", std::ceil(seconds));
  return fmt::format("{:.0f} min", std::ceil(seconds / 60.0));
}

std::atomic<bool> progress_is_wanted = true;

}  // namespace

void set_progress(bool wanted) {
  progress_is_wanted = wanted;
}

bool shows_progress() {
  return progress_is_wanted && obeys_escapes(STDERR_FILENO);
}

std::string progress_text(double fraction, const std::string& what, double seconds) {
  const double done = std::clamp(fraction, 0.0, 1.0);
  std::string text = fmt::format("{}: {:.0f} %", printable(what), std::floor(100.0 * done));
  if (done > 0.0) text += fmt::format(", {} left", duration(seconds * (1.0 - done) / done));
  return text;
}

ProgressLine::ProgressLine() : is_shown_(shows_progress()) {}

ProgressLine::~ProgressLine() {
  if (is_visible_) fmt::print(stderr, "\r\033[K");
}

ProgressMeter ProgressLine::meter() {
  if (!is_shown_) return {};
  return [this](double fraction, const std::string& what) { show(fraction, what); };
}

void ProgressLine::show(double fraction, const std::string& what) {
  constexpr std::chrono::milliseconds kQuick(50), kBetween(100);
  const Clock::time_point now = Clock::now();
  if (what != task_) {
    task_ = what;
    begin_ = now;
  }
  if (now - begin_ < kQuick || now - shown_ < kBetween) return;
  shown_ = now;
  is_visible_ = true;
  std::string text =
      progress_text(fraction, what, std::chrono::duration<double>(now - begin_).count());
  const std::size_t width = terminal_width(STDERR_FILENO) - 1;
  if (text.size() > width) text = "..." + text.substr(text.size() - (width - 3));
  fmt::print(stderr, "\r{}\033[K", text);
  std::fflush(stderr);
}

}  // namespace kinecal::cli
