// Definitions of magnetometer_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/magnetometer_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <vector>

#include "kinecal/config/magnetometer_start.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/init/proposed_columns.hpp"
#include "kinecal/tools/init/table_columns.ipp"

namespace kinecal {

std::string magnetometer_urdf(const std::string& link) {
  return fmt::format(
      "<robot name=\"magnetometer\">\n  <link name=\"{0}\"/>\n  <link name=\"magnetometer\"/>\n"
      "  <joint name=\"magnetometer_joint\" type=\"fixed\">\n    <parent link=\"{0}\"/>\n"
      "    <child link=\"magnetometer\"/>\n  </joint>\n</robot>\n",
      link);
}

std::string magnetometer_config(const std::string& base_link, std::span<const Sample> samples) {
  constexpr std::ptrdiff_t kFewest = 12;
  const auto count = std::count_if(samples.begin(), samples.end(), [](const Sample& sample) {
    return sample.conditions.contains("mag_x") && sample.conditions.contains("mag_y") &&
           sample.conditions.contains("mag_z");
  });
  if (count < kFewest) {
    throw InputError(fmt::format(
        "--from: {} with readings of a magnetometer; a turn takes {} or more.  In a bag, they are "
        "sensor_msgs/MagneticField; in samples, conditions mag_x, mag_y, mag_z",
        count == 0   ? "no sample"
        : count == 1 ? "1 sample"
                     : fmt::format("{} samples", count),
        kFewest));
  }
  const std::optional<ReadingsPlane> plane = plane_of_readings(samples);
  Eigen::Index about = 2;  // the axis that it turned about
  const bool is_along = plane && plane->normal.cwiseAbs().maxCoeff(&about) == 1.0;
  std::string hard;
  for (const Eigen::Index axis : {0, 1, 2}) {
    hard +=
        is_along && axis == about
            ? fmt::format(
                  " # mag_bias_{} is held: the bias along the axis of the turn does not show.\n",
                  "xyz"[axis])
            : fmt::format(" - mag_bias_{}\n", "xyz"[axis]);
  }
  constexpr std::array<const char*, 3> kInPlane = {
      " - mag_yy\n - mag_yz\n", " - mag_xx\n - mag_xz\n", " - mag_xx\n - mag_xy\n"};
  const std::string soft =
      plane ? " # Soft iron in the plane of the turn: the readings trace an ellipse, not a "
              "circle.\n" +
                  std::string(kInPlane[static_cast<std::size_t>(about)])
            : " # Soft iron.  Its overall scale cannot be told from the strength of the field: "
              "mag_zz "
              "is held.\n - mag_xx\n - mag_yy\n - mag_xy\n - mag_xz\n - mag_yz\n";
  return fmt::format(
      "# A magnetometer{}.\nbase_link: {}\nmodels: []\nfree_params:\n"
      " # Hard iron: what is magnetic and turns with it, microtesla.\n{}"
      " # The strength of the field{}.\n - mag_field\n{}"
      "error_blocks:\n # The strength that it reads is the same all ways; residuals are in "
      "microtesla.\n - name: mag\n   type: magnetic_field\n   loss: {{type: huber, scale: 3.0}}\n",
      plane ? " that turned about one axis, as on a base that turns in place"
            : " that turned about several axes",
      detail::name_to_yaml(base_link), hard,
      plane ? " in the plane of the turn" : ", microtesla: of the earth, 22 to 67", soft);
}

std::string magnetometer_columns(std::string_view text, const std::string& file) {
  const detail::ReadTable table = detail::read_table(text, file);
  const std::set<std::string> names = {"m",     "mag",          "magn", "magnetic", "field",
                                       "magno", "magnetometer", "b",    "compass"};
  std::array<std::string, 3> found;
  for (const detail::TableColumn& column : table.columns) {
    std::vector<std::string> words = column.words;
    // The Greek letter of microtesla may be in no word.
    const bool is_tesla = !words.empty() && words.back() == "t" &&
                          std::all_of(column.name.begin(), column.name.end(),
                                      [](char c) { return static_cast<unsigned char>(c) < 128; });
    if (!words.empty() && (words.back() == "ut" || words.back() == "t")) words.pop_back();
    if (words.empty() || !column.is_number) continue;
    std::string last = words.back();
    words.pop_back();
    const std::size_t axis = std::string_view("xyz").find(last.back());
    last.pop_back();
    if (axis == std::string_view::npos) continue;
    if (!last.empty()) words.push_back(last);
    const auto is_name = [&](const std::string& word) { return names.contains(word); };
    if (words.empty() || !std::all_of(words.begin(), words.end(), is_name)) continue;
    if (is_tesla) {
      throw InputError(
          fmt::format("{}: column '{}' is in tesla, by its name; a magnetometer is read in "
                      "microtesla: multiply the column by 1e6 and call it '..._uT'",
                      file, column.name));
    }
    if (found[axis].empty()) found[axis] = column.name;
  }
  if (std::any_of(found.begin(), found.end(), [](const auto& name) { return name.empty(); })) {
    throw InputError(
        fmt::format("{}: no three columns are called mag_x, mag_y, mag_z (or mx ...); {}", file,
                    table.header_text));
  }
  return fmt::format(
      "{} by the table's header: check it.\nseparator: {}\n"
      "conditions:  # the magnetometer, microtesla\n  mag_x: {}\n  mag_y: {}\n  mag_z: {}\n",
      kProposedColumnsMark,
      table.separator == ','    ? "comma"
      : table.separator == ';'  ? "semicolon"
      : table.separator == '\t' ? "tab"
                                : "space",
      detail::name_to_yaml(found[0]), detail::name_to_yaml(found[1]),
      detail::name_to_yaml(found[2]));
}

}  // namespace kinecal
