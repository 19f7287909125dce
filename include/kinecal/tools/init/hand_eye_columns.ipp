// Which columns of a table are a pose: for hand_eye.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/hand_eye_table.ipp"

namespace kinecal::detail {

/// The columns of a pose.
struct PoseColumns {
  std::string form;          ///< see pose_form()
  std::vector<int> indices;  ///< in the order of the form: the last ones are the rotation
};

/// Names of the columns of rotations, and the form that they stand for.
[[nodiscard]] inline const std::vector<std::pair<std::string, std::vector<HandEyeTable::Names>>>&
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
[[nodiscard]] inline PoseColumns pose_columns(const HandEyeTable& table, const std::string& given) {
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
[[nodiscard]] inline std::string units_text(const HandEyeTable& table, const PoseColumns& pose) {
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
[[nodiscard]] inline std::string common_column(const HandEyeTable& a, const HandEyeTable& b) {
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

}  // namespace kinecal::detail
