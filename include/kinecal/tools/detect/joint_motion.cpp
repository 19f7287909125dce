// Definitions of joint_motion.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/joint_motion.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <chrono>
#include <utility>

#include "kinecal/text/printable.hpp"

namespace kinecal::detail {
namespace {

constexpr std::size_t kFewestReadings = 4;
constexpr std::chrono::milliseconds kHalfFit{60};  // usual
constexpr std::chrono::milliseconds kFarthestReading{
    250};                                              // of the nearest reading before and after
constexpr std::chrono::milliseconds kWidestFit{1000};  // of any reading

/// First and last (excluded) index of the readings to fit; nullopt if there are too few.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> readings_to_fit(
    const std::vector<Stamp>& stamps, Stamp stamp) {
  const auto index = [&](auto at) { return static_cast<std::size_t>(at - stamps.begin()); };
  const auto not_before = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  const auto after = std::upper_bound(stamps.begin(), stamps.end(), stamp);
  if (not_before == stamps.end() || after == stamps.begin()) return std::nullopt;
  if (*not_before - stamp > kFarthestReading || stamp - *(after - 1) > kFarthestReading)
    return std::nullopt;
  std::size_t first = index(std::lower_bound(stamps.begin(), stamps.end(), stamp - kHalfFit));
  std::size_t last = index(std::upper_bound(stamps.begin(), stamps.end(), stamp + kHalfFit));
  first = std::min(first, index(after) - 1);
  last = std::max(last, index(not_before) + 1);
  while (last - first < kFewestReadings) {
    const Stamp before = first > 0 ? stamp - stamps[first - 1] : Stamp::max();
    const Stamp beyond = last < stamps.size() ? stamps[last] - stamp : Stamp::max();
    if (std::min(before, beyond) > kWidestFit) return std::nullopt;
    if (before <= beyond) {
      --first;
    } else {
      ++last;
    }
  }
  return std::pair(first, last);
}

}  // namespace

std::optional<MotionWeights> motion_weights(const JointTrack& track, Stamp stamp) {
  const auto range = readings_to_fit(track.stamps, stamp);
  if (!range) return std::nullopt;
  const auto [first, last] = *range;
  MotionWeights weights;
  weights.first = weights.nearest = first;
  const auto count = static_cast<Eigen::Index>(last - first);
  const auto away = [&](std::size_t i) { return std::chrono::abs(track.stamps[i] - stamp); };
  const double scale =
      std::chrono::duration<double>(std::max(away(first), away(last - 1))).count();  // seconds
  if (scale <= 0.0) return std::nullopt;
  Eigen::MatrixX3d powers(count, 3);
  for (Eigen::Index r = 0; r < count; ++r) {
    const std::size_t i = first + static_cast<std::size_t>(r);
    const double t = std::chrono::duration<double>(track.stamps[i] - stamp).count() / scale;
    powers.row(r) << 1.0, t, t * t;
    if (away(i) < away(weights.nearest)) weights.nearest = i;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr(powers);
  if (qr.rank() < 3) return std::nullopt;  // stamps that are the same
  const Eigen::MatrixXd inverse = qr.solve(Eigen::MatrixXd::Identity(count, count));
  for (Eigen::Index r = 0; r < count; ++r) {
    weights.position.push_back(inverse(0, r));
    weights.velocity.push_back(inverse(1, r) / scale);
  }
  return weights;
}

JointMotion motion_of(const JointTrack& track, std::size_t joint, const MotionWeights& weights) {
  const std::size_t count = weights.position.size(), nearest = weights.nearest - weights.first;
  const auto reading = [&](std::size_t i) { return track.rows[weights.first + i][joint]; };
  std::vector<double> away(count, 0.0);  // from the nearest reading, without turns
  for (std::size_t i = nearest + 1; i < count; ++i) {
    away[i] = away[i - 1] + unwrapped_step(reading(i - 1), reading(i));
  }
  for (std::size_t i = nearest; i-- > 0;) {
    away[i] = away[i + 1] + unwrapped_step(reading(i + 1), reading(i));
  }
  JointMotion motion{reading(nearest), 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    motion.position += weights.position[i] * away[i];
    motion.velocity += weights.velocity[i] * away[i];
  }
  return motion;
}

std::string unknown_motion(const std::string& joint, const std::string& topic) {
  return "joint '" + printable(joint) + "' of topic '" + printable(topic) +
         "' was not read within 0.25 s before and after the image: how it moved is not known";
}

}  // namespace kinecal::detail
