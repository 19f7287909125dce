// SPDX-License-Identifier: Apache-2.0
#include "pose_choice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "kinecal/files/urdf/velocity_limits.hpp"
#include "kinecal/procedure/surface_views.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/trust/verify/pose_change.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The joints that differ between samples and move what is observed.
std::vector<std::string> moved_joints(const StudyInput& input) {
  const AnyProblem& problem = *input.calibration.steps.back().problem;
  std::set<std::string> joints;
  for (const MountedSensor& sensor : problem.sensors()) {
    for (const SampledChain& chain : sensor.chains()) {
      for (const ChainJoint& joint : chain.chain().joints) {
        if (moves(joint.type)) joints.insert(std::string(joint.drive.joint));
      }
    }
  }
  return {joints.begin(), joints.end()};
}

/// Where a position is in the range of its joint, from 0 to 1.
double share_of(const Joint& joint, double position) {
  if (joint.limits && joint.limits->lower < joint.limits->upper) {
    return (position - joint.limits->lower) / (joint.limits->upper - joint.limits->lower);
  }
  return turns(joint.type) ? 0.5 + position / (2.0 * std::numbers::pi) : position;
}

/// Where the joints of a sample are in their ranges.
std::vector<double> shares_of(const StudyInput& input, const std::vector<std::string>& joints,
                              const Sample& sample) {
  std::vector<double> shares;
  for (const std::string& name : joints) {
    shares.push_back(share_of(input.robot.joint(name), sample.position(name).value_or(0.0)));
  }
  return shares;
}

/// Whether two poses count as one.
bool are_alike(const std::vector<double>& a, const std::vector<double>& b, double least_distance) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [&](double x, double y) { return std::abs(x - y) <= least_distance; });
}

/// Radians or metres per second.
std::vector<double> speeds_of(const StudyInput& input, const std::vector<std::string>& joints) {
  const auto limits = velocity_limits(input.urdf_text, "the URDF");
  constexpr double kTurning = 1.0, kSliding = 0.1;  // rad/s, m/s, where the URDF has no limit
  std::vector<double> speeds;
  for (const std::string& name : joints) {
    const auto limit = limits.find(name);
    const bool turning = turns(input.robot.joint(name).type);
    speeds.push_back(limit != limits.end() ? limit->second : turning ? kTurning : kSliding);
  }
  return speeds;
}

/// What the samples add: the first ones are candidates, the others exist.
void add_information(std::size_t candidates, PoseChoice& choice) {
  const StudyDesign& design = choice.design;
  PoseCandidates& of = choice.candidates;
  const Eigen::Index n = design.prior.rows();
  Eigen::MatrixXd before = Eigen::MatrixXd::Zero(n, n), scores = before;
  std::vector<int> all;
  for (std::size_t i = 0; i < design.samples.size(); ++i) {
    all.push_back(static_cast<int>(i));
    if (i < candidates) {
      of.information.push_back(design.samples[i].information);
      of.scores.push_back(design.samples[i].scores);
      continue;
    }
    before += design.samples[i].information.matrix() + design.prior.matrix();
    scores += design.samples[i].scores.matrix();
    choice.have.push_back(static_cast<int>(i));
  }
  of.prior = design.prior;
  of.before = before;
  of.before_scores = scores;
  choice.determined = expected_uncertainty(design, all).determined;
}

/// Points of a cloud err together, with the depth and with the meshes: scales what noise is expected to do, so that all samples
/// together give the uncertainty that their calibration has.
/// @param calibrated  standard deviation of the judged pose, metres
void scale_scores(double calibrated, PoseChoice& choice) {
  std::vector<int> all(choice.design.samples.size());
  std::iota(all.begin(), all.end(), 0);
  const double expected =
      expected_variance(expected_uncertainty(choice.design, all), choice.candidates.goal);
  if (!(expected > 0.0)) return;
  const double factor = calibrated * calibrated / expected;
  for (SampleDesign& sample : choice.design.samples) {
    sample.scores = factor * sample.scores.matrix();
  }
}

}  // namespace

void drop_poses_of_have(StudyInput& input, double least_distance) {
  if (input.have == 0) return;
  const std::vector<std::string> joints = moved_joints(input);
  std::vector<std::vector<double>> shares;
  for (const Sample& sample : input.samples) shares.push_back(shares_of(input, joints, sample));
  const std::size_t candidates = input.samples.size() - input.have;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < input.samples.size(); ++i) {
    const bool is_known =
        i < candidates &&
        std::any_of(shares.begin() + static_cast<std::ptrdiff_t>(candidates), shares.end(),
                    [&](const auto& other) { return are_alike(shares[i], other, least_distance); });
    if (is_known) continue;
    input.samples[kept] = input.samples[i];
    input.poses[kept++] = input.poses[i];
  }
  const std::size_t dropped = input.samples.size() - kept;
  if (dropped == candidates) {
    throw InputError(
        fmt::format("--have: no joint of the poses to choose from is further than {} of its range "
                    "from your poses; give other poses",
                    least_distance));
  }
  if (dropped == 0) return;
  say(stderr, "note: {} to choose from left out: --have has the same or nearly so\n",
      counted(dropped, "pose"));
  input.samples.resize(kept);
  input.poses.resize(kept);
  input.setup.samples = input.samples;
}

PoseChoice pose_choice(const StudyInput& input) {
  const StudySetup& setup = input.setup;
  PoseChoice choice;
  choice.samples = exact_samples(setup.make, setup.drawn, setup.samples);
  const AnyProblem& problem = *input.calibration.steps.back().problem;
  const FreeSet free(setup.free, problem.table().size());
  choice.design = study_design(setup.make, free, setup.drawn, choice.samples, setup.noise);
  choice.candidates.goal =
      position_goal(problem, free, setup.drawn, choice.samples, setup.frame, setup.in);
  if (input.calibrated) scale_scores(*input.calibrated, choice);
  const std::size_t candidates = choice.samples.size() - input.have;
  add_information(candidates, choice);
  choice.joints = moved_joints(input);
  choice.speeds = speeds_of(input, choice.joints);
  for (const Sample& sample : choice.samples) {
    std::vector<double> place;
    for (const std::string& name : choice.joints) {
      place.push_back(sample.position(name).value_or(0.0));
    }
    choice.places.push_back(std::move(place));
    if (choice.candidates.shares.size() < candidates) {
      choice.candidates.shares.push_back(shares_of(input, choice.joints, sample));
    }
  }
  return choice;
}

std::vector<int> with_existing(const PoseChoice& choice, const std::vector<int>& chosen) {
  std::vector<int> both = choice.have;
  both.insert(both.end(), chosen.begin(), chosen.end());
  return both;
}

double expected_position(const PoseChoice& choice, const std::vector<int>& chosen) {
  const ExpectedUncertainty expected =
      expected_uncertainty(choice.design, with_existing(choice, chosen));
  if (expected.determined < choice.determined) return std::numeric_limits<double>::infinity();
  return std::sqrt(expected_variance(expected, choice.candidates.goal));
}

double tolerated_error(double spread, double wanted) {
  constexpr double kMore = 1.1;
  return std::sqrt(std::max(0.0, kMore * kMore * wanted * wanted - spread * spread));
}

std::string millimetres(double metres) {
  if (!std::isfinite(metres)) return "not determined";
  const double shown = 1e3 * metres;
  constexpr double kSmall = 0.01;  // below it, three digits after the point are too few
  if (!(shown > 0.0) || shown >= kSmall) return fmt::format("{:.3f} mm", shown);
  std::string text =
      fmt::format("{:.{}f}", shown, 1 - static_cast<int>(std::floor(std::log10(shown))));
  if (text.back() == '0') text.pop_back();
  return text + " mm";
}

std::string surface_text(const StudyInput& input) {
  if (input.calibrated) {
    return "  scaled to what the calibration of all samples says\n";
  }
  return fmt::format(
      "  if {} points or edges a pose err independently; those of a real camera and mesh err "
      "together: it will be larger, as --samples of such poses would say\n",
      kViewPoints);
}

double random_position(const PoseChoice& choice, int count, const ProgressMeter& meter) {
  constexpr int kSets = 51;  // their median
  const int all = static_cast<int>(choice.candidates.information.size());
  std::vector<double> values;
  SeededRandom random(static_cast<std::uint64_t>(count));
  std::vector<int> order(static_cast<std::size_t>(all));
  for (int i = 0; i < all; ++i) order[static_cast<std::size_t>(i)] = i;
  for (int set = 0; set < kSets; ++set) {
    if (meter) meter(static_cast<double>(set) / kSets, fmt::format("random sets of {}", count));
    for (int i = 0; i < count; ++i) {
      std::swap(order[static_cast<std::size_t>(i)],
                order[static_cast<std::size_t>(random.integer(i, all - 1))]);
    }
    values.push_back(expected_position(choice, {order.begin(), order.begin() + count}));
  }
  std::nth_element(values.begin(), values.begin() + kSets / 2, values.end());
  return values[kSets / 2];
}

int random_poses_for(const PoseChoice& choice, double position, const ProgressMeter& meter) {
  int low = 0, high = static_cast<int>(choice.candidates.information.size()) + 1;
  while (high - low > 1) {  // the median falls with the number
    const int middle = (low + high) / 2;
    (random_position(choice, middle, meter) <= position ? high : low) = middle;
  }
  return high;
}

double session_seconds(const PoseChoice& choice, const std::vector<int>& order) {
  constexpr double kStop = 3.0;  // seconds: settling, and a few images
  return motion_time(choice.places, order, choice.speeds) +
         kStop * static_cast<double>(order.size());
}

std::string duration_text(double seconds) {
  const int whole = static_cast<int>(std::lround(seconds));
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{} min {} s", whole / 60, whole % 60);
}

std::vector<int> short_order(const PoseChoice& choice, std::vector<int> chosen) {
  std::sort(chosen.begin(), chosen.end());
  return motion_order(choice.places, chosen, choice.speeds);
}

std::vector<CapturePose> poses_of_choice(const StudyInput& input, const std::vector<int>& chosen) {
  std::vector<CapturePose> poses;
  for (const int i : chosen) poses.push_back(input.poses[static_cast<std::size_t>(i)]);
  return poses;
}

}  // namespace kinecal::cli
