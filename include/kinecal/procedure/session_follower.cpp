// Definitions of session_follower.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/session_follower.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "kinecal/config/assemble.hpp"
#include "kinecal/procedure/surface_rounds.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/trust/uncertainty/pose_elsewhere.hpp"

namespace kinecal {

SessionFollower::SessionFollower(Config config, Robot robot, const std::string& frame,
                                 std::string urdf_text, std::string urdf,
                                 CalibrationOptions options)
    : config_(std::move(config)),
      robot_(std::move(robot)),
      frame_(frame),
      urdf_text_(std::move(urdf_text)),
      urdf_(std::move(urdf)),
      options_(std::move(options)) {
  if (!config_.per_sample.empty()) {
    throw InputError(config_.per_sample.front().place.str() +
                     ": per_sample: a session cannot be followed while a target has a pose of its "
                     "own in each sample; capture without --calibrate, then calibrate");
  }
  Diagnostics diagnostics;
  Calibration empty = assemble(config_, robot_, {}, diagnostics);
  diagnostics.throw_if_errors();
  problem_ = std::move(empty.steps.back().problem);
  if (frame.empty() || robot_.has_link(frame)) return;
  std::vector<std::string> names = robot_.link_names();
  names.emplace_back("gripper");  // see parse_accuracy()
  throw InputError("the robot has no link '" + frame + "'" + did_you_mean(frame, names));
}

/// @throws SampleError  if a sample does not match the configuration
void SessionFollower::check(const Sample& sample) const {
  problem_->without_samples()->add_sample(sample);
}

/// Calibrates all samples so far, and continues from there.
/// @returns  false if there are too few
bool SessionFollower::start() {
  Diagnostics diagnostics;
  Calibration calibration = assemble(config_, robot_, samples_, diagnostics);
  if (!diagnostics.errors.empty() || calibration.steps.empty()) return false;
  SolveOptions solving;
  solving.threads = 1;
  const CalibrationResult result = calibrate(calibration, {}, solving);
  if (!result.converged) return false;
  const CalibrationStep& step = calibration.steps.back();
  if (!find_frames(*step.problem, samples_)) return false;
  const std::shared_ptr<const AnyProblem> problem = step.problem->without_samples();
  const auto make = [problem] { return problem->without_samples(); };
  const Eigen::VectorXd values = result.table.values();
  online_.emplace(make, step.free,
                  std::span<const double>(values.data(), static_cast<std::size_t>(values.size())),
                  frames_->frame, frames_->in);
  return true;
}

/// Finds the frames whose pose the session waits for.
/// @returns  false if nothing is compared
bool SessionFollower::find_frames(const AnyProblem& problem, std::span<const Sample> samples) {
  const std::vector<ComparedFrames> all = compared_frames(problem, samples);
  frames_ = all.empty() ? std::nullopt : std::optional(all.front());
  if (frames_ && !frame_.empty()) frames_->frame = {frame_};
  return frames_.has_value();
}

OnlineState SessionFollower::start_again(std::span<const Sample> ahead) {
  misfits_ = 0;
  online_.reset();
  OnlineState state;
  constexpr std::size_t kFewest = 3;
  if (samples_.size() < kFewest || !start()) return state;
  online_->expect({ahead.begin(), ahead.end()});
  for (const Sample& sample : samples_) state = online_->add(sample);
  if (!state.known) online_.reset();
  return state;
}

/// Associates, calibrates and assesses all samples, the last one among them.
void SessionFollower::calibrate_surface(std::span<const Sample> ahead, FollowedState& followed) {
  constexpr std::size_t kFewest = 3;
  if (samples_.size() < kFewest) return;
  CalibrationOptions options = options_;
  options.folds = 1;  // the end of a session asks for errors on held-out samples
  PreparedCalibration prepared = prepare(setup(), options);
  if (!prepared.diagnostics.errors.empty()) {
    followed.problem = prepared.diagnostics.errors.front();
    if (frames_) samples_.pop_back();  // those before it lie on the robot
    return;
  }
  const CalibratedRobot all = detail::solve_and_judge(std::move(prepared), options);
  OnlineState& online = followed.online;
  online.samples = static_cast<int>(all.samples.size());
  for (const LeftOutSample& left : all.left_out) {
    if (left.number == static_cast<int>(samples_.size())) online.fits = false;
    if (!left_out_.insert(left.number).second || !online.fits) continue;
    online.dropped.push_back(left.number);
  }
  if (!all.result.converged || all.assessments.empty()) return;
  const AnyProblem& problem = *all.setup.calibration.steps.back().problem;
  if (!find_frames(problem, all.samples)) return;
  const Assessment& step = all.assessments.back();
  const Eigen::VectorXd table = all.result.table.values();
  const ParameterValues values(table.data(), static_cast<std::size_t>(table.size()));
  online.known = all.is_usable();
  for (const std::span<const Sample> poses : {std::span<const Sample>(all.samples), ahead}) {
    if (poses.empty()) continue;
    const PoseUncertainty pose = pose_at(problem, step, values, poses, frames_->frame, frames_->in);
    online.known = online.known && pose.determined;
    online.position = std::max(online.position, pose.position);
    online.rotation = std::max(online.rotation, pose.rotation);
  }
  online.noise = step.noise.front().robust;
}

/// The sample of a robot that stands still, after those before it.
Sample SessionFollower::at_rest(Sample sample) const {
  std::vector<Sample> all = samples_;
  all.push_back(sample);
  set_joint_moves(all);
  sample.joint_moves = all.back().joint_moves;
  sample.joint_velocities.assign(sample.joint_names.size(), 0.0);
  return sample;
}

FollowedState SessionFollower::add(const Sample& captured, std::span<const Sample> ahead) {
  FollowedState followed;
  const Sample sample = at_rest(captured);
  try {
    check(sample);
    if (compares_surface(config_)) {
      samples_.push_back(sample);
      calibrate_surface(ahead, followed);
    } else if (online_) {
      online_->expect({ahead.begin(), ahead.end()});
      followed.online = online_->add(sample);
      samples_.push_back(sample);
      misfits_ = followed.online.fits ? 0 : misfits_ + 1;
      constexpr int kMisfits = 2;
      if (misfits_ == kMisfits) followed.online = start_again(ahead);
    } else {
      samples_.push_back(sample);
      followed.online = start_again(ahead);
    }
    if (online_ && followed.online.known) followed.next = online_->next_move();
  } catch (const SampleError& error) {
    followed.problem = error.what();
  } catch (const InputError& error) {
    followed.problem = error.what();
  }
  return followed;
}

CalibrationSetup SessionFollower::setup() const {
  return {.robot = robot_,
          .config = config_,
          .samples = samples_,
          .urdf_text = urdf_text_,
          .urdf = urdf_};
}

Sample at_pose(const CapturePose& pose, const Sample& sample) {
  Sample there;
  there.joint_names = sample.joint_names;
  there.joint_positions = sample.joint_positions;
  for (std::size_t i = 0; i < there.joint_names.size(); ++i) {
    const auto at =
        std::find(pose.joint_names.begin(), pose.joint_names.end(), there.joint_names[i]);
    if (at == pose.joint_names.end()) continue;
    there.joint_positions[i] =
        pose.positions[static_cast<std::size_t>(at - pose.joint_names.begin())];
  }
  std::vector<Sample> way = {sample, there};
  set_joint_moves(way);
  there = std::move(way.back());
  there.joint_velocities.assign(there.joint_names.size(), 0.0);
  return there;
}

std::pair<std::string, std::string> SessionFollower::frames() const {
  if (!frames_) return {};
  return {frames_->frame.name(), frames_->in.name()};
}

bool Accuracy::reached(const OnlineState& state) const {
  if (!state.known) return false;
  if (position && !(state.position <= *position)) return false;
  return !rotation || state.rotation <= *rotation;
}

Accuracy parse_accuracy(const std::string& text) {
  std::istringstream words(text);
  std::string name, unit, more;
  double number = 0.0;
  const bool complete = static_cast<bool>(words >> name >> number >> unit) && !(words >> more);
  constexpr double kDegree = std::numbers::pi / 180.0;
  const std::map<std::string, double> lengths = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}},
                                      angles = {{"deg", kDegree}, {"rad", 1.0}};
  if (!complete || !(number > 0.0) || !std::isfinite(number) ||
      (!lengths.contains(unit) && !angles.contains(unit))) {
    throw InputError("'" + text +
                     "' is not an accuracy; write 'gripper 1 mm', 'gripper 0.1 deg', or the name "
                     "of a link instead of gripper");
  }
  Accuracy accuracy;
  if (name != "gripper") accuracy.frame = name;
  if (lengths.contains(unit)) {
    accuracy.position = number * lengths.at(unit);
  } else {
    accuracy.rotation = number * angles.at(unit);
  }
  return accuracy;
}

}  // namespace kinecal
