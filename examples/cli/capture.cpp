// kinecal capture: a robot moves from pose to pose, finders look, samples are written at once.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "commands.hpp"
#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/capture/finders/find_leds.hpp"
#include "kinecal/capture/session/session.hpp"
#include "kinecal/config/cameras/next_photographs.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/urdf/velocity_limits.hpp"
#include "kinecal/procedure/session_end.hpp"
#include "kinecal/procedure/session_follower.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/tools/detect/detect.hpp"
#include "output_file.hpp"
#include "pose_file.hpp"
#include "report.hpp"
#include "robot_link.hpp"
#include "sheets.hpp"
#include "terminal.hpp"
#include "truth.hpp"

namespace kinecal::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Poses of a file, with the joints that the robot's chains move.
/// @throws InputError  if the robot cannot take them all
std::vector<CapturePose> read_poses(const std::string& path, const CaptureConfig& config,
                                    const Robot& robot) {
  std::vector<CapturePose> poses = read_pose_file(path);
  check_poses(poses, config, robot);
  std::set<std::string> moved;
  for (const CaptureChain& chain : config.chains) {
    moved.insert(chain.joints.begin(), chain.joints.end());
  }
  for (CapturePose& pose : poses) {
    CapturePose kept{{}, {}, pose.features, pose.source};
    for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
      const std::string& joint = pose.joint_names[i];
      if (!moved.empty() && !moved.contains(joint)) continue;
      kept.joint_names.push_back(joint);
      kept.positions.push_back(within_limits(robot, joint, pose.positions[i]));
    }
    if (kept.joint_names.empty() && !moved.empty()) {
      throw InputError(pose.source + ": the pose has none of the joints of the chains");
    }
    pose = std::move(kept);
  }
  return poses;
}

/// A finder of a session, with settings of any type.
SessionFinder finder_of(const CaptureFinder& finder, const Robot& robot, AnyRobot& hardware) {
  if (const auto* touch = std::get_if<TouchFinder>(&finder.settings)) {
    const auto joints_only = [&arm = hardware.arm](Stamp after) {
      MeasuredJoints joints = arm.next_joints(after);
      View view;
      view.stamp = joints.stamp;
      view.joints = std::move(joints);
      return view;
    };
    return {finder.name, joints_only,
            [touch = *touch](const View& view) { return touch.find(view); }, TouchFinder::fault};
  }
  AnyCamera& camera = hardware.cameras.at(finder.name);
  const FinderSettings settings = on_robot(finder, robot);
  const auto fault = [settings](const View& view) { return unusable(settings, view); };
  if (const auto* leds = std::get_if<LedFinder>(&settings)) {
    const auto lamp = hardware.lamps.find(finder.name);
    if (lamp == hardware.lamps.end()) {
      throw InputError(finder.place.str() + ": finder '" + finder.name +
                       "': action is missing: it switches the LEDs");
    }
    return {finder.name, camera.viewer,
            [leds = *leds, &camera, &lamp = lamp->second](const View& still) {
              return find_leds(leds, camera, lamp, still.stamp, still.joints);
            },
            fault};
  }
  return {finder.name, camera.viewer, view_finder(finder, settings).find, fault};
}

/// Follows the session and says when it is enough.
class Follower {
 public:
  Follower(const CaptureOptions& options, const Robot& robot, const std::string& urdf)
      : robot_(robot) {
    Diagnostics diagnostics;
    Config config = read_config(options.calibrate, diagnostics);
    print_or_throw(diagnostics);
    if (!options.until.empty()) until_ = parse_accuracy(options.until);
    CalibrationOptions calibrating;
    calibrating.mesh_paths = options.mesh_paths;
    follower_.emplace(std::move(config), robot, until_ ? until_->frame : "", urdf, options.urdf,
                      std::move(calibrating));
  }

  /// Takes a sample; prints what it tells on one line.
  /// @param left  poses of the session without a sample
  void add(const Sample& sample, const std::vector<CapturePose>& left) {
    enough_ = false;
    ahead_.clear();
    for (const CapturePose& pose : left) ahead_.push_back(at_pose(pose, sample));
    const FollowedState state = follower_->add(sample, ahead_);
    if (!state.problem.empty()) {
      say("  warning: {}\n", state.problem);
      return;
    }
    for (const int number : state.online.dropped) {
      say("  warning: sample {} does not fit the others\n", number);
    }
    if (!state.online.fits) {
      say("  warning: this sample does not fit the others ({:.1f} times their noise): "
          "is everything where it was?\n",
          state.online.times);
    }
    if (state.online.known) print_state(state);
    if (until_ && until_->reached(state.online)) confirm();
  }

  [[nodiscard]] bool enough() const { return enough_; }
  /// The calibration of all samples so far.
  [[nodiscard]] CalibratedRobot calibrate_all() const { return follower_->calibrate_all(); }

 private:
  void print_state(const FollowedState& state) const {
    const auto [frame, in] = follower_->frames();
    say("  '{}' in '{}': +- {:.2f} mm, {:.3f} deg", frame, in, 1e3 * state.online.position,
        state.online.rotation / kDegree);
    if (state.next) {
      const bool turns = robot_.joint(state.next->joint).type != JointType::prismatic;
      say("; next, move {} by {:+.0f} {}", state.next->joint,
          turns ? state.next->change / kDegree : 1e3 * state.next->change, turns ? "deg" : "mm");
    }
    say("\n");
  }

  /// Asks the whole calibration, and prints why it does not agree.
  void confirm() {
    const std::string why = why_go_on(*until_, *follower_, ahead_);
    enough_ = why.empty();
    if (!enough_) say("  not enough yet: {}\n", why);
  }

  Robot robot_;
  std::optional<Accuracy> until_;
  std::optional<SessionFollower> follower_;
  std::vector<Sample> ahead_ = {};  ///< poses without a sample
  bool enough_ = false;
};

/// Prints what became of a pose on one line.
/// @param left  of the session: "; 6 min left"
/// @param said  notes of finders that have been printed
void print_pose(std::size_t number, std::size_t count, const CapturedPose& captured,
                const std::string& left, std::set<std::string>& said) {
  std::string text;
  for (const FinderOutcome& outcome : captured.outcomes) {
    const Found& found = outcome.found;
    text += text.empty() ? "" : "; ";
    text += found ? fmt::format("{}: {}", outcome.finder,
                                counted(found.observations.front().features.size(), "feature"))
                  : fmt::format("{}: nothing, {}", outcome.finder, found.refusal);
    if (found && !found.refusal.empty()) text += " (" + found.refusal + ")";
    for (const std::string& note : found.notes) {
      if (found && said.insert(note).second) text += " (note: " + note + ")";
    }
  }
  if (!captured.failure.empty()) text = "skipped: " + captured.failure;
  const std::string of = count > 0 ? fmt::format(" of {}", count) : "";
  say("pose {}{}: {}{}\n", number, of, text, left);
  std::fflush(stdout);
}

/// The places that a tip may touch, if there are several: one of them in each pose.
std::vector<std::string> places_to_touch(const CaptureConfig& config) {
  std::vector<std::string> names;
  for (const CaptureFinder& finder : config.finders) {
    if (std::holds_alternative<TouchFinder>(finder.settings)) names.push_back(finder.name);
  }
  return names.size() > 1 ? names : std::vector<std::string>{};
}

/// The poses of the session: a list, or wherever a person puts the robot.
NextPose next_pose(const CaptureOptions& options, const CaptureConfig& config,
                   const std::vector<CapturePose>& poses) {
  if (!options.manual) return poses_of(poses);
  return [places = places_to_touch(config)]() -> std::optional<CapturePose> {
    std::string line;
    while (true) {
      if (places.empty()) {
        say("put the robot into the next pose, then press Enter; q ends the session\n");
      } else {
        say("put the tip into one of {}, then write its name and press Enter; q ends the session\n",
            fmt::join(places, ", "));
      }
      std::fflush(stdout);
      if (!std::getline(std::cin, line) || is_end(line)) return std::nullopt;
      if (places.empty()) return CapturePose{};
      // "2" is socket_2, if no other ends so.
      const auto is_meant = [&](const std::string& name) {
        return name == line || (!line.empty() && name.ends_with("_" + line));
      };
      auto named = std::find(places.begin(), places.end(), line);
      if (named == places.end() && std::count_if(places.begin(), places.end(), is_meant) == 1)
        named = std::find_if(places.begin(), places.end(), is_meant);
      if (named != places.end()) return CapturePose{{}, {}, {*named}};
      say("'{}' is none of them\n", line);
    }
  };
}

/// The samples of an earlier session; empty if this is the first.
std::vector<Sample> earlier_samples(const CaptureOptions& options) {
  if (!options.resume || !std::filesystem::exists(options.output)) return {};
  Diagnostics diagnostics;
  std::vector<Sample> samples = output_encoding(options.output)
                                    ? read_recordings({options.output}, diagnostics).samples
                                    : read_complete_samples(options.output, diagnostics);
  print_or_throw(diagnostics);
  return samples;
}

/// @throws InputError  if samples of an earlier session lack a joint that the poses move
void check_robot(const std::vector<Sample>& samples, const std::vector<CapturePose>& poses) {
  for (const Sample& sample : samples) {
    for (const std::string& joint : poses.front().joint_names) {
      if (sample.position(joint)) continue;
      throw InputError(sample.source + ": has no joint '" + joint +
                       "', which the poses move; --resume goes on with the same robot" +
                       did_you_mean(joint, sample.joint_names));
    }
  }
}

/// The calibration of `--result`.
CalibrateOptions calibration_of(const CaptureOptions& options) {
  CalibrateOptions calibrating;
  calibrating.urdf = options.urdf;
  calibrating.config = options.calibrate;
  calibrating.samples = {options.output};
  calibrating.mesh_paths = options.mesh_paths;
  calibrating.output = options.result;
  calibrating.force = options.force;
  if (!options.report.empty()) calibrating.reports = {options.report};
  calibrating.command = ShellCommand{"kinecal", "calibrate"}
                            .add(input_options(calibrating))
                            .add_option("--output", {options.result});
  return calibrating;
}

void check_options(const CaptureOptions& options) {
  (void)output_encoding(options.output);
  std::vector<std::string> inputs = {options.config, options.urdf, options.poses,
                                     options.calibrate};
  if (options.robot.starts_with(kSimulated)) {
    inputs.push_back(options.robot.substr(kSimulated.size()));
  }
  check_output(options.output, inputs, options.force || options.resume);
  inputs.push_back(options.output);
  if (!options.sheet.empty()) {
    const bool is_own = options.resume && std::filesystem::exists(options.output);
    check_sheets(options.sheet, inputs, options.force || is_own);
  }
  if (!options.result.empty()) check_results(calibration_of(options));
  if (!options.result.empty() && options.urdf.empty() && !output_encoding(options.output)) {
    throw InputError(
        "--urdf is required: samples in YAML do not have the URDF, which --result "
        "needs; or let the name of --output end in .bag or .mcap");
  }
  check_reports(calibration_of(options));
  if (!(options.velocity > 0.0)) throw InputError("--velocity must be a number from 0.01 to 1");
  if (options.manual == options.poses.empty()) return;
  throw InputError(options.manual ? "--manual: a person moves the robot, so --poses has no use"
                                  : "--poses is required, or --manual");
}

/// A session and what it has recorded.
struct Session {
  const CaptureOptions& options;
  std::string urdf;  ///< text
  Robot robot;
  std::vector<CapturePose> poses;
  std::vector<Sample> samples;  ///< those of an earlier session first
  std::optional<Follower> follower;
  std::size_t earlier = 0;  ///< poses of an earlier session
  std::size_t done = 0;     ///< poses of this one
  Stamp spent{};            ///< on the robot's clock, for `timed` of these poses
  std::size_t timed = 0;    ///< poses that were not skipped
  std::vector<std::string> earlier_views = {};  ///< of an earlier session's contact sheets
  std::vector<Thumbnail> thumbnails = {};       ///< of what finders looked at
  std::set<std::string> said = {};              ///< notes of finders
  std::vector<std::string> advice = {};         ///< what was printed last: see advise()
  SettleOptions settling = {};                  ///< when the robot is still and has arrived

  /// Prints, writes and follows what came of a pose.
  void take(CapturedPose captured) {
    if (options.manual && has_not_moved(captured)) {
      captured.samples.clear();
      captured.failure = fmt::format(
          "nothing has moved since the last sample; move a joint by more than {} rad ({:.1f} deg) "
          "or {:.0f} mm",
          kSamePosition, kSamePosition / kDegree, 1e3 * kSamePosition);
    }
    spent += captured.duration;
    timed += captured.duration > Stamp::zero() ? 1 : 0;
    ++done;
    print_pose(earlier + done, poses.empty() ? 0 : earlier + poses.size(), captured, time_left(),
               said);
    add_thumbnails(captured);
    if (captured.samples.empty()) return;
    samples.insert(samples.end(), captured.samples.begin(), captured.samples.end());
    write_recording(options.output, samples, urdf, existing_at(options.output));
    for (const Sample& sample : captured.samples) {
      if (follower) follower->add(sample, poses_left(poses, samples, settling));
    }
    advise();
  }

  /// Prints what all samples lack for the lenses of cameras, where that has changed.
  void advise() {
    std::vector<std::string> now = next_photographs(samples);
    if (now == advice) return;
    for (const std::string& line : now) say("  {}\n", line);
    advice = std::move(now);
  }

  /// "; 6 min left": the poses that are left take the mean time of those so far.  The first one alone
  /// is no measure: the robot may have been near it.
  [[nodiscard]] std::string time_left() const {
    if (timed < 2 || done >= poses.size()) return {};
    const double mean = std::chrono::duration<double>(spent).count() / static_cast<double>(timed);
    const double seconds = mean * static_cast<double>(poses.size() - done);
    constexpr double kMinute = 60.0, kLong = 90.0;
    return fmt::format("; {}{:.0f} {} left", options.until.empty() ? "" : "at most ",
                       seconds < kLong ? seconds : seconds / kMinute,
                       seconds < kLong ? "s" : "min");
  }

  /// Whether the robot stands where it stood in the last sample.
  [[nodiscard]] bool has_not_moved(const CapturedPose& captured) const {
    if (samples.empty() || captured.samples.empty()) return false;
    const Sample& now = captured.samples.front();
    for (std::size_t i = 0; i < now.joint_names.size(); ++i) {
      const std::string& name = now.joint_names[i];
      const std::optional<double> before = samples.back().position(name);
      if (!before || joint_distance(name, *before, now.joint_positions[i], settling.continuous) >
                         kSamePosition) {
        return false;
      }
    }
    return true;
  }

  void add_thumbnails(const CapturedPose& captured) {
    if (options.sheet.empty()) return;
    for (const FinderOutcome& outcome : captured.outcomes) {
      if (outcome.view.image.empty()) continue;
      thumbnails.push_back(
          thumbnail(outcome.view.image, outcome.found.marks, fmt::format("pose {}", earlier + done),
                    outcome.found ? "" : outcome.found.refusal, outcome.found.grid));
    }
  }

  /// Runs until the last pose, Ctrl-C or the accuracy.
  /// @returns  why the session ended before; empty if it did not
  [[nodiscard]] std::string run(const CaptureConfig& config) {
    const Interruption interruption;
    AnyRobot hardware = connect(
        options.robot, config, robot, velocity_limits(urdf, urdf_name(options.urdf)),
        options.manual ? MovedBy::person : MovedBy::controllers, {options.joints, options.depth});
    std::vector<SessionFinder> finders;
    for (const CaptureFinder& finder : config.finders) {
      finders.push_back(finder_of(finder, robot, hardware));
    }
    const NextPose from_list = next_pose(options, config, poses);
    const NextPose next = [&]() -> std::optional<CapturePose> {
      if (Interruption::is_asked() || (follower && follower->enough())) return std::nullopt;
      return from_list();
    };
    SessionOptions session;
    session.velocity_factor = options.velocity;
    session.settling = settling;
    session.fault = [&](const MeasuredJoints& joints) { return like_degrees(joints, robot); };
    if (options.manual) session.hopeless = 0;  // a person reads why, and may try on
    std::string lost;
    try {
      run_session(
          hardware.arm, next, finders, [&](const CapturedPose& pose) { take(pose); }, session);
    } catch (const ConnectionError& error) {
      lost = error.what();
    } catch (const HopelessError& error) {
      lost = error.what();
    }
    return lost;
  }
};

/// Prints what a session has recorded.
/// @param before  samples of an earlier session
void print_session(const Session& session, std::size_t before) {
  const double minutes = std::chrono::duration<double, std::ratio<60>>(session.spent).count();
  say("{}: {} of {} in {:.1f} minutes of the robot's time{}\n", session.options.output,
      counted(session.samples.size(), "sample"), counted(session.done, "pose"), minutes,
      before > 0 ? fmt::format(" ({} from before)", before) : "");
  if (session.follower && session.follower->enough()) {
    say("'{}' is reached\n", session.options.until);
  }
  std::fflush(stdout);
}

}  // namespace

int capture(const CaptureOptions& options) {
  if (is_base_config(options.config)) return capture_base(options);
  if (options.drive || options.distance || options.seconds || !options.topics.empty()) {
    throw InputError("--drive, --distance, --seconds and --topic are of a mobile base: " +
                     options.config + " has no error block of one");
  }
  check_options(options);
  Diagnostics diagnostics;
  const CaptureConfig config = read_capture_config(options.config, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  Session session{options, urdf_of(options.urdf, options.robot), {}, {}, earlier_samples(options),
                  {}};
  session.robot = parse_urdf(session.urdf, urdf_name(options.urdf));
  session.settling.continuous = continuous_joints(session.robot);
  const std::size_t before = session.samples.size();
  if (before > 0 && !options.sheet.empty()) session.earlier_views = read_sheets(options.sheet);
  check_chains(options.config, config, session.robot);
  bool is_complete = false;
  if (!options.manual) {
    const std::vector<CapturePose> all = read_poses(options.poses, config, session.robot);
    check_robot(session.samples, all);
    session.poses = poses_left(all, session.samples, session.settling);
    session.earlier = all.size() - session.poses.size();
    is_complete = session.poses.empty();
  }
  if (!options.calibrate.empty()) {
    session.follower.emplace(options, session.robot, session.urdf);
    for (const Sample& sample : session.samples) session.follower->add(sample, session.poses);
  }
  const std::string lost = is_complete ? "" : session.run(config);
  if (!session.thumbnails.empty()) {
    say("{}: what was found in {}\n",
        write_sheets(options.sheet, session.thumbnails, session.earlier_views),
        counted(session.earlier_views.size() + session.thumbnails.size(), "view"));
  }
  if (is_complete) {
    say("{}: {} from before; all poses of {} are captured\n", options.output,
        counted(before, "sample"), options.poses);
  } else if (session.done > 0) {
    print_session(session, before);
  }
  const bool is_interrupted = !is_complete && Interruption::is_asked();
  if (is_interrupted || !lost.empty()) {
    say(stderr, "error: {}{}\n", is_interrupted ? "interrupted" : lost,
        session.samples.empty() ? "" : "; --resume goes on from here");
    return is_interrupted ? kInterrupted : kBadInput;
  }
  if (session.samples.empty()) {
    say(stderr, "error: nothing was found in any pose\n");
    return kBadInput;
  }
  const int code = options.result.empty() ? kDone : calibrate(calibration_of(options));
  if (session.follower && options.robot.starts_with(kSimulated)) {
    const std::string scene = options.robot.substr(kSimulated.size());
    say("{}", truth_text(session.robot, scene, session.follower->calibrate_all()));
  }
  return code;
}

}  // namespace kinecal::cli
