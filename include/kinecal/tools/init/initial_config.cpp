// The text of a first configuration: definitions of initial_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/initial_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/camera_parts.ipp"
#include "kinecal/tools/init/determined_offsets.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

namespace detail {
namespace {

// The content of a first configuration: the entries of its lists, each with its reason.

/// One entry of a list: a comment, a name, and keys with YAML values.  Without keys, only the name.
struct InitEntry {
  std::string why;
  std::string name;  ///< not yet quoted for YAML
  std::vector<std::pair<std::string, std::string>> fields;
};

/// An offset that is not freed, with the reason.
struct InitLeftOut {
  std::string joint, why;
};

struct InitPlan {
  std::vector<InitEntry> models, free_params, free_frames, fixed_frames, initial_values,
      error_blocks;
  std::vector<InitLeftOut> left_out;
};

/// A frame with its pose: zeros.
[[nodiscard]] InitEntry frame_at_zero(const std::string& frame, const std::string& why) {
  InitEntry entry{why, frame, {}};
  for (const char* key : {"x", "y", "z", "roll", "pitch", "yaw"}) {
    entry.fields.emplace_back(key, "0.0");
  }
  return entry;
}

/// The initial value of a frame that is not in the URDF: zeros, to be replaced by hand.
void add_initial_value(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.initial_values.push_back(frame_at_zero(frame, why));
}

/// Writes where a frame is.
/// @param at  metres
void put(InitEntry& frame, const Vector3<double>& at) {
  for (std::size_t i = 0; i < 3; ++i) {
    frame.fields[i].second = fmt::format("{}", at(static_cast<Eigen::Index>(i)));
  }
}

/// Frees a frame once: its position and, unless it is the frame of a point, its rotation.
void free_frame(InitPlan& plan, const std::string& name, const std::string& why,
                bool is_point = false) {
  for (const InitEntry& frame : plan.free_frames) {
    if (frame.name == name) return;
  }
  plan.free_frames.push_back({why, name, {}});
  const std::array<const char*, 6> axes = {"x", "y", "z", "roll", "pitch", "yaw"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    plan.free_frames.back().fields.emplace_back(axes[i], i < 3 || !is_point ? "true" : "false");
  }
}

/// The joints that move between two links.
/// @throws RobotError  like make_chain()
[[nodiscard]] std::vector<ChainJoint> movers(const Robot& robot, const std::string& base,
                                             const std::string& tip) {
  return make_chain(robot, base, tip).joints;
}

/// The stands of robots that the samples of a camera relate to what it sees: those on the way to one of them only.
[[nodiscard]] std::vector<std::string> related_stands(const Robot& robot,
                                                      const InitAnswers& answers) {
  const auto stand_of = [&](const std::string& link) {
    return joint_above(robot, link.empty() ? answers.base : link, answers.stands);
  };
  const std::string seen = stand_of(answers.arm), seen_by = stand_of(answers.camera);
  std::vector<std::string> related;
  if (seen == seen_by) return related;
  for (const std::string& stand : {seen, seen_by}) {
    if (!stand.empty()) related.push_back(stand);
  }
  return related;
}

/// Removes the common joints at the beginning of two chains.
void remove_common(std::vector<ChainJoint>& a, std::vector<ChainJoint>& b) {
  while (!a.empty() && !b.empty() && a.front().name == b.front().name) {
    a.erase(a.begin());
    b.erase(b.begin());
  }
}

/// Frees the offsets of joints that samples determine, and gives the reason for the others.
/// @returns  whether samples also determine the frames
bool free_offsets(InitPlan& plan, const Robot& robot, const MeasuredTarget& measured,
                  const std::vector<std::string>& frames) {
  const OffsetEffects effects =
      offset_effects(robot, measured, frames, driven_joints(robot, measured));
  for (const OffsetEffect& effect : effects.offsets) {
    if (effect.determined) {
      plan.free_params.push_back({"", effect.joint, {}});
    } else if (!effect.is_seen) {
      plan.left_out.push_back({effect.joint, measured.contact == Contact::none
                                                 ? "It moves the arm and the camera alike"
                                                 : "It changes nothing that is recorded"});
    } else if (effect.imitated_by == effect.joint) {
      plan.left_out.push_back({effect.joint, "Its frame is free, which includes its offset"});
    } else if (!effect.imitated_by.empty()) {
      plan.left_out.push_back(
          {effect.joint, "Frame " + name_to_yaml(effect.imitated_by) +
                             " is free, and no sample can distinguish its rotation (or "
                             "shift) from this joint's offset"});
    } else {
      plan.left_out.push_back({effect.joint,
                               "No sample can distinguish its offset from changes of the free "
                               "frames and of the offsets above"});
    }
  }
  std::vector<std::string> ends = {measured.target, measured.sensor};
  for (const FurtherTip& tip : measured.more_tips) ends.push_back(tip.link);
  for (const std::string& end : ends) {
    for (const ChainJoint& joint : movers(robot, measured.base, end)) {
      const auto is_known = [&](const InitLeftOut& known) { return known.joint == joint.name; };
      if (joint.drive.joint == joint.name ||
          std::any_of(plan.left_out.begin(), plan.left_out.end(), is_known)) {
        continue;
      }
      plan.left_out.push_back({joint.name, "It mimics joint " + name_to_yaml(joint.drive.joint) +
                                               ", which has the offset"});
    }
  }
  return effects.frames_determined;
}

// Entries of a first configuration that several targets share: models, the camera's parameters,
// error blocks, a board.

void add_chain_model(InitPlan& plan, const std::string& why, const std::string& name,
                     const std::string& link) {
  plan.models.push_back({why, name, {{"type", "chain3d"}, {"frame", name_to_yaml(link)}}});
}

void add_camera_model(InitPlan& plan, const InitAnswers& answers) {
  const bool depth = answers.camera_type == "camera3d";
  plan.models.push_back({depth ? "A depth camera: points in metres, in its optical frame."
                               : "A camera: pixels.  In its frame z points ahead and y down.",
                         answers.camera_name,
                         {{"type", answers.camera_type}, {"frame", name_to_yaml(answers.camera)}}});
}

/// Frees the camera's parameters.
/// @param floor_only  only those that the floor determines
void free_camera(InitPlan& plan, const InitAnswers& answers, bool floor_only) {
  const auto add = [&](const char* part, const std::string& why) {
    plan.free_params.push_back({why, answers.camera_name + "_" + part, {}});
  };
  if (!floor_only && !answers.known_lens) {
    add("fx",
        "Focal lengths and image centre, relative to the driver's values: 0.01 is one percent.");
    for (const char* part : {"fy", "cx", "cy"}) add(part, "");
  }
  if (answers.camera_type != "camera3d") return;
  add("z_offset", "Depth: z = (1 + z_scaling) * (measured z + z_offset), z_offset in metres.");
  add("z_scaling", "");
}

/// Compares the points seen by the camera with those of a model.
void add_hand_eye(InitPlan& plan, const InitAnswers& answers) {
  const std::string model = holder_of(answers);
  InitEntry block{"", "hand_eye", {}};
  if (answers.camera_type == "camera3d") {
    block.why = "The camera and model '" + model +
                "' observe the same points, in the same order.  sigma is the camera's accuracy for "
                "one point, in metres: 0.003 is a guess, write yours.";
    block.fields = {{"type", "chain3d_to_chain3d"},
                    {"model_a", name_to_yaml(answers.camera_name)},
                    {"model_b", name_to_yaml(model)},
                    {"sigma", "0.003"}};
  } else {
    block.why = "The camera sees the points of model '" + model +
                "', in the same order.  sigma is its accuracy for one point, in "
                "pixels: 0.5 is a guess, write yours.";
    block.fields = {{"type", "chain3d_to_camera2d"},
                    {"model_3d", name_to_yaml(model)},
                    {"model_2d", name_to_yaml(answers.camera_name)},
                    {"sigma", "0.5"}};
  }
  block.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(std::move(block));
}

void add_ground(InitPlan& plan, const InitAnswers& answers) {
  plan.error_blocks.push_back({"The floor: a x + b y + c z + d = 0 in link " +
                                   name_to_yaml(answers.base) +
                                   ".  Set d if the origin of this link is not on the floor (0.1 m "
                                   "above it: d: 0.1).  'alone' selects "
                                   "the samples in which only the camera observes.  sigma, the "
                                   "camera's accuracy for one point in metres, is a guess.",
                               "ground_plane",
                               {{"type", "chain3d_to_plane"},
                                {"model", name_to_yaml(answers.camera_name)},
                                {"a", "0.0"},
                                {"b", "0.0"},
                                {"c", "1.0"},
                                {"d", "0.0"},
                                {"samples", "alone"},
                                {"sigma", "0.003"},
                                {"loss", "{type: huber, scale: 3.0}"}}});
}

/// Keeps a frame near zero in the directions that samples do not determine.
void keep_near_zero(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.error_blocks.push_back(
      {why + "  It counts once per sample: with 100 samples, these scales weigh as much as one "
             "measurement with an accuracy of 0.1 m and 6 degrees.",
       "restrict_" + frame,
       {{"type", "outrageous"},
        {"param", name_to_yaml(frame)},
        {"joint_scale", "0.0"},
        {"position_scale", "1.0"},
        {"rotation_scale", "1.0"}}});
}

/// The joint whose frame describes the camera's mount.
/// @throws InputError  if there is no such joint
[[nodiscard]] const Joint& require_mount(const Robot& robot, const InitAnswers& answers,
                                         const std::vector<std::string>& others) {
  const Joint* mount = camera_mount(robot, answers.camera, others);
  if (mount == nullptr) {
    throw InputError(
        fmt::format("--camera: no joint that could be corrected belongs to link '{}' alone; choose "
                    "another link, or another --base or --arm",
                    answers.camera));
  }
  return *mount;
}

/// Frees the frame of a board that is in the gripper or fixed in the world.
void add_board(InitPlan& plan, const std::string& name, const std::string& link) {
  free_frame(
      plan, name,
      "Where the board is, seen from link " + name_to_yaml(link) +
          ".  The URDF does not contain this frame; it is the frame_id of the board's corners.");
  add_initial_value(plan, name,
                    "Zeros are no guess: kinecal searches for the board.  Should it not find it, "
                    "measure where the board's first corner is in link " +
                        name_to_yaml(link) +
                        " and how the board is turned (x along its rows, y along its columns).");
}

/// Points on a link, or of a board in the target frame on it, that the camera sees.
[[nodiscard]] MeasuredTarget seen_by_camera(const InitAnswers& answers, const std::string& link) {
  MeasuredTarget seen{answers.base, link, answers.camera};
  seen.target_frame = answers.target_frame;
  seen.is_camera = true;
  seen.has_depth = answers.camera_type == "camera3d";
  return seen;
}

// The offsets and frames that each target determines: these are freed, the others left out.
//
// A free frame can replace a joint's offset: the rotation of a tracker that of the first joint, the
// position of a reflector that of the last.  With both free, the samples would only determine their
// sum.  So the offset is left out, and the configuration gives the reason: determined_offsets.hpp.

/// Frees the camera and its mount, and compares what it sees.
/// @param determined  the samples determine the whole frame of the mount; if not, a block keeps it small
/// @param why         the frame is not determined
void add_mounted_camera(InitPlan& plan, const InitAnswers& answers, const std::string& mount,
                        bool determined, const std::string& why) {
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, false);
  add_hand_eye(plan, answers);
  if (!determined) keep_near_zero(plan, mount, why);
}

/// Frees the offsets between the camera and what it sees on the arm, and the frame of the part that carries it.
/// @param head  moves the camera and not the arm
/// @returns     whether the samples determine the frame of the mount
bool free_arm_and_head(InitPlan& plan, const Robot& robot, const InitAnswers& answers,
                       const std::vector<ChainJoint>& head, const std::string& mount) {
  const std::vector<std::string> stands = related_stands(robot, answers);
  const std::string head_frame = head.empty()      ? mount
                                 : !stands.empty() ? stands.front()
                                                   : head.front().name;
  MeasuredTarget seen = seen_by_camera(answers, answers.arm);
  if (!is_board(answers.target)) seen.target_frame.clear();
  std::vector<std::string> frames = {head_frame};
  if (mount != head_frame) frames.push_back(mount);
  const bool determined = free_offsets(plan, robot, seen, frames);
  if (!head.empty() && stands.empty()) {
    free_frame(plan, head_frame, "How the part that carries the camera is mounted on the robot.");
  }
  return determined;
}

/// LEDs or a board on the gripper, seen by a camera that does not move with it.
[[nodiscard]] InitPlan plan_hand_eye(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  std::vector<ChainJoint> arm = movers(robot, answers.base, answers.arm);
  std::vector<ChainJoint> head = movers(robot, answers.base, answers.camera);
  remove_common(arm, head);
  if (arm.empty()) {
    throw InputError(fmt::format(
        "--camera: camera '{}' moves with arm '{}' and sees the same in every pose; let it see a "
        "board in the world: --target world_checkerboard",
        answers.camera, answers.arm));
  }
  const bool board = answers.target == InitTarget::checkerboard;
  add_chain_model(plan,
                  board ? "The arm, which holds the board: the points are the board's corners."
                        : "The arm: the points are the LEDs, at known places in this link.",
                  holder_of(answers), answers.arm);
  add_camera_model(plan, answers);

  const std::string mount = require_mount(robot, answers, {answers.base, answers.arm}).name;
  if (board) add_board(plan, answers.target_frame, answers.arm);
  const bool determined = free_arm_and_head(plan, robot, answers, head, mount);
  add_mounted_camera(plan, answers, mount, determined,
                     "The joints cannot show all of the camera's frame beside the others: this "
                     "block keeps its correction small.");
  return plan;
}

/// A board in the world, seen by a camera that the robot moves.
[[nodiscard]] InitPlan plan_world_checkerboard(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.camera);
  if (way.empty()) {
    throw InputError(fmt::format(
        "--camera: camera '{}' does not move relative to link '{}', so a board that stands in the "
        "world determines nothing; choose another link, or another --base",
        answers.camera, answers.base));
  }
  add_chain_model(plan, "The board, which stands still in this link: the points are its corners.",
                  holder_of(answers), answers.base);
  add_camera_model(plan, answers);
  const std::string mount = require_mount(robot, answers, {answers.base}).name;
  add_board(plan, answers.target_frame, answers.base);
  const bool determined = free_offsets(plan, robot, seen_by_camera(answers, answers.base), {mount});
  add_mounted_camera(plan, answers, mount, determined,
                     "The camera does not turn about two axes, so samples cannot distinguish all "
                     "of its frame from the board's: this block keeps the correction of the "
                     "camera's frame small.");
  return plan;
}

/// A reflector on the arm and a tracker fixed in the world.
[[nodiscard]] InitPlan plan_tracker(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.arm);
  if (way.empty()) {
    throw InputError(
        fmt::format("--arm: link '{}' does not move relative to link '{}'; choose another link, or "
                    "another --base",
                    answers.arm, answers.base));
  }
  const std::string &tracker = answers.tracker_frame, &reflector = answers.target_frame;
  std::vector<std::string> reflectors = answers.more_reflectors;
  reflectors.insert(reflectors.begin(), reflector);
  add_chain_model(plan,
                  reflectors.size() == 1
                      ? "The arm: the reflector is point (0, 0, 0) of frame " + reflector + "."
                      : "The arm: each reflector is point (0, 0, 0) of its frame.",
                  holder_of(answers), answers.arm);
  add_chain_model(
      plan,
      "The tracker, which stands still in this link: measured points in frame " + tracker + ".",
      tracker_of(answers), answers.base);
  MeasuredTarget followed{answers.base, answers.arm, answers.base};
  followed.target_frame = reflector;
  followed.is_point = true;
  followed.sensor_frame = tracker;
  const bool determined = free_offsets(plan, robot, followed, {});
  free_frame(
      plan, tracker,
      "Where the tracker stands, seen from link " + name_to_yaml(answers.base) +
          ".  The URDF does not contain this frame; it is the frame_id of the measured points.");
  for (const std::string& frame : reflectors) {
    free_frame(plan, frame,
               "Where the reflector (SMR) is in link " + name_to_yaml(answers.arm) +
                   "; a point has no rotation.  The URDF does not contain this frame either.",
               true);
  }
  add_initial_value(plan, tracker,
                    "Zeros are no guess: kinecal searches for the tracker.  Should it not find it, "
                    "measure where it stands and how it is turned.");
  for (const std::string& frame : reflectors) add_initial_value(plan, frame, "");
  InitEntry measured{
      "Both observe the same point.  The noise is what residuals show; 'sigma' would give it.",
      "measured",
      {{"type", "chain3d_to_chain3d"},
       {"model_a", name_to_yaml(holder_of(answers))},
       {"model_b", name_to_yaml(tracker_of(answers))}}};
  if (!determined) {  // the prior below is weighed against it
    measured.why =
        "Both observe the same point.  sigma combines the accuracy of the tracker and the "
        "repeatability of the robot, in metres: 0.0001 is a guess, write yours.";
    measured.fields.emplace_back("sigma", "0.0001");
  }
  measured.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(std::move(measured));
  if (!determined) {
    keep_near_zero(plan, reflector,
                   "The arm does not turn about two axes, so samples cannot distinguish all of the "
                   "reflector's position from the tracker's: this block keeps the reflector near "
                   "the origin of its link.");
  }
  return plan;
}

// Targets that a tip touches: joints are all that is recorded.

[[nodiscard]] Contact contact_of(InitTarget target) {
  switch (target) {
    case InitTarget::plane:
    case InitTarget::distance:
      return Contact::plane;
    case InitTarget::line:
      return Contact::line;
    case InitTarget::sphere:
    case InitTarget::bar:
      return Contact::sphere;
    case InitTarget::gravity:
      return Contact::gravity;
    case InitTarget::grip:
      return Contact::grip;
    default:
      return Contact::point;
  }
}

/// What the tip touches, seen from the arm's base.
[[nodiscard]] MeasuredTarget touched_by_arm(const InitAnswers& answers) {
  MeasuredTarget touched{answers.base, answers.arm, answers.carrier};
  touched.contact = contact_of(answers.target);
  const bool is_grip = touched.contact == Contact::grip;
  if (!is_grip) touched.target_frame = answers.target_frame;
  touched.is_point = answers.target != InitTarget::distance && !is_grip;
  if (!answers.at) touched.sensor_frame = answers.places.front();
  touched.radius_known = answers.length.has_value();
  touched.places = static_cast<int>(answers.places.size());
  touched.layout = answers.layout;
  for (const FurtherArm& more : answers.more_arms)
    touched.more_tips.push_back({more.arm, more.target_frame});
  if (answers.at && touched.layout.empty()) touched.layout = {Vector3<double>::Zero()};
  for (Vector3<double>& place : touched.layout) {
    if (answers.at) place += *answers.at;
  }
  return touched;
}

/// Frees some axes of a frame outside the URDF.
/// @param axes  of x y z roll pitch yaw
void free_axes(InitPlan& plan, const std::string& name, const std::string& why,
               const std::array<bool, 6>& axes) {
  free_frame(plan, name, why);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    plan.free_frames.back().fields[i].second = axes[i] ? "true" : "false";
  }
}

/// Frees the frames of what is touched, in the axes that a contact shows.
void free_places(InitPlan& plan, const InitAnswers& answers) {
  const std::string base = name_to_yaml(answers.carrier);
  const std::string& first = answers.places.front();
  if (answers.at) {
    plan.fixed_frames.push_back(
        frame_at_zero(first, "What is touched, at a known place of link " + base +
                                 ", which is held: an error of this place is one of the result."));
    put(plan.fixed_frames.back(), *answers.at);
    return;
  }
  switch (answers.target) {
    case InitTarget::plane:
    case InitTarget::distance:
      free_axes(plan, first, "The plane: z = 0 of this frame, seen from link " + base + ".",
                {false, false, true, true, true, false});
      break;
    case InitTarget::grip:
      free_frame(plan, first,
                 "Where hand " + name_to_yaml(answers.arm) + " is in hand " + base +
                     " while both hold the same thing: anywhere, but always there.");
      break;
    case InitTarget::line:
      free_axes(plan, first, "The line: the z axis of this frame, seen from link " + base + ".",
                {true, true, false, true, true, false});
      break;
    case InitTarget::sockets:
      if (!answers.layout.empty()) {
        free_axes(plan, first,
                  "The sockets, at known places of this frame, seen from link " + base +
                      ".  No sample shows a rotation about an axis that all of them are on.",
                  shown_axes(answers.layout));
        break;
      }
      [[fallthrough]];
    default:
      for (const std::string& place : answers.places) {
        free_frame(plan, place,
                   &place == &first ? "What stands still, seen from link " + base +
                                          ": a point, which has no rotation."
                                    : "",
                   true);
      }
  }
}

/// The joint that holds a tip which is a link of the URDF.
/// @throws InputError  if that joint moves
[[nodiscard]] const Joint& joint_of_tip(const Robot& robot, const std::string& link) {
  const Joint* joint = robot.parent_joint(link);
  if (joint != nullptr && joint->type == JointType::fixed) return *joint;
  throw InputError(fmt::format(
      "--target-frame: link '{}' is not fixed to another one, so it is no tip; choose a link "
      "behind a fixed joint, or a name that the URDF does not have",
      link));
}

/// Frees the zeros that a touch shows.
/// @throws InputError  if it shows none
void free_touched_offsets(InitPlan& plan, const Robot& robot, const InitAnswers& answers) {
  free_offsets(plan, robot, touched_by_arm(answers), {});
  if (!plan.free_params.empty()) return;
  if (answers.at) {
    throw InputError(fmt::format(
        "--touched-at: arm '{}' hardly reaches this place of link '{}' within the limits of its "
        "joints; is it in metres, in the axes of this link?",
        answers.arm, answers.carrier));
  }
  throw InputError(
      fmt::format("--target: {} shows no joint offset of arm '{}'; with --target tool, a tip alone "
                  "is found",
                  to_string(answers.target), answers.arm));
}

/// An accelerometer on an arm that reads gravity at rest.
[[nodiscard]] InitPlan plan_gravity(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  add_chain_model(plan,
                  "The accelerometer, with its axes in frame " + answers.target_frame +
                      "; what it reads are conditions ax, ay, az of each sample.",
                  holder_of(answers), answers.arm);
  plan.models.back().fields.front().second = "chain6d";
  free_touched_offsets(plan, robot, answers);
  plan.free_params.push_back({"What it would read with the axes of link " +
                                  name_to_yaml(answers.base) +
                                  ": the base may lean, and its scale need not be 1.",
                              "contact_x",
                              {}});
  for (const char* other : {"contact_y", "contact_z"}) plan.free_params.push_back({"", other, {}});
  const bool is_link = robot.has_link(answers.target_frame);
  free_axes(plan, is_link ? joint_of_tip(robot, answers.target_frame).name : answers.target_frame,
            is_link ? "How the accelerometer is turned, by this joint of the URDF."
                    : "How the accelerometer is turned on link " + name_to_yaml(answers.arm) +
                          ".  The URDF does not contain this frame.",
            {false, false, false, true, true, true});
  if (!is_link) {
    add_initial_value(plan, answers.target_frame,
                      "Zeros are no guess: kinecal searches for what the URDF does not have.");
  }
  plan.error_blocks.push_back(
      {"At rest it reads gravity, m/s^2.  The noise is what residuals show.",
       "contact",
       {{"type", "gravity_seen"},
        {"model", name_to_yaml(holder_of(answers))},
        {"loss", "{type: huber, scale: 3.0}"}}});
  return plan;
}

/// Both hands hold one rigid thing: the pose of one in the other stays.
[[nodiscard]] InitPlan plan_grip(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  add_chain_model(plan, "One hand: its link.", holder_of(answers), answers.arm);
  add_chain_model(plan, "The other hand, in which the first always has the same pose.",
                  tracker_of(answers), answers.carrier);
  for (InitEntry& model : plan.models) model.fields.front().second = "chain6d";
  free_touched_offsets(plan, robot, answers);
  free_places(plan, answers);
  add_initial_value(plan, answers.places.front(),
                    "Zeros are no guess: kinecal searches for what the URDF does not have.");
  plan.error_blocks.push_back(
      {"Both hands hold the same thing in every sample.  One over the accuracies of a pose of one "
       "hand in the other, which decide how distances weigh against angles: 1 mm and 2 mrad are a "
       "guess.  The noise is what residuals show.",
       "contact",
       {{"type", "pose_to_pose"},
        {"model_a", name_to_yaml(holder_of(answers))},
        {"model_b", name_to_yaml(tracker_of(answers))},
        {"translation_scale", "1000.0"},
        {"rotation_scale", "500.0"},
        {"loss", "{type: huber, scale: 3.0}"}}});
  return plan;
}

/// The tip of an arm touches something that stands still; nothing is measured but the joints.
[[nodiscard]] InitPlan plan_touched(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const InitTarget target = answers.target;
  if (movers(robot, answers.carrier, answers.arm).empty()) {
    throw InputError(
        fmt::format("--arm: link '{}' does not move relative to link '{}'; choose another "
                    "link, or another {}",
                    answers.arm, answers.carrier,
                    answers.carrier == answers.base ? "--base" : "--touched-link"));
  }
  if (target == InitTarget::gravity) return plan_gravity(robot, answers);
  if (target == InitTarget::grip) return plan_grip(robot, answers);
  const bool is_link = robot.has_link(answers.target_frame);
  const std::string tip =
      is_link ? joint_of_tip(robot, answers.target_frame).name : answers.target_frame;
  const bool is_pose = contact_of(target) == Contact::plane || contact_of(target) == Contact::line;
  add_chain_model(
      plan,
      target == InitTarget::distance
          ? "The arm: the plane is at point (0, 0, distance) of frame " + answers.target_frame + "."
          : "The arm: the tip is point (0, 0, 0) of frame " + answers.target_frame + ".",
      holder_of(answers), answers.arm);
  for (const FurtherArm& more : answers.more_arms) {
    add_chain_model(plan, "A further arm, with its tip in frame " + more.target_frame + ".",
                    more.arm, more.arm);
  }
  add_chain_model(plan, "What it touches, which stands still in this link.", tracker_of(answers),
                  answers.carrier);
  if (is_pose) plan.models.back().fields.front().second = "chain6d";
  if (target == InitTarget::tool) {
    plan.left_out.push_back(
        {"all joints", "The tool's centre point alone: with --target point, they are free, too"});
  } else {
    free_touched_offsets(plan, robot, answers);
  }
  free_places(plan, answers);
  if (target == InitTarget::distance) {
    free_axes(plan, tip,
              "Where the sensor is in link " + name_to_yaml(answers.arm) +
                  " and along which z it measures.",
              {true, true, true, true, true, false});
  } else {
    free_frame(
        plan, tip,
        is_link ? "Where the tip is, by this joint of the URDF; a point has no rotation."
                : "Where the tip is in link " + name_to_yaml(answers.arm) +
                      "; a point has no rotation.  The URDF does not contain this frame: name the "
                      "link of a tip that is in it with --target-frame.",
        true);
  }
  for (const FurtherArm& more : answers.more_arms) {
    free_frame(plan, more.target_frame, "Where its tip is in link " + name_to_yaml(more.arm) + ".",
               true);
  }
  for (const std::string& place : answers.places) {
    if (!answers.at) add_initial_value(plan, place, "");
  }
  if (contact_of(target) == Contact::sphere && !answers.at) {
    put(plan.initial_values.front(), (1e3 * answers.center).array().round() / 1e3);
  }
  if (!is_link) add_initial_value(plan, tip, "");
  for (const FurtherArm& more : answers.more_arms) add_initial_value(plan, more.target_frame, "");
  if (!plan.initial_values.empty()) {
    plan.initial_values.front().why =
        "Zeros are no guess: kinecal searches for what the URDF does not have.";
  }
  InitEntry block{
      "The tip is there in every sample.  The noise is what residuals show.", "contact", {}};
  const char* type = contact_of(target) == Contact::plane    ? "point_on_plane"
                     : target == InitTarget::line            ? "point_on_line"
                     : contact_of(target) == Contact::sphere ? "point_distance"
                                                             : "chain3d_to_chain3d";
  block.fields = {{"type", type},
                  {"model_a", name_to_yaml(holder_of(answers))},
                  {"model_b", name_to_yaml(tracker_of(answers))}};
  if (contact_of(target) == Contact::sphere) {
    constexpr double kGuess = 0.1;  // metres
    block.fields.emplace_back("length", fmt::format("{}", answers.length.value_or(kGuess)));
    if (!answers.length) {
      plan.free_params.push_back({target == InitTarget::bar
                                      ? "The length of the bar, metres: what is known as 'length' "
                                        "below need not be free."
                                      : "From the ball's center to the tip, metres: its radius and "
                                        "that of a round tip.",
                                  "contact_length",
                                  {}});
    }
  }
  block.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(block);
  for (const FurtherArm& more : answers.more_arms) {
    block.why.clear();
    block.name = "contact_" + more.arm;
    block.fields[1].second = name_to_yaml(more.arm);
    plan.error_blocks.push_back(block);
  }
  return plan;
}

/// The floor alone.
[[nodiscard]] InitPlan plan_ground(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  add_camera_model(plan, answers);
  const std::string mount = require_mount(robot, answers, {answers.base}).name;
  for (const ChainJoint& joint : movers(robot, answers.base, answers.camera)) {
    plan.left_out.push_back({joint.name,
                             "The floor determines the camera's height and tilt, not which joint "
                             "or frame is wrong; the camera's frame stands for all of them"});
  }
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, true);
  keep_near_zero(plan, mount,
                 "The floor does not determine shifts along it and rotations about its normal: "
                 "this block keeps the correction of the camera's frame small.");
  return plan;
}

/// The robot's own surface: where a camera stands that sees it; with an arm, also its joints.
[[nodiscard]] InitPlan plan_robot(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const bool depth = answers.camera_type == "camera3d";
  add_camera_model(plan, answers);
  std::vector<std::string> others = {answers.base};
  if (!answers.arm.empty()) others.push_back(answers.arm);
  const std::string mount = require_mount(robot, answers, others).name;
  bool determined = true;
  if (answers.arm.empty()) {
    plan.left_out.push_back(
        {"all joints",
         "Errors of meshes and depth look like errors of their zeros; free those with which "
         "'kinecal calibrate' finds samples that had no say nearer"});
  } else {
    std::vector<ChainJoint> arm = movers(robot, answers.base, answers.arm);
    std::vector<ChainJoint> head = movers(robot, answers.base, answers.camera);
    remove_common(arm, head);
    if (arm.empty()) head.clear();  // the arm carries the camera: its own joints are the arm's
    determined = free_arm_and_head(plan, robot, answers, head, mount);
  }
  free_frame(plan, mount,
             "How the camera is mounted.  Where the URDF has zeros, kinecal searches for it.");
  if (!determined) {
    keep_near_zero(plan, mount,
                   "The joints cannot show all of the camera's frame beside the others: this block "
                   "keeps its correction small.");
  }
  InitEntry block{"", "surface", {}};
  if (depth) {
    block.why =
        "The points of the camera lie on the meshes of the URDF; those of the background are left "
        "out.  The loss is in metres.  'links: [...]' names the links if not all are seen.";
    block.fields = {{"type", "chain3d_to_mesh"}, {"model", name_to_yaml(answers.camera_name)}};
    block.fields.emplace_back("loss", "{type: cauchy, scale: 0.005}");
  } else {
    block.name = "outline";
    block.why =
        "The edges of masks ('kinecal detect --masks') lie on the outline of the meshes of the "
        "URDF.  The loss is in pixels.  'links: [...]' names the links if some are always covered.";
    block.fields = {{"type", "camera2d_to_mesh"}, {"model", name_to_yaml(answers.camera_name)}};
    block.fields.emplace_back("loss", "{type: cauchy, scale: 2.0}");
  }
  plan.error_blocks.push_back(std::move(block));
  return plan;
}

/// Plans what to free and compare.
/// @throws InputError  if a link cannot be reached, or the target determines nothing of this robot
[[nodiscard]] InitPlan plan_initial_config(const Robot& robot, const InitAnswers& answers) {
  try {
    InitPlan plan;
    if (is_touched(answers.target)) return plan_touched(robot, answers);
    if (answers.target == InitTarget::tracker) {
      plan = plan_tracker(robot, answers);
    } else if (answers.target == InitTarget::robot) {
      plan = plan_robot(robot, answers);
    } else if (answers.target == InitTarget::ground) {
      plan = plan_ground(robot, answers);
    } else if (answers.target == InitTarget::world_checkerboard) {
      plan = plan_world_checkerboard(robot, answers);
    } else {
      plan = plan_hand_eye(robot, answers);
    }
    if (answers.target == InitTarget::ground || answers.with_ground) {
      add_ground(plan, answers);
    }
    for (const std::string& stand : related_stands(robot, answers)) {
      free_frame(plan, stand,
                 "Where the robot stands.  Where the URDF has zeros, kinecal searches for it.");
    }
    return plan;
  } catch (const RobotError& e) {
    throw InputError(std::string("--base: ") + e.what());
  }
}

// Several cameras and arms in one problem.

/// Adds the entries that a list does not have yet, by their names.
void add_new(std::vector<InitEntry>& list, std::vector<InitEntry> more) {
  for (InitEntry& entry : more) {
    const auto is_known = [&](const InitEntry& known) { return known.name == entry.name; };
    if (std::none_of(list.begin(), list.end(), is_known)) list.push_back(std::move(entry));
  }
}

/// Which arms and heads the free frames of earlier plans relate, by their first joints.
using Related = std::map<std::string, int>;

/// Holds the frame of the part that carries a camera, if frames of earlier plans relate it to the arm: of two arms that see each
/// other, both bases would be free.
void relate_once(const Robot& robot, const InitAnswers& answers, Related& related, InitPlan& one) {
  if (!needs_arm(answers.target) || !needs_camera(answers.target)) return;
  std::vector<ChainJoint> arm = movers(robot, answers.base, answers.arm);
  std::vector<ChainJoint> head = movers(robot, answers.base, answers.camera);
  remove_common(arm, head);
  if (arm.empty() || head.empty()) return;
  const auto group = [&](const std::string& joint) {
    return related.emplace(joint, static_cast<int>(related.size())).first->second;
  };
  const std::string& moved = head.front().name;
  const int of_arm = group(arm.front().name), of_head = group(moved);
  if (of_arm != of_head) {
    for (auto& [joint, number] : related) number = number == of_head ? of_arm : number;
    return;
  }
  if (require_mount(robot, answers, {answers.base, answers.arm}).name == moved) return;
  std::erase_if(one.free_frames, [&](const InitEntry& frame) { return frame.name == moved; });
}

/// The plans of all answers as one.  Blocks that compare get the names of what they compare.
[[nodiscard]] InitPlan plan_all(const Robot& robot, const std::vector<InitAnswers>& all) {
  InitPlan plan;
  Related related;
  for (const InitAnswers& answers : all) {
    InitPlan one = plan_initial_config(robot, answers);
    if (all.size() > 1) relate_once(robot, answers, related, one);
    for (InitEntry& block : one.error_blocks) {
      if (all.size() == 1 || block.name.starts_with("restrict_")) continue;
      if (needs_camera(answers.target)) block.name += "_" + answers.camera_name;
      const auto is_known = [&](const InitEntry& known) { return known.name == block.name; };
      if (std::any_of(plan.error_blocks.begin(), plan.error_blocks.end(), is_known)) {
        block.name += "_" + holder_of(answers);
      }
    }
    add_new(plan.models, std::move(one.models));
    add_new(plan.free_params, std::move(one.free_params));
    add_new(plan.free_frames, std::move(one.free_frames));
    add_new(plan.fixed_frames, std::move(one.fixed_frames));
    add_new(plan.initial_values, std::move(one.initial_values));
    add_new(plan.error_blocks, std::move(one.error_blocks));
    for (InitLeftOut& left_out : one.left_out) {
      const auto is_known = [&](const InitLeftOut& known) { return known.joint == left_out.joint; };
      if (std::none_of(plan.left_out.begin(), plan.left_out.end(), is_known)) {
        plan.left_out.push_back(std::move(left_out));
      }
    }
  }
  std::erase_if(plan.left_out, [&](const InitLeftOut& left_out) {
    return std::any_of(plan.free_params.begin(), plan.free_params.end(),
                       [&](const InitEntry& free) { return free.name == left_out.joint; });
  });
  return plan;
}

// Checks the answers of `kinecal init` before planning.

/// Checks the frames of several reflectors.
void check_reflectors(const Robot& robot, const InitAnswers& answers, Diagnostics& diagnostics) {
  std::vector<std::string> before = {answers.target_frame, answers.tracker_frame};
  for (const std::string& frame : answers.more_reflectors) {
    check_init_frame(robot, "--target-frame", frame, diagnostics);
    if (std::find(before.begin(), before.end(), frame) != before.end()) {
      diagnostics.error({"--target-frame", 0},
                        "'" + frame + "' occurs twice; each reflector has a frame of its own");
    }
    before.push_back(frame);
  }
  if (!answers.more_reflectors.empty() && answers.target != InitTarget::tracker) {
    diagnostics.error({"--target-frame", 0},
                      "only a tracker has several reflectors; give one name");
  }
}

/// Checks the answers before planning.
/// @throws InputError  with all their errors
void check_answers(const Robot& robot, const InitAnswers& answers) {
  Diagnostics diagnostics;
  const InitTarget target = answers.target;
  check_init_link(robot, "--base", answers.base, diagnostics);
  if (needs_arm(target)) check_init_link(robot, "--arm", answers.arm, diagnostics);
  if (needs_camera(target)) {
    check_init_link(robot, "--camera", answers.camera, diagnostics);
    const std::array<std::string, 2> types = {"camera3d", "camera2d"};
    if (std::find(types.begin(), types.end(), answers.camera_type) == types.end()) {
      diagnostics.error({"--camera-type", 0},
                        fmt::format("'{}' is neither camera3d nor camera2d{}", answers.camera_type,
                                    did_you_mean(answers.camera_type, types)));
    }
    check_init_camera_name("--robot-camera-name", answers.camera_name, diagnostics);
  }
  if (needs_target_frame(target)) {
    const bool is_tip = is_touched(target) && robot.has_link(answers.target_frame);
    if (!is_tip) check_init_frame(robot, "--target-frame", answers.target_frame, diagnostics);
    check_reflectors(robot, answers, diagnostics);
  }
  if (target == InitTarget::tracker) {
    check_init_frame(robot, "--tracker-frame", answers.tracker_frame, diagnostics);
    if (answers.target_frame == answers.tracker_frame) {
      diagnostics.error({"--tracker-frame", 0},
                        "'" + answers.tracker_frame +
                            "' is the frame of the reflector too; give the tracker another one");
    }
  }
  for (const std::string& place : answers.places) {
    check_init_frame(robot, "--target", place, diagnostics);
  }
  if (is_touched(target)) check_init_link(robot, "--touched-link", answers.carrier, diagnostics);
  if (answers.at) check_init_place(target, *answers.at, diagnostics);
  if (answers.at && target == InitTarget::sockets && answers.layout.empty()) {
    diagnostics.error({"--touched-at", 0},
                      "of several sockets, sockets.csv beside the configuration says where each is "
                      "(socket, x, y, z in metres), seen from this place");
  }
  for (const FurtherArm& more : answers.more_arms) {
    check_init_link(robot, "--arm", more.arm, diagnostics);
    check_init_frame(robot, "--target-frame", more.target_frame, diagnostics);
  }
  if (answers.length) check_init_length(target, *answers.length, diagnostics);
  const bool floor = target == InitTarget::ground || answers.with_ground;
  if (floor && !needs_camera(target)) {
    diagnostics.error(
        {"--target", 0},
        fmt::format("{} and ground have no parameters in common; make a configuration for each",
                    to_string(target)));
  } else if (floor && answers.camera_type == "camera2d") {
    diagnostics.error({"--camera-type", 0}, "the floor is seen by depth cameras only: camera3d");
  }
  diagnostics.throw_if_errors();
}

}  // namespace
}  // namespace detail

void check_init_link(const Robot& robot, const std::string& option, const std::string& link,
                     Diagnostics& diagnostics) {
  if (link.empty()) {
    diagnostics.error({option, 0}, "no link is given");
  } else if (!robot.has_link(link)) {
    diagnostics.error({option, 0}, fmt::format("no link '{}' in robot '{}'{}", link, robot.name(),
                                               did_you_mean(link, robot.link_names())));
  }
}

void check_init_frame(const Robot& robot, const std::string& option, const std::string& name,
                      Diagnostics& diagnostics) {
  if (name.empty()) {
    diagnostics.error({option, 0}, "no frame is given");
  } else if (!is_free_frame_name(robot, name)) {
    diagnostics.error({option, 0}, "'" + name +
                                       "' is a link or a joint of the robot, or resembles one; a "
                                       "frame that the URDF does not contain needs another name");
  }
}

void check_init_length(InitTarget target, double length, Diagnostics& diagnostics) {
  constexpr double kMost = 10.0;  // metres
  if (!has_length(target)) {
    diagnostics.error(
        {"--length", 0},
        fmt::format("{} has no length; sockets, sphere and bar have one", to_string(target)));
  } else if (!(length > 0.0 && length < kMost)) {
    diagnostics.error({"--length", 0}, fmt::format("{} is no length in metres", length));
  }
}

void check_init_place(InitTarget target, const Vector3<double>& at, Diagnostics& diagnostics) {
  constexpr double kMost = 10.0;  // metres
  if (!has_place(target)) {
    diagnostics.error({"--touched-at", 0},
                      fmt::format("{} is not at one point; point, sockets, sphere and bar are",
                                  to_string(target)));
  } else if (!(at.cwiseAbs().maxCoeff() < kMost)) {
    diagnostics.error({"--touched-at", 0},
                      fmt::format("{},{},{} is no place in metres", at.x(), at.y(), at.z()));
  }
}

void check_init_camera_name(const std::string& option, const std::string& name,
                            Diagnostics& diagnostics) {
  if (name.empty() || name == "arm" || name == "board") {
    diagnostics.error({option, 0}, "'" + name + "' cannot be the camera's name; choose another");
  }
}

namespace detail {
namespace {

/// A text as comment lines of at most 100 columns.
[[nodiscard]] std::string comment_lines(std::string_view text, const std::string& indent) {
  constexpr std::size_t kWidth = 100;
  std::string lines, line = indent + "#";
  const std::size_t empty = line.size();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, blank - at);
    if (line.size() > empty && line.size() + 1 + word.size() > kWidth) {
      if (line.ends_with(' ')) line.pop_back();  // of two spaces between sentences
      lines += line + '\n';
      line.resize(empty);
    }
    line += ' ';
    line += word;
    at = blank + 1;
  }
  return text.empty() ? "" : lines + line + '\n';
}

/// A list of entries below its comment; empty if there are no entries.
/// @param on_a_line  write each entry in braces, on one line
[[nodiscard]] std::string list_to_yaml(const std::string& key, const std::string& why,
                                       const std::vector<InitEntry>& entries, bool on_a_line) {
  if (entries.empty()) return "";
  std::string text = "\n" + comment_lines(why, "") + key + ":\n";
  for (const InitEntry& entry : entries) {
    text += comment_lines(entry.why, " ");
    const std::string name = name_to_yaml(entry.name);
    if (entry.fields.empty()) {
      text += " - " + name + "\n";
      continue;
    }
    text += (on_a_line ? " - {name: " : " - name: ") + name;
    for (const auto& [field, value] : entry.fields) {
      text += (on_a_line ? ", " : "\n   ") + field + ": " + value;
    }
    text += on_a_line ? "}\n" : "\n";
  }
  return text;
}

/// Offsets that are not freed, as comments below the free ones.
[[nodiscard]] std::string left_out_comments(const InitPlan& plan) {
  std::string text;
  for (const InitLeftOut& left_out : plan.left_out) {
    text += comment_lines("Left out: " + name_to_yaml(left_out.joint) + ".  " + left_out.why + ".",
                          plan.free_params.empty() ? "" : " ");
  }
  return text.empty() || !plan.free_params.empty() ? text : "\n" + text;
}

[[nodiscard]] std::string plan_to_yaml(const Robot& robot, const InitAnswers& answers,
                                       const InitPlan& plan) {
  std::string target(to_string(answers.target, answers.board));
  if (answers.with_ground) target += " and ground";
  std::string text =
      comment_lines(fmt::format("Calibration of robot {} from {}.  'kinecal init' wrote this first "
                                "configuration: adapt it to your robot.",
                                name_to_yaml(robot.name()), target),
                    "");
  text += comment_lines(
      "Units are metres, radians and pixels.  'kinecal check' reports errors in this file, "
      "'kinecal calibrate' what the samples leave undetermined.",
      "");
  text += "\n" + comment_lines("The link in which all measurements are compared.", "");
  text += "base_link: " + name_to_yaml(answers.base) + "\nmax_num_iterations: 1000\n";
  text += list_to_yaml(
      "models",
      "What makes observations, and the link that it is fixed to.  A model's name is the "
      "sensor_name of its observations.",
      plan.models, false);
  text += list_to_yaml(
      "free_params",
      needs_camera(answers.target)
          ? "Parameters to calibrate: joint offsets, which are added to the measured positions, "
            "and the camera's parameters."
          : "Parameters to calibrate: joint offsets, which are added to the measured positions.",
      plan.free_params, false);
  text += left_out_comments(plan);
  text += list_to_yaml("free_frames",
                       "Frames to calibrate, by the names of their joints: how a part is mounted "
                       "on the one before it.  Free one rotation or all three.",
                       plan.free_frames, true);
  text += list_to_yaml("fixed_frames", "Frames that the URDF does not contain, at known poses.",
                       plan.fixed_frames, true);
  text += list_to_yaml("free_frames_initial_values",
                       "Where the search starts, for frames that the URDF does not contain.",
                       plan.initial_values, true);
  text +=
      list_to_yaml("error_blocks",
                   "What is compared.  A feature that is more than 3 sigma off has no more "
                   "influence than one at 3 sigma, so one bad capture does not ruin the result.",
                   plan.error_blocks, false);
  return text;
}

}  // namespace
}  // namespace detail

std::string initial_config(const Robot& robot, const InitAnswers& given) {
  return initial_config(robot, std::vector<InitAnswers>{given});
}

std::string initial_config(const Robot& robot, const std::vector<InitAnswers>& given) {
  std::vector<InitAnswers> all;
  for (const InitAnswers& answers : given) {
    all.push_back(with_proposals(robot, answers));
    detail::check_answers(robot, all.back());
  }
  return detail::plan_to_yaml(robot, all.front(), detail::plan_all(robot, all));
}

}  // namespace kinecal
