// Definitions of joint_track.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_track.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "kinecal/geometry/median.hpp"

namespace kinecal::detail {

double unwrapped_step(double from, double to) {
  const double step = to - from;
  return std::abs(step) > std::numbers::pi ? std::remainder(step, 2.0 * std::numbers::pi) : step;
}

void JointTrack::add(Stamp stamp, const std::vector<double>& positions) {
  constexpr std::chrono::milliseconds kBin{10};
  constexpr std::chrono::seconds kBack{1};
  const bool first = stamps.empty();
  if (!first && stamp < newest - kBack && !back) back = Standstill{stamp, newest};
  newest = first ? stamp : std::max(newest, stamp);
  if (first || stamp < bin || stamp >= bin + kBin) {
    stamps.push_back(stamp);
    rows.push_back(positions);
    bin = stamp;
    readings = 1;
    return;
  }
  ++readings;
  stamps.back() += (stamp - stamps.back()) / readings;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    rows.back()[i] += unwrapped_step(rows.back()[i], positions[i]) / readings;
  }
}

void JointTrack::sort() {
  if (std::is_sorted(stamps.begin(), stamps.end())) return;
  std::vector<std::size_t> order(stamps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  JointTrack sorted = *this;
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.stamps[i] = stamps[order[i]];
    sorted.rows[i] = rows[order[i]];
  }
  *this = std::move(sorted);
}

/// The usual time between stamps.
[[nodiscard]] inline Stamp usual_period(const std::vector<Stamp>& stamps) {
  std::vector<Stamp> periods;
  for (std::size_t i = 1; i < stamps.size(); ++i) periods.push_back(stamps[i] - stamps[i - 1]);
  return periods.empty() ? Stamp{} : median_of(std::move(periods));
}

std::vector<Standstill> JointTrack::rests(const std::vector<std::size_t>& joints,
                                          const SettleOptions& options) const {
  constexpr std::chrono::milliseconds kLeastGap{200};
  const Stamp period = usual_period(stamps);
  const Stamp gap = std::max<Stamp>(4 * period, kLeastGap);
  SettleOptions own = options;
  own.window = std::max(options.window, 3 * period);  // JointRest needs four readings
  MeasuredJoints reading;
  for (const std::size_t j : joints) reading.names.push_back(names[j]);
  reading.positions.resize(joints.size());
  JointRest rest(own);
  std::vector<Standstill> found;
  Stamp begin{};  // of readings without a gap
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (i > 0 && stamps[i] <= stamps[i - 1]) continue;
    if (i == 0 || stamps[i] - stamps[i - 1] > gap) {
      rest = JointRest(own);
      begin = stamps[i];
    }
    reading.stamp = stamps[i];
    for (std::size_t j = 0; j < joints.size(); ++j) reading.positions[j] = rows[i][joints[j]];
    rest.add(reading);
    if (!rest.still()) continue;
    const Stamp since = std::max(begin, stamps[i] - own.window);
    if (!found.empty() && since <= found.back().end) {
      found.back().end = stamps[i];
    } else {
      found.push_back({since, stamps[i]});
    }
  }
  return found;
}

std::pair<std::size_t, std::size_t> JointTrack::near(Stamp stamp, const Standstill& time) const {
  const auto index = [&](auto at) { return static_cast<std::size_t>(at - stamps.begin()); };
  const std::size_t first = index(std::lower_bound(stamps.begin(), stamps.end(), time.begin));
  const std::size_t last = index(std::upper_bound(stamps.begin(), stamps.end(), time.end));
  if (first < last) return {first, last};
  std::size_t next = index(std::lower_bound(stamps.begin(), stamps.end(), stamp));
  if (next == stamps.size() || (next > 0 && stamp - stamps[next - 1] < stamps[next] - stamp)) {
    --next;
  }
  return {next, next + 1};
}

std::vector<Standstill> common(const std::vector<Standstill>& a, const std::vector<Standstill>& b) {
  std::vector<Standstill> both;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const Standstill part{std::max(a[i].begin, b[j].begin), std::min(a[i].end, b[j].end)};
    if (part.begin < part.end) both.push_back(part);
    if (a[i].end < b[j].end) {
      ++i;
    } else {
      ++j;
    }
  }
  return both;
}

}  // namespace kinecal::detail
