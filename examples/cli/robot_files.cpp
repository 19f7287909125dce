// SPDX-License-Identifier: Apache-2.0
#include "robot_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <system_error>

#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/homing_offsets.hpp"
#include "kinecal/files/results/kinematics_yaml.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/patch_xacro.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal::cli {
namespace {

namespace fs = std::filesystem;

/// A file itself, where its name is a link: the link stays.
fs::path file_behind(const std::string& name) {
  std::error_code missing;
  const fs::path file = fs::canonical(name, missing);
  return missing ? fs::path(name) : file;
}

/// "arm.json.backup_<n>"
std::string backup_name(const fs::path& file, int n) {
  return fmt::format("{}.backup_{}", file.filename().string(), n);
}

/// Number of the newest backup of a file; 0 without one.
int newest_backup(const fs::path& file) {
  int n = 0;
  while (fs::exists(file.parent_path() / backup_name(file, n + 1))) ++n;
  return n;
}

/// A file of --kinematics, and what the joints of its arm begin with.
struct KinematicsOption {
  std::string prefix, file;
};

/// FILE, or PREFIX=FILE of one of several arms.
KinematicsOption kinematics_option(const std::string& option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos || fs::exists(option)) return {"", option};
  return {option.substr(0, equals), option.substr(equals + 1)};
}

/// Checks that a URDF was made with the file that is to be replaced: else a factory's calibration would be replaced by the
/// nominal geometry.  A file that kinecal wrote may also hold a calibration of the same URDF.
/// @throws InputError  naming the joints that differ
void check_kinematics(const KinematicsOption& of, const fs::path& file, const Robot& robot,
                      const std::string& existing) {
  const std::string& name = of.file;
  std::string difference = kinematics_difference(robot, existing, name, of.prefix);
  if (difference.empty()) return;
  if (existing.starts_with(kKinematicsMark)) {
    std::string before;  // the newest backup that kinecal has not written
    for (int n = newest_backup(file); n > 0 && before.empty(); --n) {
      before = detail::read_text_file((file.parent_path() / backup_name(file, n)).string());
      if (before.starts_with(kKinematicsMark)) before.clear();
    }
    if (before.empty()) return;
    difference = kinematics_difference(robot, before, name, of.prefix);
    if (difference.empty()) return;
  }
  throw InputError(
      fmt::format("{}: the URDF was not made with this file: joints differ: {}; its calibration "
                  "would be lost. Expand the xacro "
                  "with the file (kinematics_params:=FILE; kinematics_params_file:=FILE in launch "
                  "files) and calibrate that URDF, or give the "
                  "name of a new file",
                  name, difference));
}

void add_kinematics(const KinematicsOption& of, const Robot& robot,
                    const std::vector<JointPatch>& patches, RobotFiles& files) {
  const std::string& name = of.file;
  const fs::path file = file_behind(name);
  const std::string existing = fs::exists(file) ? detail::read_text_file(name) : "";
  const std::string text = kinematics_yaml(robot, patches, existing, name, of.prefix);
  if (!existing.empty()) check_kinematics(of, file, robot, existing);
  FileSet set{folder_of(file.string()), {{file.filename().string(), text}}};
  if (!existing.empty() && existing != text) {
    set.files.insert(set.files.begin(), {backup_name(file, newest_backup(file) + 1), existing});
    files.said.note({name, 0},
                    fmt::format("the file before is kept as {}", set.files.front().name));
  }
  files.sets.push_back(std::move(set));
  files.said.note({name, 0}, "has the origins of joints; their zeros are in them");
}

/// The zeros of joints as a list.  A list that kinecal has not written may be in the positions that were recorded already.
void add_zeros(const RobotFileOptions& of, const Robot& robot,
               const std::vector<JointPatch>& patches, RobotFiles& files) {
  const fs::path file = file_behind(of.zeros);
  const std::string existing = fs::exists(file) ? detail::read_text_file(of.zeros) : "";
  if (!existing.empty() && !existing.starts_with(kZerosMark)) {
    throw InputError(
        of.zeros +
        ": exists, and kinecal has not written it: whether its zeros are in the recorded positions "
        "is not known; give the name of a new file");
  }
  FileSet set{folder_of(file.string()),
              {{file.filename().string(), zeros_yaml(robot, patches, of.degrees)}}};
  if (!existing.empty() && existing != set.files.front().content) {
    set.files.insert(set.files.begin(), {backup_name(file, newest_backup(file) + 1), existing});
    files.said.note({of.zeros, 0},
                    fmt::format("the file before is kept as {}", set.files.front().name));
  }
  files.sets.push_back(std::move(set));
  files.said.note({of.zeros, 0},
                  "has the zeros, which the URDF has, too: let one of them add to the readings");
}

/// Homing offsets are added to: a copy of the file before says whether they hold these zeros already.
void add_homing(const RobotFileOptions& options, const Robot& robot,
                const std::vector<JointPatch>& patches, RobotFiles& files) {
  const std::string& name = options.homing;
  const ServoMake make = options.servos == "dynamixel" ? ServoMake::dynamixel : ServoMake::feetech;
  const auto patched = [&](const std::string& text) {
    return patch_homing_offsets(text, name, robot, patches, make);
  };
  const fs::path file = file_behind(name);
  const std::string text = detail::read_text_file(name);
  const HomingPatch patch = patched(text);
  for (const std::string& joint : patch.missing) {
    files.said.warning({name, 0}, fmt::format("joint '{}' has a zero but no motor", joint));
  }
  if (!patch.unused.empty()) {
    files.said.note({name, 0},
                    fmt::format("motors that are no joint: {}", fmt::join(patch.unused, ", ")));
  }
  if (patch.text == text) return;
  const int n = newest_backup(file);
  const fs::path backup = file.parent_path() / backup_name(file, n);
  if (n > 0 && patched(detail::read_text_file(backup.string())).text == text) {
    files.said.note({name, 0}, fmt::format("holds these zeros already; {} is without them",
                                           backup.filename().string()));
    return;
  }
  for (const std::string& change : patch.changes) files.said.note({name, 0}, change);
  if (!patch.changes.empty()) {
    files.said.note({name, 0}, "has the zeros of these joints, so the URDF is without them");
  }
  files.sets.push_back(
      {folder_of(file.string()),
       {{backup_name(file, n + 1), text}, {file.filename().string(), patch.text}}});
}

void add_xacro(const std::string& name, const InputTexts& texts, const std::string& calibrated,
               RobotFiles& files) {
  const std::vector<XacroFile> sources = read_xacro_files(name, files.said);
  const XacroPatch patch = patch_xacro(sources, texts.urdf_text, calibrated);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const PatchedXacro& of = patch.files[i];
    if (!of.patched.empty()) {
      files.said.note({of.name, 0}, fmt::format("has the calibration of {}: {}",
                                                counted(of.patched.size(), "joint"),
                                                fmt::join(of.patched, ", ")));
    }
    if (of.text == sources[i].text) continue;
    const fs::path file = file_behind(of.name);
    files.sets.push_back({folder_of(file.string()), {{file.filename().string(), of.text}}});
  }
  for (const std::string& unpatched : patch.unpatched) files.said.warnings.push_back(unpatched);
}

bool names_same_file(const std::string& one, const std::string& other) {
  std::error_code missing;
  return fs::equivalent(one, other, missing);
}

}  // namespace

std::vector<std::string> RobotFileOptions::files() const {
  std::vector<std::string> all = {homing, xacro, zeros};
  for (const std::string& option : kinematics) all.push_back(kinematics_option(option).file);
  return all;
}

void check_robot_files(const ResultOptions& options, const Robot& robot, const InputTexts& texts) {
  const RobotFileOptions& of = options.robot_files;
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  const auto check = [&](const std::string& name) {
    if (name.empty()) return;
    if (name == "-") throw InputError("'-' is no file that can be patched; give its name");
    for (const std::string& other : inputs) {
      if (!names_same_file(name, other)) continue;
      throw OutputError(name + ": would replace an input; choose another file");
    }
    inputs.push_back(name);
    const std::string folder = folder_of(file_behind(name).string());
    if (!options.output.empty() && names_same_file(folder, options.output)) {
      throw OutputError(name + ": is in the folder of the results; choose another one");
    }
    const OutputFolder can_be_written(folder);
  };
  for (const std::string& name : of.files()) check(name);
  if (!of.xacro.empty()) {
    Diagnostics said_when_written;
    const std::vector<XacroFile> all = read_xacro_files(of.xacro, said_when_written);
    for (std::size_t i = 1; i < all.size(); ++i) check(all[i].name);  // that it includes
  }
  (void)robot_files(options, robot, texts, ParameterTable(), texts.urdf_text);
}

std::set<std::string> zeros_in_servos(const RobotFileOptions& of, const Robot& robot) {
  if (of.homing.empty()) return {};
  return servo_joints(detail::read_text_file(of.homing), of.homing, robot);
}

RobotFiles robot_files(const ResultOptions& options, const Robot& robot, const InputTexts& texts,
                       const ParameterTable& table, const std::string& calibrated) {
  const RobotFileOptions& of = options.robot_files;
  RobotFiles files;
  for (const std::string& option : of.kinematics) {
    const std::set<std::string> in_servos = zeros_in_servos(of, robot);
    add_kinematics(kinematics_option(option), robot, joint_patches(robot, table, in_servos), files);
  }
  if (!of.zeros.empty()) {
    add_zeros(of, robot, joint_patches(robot, table, zeros_in_servos(of, robot)), files);
  }
  if (!of.homing.empty()) add_homing(of, robot, joint_patches(robot, table), files);
  if (!of.xacro.empty()) add_xacro(of.xacro, texts, calibrated, files);
  return files;
}

void write(const RobotFiles& files) {
  write_file_sets(files.sets);
  print(files.said);
}

}  // namespace kinecal::cli
