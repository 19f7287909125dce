// Definitions of hand_eye.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/hand_eye.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "kinecal/config/cameras/camera_start.hpp"
#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/hand_eye_fit.hpp"
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
  /// @param of  of what they are: before or behind each name
  [[nodiscard]] std::vector<int> find_any(const std::vector<Names>& lists,
                                          const std::string& of = "") const {
    for (const Names& names : lists) {
      std::vector<int> found;
      for (const std::string& name : names) {
        const auto is_it = [&](const TableColumn& column) {
          const std::string joined = fmt::format("{}", fmt::join(column.words, ""));
          return joined == of + name || joined == name + of;
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
    throw InputError(fmt::format("{}: has no columns {}; {}", file_, what, header_text()));
  }

  /// Columns as columns.yaml names them: by their numbers where several have the name.
  [[nodiscard]] Names names(const std::vector<int>& indices) const {
    Names names;
    for (const int i : indices) {
      const std::string& name = columns()[static_cast<std::size_t>(i)].name;
      const auto same = [&](const TableColumn& column) { return column.name == name; };
      const bool is_clear = std::count_if(columns().begin(), columns().end(), same) == 1;
      names.push_back(is_clear ? name_to_yaml(name) : fmt::format("{}", i + 1));
    }
    return names;
  }
  /// The numbers of a row in some columns.
  [[nodiscard]] std::vector<double> numbers(std::size_t row,
                                            const std::vector<int>& indices) const {
    std::vector<double> numbers;
    for (const int i : indices)
      numbers.push_back(columns()[static_cast<std::size_t>(i)].values[row]);
    return numbers;
  }
  [[nodiscard]] std::size_t rows() const {
    return columns().empty() ? 0 : columns().front().values.size();
  }
  /// The text in a column of a row.
  [[nodiscard]] const std::string& text(std::size_t row, int column) const {
    return columns()[static_cast<std::size_t>(column)].texts[row];
  }
  [[nodiscard]] const std::string& header_text() const { return table_.header_text; }

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
  std::string of = {};       ///< what its names have beside x, y, z: "marker"
  std::string why = {};      ///< comment on the form
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
        {"rotationx", "rotationy", "rotationz", "rotationw"},
        {"rotx", "roty", "rotz", "rotw"}}},
      {"quaternion_wxyz", {{"q1", "q2", "q3", "q4"}, {"q0", "q1", "q2", "q3"}}},
      {"rpy", {{"roll", "pitch", "yaw"}, {"thetax", "thetay", "thetaz"}}},
      {"rotation_vector",
       {{"rx", "ry", "rz"},
        {"rvecx", "rvecy", "rvecz"},
        {"rotx", "roty", "rotz"},
        {"rotationx", "rotationy", "rotationz"}}},
      {"kuka", {{"a", "b", "c"}}},
      {"fanuc", {{"w", "p", "r"}}}};
  return all;
}

/// All poses of a table that are known by the names of their columns, with what these have beside them: tcp_x, x_marker.
/// @param given  a form whose number of columns they must have
[[nodiscard]] std::vector<PoseColumns> named_poses(const HandEyeTable& table,
                                                   const std::optional<PoseForm>& given = {}) {
  const std::vector<HandEyeTable::Names> positions = {
      {"x", "y", "z"},
      {"tx", "ty", "tz"},
      {"px", "py", "pz"},
      {"posx", "posy", "posz"},
      {"positionx", "positiony", "positionz"},
      {"translationx", "translationy", "translationz"},
      {"tvecx", "tvecy", "tvecz"}};
  std::vector<PoseColumns> all;
  std::set<std::string> affixes = {""};
  for (const TableColumn& column : table.columns()) {
    const std::string name = fmt::format("{}", fmt::join(column.words, ""));
    for (const HandEyeTable::Names& position : positions) {
      const std::string& x = position.front();
      if (name.ends_with(x)) affixes.insert(name.substr(0, name.size() - x.size()));
      if (name.starts_with(x)) affixes.insert(name.substr(x.size()));
    }
  }
  std::set<int> taken;  // shorter names come first: tx is no x of "t"
  for (const std::string& of : affixes) {
    const std::vector<int> position = table.find_any(positions, of);
    if (position.empty() || taken.contains(position.front())) continue;
    for (const auto& [form, lists] : rotation_names()) {
      const std::vector<int> rotation = table.find_any(lists, of);
      if (rotation.empty() || taken.contains(rotation.front()) ||
          (given && !given->has_size(position.size() + rotation.size()))) {
        continue;
      }
      PoseColumns pose{form, position, of};
      pose.indices.insert(pose.indices.end(), rotation.begin(), rotation.end());
      taken.insert(pose.indices.begin(), pose.indices.end());
      all.push_back(std::move(pose));
      break;
    }
  }
  return all;
}

/// @param of  of what the pose is, by named_poses()
/// @throws InputError  if the form is unknown, or the columns are not clear
[[nodiscard]] PoseColumns pose_columns(const HandEyeTable& table, const std::string& given,
                                       const std::string& of) {
  const std::optional<PoseForm> form = given.empty() ? std::nullopt : pose_form(given);
  if (!given.empty() && !form) {
    throw InputError(fmt::format(
        "--form: '{}' is none of {}; angles about other axes are "
        "fixed_zyx, euler_xyz and so on{}",
        given, fmt::join(pose_form_names(), ", "), did_you_mean(given, pose_form_names())));
  }
  PoseColumns pose{given, {}};
  for (PoseColumns& named : named_poses(table, form)) {
    if (named.of != of) continue;
    // By names, a quaternion is found in the order x y z w, whatever the order in the table.
    if (!given.empty() && named.form != "quaternion_xyzw") named.form = given;
    return named;
  }
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
      "{}: {}; {}", table.file(),
      taken ? "the form has " + taken->columns_text()
            : "no columns x y z with a rotation (qx qy qz qw, rx ry rz, roll pitch yaw, A B C, W P "
              "R) were found: give --form, one of " +
                  fmt::format("{}", fmt::join(pose_form_names(), ", ")),
      table.header_text()));
}

/// The columns that are a position.
[[nodiscard]] std::vector<int> position_of(const PoseColumns& pose) {
  if (pose_form(pose.form)->rotation == RotationForm::matrix)
    return {pose.indices[3], pose.indices[7], pose.indices[11]};
  return {pose.indices.begin(), pose.indices.begin() + 3};
}

/// The form with the units of its columns: those of names, else of values.
[[nodiscard]] PoseForm form_of(const HandEyeTable& table, const PoseColumns& pose) {
  PoseForm form = *pose_form(pose.form);
  form.millimetres = table.is_millimetres(position_of(pose));
  if (!form.has_angles()) return form;
  const std::vector<int> rotation(pose.indices.begin() + 3, pose.indices.end());
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const NamedUnit named = table.unit(rotation);
  form.degrees = named == NamedUnit::degrees ||
                 (named != NamedUnit::radians && (form.degrees || table.largest(rotation) > kTurn));
  return form;
}

/// "form: kuka\n    unit: millimetres  # positions up to 874\n ..."
/// @param indent  before each line but the first
[[nodiscard]] std::string form_text(const HandEyeTable& table, const PoseColumns& pose,
                                    const std::string& indent) {
  const PoseForm form = form_of(table, pose);
  std::string text =
      fmt::format("form: {}{}\n{}unit: {}  # positions up to {:.4g}\n", pose.form,
                  pose.why.empty() ? "" : "  # " + pose.why, indent,
                  form.millimetres ? "millimetres" : "metres", table.largest(position_of(pose)));
  if (!form.has_angles()) return text;
  const std::vector<int> rotation(pose.indices.begin() + 3, pose.indices.end());
  return text + fmt::format("{}angles: {}  # up to {:.4g}\n", indent,
                            form.degrees ? "degrees" : "radians", table.largest(rotation));
}

/// The column that names the row of another table: `image` if both have it, else the first that both
/// have.
/// @return  its index in each
/// @throws InputError  if it is missing
[[nodiscard]] std::pair<int, int> common_column(const HandEyeTable& a, const HandEyeTable& b) {
  for (const bool any : {false, true}) {
    for (std::size_t i = 0; i < a.columns().size(); ++i) {
      const std::string& name = a.columns()[i].name;
      const auto same = [&](const TableColumn& other) { return other.name == name; };
      if (!any && name != "image") continue;
      const auto other = std::find_if(b.columns().begin(), b.columns().end(), same);
      if (other != b.columns().end())
        return {static_cast<int>(i), static_cast<int>(other - b.columns().begin())};
    }
  }
  throw InputError(
      fmt::format("{}: has no column that {} has, too: one that says which pose a "
                  "corner belongs to, such as 'image'",
                  b.file(), a.file()));
}

/// The columns of corners and of where they are on the board.
struct CornerColumns {
  std::vector<int> pixel, place;
  int id = 0, target_id = 0;
  int of_pose = 0, of_corner = 0;  ///< what says which pose a corner belongs to
};

/// @throws InputError  if one is missing
[[nodiscard]] CornerColumns corner_columns(const HandEyeTable& poses, const HandEyeTable& corners,
                                           const HandEyeTable& target) {
  const std::vector<HandEyeTable::Names> ids = {{"id"}, {"corner"}, {"cornerid"}};
  CornerColumns columns{corners.find({{"u", "v"}, {"x", "y"}, {"pxu", "pxv"}}, "u and v"),
                        target.find({{"x", "y", "z"}}, "x, y and z"),
                        corners.find(ids, "id").front(), target.find(ids, "id").front()};
  std::tie(columns.of_pose, columns.of_corner) = common_column(poses, corners);
  return columns;
}

/// The observations of corners, as columns.yaml has them.
[[nodiscard]] std::string corners_text(const HandEyeTables& tables,
                                       const std::string& output_folder, const HandEyeTable& poses,
                                       const std::vector<HandEyeTable>& corners,
                                       const HandEyeTable& target,
                                       const std::vector<CornerColumns>& columns) {
  const auto path = [&](const std::string& file) {
    const auto folder = std::filesystem::absolute(output_folder.empty() ? "." : output_folder);
    return name_to_yaml(std::filesystem::proximate(file, folder).string());
  };
  const CornerColumns& any = columns.front();
  std::string text = fmt::format(
      "\nobservations:\n"
      " - sensor: {}  # what carries the board: where its corners are\n   frame: {}\n"
      "   table: {}\n   unit: {}\n   points: [[{}]]\n   id_columns: [{}]\n",
      name_to_yaml(tables.holder), HandEyeNames::kTarget, path(tables.target),
      target.is_millimetres(any.place) ? "millimetres" : "metres",
      fmt::join(target.names(any.place), ", "), target.names({any.target_id}).front());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const CornerColumns& of = columns[c];
    text += fmt::format(
        " - sensor: {0}\n   frame: {0}\n   table: {1}\n   match: {2}\n   pixels: [[{3}]]\n"
        "   id_columns: [{4}]\n",
        name_to_yaml(tables.corners[c].camera), path(tables.corners[c].file),
        poses.names({of.of_pose}).front(), fmt::join(corners[c].names(of.pixel), ", "),
        corners[c].names({of.id}).front());
  }
  return text;
}

/// @throws InputError  if no row of a camera's corners belongs to a pose
void check_seen(const CameraCorners& camera, const HandEyeTable& poses, const HandEyeTable& corners,
                const CornerColumns& columns) {
  std::set<std::string> known;
  for (std::size_t row = 0; row < poses.rows(); ++row)
    known.insert(poses.text(row, columns.of_pose));
  for (std::size_t row = 0; row < corners.rows(); ++row) {
    if (known.contains(corners.text(row, columns.of_corner))) return;
  }
  const std::string of_pose = poses.names({columns.of_pose}).front();
  throw InputError(fmt::format(
      "{}: camera '{}' sees nothing: {}", camera.file, camera.camera,
      corners.rows() == 0 ? std::string("the table has no corners")
                          : fmt::format("no {} of a corner ({}, ...) is one of {} ({}, ...)",
                                        of_pose, corners.text(0, columns.of_corner), poses.file(),
                                        poses.rows() == 0 ? "" : poses.text(0, columns.of_pose))));
}

// What three angles are: names and values tell little, poses of something that the camera sees tell all.

/// A pose of each row; nullopt where numbers are missing or wrong.
[[nodiscard]] std::vector<std::optional<Pose<double>>> poses_by_row(const HandEyeTable& table,
                                                                    const PoseColumns& columns,
                                                                    bool inverse) {
  PoseForm form = form_of(table, columns);
  form.inverse = inverse;
  std::vector<std::optional<Pose<double>>> poses;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::vector<double> numbers = table.numbers(row, columns.indices);
    const bool is_whole = std::all_of(numbers.begin(), numbers.end(),
                                      [](double number) { return std::isfinite(number); });
    const NumberedPose read =
        is_whole ? pose_from_numbers(form, numbers) : NumberedPose{{}, "missing"};
    poses.push_back(read.wrong.empty() ? std::optional(read.pose) : std::nullopt);
  }
  return poses;
}

/// The forms that columns may be, that of their names first.
[[nodiscard]] std::vector<std::string> possible_forms(const PoseColumns& columns) {
  const PoseForm form = *pose_form(columns.form);
  std::vector<std::string> forms = {columns.form};
  const auto add = [&](std::initializer_list<const char*> names) {
    for (const char* name : names) {
      const PoseForm other = *pose_form(name);
      if (other.rotation != form.rotation || other.axes != form.axes) forms.emplace_back(name);
    }
  };
  if (form.rotation == RotationForm::quaternion_wxyz) add({"quaternion_xyzw"});
  if (form.has_angles()) {
    add({"rotation_vector", "fixed_xyz", "euler_zyx", "euler_xyz", "fixed_zyx", "euler_zyz",
         "fixed_zyz",       "euler_zxz", "fixed_zxz", "euler_xzy", "fixed_xzy", "euler_yxz",
         "fixed_yxz",       "euler_yzx", "fixed_yzx", "euler_zxy", "fixed_zxy", "euler_xyx",
         "euler_xzx",       "euler_yxy", "euler_yzy"});
  }
  return forms;
}

/// How a form fits to what the camera sees.
struct FormFit {
  std::string form;
  double degrees = 0.0, millimetres = 0.0;  ///< root mean square differences of motions
  double cost =
      0.0;  ///< both: radians, and parts of how far the flange moves.  Rotations alone do not tell cyclic axes apart

  [[nodiscard]] std::string text() const {
    return fmt::format("{:.2g} deg and {:.2g} mm", degrees, millimetres);
  }
};

/// The forms of a pose in the order of their fits; of those that are alike, a usual one first.
/// @param seen  camera_T_object of each row, as far as it is known
[[nodiscard]] std::vector<FormFit> fits_of(const HandEyeTable& table, const PoseColumns& flange,
                                           const HandEyeTables& tables,
                                           const std::vector<std::optional<Pose<double>>>& seen) {
  constexpr std::size_t kMostRows = 40, kLeast = 4;
  constexpr double kAlike = 1.2;
  std::vector<FormFit> fits;
  for (const std::string& form : possible_forms(flange)) {
    PoseColumns columns = flange;
    columns.form = form;
    const auto poses = poses_by_row(table, columns, tables.inverse);
    std::vector<Sample> samples;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (std::size_t row = 0; row < poses.size() && samples.size() < kMostRows; ++row) {
      if (row >= seen.size() || !poses[row] || !seen[row]) continue;
      samples.push_back(hand_eye_sample(*poses[row], *seen[row]));
      sum += poses[row]->translation;
      squares += poses[row]->translation.squaredNorm();
    }
    if (samples.size() < kLeast) continue;
    const auto n = static_cast<double>(samples.size());
    const double moves = std::sqrt(std::max(1e-6, squares / n - (sum / n).squaredNorm()));
    const HandEyeFit fit = fit_hand_eye(samples, tables.camera_on_hand);
    if (!std::isfinite(fit.turn + fit.difference)) continue;
    fits.push_back({form, fit.turn * 180.0 / std::numbers::pi, 1e3 * fit.difference,
                    fit.turn + fit.difference / moves});
  }
  if (fits.empty()) return fits;
  const auto by_cost = [](const FormFit& a, const FormFit& b) { return a.cost < b.cost; };
  const double least = std::min_element(fits.begin(), fits.end(), by_cost)->cost;
  const std::string usual = std::find_if(fits.begin(), fits.end(), [&](const FormFit& fit) {
                              return fit.cost <= kAlike * least;
                            })->form;
  std::stable_sort(fits.begin(), fits.end(), by_cost);
  std::stable_partition(fits.begin(), fits.end(),
                        [&](const FormFit& fit) { return fit.form == usual; });
  return fits;
}

/// "poses fit to 0.3 deg and 1 mm; as rotation_vector to 81 deg and 200 mm, as ..."
[[nodiscard]] std::string fits_text(const std::vector<FormFit>& fits, const std::string& form) {
  std::string text;
  const auto chosen =
      std::find_if(fits.begin(), fits.end(), [&](const FormFit& fit) { return fit.form == form; });
  if (chosen != fits.end()) text = "poses fit to " + chosen->text();
  constexpr std::size_t kOthers = 2;
  std::size_t others = 0;
  for (const FormFit& fit : fits) {
    if (fit.form == form || ++others > kOthers) continue;
    text += fmt::format("{} as {} to {}", others == 1 ? ";" : ",", fit.form, fit.text());
  }
  return text;
}

/// Takes the form that fits, if that of the names does not; a given one is kept, with a doubt.
void choose_form(const HandEyeTable& table, const std::vector<FormFit>& fits, bool is_given,
                 PoseColumns& pose, Diagnostics& diagnostics) {
  constexpr double kGood = 0.5, kTimes = 3.0;  // a camera of which little is known is a bit wrong
  if (fits.size() < 2) return;
  const auto named = std::find_if(fits.begin(), fits.end(),
                                  [&](const FormFit& fit) { return fit.form == pose.form; });
  const FormFit& best = fits.front();
  const bool is_better = best.form != pose.form && best.cost < kGood &&
                         (named == fits.end() || kTimes * best.cost < named->cost);
  if (is_better && !is_given) pose.form = best.form;
  pose.why = fits_text(fits, pose.form);
  if (is_better && is_given) {
    diagnostics.doubt({table.file(), 0},
                      fmt::format("--form {}: {}: is {} meant?", pose.form, pose.why, best.form));
  } else if (best.cost > kGood) {
    diagnostics.doubt(
        {table.file(), 0},
        fmt::format("no form of the angles fits to what the camera sees: {}; is --target right, or "
                    "are the poses those of the base in the flange (--inverse)?",
                    pose.why));
  }
}

/// What rx ry rz are without anything that the camera sees: hardly ever a rotation vector if they are degrees, and never one
/// if several are much longer than half a turn.
void choose_form_by_values(const HandEyeTable& table, PoseColumns& pose) {
  if (pose.form != "rotation_vector") return;
  const bool degrees = form_of(table, pose).degrees;
  constexpr double kHalfTurn = 1.05 * 180.0;
  double longest = 0.0;
  std::size_t longer = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::vector<double> numbers = table.numbers(row, pose.indices);
    const double angle = Vector3<double>::Map(numbers.data() + 3).norm() *
                         (degrees ? 1.0 : 180.0 / std::numbers::pi);
    longest = std::isfinite(angle) ? std::max(longest, angle) : longest;
    longer += angle > kHalfTurn ? 1 : 0;
  }
  constexpr std::size_t kSeveral = 2;
  if (!degrees && longer < kSeveral) return;
  pose.form = "fixed_xyz";
  pose.why = longer >= kSeveral
                 ? fmt::format("no rotation vector: they would be up to {:.0f} deg long", longest)
                 : "a guess: degrees are hardly ever a rotation vector";
}

/// camera_T_board of each row of the table of poses, by its corners and a camera of which nothing is known.
[[nodiscard]] std::vector<std::optional<Pose<double>>> boards_of(const HandEyeTable& poses,
                                                                 const HandEyeTable& corners,
                                                                 const HandEyeTable& target,
                                                                 const CornerColumns& columns) {
  std::map<double, Eigen::Vector2d> places;
  std::vector<std::optional<Pose<double>>> seen(poses.rows());
  const double to_metres = target.is_millimetres(columns.place) ? 1e-3 : 1.0;
  double height = 0.0;
  for (std::size_t row = 0; row < target.rows(); ++row) {
    const std::vector<double> at = target.numbers(row, columns.place);
    if (row == 0) height = at[2];
    if (std::abs(at[2] - height) * to_metres > 1e-6) return seen;  // not flat
    places[target.numbers(row, {columns.target_id}).front()] =
        to_metres * Eigen::Vector2d(at[0], at[1]);
  }
  std::vector<TargetView> views(poses.rows());
  std::map<std::string, std::size_t> row_of;
  for (std::size_t row = 0; row < poses.rows(); ++row)
    row_of[poses.text(row, columns.of_pose)] = row;
  double width = 0.0, image_height = 0.0;
  for (std::size_t i = 0; i < corners.rows(); ++i) {
    const auto row = row_of.find(corners.text(i, columns.of_corner));
    const auto place = places.find(corners.numbers(i, {columns.id}).front());
    const std::vector<double> pixel = corners.numbers(i, columns.pixel);
    if (row == row_of.end() || place == places.end() || !std::isfinite(pixel[0] + pixel[1]))
      continue;
    views[row->second].plane.push_back(place->second);
    views[row->second].pixels.emplace_back(pixel[0], pixel[1]);
    width = std::max(width, pixel[0]);
    image_height = std::max(image_height, pixel[1]);
  }
  std::vector<TargetView> usable;
  std::copy_if(views.begin(), views.end(), std::back_inserter(usable),
               [](const TargetView& view) { return view.plane.size() >= 4; });
  const std::optional<CameraStart> camera = camera_start(usable, width, image_height);
  for (std::size_t row = 0; camera && row < views.size(); ++row) {
    if (views[row].plane.size() >= 4) seen[row] = camera->pose(views[row]);
  }
  return seen;
}

/// Takes the form of a marker's pose that fits to those of the flange in any form, if its names do not say it.
void choose_marker_form(const HandEyeTable& table, const HandEyeTables& tables,
                        const PoseColumns& flange, PoseColumns& marker) {
  const std::vector<std::string> forms = possible_forms(marker);
  if (forms.size() == 1) return;
  std::vector<FormFit> best;
  for (const std::string& form : forms) {
    PoseColumns columns = marker;
    columns.form = form;
    const auto fits = fits_of(table, flange, tables, poses_by_row(table, columns, false));
    if (fits.empty()) continue;
    best.push_back(fits.front());
    best.back().form = form;
  }
  if (best.empty()) return;
  const double of_names = best.front().form == marker.form
                              ? best.front().cost
                              : std::numeric_limits<double>::infinity();
  std::stable_sort(best.begin(), best.end(),
                   [](const FormFit& a, const FormFit& b) { return a.cost < b.cost; });
  constexpr double kTimes = 3.0;
  if (kTimes * best.front().cost < of_names) marker.form = best.front().form;
  marker.why = fits_text(best, marker.form);
}

/// Which of the poses of a row is the flange's, and which the marker's.
/// @throws InputError  if names do not say it
[[nodiscard]] std::pair<std::string, std::string> flange_and_marker(const HandEyeTable& table) {
  const auto has_any = [](const std::string& name, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return name.find(word) != std::string::npos; });
  };
  std::vector<std::string> others, markers, flanges;
  const std::vector<PoseColumns> poses = named_poses(table);
  for (const PoseColumns& pose : poses) {
    const bool is_marker =
        has_any(pose.of, {"marker", "target", "board", "tag", "object", "obj", "cam", "aruco",
                          "checker", "pattern", "tracking", "sensor", "charuco", "eye"});
    const bool is_flange =
        !is_marker && has_any(pose.of, {"flange", "tcp", "tool", "hand", "gripper", "ee", "eef",
                                        "effector", "robot", "arm"});
    (is_marker ? markers : is_flange ? flanges : others).push_back(pose.of);
  }
  if (markers.size() == 1 && flanges.empty() && others.size() == 1) flanges = others;
  if (flanges.size() == 1 && markers.empty() && others.size() == 1) markers = others;
  if (flanges.size() == 1 && markers.size() == 1) return {flanges.front(), markers.front()};
  std::string found;
  for (const PoseColumns& pose : poses) {
    found += (found.empty() ? "" : ", ") + table.names({pose.indices.front()}).front();
  }
  throw InputError(
      fmt::format("{}: a row needs two poses: of the flange (x y z qx qy qz qw, or tcp_x ...) and "
                  "of the marker in the camera "
                  "(marker_x marker_y marker_z marker_qx ...); poses begin at {}; {}. Or give "
                  "samples of MoveIt "
                  "Calibration (effector_wrt_world, object_wrt_sensor) or of easy_handeye2",
                  table.file(), found.empty() ? "no column" : found, table.header_text()));
}

}  // namespace
}  // namespace detail

std::string hand_eye_urdf(bool camera_on_hand, const std::vector<std::string>& cameras) {
  using Names = HandEyeNames;
  std::string text = fmt::format(
      R"(<?xml version="1.0"?>
<!-- A robot of which only the poses of the flange are known: the samples have them. -->
<robot name="hand_eye">
  <link name="{0}"/>
  <link name="{1}"/>
  <joint name="{2}" type="floating">
    <parent link="{0}"/>
    <child link="{1}"/>
  </joint>
  <!-- The optical frame of a camera: z ahead, x right, y down. -->
)",
      Names::kBase, Names::kFlange, Names::kFlangeJoint);
  for (const std::string& camera : cameras) {
    text += fmt::format(
        R"(  <link name="{0}"/>
  <joint name="{0}_joint" type="fixed">
    <parent link="{1}"/>
    <child link="{0}"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
  </joint>
)",
        camera, camera_on_hand ? Names::kFlange : Names::kBase);
  }
  return text + "</robot>\n";
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

std::string hand_eye_columns(const HandEyeTables& tables, const std::string& output_folder,
                             Diagnostics& diagnostics) {
  using namespace detail;
  const HandEyeTable poses(tables.poses);
  const std::vector<PoseColumns> named = named_poses(poses);
  const bool is_plain = std::any_of(named.begin(), named.end(),
                                    [](const PoseColumns& pose) { return pose.of.empty(); });
  std::pair<std::string, std::string> of;  // flange and marker
  if (named.size() == 1) of.first = named.front().of;
  if (tables.has_marker || (named.size() > 1 && !is_plain)) of = flange_and_marker(poses);
  PoseColumns columns = pose_columns(poses, tables.form, of.first);
  const auto choose = [&](const std::vector<std::optional<Pose<double>>>& seen) {
    choose_form(poses, fits_of(poses, columns, tables, seen), !tables.form.empty(), columns,
                diagnostics);
  };
  std::string observations;
  if (tables.has_marker) {
    PoseColumns object = pose_columns(poses, "", of.second);
    choose_marker_form(poses, tables, columns, object);
    choose(poses_by_row(poses, object, false));
    observations = fmt::format(
        "\nobservations:\n - sensor: {}  # what holds the marker\n   frame: {}\n   form: "
        "quaternion_xyzw\n"
        "   constant_poses: [[0, 0, 0, 0, 0, 0, 1]]\n - sensor: {}  # the marker in the camera\n   "
        "frame: {}\n   {}   poses: [[{}]]\n",
        HandEyeNames::kObject, HandEyeNames::kTarget, HandEyeNames::kCamera, HandEyeNames::kCamera,
        form_text(poses, object, "   "), fmt::join(poses.names(object.indices), ", "));
  } else if (!tables.corners.empty()) {
    if (tables.target.empty()) {
      throw InputError(tables.corners.front().file +
                       ": needs the table of where the corners are on the board");
    }
    const HandEyeTable target(tables.target);
    std::vector<HandEyeTable> corners;
    std::vector<CornerColumns> found;
    std::size_t most = 0;  // the camera with the most corners says most of what the angles are
    for (const CameraCorners& camera : tables.corners) {
      corners.emplace_back(camera.file);
      found.push_back(corner_columns(poses, corners.back(), target));
      check_seen(camera, poses, corners.back(), found.back());
      if (corners.back().rows() > corners[most].rows()) most = corners.size() - 1;
    }
    choose(boards_of(poses, corners[most], target, found[most]));
    observations = corners_text(tables, output_folder, poses, corners, target, found);
  }
  if (columns.why.empty() && tables.form.empty()) choose_form_by_values(poses, columns);
  std::string text = fmt::format(
      "# Columns for a hand-eye calibration, proposed by the table's header and values: check "
      "them.\nseparator: {}\nheader: {}\n\nposes:\n  {}:\n    {}    columns: [{}]\n",
      poses.separator(), poses.has_header(), HandEyeNames::kFlangeJoint,
      form_text(poses, columns, "    "), fmt::join(poses.names(columns.indices), ", "));
  if (tables.inverse) text += "    inverse: true  # of the base in the flange\n";
  return text + observations;
}

std::vector<Sample> corner_samples(const std::string& corners_file, const std::string& target_file,
                                   const std::vector<std::string>& cameras) {
  using namespace detail;
  const HandEyeTable corners(corners_file), target(target_file);
  const std::vector<HandEyeTable::Names> ids = {{"id"}, {"corner"}, {"cornerid"}};
  const std::vector<int> pixel = corners.find({{"u", "v"}, {"x", "y"}, {"pxu", "pxv"}}, "u and v"),
                         id = corners.find(ids, "id"), of_target = target.find(ids, "id"),
                         place = target.find({{"x", "y", "z"}}, "x, y and z"),
                         image = corners.find(
                             {{"image"}, {"file"}, {"filename"}, {"frame"}, {"view"}}, "image"),
                         camera = cameras.size() > 1 ? corners.find({{"camera"}}, "camera")
                                                     : std::vector<int>();
  const double to_metres = target.is_millimetres(place) ? 1e-3 : 1.0;
  std::map<double, Feature> board;
  const auto id_of = [](const HandEyeTable& table, std::size_t row, int column) {
    const double number = table.numbers(row, {column}).front();
    if (number >= 0.0 && number == std::floor(number) && number < 1e9) return number;
    throw InputError(fmt::format("{}: row {}: an id is a whole number from 0, not '{}'",
                                 table.file(), row + 1, table.text(row, column)));
  };
  for (std::size_t row = 0; row < target.rows(); ++row) {
    const double number = id_of(target, row, of_target.front());
    const Vector3<double> at = to_metres * Vector3<double>::Map(target.numbers(row, place).data());
    board[number] = {.frame = "board", .point = at, .id = static_cast<int>(number)};
  }
  std::vector<Sample> samples;
  std::map<std::string, std::size_t> sample_of;
  for (std::size_t row = 0; row < corners.rows(); ++row) {
    const std::string& name = corners.text(row, image.front());
    const std::string& of = camera.empty() ? cameras.front() : corners.text(row, camera.front());
    if (std::find(cameras.begin(), cameras.end(), of) == cameras.end()) {
      throw InputError(fmt::format("{}: row {}: camera '{}' is none of --cameras {}", corners_file,
                                   row + 1, of, fmt::join(cameras, ",")));
    }
    const double number = id_of(corners, row, id.front());
    const auto on_board = board.find(number);
    if (on_board == board.end()) {
      throw InputError(fmt::format("{}: row {}: {} has no corner {}", corners_file, row + 1,
                                   target_file, number));
    }
    const auto [known, is_new] = sample_of.emplace(name, samples.size());
    if (is_new) {
      samples.emplace_back().source = corners_file + ": " + name;
      samples.back().observations.push_back({"board", {}});
      for (const auto& [key, feature] : board)
        samples.back().observations.front().features.push_back(feature);
    }
    std::vector<Observation>& seen = samples[known->second].observations;
    auto observation = std::find_if(seen.begin(), seen.end(),
                                    [&](const Observation& o) { return o.sensor == of; });
    if (observation == seen.end()) observation = seen.insert(seen.end(), Observation{of, {}});
    const std::vector<double> at = corners.numbers(row, pixel);
    observation->features.push_back(
        {.frame = of, .point = {at[0], at[1], 0.0}, .id = static_cast<int>(number)});
  }
  return samples;
}

}  // namespace kinecal
