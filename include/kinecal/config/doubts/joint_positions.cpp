// Definitions of joint_positions.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/joint_positions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/doubts/exchanged_joints.hpp"
#include "kinecal/config/doubts/joint_limits.hpp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {
namespace {

// Positions under the names of another order of the joints: that of the alphabet, or reversed.

/// Another order of the joints: joint j gets the positions named after joint order[j].
struct JointOrder {
  std::vector<std::size_t> order;
  const char* how;
};

/// Orders that drivers and people commonly produce, other than the one as given.
[[nodiscard]] std::vector<JointOrder> joint_orders(std::span<const UsedJoint> joints) {
  std::vector<std::size_t> sorted(joints.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::vector<std::size_t> reversed(sorted.rbegin(), sorted.rend()), inverse = sorted;
  std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
    return joints[a].joint.name < joints[b].joint.name;
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) inverse[sorted[i]] = i;
  std::vector<JointOrder> orders{
      {sorted, "if they are in the order of the chain and the names in that of the alphabet"},
      {inverse, "if they are in the order of the alphabet and the names in that of the chain"},
      {reversed, "if they are in reverse order"}};
  std::erase_if(orders, [](const JointOrder& order) {
    return std::is_sorted(order.order.begin(), order.order.end());
  });
  return orders;
}

/// Error: names and positions are in different orders.
/// @returns  true if it was reported
bool report_order(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                  Diagnostics& diagnostics) {
  std::size_t all = 0;
  for (const UsedJoint& joint : joints) all += joint.positions.size();
  const auto first = std::find_if(joints.begin(), joints.end(), [](const UsedJoint& joint) {
    return count_outside(joint, joint) > 0;
  });
  const std::size_t before = count_all_outside(joints);
  if (first == joints.end() || !are_many(before, samples.size())) return false;
  for (const auto& [order, how] : joint_orders(joints)) {
    std::size_t after = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      after += count_outside(joints[j], joints[order[j]]);
    }
    if (!explains(before, after, all)) continue;
    std::size_t at = 0;
    while (!is_outside(*first, first->positions[at])) ++at;
    diagnostics.error(
        place_of(samples, first->samples[at]),
        fmt::format("position of '{}' is {:.4g}; its limits are {}; all positions are within their "
                    "limits {}; compare the order of names and positions with the driver",
                    first->joint.name, first->positions[at], first->limits_text(), how));
    return true;
  }
  return false;
}

// Reports positions of a joint that are outside its limits.

/// What a turn into the limits means; the other sign may explain the same.
[[nodiscard]] std::string turned_text(double turn, bool or_negated) {
  return fmt::format(
      fmt::runtime(
          or_negated
              ? "; with {:+.3g} rad, or with the other sign, they are inside: is its zero or its "
                "direction another one than the URDF's?"
              : "; with {:+.3g} rad they are inside: is its zero another one than the URDF's?"),
      turn);
}

/// Reports positions outside the limits: far (doubt), slightly or by a turn (warning).
void report_outside(const UsedJoint& joint, std::span<const Sample> samples,
                    Diagnostics& diagnostics) {
  if (!joint.limits) return;
  constexpr double kRounding = 1e-3;  // of limits in a URDF, radians or metres
  Occurrences far, near;
  double most_far = 0.0, most_near = 0.0;
  for (std::size_t i = 0; i < joint.positions.size(); ++i) {
    const double excess = excess_of(joint, joint.positions[i]);
    if (excess <= kRounding) continue;
    const bool is_far = is_outside(joint, joint.positions[i]);
    (is_far ? far : near).add(joint.samples[i]);
    double& most = is_far ? most_far : most_near;
    most = std::max(most, excess);
  }
  const auto text = [&](const Occurrences& found, double most) {
    return fmt::format("position of '{}' is outside its limits {}{}, by up to {:.3g} {}",
                       joint.joint.name, joint.limits_text(), found.others(), most,
                       position_unit(joint.joint.type));
  };
  if (far.count > 0) {
    const std::optional<double> turn = turn_into_limits(joint);
    diagnostics.doubt(
        place_of(samples, far.first),
        text(far, most_far) +
            (turn ? turned_text(*turn, fits_negated(joint))
                  : "; is it the position of another joint, in another unit, or the URDF of "
                    "another robot?"));
  } else if (near.count > 0) {
    diagnostics.warning(place_of(samples, near.first), text(near, most_near));
  }
}

}  // namespace

/// A joint without limits beyond this looks wound up, or in degrees.
inline constexpr double kWoundUp = 4 * std::numbers::pi;

/// True if the positions are wrong as they are but right when multiplied by `factor`.
[[nodiscard]] inline bool fits_in_other_unit(const UsedJoint& joint, double factor) {
  const auto of = [&](auto&& is) {
    return static_cast<std::size_t>(
        std::count_if(joint.positions.begin(), joint.positions.end(), is));
  };
  const std::size_t all = joint.positions.size();
  if (!joint.limits) {
    const std::size_t far = of([](double q) { return std::abs(q) > kWoundUp; });
    return turns(joint.joint.type) && all > 1 && 10 * far >= 3 * all && joint.range() > kWoundUp;
  }
  const std::size_t outside = of([&](double q) { return is_outside(joint, q); });
  const std::size_t after = of([&](double q) { return is_outside(joint, q * factor); });
  const double most =
      std::abs(*std::max_element(joint.positions.begin(), joint.positions.end(),
                                 [](double a, double b) { return std::abs(a) < std::abs(b); }));
  const bool is_large = turns(joint.joint.type) ? most > std::numbers::pi : most > 1.0;
  if (turn_into_limits(joint)) return false;  // its zero is elsewhere; degrees would hardly move it
  constexpr double kMoves = 0.01;  // of what the limits allow: a lift that moves 1 mm is no lift
  const double allowed = joint.limits->upper - joint.limits->lower;
  if (joint.range() * factor < kMoves * allowed) return false;
  return is_large && are_many(outside, all) && 50 * after <= all;
}

/// Joints whose positions are in degrees, or millimetres; indices.
[[nodiscard]] inline std::vector<std::size_t> in_other_unit(std::span<const UsedJoint> joints,
                                                            bool turning) {
  const double factor = turning ? std::numbers::pi / 180.0 : 1e-3;
  std::vector<std::size_t> found;
  std::size_t far = 0, all = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (turns(joints[j].joint.type) != turning || joints[j].positions.empty()) continue;
    all += joints[j].range() > 0.0 ? 1 : 0;
    if (!fits_in_other_unit(joints[j], factor)) continue;
    found.push_back(j);
    far += joints[j].limits && joints[j].range() > kWoundUp ? 1 : 0;
  }
  // A single joint may just be wound up, or have the positions of another one.
  return far > 0 || 2 * found.size() >= std::max<std::size_t>(all, 2) ? found
                                                                      : std::vector<std::size_t>();
}

/// The index of the position that is furthest from zero.
[[nodiscard]] inline std::size_t furthest(const UsedJoint& joint) {
  const auto& q = joint.positions;
  return static_cast<std::size_t>(
      std::max_element(q.begin(), q.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      q.begin());
}

/// One error for all joints that seem to be in degrees or millimetres.
inline void report_unit(std::span<const UsedJoint> joints, const std::vector<std::size_t>& wrong,
                        std::span<const Sample> samples, Diagnostics& diagnostics) {
  const UsedJoint& joint = joints[wrong.front()];
  const bool turning = turns(joint.joint.type);
  const std::size_t at = furthest(joint);
  std::string others;
  for (std::size_t i = 1; i < wrong.size(); ++i) {
    others += (i == 1 ? "; so do those of '" : ", '") + joints[wrong[i]].joint.name + "'";
  }
  diagnostics.error(
      place_of(samples, joint.samples[at]),
      fmt::format(
          "positions of '{}' reach {:.6g}; {}: they look like {}{}; positions must be in {}",
          joint.joint.name, joint.positions[at],
          joint.limits ? "its limits are " + joint.limits_text()
                       : "that is more than two turns, to and fro",
          turning ? "degrees" : "millimetres", others, turning ? "radians" : "metres"));
}

/// Reports numbers that no joint reaches.
/// @returns  true if there are any
inline bool report_absurd(const UsedJoint& joint, std::span<const Sample> samples,
                          Diagnostics& diagnostics) {
  const bool turning = turns(joint.joint.type);
  const double most =
      joint.limits ? (turning ? 20 * std::numbers::pi : 1e3) : (turning ? 1e4 : 1e3);
  Occurrences absurd;
  double first = 0.0;
  for (std::size_t i = 0; i < joint.positions.size(); ++i) {
    const double q = joint.positions[i];
    if (std::abs(q) <= most) continue;
    if (absurd.add(joint.samples[i])) first = q;
  }
  if (absurd.count == 0) return false;
  diagnostics.error(
      place_of(samples, absurd.first),
      fmt::format(
          "position of '{}' is {:.6g} {}{}; {}; correct or remove the sample", joint.joint.name,
          first, position_unit(joint.joint.type), absurd.others(),
          joint.limits ? "its limits are " + joint.limits_text() : "no joint reaches that"));
  return true;
}

void check_joint_positions(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                           Diagnostics& diagnostics) {
  std::vector<bool> explained(joints.size(), false);
  if (!is_one_turned(joints)) {
    std::vector<std::size_t> renamed = report_negated(joints, samples, diagnostics);
    if (renamed.empty()) renamed = report_exchanged(joints, samples, diagnostics);
    for (const std::size_t j : renamed) explained[j] = true;
    if (renamed.empty() && report_order(joints, samples, diagnostics)) return;
  }
  for (const bool turning : {true, false}) {
    std::vector<std::size_t> wrong = in_other_unit(joints, turning);
    std::erase_if(wrong, [&](std::size_t j) { return explained[j]; });
    if (wrong.empty()) continue;
    report_unit(joints, wrong, samples, diagnostics);
    for (const std::size_t j : wrong) explained[j] = true;
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (explained[j] || report_absurd(joints[j], samples, diagnostics)) continue;
    report_outside(joints[j], samples, diagnostics);
  }
}

/// Number of steps from one sample to the next in which the reading changes.
/// @param begin, end  samples
[[nodiscard]] inline std::size_t steps_of(const UsedJoint& joint, std::size_t begin,
                                          std::size_t end) {
  std::size_t steps = 0;
  for (std::size_t i = begin + 1; i < end; ++i) {
    if (joint.positions[i] != joint.positions[i - 1]) ++steps;
  }
  return steps;
}

void check_stopped_joints(std::span<const UsedJoint> joints, std::span<const Sample> samples,
                          Diagnostics& diagnostics) {
  constexpr std::size_t kFewest = 6;
  const std::size_t all = samples.size();
  const auto always = [](std::size_t steps, std::size_t of) { return 10 * steps >= 9 * (of - 1); };
  for (const UsedJoint& joint : joints) {
    if (joint.positions.size() != all || all < 2 * kFewest) continue;
    std::size_t first = all - 1;
    while (first > 0 && joint.positions[first - 1] == joint.positions.back()) --first;
    const std::size_t last = all - first;
    if (first < kFewest || last < kFewest || 10 * last < all) continue;
    if (!always(steps_of(joint, 0, first), first)) continue;  // it moves in some samples only
    const auto moving = std::count_if(joints.begin(), joints.end(), [&](const UsedJoint& other) {
      return other.positions.size() == all && always(steps_of(other, first, all), last);
    });
    if (2 * static_cast<std::size_t>(moving) < joints.size() || moving == 0) continue;
    diagnostics.refutable_doubt(
        place_of(samples, joint.samples[first]),
        fmt::format("the reading of '{}' is {:.6g} in this and all {} after it, while other joints "
                    "move; has its driver or topic stopped?",
                    joint.joint.name, joint.positions[first], counted(last - 1, "sample")));
  }
}

void check_still_joints(const Config& config, std::span<const UsedJoint> joints,
                        Diagnostics& diagnostics) {
  std::set<std::string> reported;
  for (const StepConfig& step : config.steps) {
    for (const FreeParamConfig& param : step.free_params) {
      const auto joint = std::find_if(joints.begin(), joints.end(), [&](const UsedJoint& used) {
        return used.joint.name == param.name;
      });
      if (joint == joints.end() || joint->positions.size() < 2) continue;
      const double still = turns(joint->joint.type) ? 1e-4 : 1e-5;  // encoders at rest change less
      if (joint->range() > still || !reported.insert(param.name).second) continue;
      diagnostics.doubt(
          param.place,
          fmt::format("the offset of '{}' is free, but the joint never moves: it is at {:.6g} in "
                      "all {}; so its offset cannot be told from an error of the frames beside it; "
                      "record it in other positions, or remove it from free_params",
                      param.name, joint->positions.front(),
                      counted(joint->positions.size(), "sample")));
    }
  }
}

}  // namespace kinecal::detail
