// Definitions of joint_track.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_track.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "kinecal/geometry/median.hpp"

namespace kinecal::detail {

/// The usual time between stamps.
[[nodiscard]] inline Stamp usual_period(const std::vector<Stamp>& stamps) {
  std::vector<Stamp> periods;
  for (std::size_t i = 1; i < stamps.size(); ++i) periods.push_back(stamps[i] - stamps[i - 1]);
  return periods.empty() ? Stamp{} : median_of(std::move(periods));
}

bool is_impossible(double step, Stamp time) {
  constexpr double kFastest = 5.0;  // rad/s or m/s: beyond the joints of robots with cameras
  constexpr double kFar = 0.05;     // radians or metres: beyond noise
  const double seconds = std::abs(std::chrono::duration<double>(time).count());
  return std::abs(step) > std::max(kFar, kFastest * seconds);
}

namespace {

/// The joint that goes away and back in the middle one of three messages.
/// @param restless  joints that may
[[nodiscard]] std::optional<JointJump> jump_at(const JointMessage& before, const JointMessage& at,
                                               const JointMessage& after,
                                               const std::vector<bool>& restless) {
  for (std::size_t j = 0; j < at.positions.size(); ++j) {
    if (restless[j]) continue;
    const double away = unwrapped_step(before.positions[j], at.positions[j]);
    const double back = unwrapped_step(at.positions[j], after.positions[j]);
    const double least = std::min(std::abs(away), std::abs(back));
    if (away * back >= 0.0 || std::abs(away + back) > 0.5 * least) continue;
    if (!is_impossible(2.0 * least, after.stamp - before.stamp)) continue;
    return JointJump{j, before.positions[j], at.positions[j]};
  }
  return std::nullopt;
}

}  // namespace

void JointTrack::add(JointMessage reading) {
  ++messages;
  if (last_) {
    const auto found = taken_ ? jump_at(*taken_, *last_, reading, restless) : std::nullopt;
    if (found) {
      ++jumps;
      if (!jump) jump = found;
    } else {
      take(*last_);
      taken_ = std::move(last_);
    }
  }
  last_ = std::move(reading);
}

void JointTrack::take(const JointMessage& reading) {
  constexpr std::chrono::milliseconds kBin{10};
  constexpr std::chrono::seconds kBack{1};
  const Stamp stamp = reading.stamp;
  const bool first = stamps.empty();
  if (!first && stamp < newest - kBack && !back) back = Standstill{stamp, newest};
  newest = first ? stamp : std::max(newest, stamp);
  if (first || stamp < bin || stamp >= bin + kBin) {
    stamps.push_back(stamp);
    rows.push_back(reading.positions);
    bin = stamp;
    readings = 1;
    return;
  }
  ++readings;
  stamps.back() += (stamp - stamps.back()) / readings;
  for (std::size_t i = 0; i < names.size(); ++i) {
    rows.back()[i] += unwrapped_step(rows.back()[i], reading.positions[i]) / readings;
  }
}

void JointTrack::finish() {
  if (last_) take(*last_);
  last_ = taken_ = std::nullopt;
  if (!std::is_sorted(stamps.begin(), stamps.end())) {
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
  leave_out_first_zeros();
  noise.clear();
  for (std::size_t j = 0; j < names.size(); ++j) noise.push_back(noise_at_rest(j));
}

void JointTrack::leave_out_first_zeros() {
  const auto real = std::find_if(rows.begin(), rows.end(), [](const std::vector<double>& row) {
    return std::any_of(row.begin(), row.end(), [](double q) { return q != 0.0; });
  });
  if (real == rows.begin() || real == rows.end()) return;
  std::vector<std::size_t> impossible;  // rows to which joints jump
  for (std::size_t i = 1; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < names.size(); ++j) {
      const double step = unwrapped_step(rows[i - 1][j], rows[i][j]);
      if (!is_impossible(step, stamps[i] - stamps[i - 1])) continue;
      impossible.push_back(i);
      break;
    }
  }
  zeros = static_cast<std::size_t>(real - rows.begin());
  if (impossible != std::vector{zeros}) {  // a simulation jumps each time
    zeros = 0;
    return;
  }
  rows.erase(rows.begin(), real);
  stamps.erase(stamps.begin(), stamps.begin() + static_cast<std::ptrdiff_t>(zeros));
}

/// By pieces of eight readings in which the joint hardly moves: that of the noisiest fifth, because
/// readings that are rounded flicker only where the joint is between two counts.
double JointTrack::noise_at_rest(std::size_t joint) const {
  constexpr std::size_t kPiece = 8;
  constexpr double kMoved = 0.03, kShare = 0.8;  // radians or metres
  const Stamp longest = 2 * kPiece * usual_period(stamps);
  std::vector<double> noises;
  for (std::size_t first = 0; first + kPiece <= rows.size(); first += kPiece / 2) {
    if (stamps[first + kPiece - 1] - stamps[first] > longest) continue;
    std::vector<double> piece = {rows[first][joint]};
    for (std::size_t i = first + 1; i < first + kPiece; ++i) {
      piece.push_back(piece.back() + unwrapped_step(rows[i - 1][joint], rows[i][joint]));
    }
    if (std::abs(piece.back() - piece.front()) < kMoved) noises.push_back(reading_noise(piece));
  }
  if (noises.empty()) return 0.0;
  const auto at =
      noises.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(noises.size() - 1));
  std::nth_element(noises.begin(), at, noises.end());
  return *at;
}

double JointTrack::mean(std::size_t joint, std::size_t first, std::size_t last) const {
  const double start = rows[first][joint];
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i) sum += unwrapped_step(start, rows[i][joint]);
  return start + sum / static_cast<double>(last - first);
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
  std::vector<double> own_noise;
  for (const std::size_t j : joints) own_noise.push_back(noise[j]);
  JointRest rest(own, own_noise);
  std::vector<Standstill> found;
  Stamp begin{};  // of readings without a gap
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (i > 0 && stamps[i] <= stamps[i - 1]) continue;
    if (i == 0 || stamps[i] - stamps[i - 1] > gap) {
      rest = JointRest(own, own_noise);
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
