// Definitions of hand_eye.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/hand_eye.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal {

namespace detail {
namespace {

// A table of poses, corners or points of a hand-eye calibration.

/// A table whose columns are found by some of the names that programs give them.
class HandEyeTable {
 public:
  using Names = std::vector<std::string>;

  explicit HandEyeTable(const std::string& file)
      : file_(file), table_(read_table(read_pose_table(file), file)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool has_header() const { return table_.header; }
  [[nodiscard]] const char* separator() const {
    static const std::map<char, const char*> names = {
        {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "space"}};
    return names.at(table_.separator);
  }
  [[nodiscard]] const std::vector<TableColumn>& columns() const { return table_.columns; }

  /// The columns of one of several lists of names, small letters and digits only; empty if there are
  /// none.
  [[nodiscard]] std::vector<int> find_any(const std::vector<Names>& lists) const {
    for (const Names& names : lists) {
      std::vector<int> found;
      for (const std::string& name : names) {
        const auto is_it = [&](const TableColumn& column) {
          return fmt::format("{}", fmt::join(column.words, "")) == name;
        };
        const auto at = std::find_if(columns().begin(), columns().end(), is_it);
        if (at != columns().end()) found.push_back(static_cast<int>(at - columns().begin()));
      }
      if (found.size() == names.size()) return found;
    }
    return {};
  }
  /// The same.
  /// @throws InputError  if they are missing
  [[nodiscard]] std::vector<int> find(const std::vector<Names>& lists,
                                      const std::string& what) const {
    std::vector<int> found = find_any(lists);
    if (!found.empty()) return found;
    throw InputError(fmt::format("{}: has no columns {}; the table has {}", file_, what,
                                 fmt::join(all_names(), ", ")));
  }

  /// Columns as columns.yaml names them.
  [[nodiscard]] Names names(const std::vector<int>& indices) const {
    Names names;
    for (const int i : indices) {
      names.push_back(name_to_yaml(columns()[static_cast<std::size_t>(i)].name));
    }
    return names;
  }
  [[nodiscard]] Names all_names() const {
    Names names;
    for (const TableColumn& column : columns()) names.push_back(column.name);
    return names;
  }

  [[nodiscard]] double largest(const std::vector<int>& indices) const {
    double largest = 0.0;
    for (const int i : indices) {
      largest = std::max(largest, columns()[static_cast<std::size_t>(i)].largest);
    }
    return largest;
  }
  [[nodiscard]] NamedUnit unit(const std::vector<int>& indices) const {
    return columns()[static_cast<std::size_t>(indices.front())].unit;
  }
  /// True for lengths in millimetres, by the names or the values.
  [[nodiscard]] bool is_millimetres(const std::vector<int>& indices) const {
    constexpr double kMostMetres = 20.0;
    const NamedUnit named = unit(indices);
    return named == NamedUnit::millimetres ||
           (named != NamedUnit::metres && largest(indices) > kMostMetres);
  }

 private:
  std::string file_;
  ReadTable table_;
};

// Which columns of a table are a pose.

/// The columns of a pose.
struct PoseColumns {
  std::string form;          ///< see pose_form()
  std::vector<int> indices;  ///< in the order of the form: the last ones are the rotation
};

/// Names of the columns of rotations, and the form that they stand for.
[[nodiscard]] const std::vector<std::pair<std::string, std::vector<HandEyeTable::Names>>>&
rotation_names() {
  using Names = std::vector<HandEyeTable::Names>;
  static const std::vector<std::pair<std::string, Names>> all = {
      {"quaternion_xyzw",
       {{"qx", "qy", "qz", "qw"},
        {"quatx", "quaty", "quatz", "quatw"},
        {"orientationx", "orientationy", "orientationz", "orientationw"},
        {"rotationx", "rotationy", "rotationz", "rotationw"}}},
      {"quaternion_wxyz", {{"q1", "q2", "q3", "q4"}, {"q0", "q1", "q2", "q3"}}},
      {"rpy", {{"roll", "pitch", "yaw"}}},
      {"rotation_vector", {{"rx", "ry", "rz"}, {"rvecx", "rvecy", "rvecz"}}},
      {"kuka", {{"a", "b", "c"}}},
      {"fanuc", {{"w", "p", "r"}}}};
  return all;
}

/// @throws InputError  if the form is unknown, or the columns are not clear
[[nodiscard]] PoseColumns pose_columns(const HandEyeTable& table, const std::string& given) {
  const std::optional<PoseForm> form = given.empty() ? std::nullopt : pose_form(given);
  if (!given.empty() && !form) {
    throw InputError(fmt::format(
        "--form: '{}' is none of {}; angles about other axes are "
        "fixed_zyx, euler_xyz and so on{}",
        given, fmt::join(pose_form_names(), ", "), did_you_mean(given, pose_form_names())));
  }
  PoseColumns pose{given, table.find_any({{"x", "y", "z"},
                                          {"tx", "ty", "tz"},
                                          {"px", "py", "pz"},
                                          {"posx", "posy", "posz"},
                                          {"positionx", "positiony", "positionz"},
                                          {"translationx", "translationy", "translationz"}})};
  for (const auto& [name, lists] : rotation_names()) {
    const std::vector<int> rotation = table.find_any(lists);
    const std::size_t size = pose.indices.size() + rotation.size();
    if (pose.indices.empty() || rotation.empty() || (form && !form->has_size(size))) continue;
    // By names, a quaternion is found in the order x y z w, whatever the order in the table.
    if (given.empty() || name == "quaternion_xyzw") pose.form = name;
    pose.indices.insert(pose.indices.end(), rotation.begin(), rotation.end());
    return pose;
  }
  pose.indices.clear();
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const TableColumn& column = table.columns()[c];
    if (column.is_number && column.name != "image") pose.indices.push_back(static_cast<int>(c));
  }
  const std::size_t count = pose.indices.size();
  if (given.empty() && (count == 12 || count == 16)) pose.form = "matrix";
  const std::optional<PoseForm> taken = pose_form(pose.form);
  if (taken && !taken->has_size(count) && taken->has_size(count - 1)) {  // a number of the row
    pose.indices.erase(pose.indices.begin());
  }
  if (taken && taken->has_size(pose.indices.size())) return pose;
  throw InputError(fmt::format(
      "{}: {}; the table has {}", table.file(),
      taken ? "the form has " + taken->columns_text()
            : "no columns x y z with a rotation (qx qy qz qw, rx ry rz, roll pitch yaw, A B C, W P "
              "R) were found: give --form, one of " +
                  fmt::format("{}", fmt::join(pose_form_names(), ", ")),
      fmt::join(table.all_names(), ", ")));
}

/// "    unit: millimetres  # by its values, up to 874\n", if it is not that of the form
[[nodiscard]] std::string units_text(const HandEyeTable& table, const PoseColumns& pose) {
  const PoseForm form = *pose_form(pose.form);
  if (form.rotation == RotationForm::matrix) {
    const std::vector<int> position = {pose.indices[3], pose.indices[7], pose.indices[11]};
    return table.is_millimetres(position) ? "    unit: millimetres  # by its values\n" : "";
  }
  const std::vector<int> position(pose.indices.begin(), pose.indices.begin() + 3),
      rotation(pose.indices.begin() + 3, pose.indices.end());
  std::string text = fmt::format("    unit: {}  # positions up to {:.4g}\n",
                                 table.is_millimetres(position) ? "millimetres" : "metres",
                                 table.largest(position));
  if (!form.has_angles()) return text;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const NamedUnit named = table.unit(rotation);
  const double largest = table.largest(rotation);
  const bool degrees = named == NamedUnit::degrees ||
                       (named != NamedUnit::radians && (form.degrees || largest > kTurn));
  return text +
         fmt::format("    angles: {}  # up to {:.4g}\n", degrees ? "degrees" : "radians", largest);
}

/// The column that names the row of another table: `image` if both have it, else the first that both
/// have.
/// @throws InputError  if it is missing
[[nodiscard]] std::string common_column(const HandEyeTable& a, const HandEyeTable& b) {
  for (const bool any : {false, true}) {
    for (const TableColumn& column : a.columns()) {
      const auto same = [&](const TableColumn& other) { return other.name == column.name; };
      if (!any && column.name != "image") continue;
      if (std::any_of(b.columns().begin(), b.columns().end(), same)) {
        return name_to_yaml(column.name);
      }
    }
  }
  throw InputError(
      fmt::format("{}: has no column that {} has, too: one that says which pose a "
                  "corner belongs to, such as 'image'",
                  b.file(), a.file()));
}

}  // namespace
}  // namespace detail

std::string hand_eye_urdf(bool camera_on_hand) {
  using Names = HandEyeNames;
  return fmt::format(
      R"(<?xml version="1.0"?>
<!-- A robot of which only the poses of the flange are known: the samples have them. -->
<robot name="hand_eye">
  <link name="{0}"/>
  <link name="{1}"/>
  <joint name="{2}" type="floating">
    <parent link="{0}"/>
    <child link="{1}"/>
  </joint>
  <!-- The camera's optical frame: z ahead, x right, y down. -->
  <link name="{3}"/>
  <joint name="{4}" type="fixed">
    <parent link="{5}"/>
    <child link="{3}"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
  </joint>
</robot>
)",
      Names::kBase, Names::kFlange, Names::kFlangeJoint, Names::kCamera, Names::kCameraJoint,
      camera_on_hand ? Names::kFlange : Names::kBase);
}

std::string hand_eye_pose_config(bool camera_on_hand) {
  using Names = HandEyeNames;
  return fmt::format(
      R"(# Hand-eye calibration from poses of the flange and of an object in the camera.  'kinecal init' wrote
# this first configuration.  Units are metres and radians.
base_link: {base}
max_num_iterations: 1000

models:
 # The camera: poses of the object in it.
 - name: {camera}
   type: chain6d
   frame: {camera}
 # What holds the object.
 - name: {object}
   type: chain6d
   frame: {holder}

free_frames:
 # How the camera is mounted.
 - {{name: {joint}, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}}
 # Where the object is in '{holder}'.
 - {{name: {target}, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}}

free_frames_initial_values:
 # Nobody needs to know it.
 - {{name: {target}, x: 0.0, y: 0.0, z: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0}}

error_blocks:
 # Both see the same pose.  One over the accuracies of a pose of the object: 1 mm and 5 mrad are a guess,
 # write yours.
 - name: hand_eye
   type: pose_to_pose
   model_a: {camera}
   model_b: {object}
   translation_scale: 1000.0
   rotation_scale: 200.0
   loss: {{type: huber, scale: 3.0}}
)",
      fmt::arg("base", Names::kBase), fmt::arg("camera", Names::kCamera),
      fmt::arg("object", Names::kObject), fmt::arg("joint", Names::kCameraJoint),
      fmt::arg("target", Names::kTarget),
      fmt::arg("holder", camera_on_hand ? Names::kBase : Names::kFlange));
}

std::string hand_eye_columns(const HandEyeTables& tables, const std::string& output_folder) {
  using namespace detail;
  const HandEyeTable poses(tables.poses);
  const PoseColumns columns = pose_columns(poses, tables.form);
  std::string text = fmt::format(
      "# Columns for a hand-eye calibration, proposed by the table's header and values: check "
      "them.\nseparator: {}\nheader: {}\n\nposes:\n  {}:\n    form: {}\n{}    columns: [{}]\n",
      poses.separator(), poses.has_header(), HandEyeNames::kFlangeJoint, columns.form,
      units_text(poses, columns), fmt::join(poses.names(columns.indices), ", "));
  if (tables.inverse) text += "    inverse: true  # of the base in the flange\n";
  if (tables.corners.empty()) return text;
  if (tables.target.empty()) {
    throw InputError(tables.corners + ": needs the table of where the corners are on the board");
  }
  const HandEyeTable corners(tables.corners), target(tables.target);
  const auto path = [&](const std::string& file) {
    const auto folder = std::filesystem::absolute(output_folder.empty() ? "." : output_folder);
    return name_to_yaml(std::filesystem::proximate(file, folder).string());
  };
  const std::vector<int> pixel = corners.find({{"u", "v"}, {"x", "y"}, {"pxu", "pxv"}}, "u and v"),
                         id = corners.find({{"id"}, {"corner"}, {"cornerid"}}, "id"),
                         place = target.find({{"x", "y", "z"}}, "x, y and z"),
                         of_target = target.find({{"id"}, {"corner"}, {"cornerid"}}, "id");
  text += fmt::format(
      "\nobservations:\n"
      " - sensor: {}  # what carries the board: where its corners are\n   frame: {}\n"
      "   table: {}\n   unit: {}\n   points: [[{}]]\n   id_columns: [{}]\n",
      name_to_yaml(tables.holder), HandEyeNames::kTarget, path(tables.target),
      target.is_millimetres(place) ? "millimetres" : "metres", fmt::join(target.names(place), ", "),
      target.names(of_target).front());
  text += fmt::format(
      " - sensor: camera\n   frame: {}\n   table: {}\n   match: {}\n   pixels: [[{}]]\n"
      "   id_columns: [{}]\n",
      HandEyeNames::kCamera, path(tables.corners), common_column(poses, corners),
      fmt::join(corners.names(pixel), ", "), corners.names(id).front());
  return text;
}

}  // namespace kinecal
