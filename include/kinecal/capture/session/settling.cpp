// Definitions of settling.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/settling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numbers>
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

double unwrapped_step(double from, double to) {
  const double step = to - from;
  return std::abs(step) > std::numbers::pi ? std::remainder(step, 2.0 * std::numbers::pi) : step;
}

double reading_noise(std::span<const double> readings) {
  if (readings.size() < 3) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 2; i < readings.size(); ++i) {
    const double bend = readings[i - 2] - 2.0 * readings[i - 1] + readings[i];
    sum += bend * bend;
  }
  constexpr double kOfSecondDifferences = 6.0;  // 1 + 4 + 1 times the variance of a reading
  return std::sqrt(sum / (kOfSecondDifferences * static_cast<double>(readings.size() - 2)));
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
    for (std::size_t i = 0; i < reading.positions.size(); ++i) {
      const double before = last.positions[i];
      double& now = reading.positions[i];
      if (std::abs(now - before) > std::numbers::pi)
        now = before + detail::unwrapped_step(before, now);
    }
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
  constexpr double kSurely = 4.0;  // standard deviations
  const double of_halves = std::sqrt(1.0 / static_cast<double>(half) +
                                     1.0 / static_cast<double>(readings_.size() - half));
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double by_noise = noise_.empty() ? 0.0 : kSurely * noise_[i] * of_halves;
    if (std::abs(now[i] - before[i]) > std::max(options_.still, by_noise)) return false;
    if (detail::reading_noise(readings_of(i)) > options_.most_noise) return false;
  }
  return true;
}

std::vector<double> JointRest::readings_of(std::size_t joint) const {
  std::vector<double> positions;
  for (const MeasuredJoints& reading : readings_) positions.push_back(reading.positions[joint]);
  return positions;
}

std::string JointRest::why_not_still() const {
  const std::vector<std::string>& names = readings_.back().names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<double> positions = readings_of(i);
    const auto [low, high] = std::minmax_element(positions.begin(), positions.end());
    // Of a joint that moves one way, the sum of all steps is the distance between the ends.
    double way = 0.0;
    for (std::size_t r = 1; r < positions.size(); ++r) {
      way += std::abs(positions[r] - positions[r - 1]);
    }
    constexpr double kToAndFro = 3.0;
    if (detail::reading_noise(positions) <= options_.most_noise ||
        way < kToAndFro * (*high - *low)) {
      continue;
    }
    std::ostringstream text;
    text << "readings of joint '" << names[i] << "' jump between " << *low << " and " << *high
         << ": do two nodes publish its positions";
    return text.str();
  }
  return "joints do not stop";
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
    const double away = joint_distance(name, *position, target.positions[i], options_.continuous);
    if (away <= farthest) continue;
    farthest = away;
    text.str({});
    text << "joint '" << name << "' did not arrive: it is at " << *position << ", "
         << target.positions[i] << " was asked for";
  }
  return text.str();
}

double joint_distance(const std::string& joint, double a, double b,
                      const std::set<std::string>& continuous) {
  const bool endless = continuous.count(joint) > 0;
  return std::abs(endless ? std::remainder(a - b, 2.0 * std::numbers::pi) : a - b);
}

std::set<std::string> continuous_joints(const Robot& robot) {
  std::set<std::string> names;
  for (const Joint& joint : robot.joints()) {
    if (joint.type == JointType::continuous) names.insert(joint.name);
  }
  return names;
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
