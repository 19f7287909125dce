// Definitions of settling.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/settling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <utility>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {

std::string seconds_text(Stamp duration) {
  std::ostringstream text;
  text.precision(4);
  text << std::chrono::duration<double>(duration).count() << " s";
  return text.str();
}

std::string clock_fault(Stamp view, Stamp joints, const SettleOptions& options) {
  if (view <= joints + options.clock_limit) return {};
  return "the camera's stamps are " + seconds_text(view - joints) +
         " ahead of those of the joints; set both computers' clocks, or stamp both on one";
}

}  // namespace detail

void JointRest::add(MeasuredJoints reading) {
  if (reading.positions.size() != reading.names.size() || reading.names.empty()) {
    throw PoseError("joint states have " + std::to_string(reading.names.size()) + " names and " +
                    std::to_string(reading.positions.size()) + " positions");
  }
  for (std::size_t i = 0; i < reading.names.size(); ++i) {
    if (std::isfinite(reading.positions[i])) continue;
    throw PoseError("the position of joint '" + reading.names[i] + "' is not a number");
  }
  if (!readings_.empty()) {
    const MeasuredJoints& last = readings_.back();
    if (reading.stamp <= last.stamp) {
      throw PoseError(
          "stamps of joint states do not advance: " + detail::seconds_text(reading.stamp) +
          " after " + detail::seconds_text(last.stamp));
    }
    if (reading.names != last.names) throw PoseError("joint states change their joints");
  }
  readings_.push_back(std::move(reading));
  const Stamp begin = readings_.back().stamp - options_.window;
  while (readings_.size() > 2 && readings_[1].stamp <= begin) readings_.pop_front();
}

std::vector<double> JointRest::mean_of(std::size_t first, std::size_t last) const {
  std::vector<double> mean(readings_.front().names.size(), 0.0);
  for (std::size_t r = first; r < last; ++r) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += readings_[r].positions[i] / static_cast<double>(last - first);
    }
  }
  return mean;
}

bool JointRest::still() const {
  constexpr std::size_t kFewest = 4;  // readings in the window
  if (readings_.size() < kFewest) return false;
  if (readings_.back().stamp - readings_.front().stamp < options_.window) return false;
  const std::size_t half = readings_.size() / 2;
  const std::vector<double> before = mean_of(0, half), now = mean_of(half, readings_.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (std::abs(now[i] - before[i]) > options_.still) return false;
  }
  return true;
}

MeasuredJoints JointRest::mean() const {
  MeasuredJoints joints = readings_.back();
  joints.positions = mean_of(0, readings_.size());
  return joints;
}

std::string JointRest::not_arrived(const JointTarget& target) const {
  const MeasuredJoints now = mean();
  double farthest = options_.arrival;
  std::ostringstream text;
  for (std::size_t i = 0; i < target.names.size(); ++i) {
    const std::string& name = target.names[i];
    const std::optional<double> position = now.position(name);
    if (!position) {
      throw PoseError("joint '" + name + "' of the pose is not measured" +
                      did_you_mean(name, now.names));
    }
    const double away = std::abs(*position - target.positions[i]);
    if (away <= farthest) continue;
    farthest = away;
    text.str({});
    text << "joint '" << name << "' did not arrive: it is at " << *position << ", "
         << target.positions[i] << " was asked for";
  }
  return text.str();
}

double changed_pixels(const GrayImage& a, const GrayImage& b, int gray_levels) {
  if (a.width != b.width || a.height != b.height) return 1.0;
  if (a.empty()) return 0.0;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if (std::abs(int{a.pixels[i]} - int{b.pixels[i]}) > gray_levels) ++changed;
  }
  return static_cast<double>(changed) / static_cast<double>(a.pixels.size());
}

View settle_image(const std::function<View(Stamp after)>& next_view, Stamp after,
                  const SettleOptions& options) {
  View last = next_view(after);
  if (const std::string fault = detail::clock_fault(last.stamp, after, options); !fault.empty()) {
    throw PoseError(fault);
  }
  double changed = 0.0;
  while (!last.image.empty()) {
    View next = next_view(last.stamp);
    if (next.stamp <= last.stamp) {
      throw PoseError("stamps of the camera do not advance: " + detail::seconds_text(next.stamp) +
                      " after " + detail::seconds_text(last.stamp));
    }
    if (next.image.width != last.image.width || next.image.height != last.image.height) {
      throw PoseError("the size of the camera's image changes from " +
                      std::to_string(last.image.width) + " x " + std::to_string(last.image.height) +
                      " to " + std::to_string(next.image.width) + " x " +
                      std::to_string(next.image.height));
    }
    changed = changed_pixels(last.image, next.image, options.gray_levels);
    last = std::move(next);
    if (changed <= options.still_pixels) break;
    if (last.stamp - after > options.image_time_limit) {
      std::ostringstream text;
      text.precision(2);
      text << "the image does not come to rest in " << detail::seconds_text(last.stamp - after)
           << ": " << 100.0 * changed << " % of its pixels change";
      throw PoseError(text.str());
    }
  }
  return last;
}

}  // namespace kinecal
