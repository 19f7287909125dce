// Definitions of read_csv_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/read_csv_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/csv/csv_columns.hpp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/csv/csv_units.hpp"
#include "kinecal/files/csv/point_file.hpp"
#include "kinecal/files/natural_order.hpp"
#include "kinecal/files/poses/pose_table.hpp"
#include "kinecal/files/samples/feature_id_parameters.ipp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/geometry/planar_motion.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal {

namespace detail {
namespace {

// Converts the rows of a table to samples.

/// Converts rows to samples.  After a few bad cells it only counts the rest.
class CsvSamples {
 public:
  /// @param units  the row of units below the header; without cells if the table has none
  CsvSamples(const CsvMapping& mapping, CsvColumns columns, const CsvRow& units, std::string file,
             Diagnostics& diagnostics)
      : mapping_(mapping),
        columns_(std::move(columns)),
        units_(units),
        file_(std::move(file)),
        diagnostics_(diagnostics) {
    for (const CsvJoint& joint : mapping.joints) {
      joints_.push_back(find(joint.columns));
      check_units(joints_.back(), joint.unit, "unit");
    }
    for (const CsvPose& pose : mapping.poses) {
      poses_.push_back(find(pose.columns));
      check_pose_units(poses_.back(), pose.form);
    }
    for (const CsvJoint& joint : mapping.velocities) {
      velocities_.push_back(find(joint.columns));
      check_units(velocities_.back(), joint.unit, "unit");
    }
    for (const CsvCondition& condition : mapping.conditions) {
      conditions_.push_back(find(condition.columns));
    }
    std::map<std::string, std::size_t> places;
    for (const CsvObservation& observation : mapping.observations) {
      if (!observation.table.empty()) continue;
      observations_.push_back(&observation);
      sensors_.push_back(places.try_emplace(observation.sensor, places.size()).first->second);
      frames_.push_back(find(observation.frame_column));
      ids_.push_back(find(observation.id_columns));
      for (const CsvSum& pose : observation.poses) {
        object_poses_.push_back(find(pose));
        check_pose_units(object_poses_.back(), observation.form);
      }
      for (const auto& point : observation.points) {
        for (const CsvSum& sum : point) {
          points_.push_back(find(sum));
          check_units(points_.back(), observation.unit, "unit");
        }
      }
    }
  }

  /// The sample of a row; a warning and nullopt if a joint's position or pose is missing.
  [[nodiscard]] std::optional<Sample> sample(const CsvRow& row) {
    Sample sample;
    sample.source = SourceLocation{file_, row.line}.str();
    bool complete = true;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const CsvJoint& joint = mapping_.joints[i];
      const double q = value(row, joints_[i], joint.unit);
      if (std::isnan(q) && complete) {
        diagnostics_.warning(
            {file_, row.line},
            fmt::format("joint '{}' has no position; the row is left out", joint.name));
      }
      complete = complete && !std::isnan(q);
      if (!joint.unit.degrees && !joint.unit.millimetres) {
        doubt(row, "joint '" + joint.name + "'", q, 4.0 * std::numbers::pi, "radians or metres");
      }
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back(q);
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      complete = add_pose(row, mapping_.poses[i], poses_[i], sample) && complete;
    }
    if (complete) add_velocities(row, sample);
    for (std::size_t i = 0; i < conditions_.size(); ++i) {
      sample.conditions[mapping_.conditions[i].name] =
          value(row, conditions_[i], mapping_.conditions[i].unit);
    }
    std::size_t next = 0, next_pose = 0;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const CsvObservation& observation = *observations_[i];
      if (sensors_[i] == sample.observations.size()) {
        sample.observations.push_back({observation.sensor, {}});
      }
      add_features(row, observation, frames_[i], ids_[i], next, next_pose,
                   sample.observations[sensors_[i]].features);
    }
    if (!complete) return std::nullopt;
    return sample;
  }

  /// Reports the number of bad cells that were only counted, and rotation vectors that are unlikely.
  void finish() {
    for (const auto& [name, rows] : over_half_turn_) {
      if (rows.first < 2) continue;
      diagnostics_.warning(
          {file_, 0},
          fmt::format(
              "{} poses of '{}' have rotation vectors of more than half a turn, up to {:.0f} "
              "deg: are these three angles about axes (form: fixed_xyz, euler_zyx, ...)?",
              rows.first, name, rows.second * 180.0 / std::numbers::pi));
    }
    if (bad_cells_ <= kReported) return;
    const std::size_t more = bad_cells_ - kReported;
    diagnostics_.error({file_, 0}, fmt::format("{} more cell{} like these cannot be read", more,
                                               more == 1 ? "" : "s"));
  }

 private:
  static constexpr std::size_t kReported = 20;  ///< bad cells, one by one
  using Indices = std::vector<std::pair<std::size_t, const CsvColumn*>>;

  /// Reports columns whose unit, in the row of units, is not that of the mapping.
  /// @param key  of the mapping, to which the unit belongs
  void check_units(std::span<const Indices::value_type> columns, const CsvUnit& unit,
                   const char* key) {
    for (const auto& [index, column] : columns) {
      if (index >= units_.cells.size()) continue;
      const std::string& cell = units_.cells[index];
      const NamedUnit named = unit_of_cell(cell).value_or(NamedUnit::none);
      const bool is_short = named == NamedUnit::millimetres, is_turn = named == NamedUnit::degrees;
      std::string what;
      if (named == NamedUnit::unreadable)
        what = "convert it to metres, millimetres, radians or degrees";
      if (is_short != unit.millimetres && (is_short || named == NamedUnit::metres)) {
        what = fmt::format("write '{}: {}'", key, is_short ? "millimetres" : "metres");
      }
      if (is_turn != unit.degrees && (is_turn || named == NamedUnit::radians)) {
        what = fmt::format("write '{}: {}'", key, is_turn ? "degrees" : "radians");
      }
      if (what.empty()) continue;
      diagnostics_.error(
          column->place,
          fmt::format("column '{}' is in {}, by the row of units in {}; {}", column->name, cell,
                      SourceLocation{file_, units_.line}.str(), what));
      return;
    }
  }
  void check_pose_units(const Indices& columns, const PoseForm& form) {
    if (!form.has_size(columns.size())) return;  // an error elsewhere
    if (form.rotation == RotationForm::matrix) {
      for (const std::size_t i : {3U, 7U, 11U})
        check_units({&columns[i], 1}, {false, form.millimetres}, "unit");
      return;
    }
    const std::span all(columns);
    check_units(all.first(3), {false, form.millimetres}, "unit");
    if (form.has_angles()) check_units(all.subspan(3), {form.degrees, false}, "angles");
  }

  /// Adds the measured pose of a floating joint.
  /// @returns  false, after a warning, if numbers of it are missing
  [[nodiscard]] bool add_pose(const CsvRow& row, const CsvPose& of, const Indices& columns,
                              Sample& sample) {
    const std::size_t before = bad_cells_;
    const std::optional<Pose<double>> pose = pose_of(row, of.form, columns, of.joint);
    if (!pose) {
      diagnostics_.warning({file_, row.line},
                           fmt::format("joint '{}' has no pose; the row is left out", of.joint));
      return false;
    }
    sample.poses[of.joint] = *pose;
    return bad_cells_ == before;
  }

  /// The pose in some columns; nullopt if a number is missing.  Reports what is wrong with it.
  [[nodiscard]] std::optional<Pose<double>> pose_of(const CsvRow& row, const PoseForm& form,
                                                    const Indices& columns,
                                                    const std::string& name) {
    std::vector<double> numbers;
    for (const auto& column : columns) numbers.push_back(value(row, {column}, {}));
    const auto is_missing = [](double number) { return std::isnan(number); };
    if (std::any_of(numbers.begin(), numbers.end(), is_missing)) return std::nullopt;
    const NumberedPose read = pose_from_numbers(form, numbers);
    if (!read.wrong.empty()) bad_row(row, fmt::format("pose of '{}': {}", name, read.wrong));
    constexpr double kHalfTurn = 1.05 * std::numbers::pi;
    if (form.rotation == RotationForm::rotation_vector) {
      const double angle = Vector3<double>::Map(numbers.data() + 3).norm() *
                           (form.degrees ? std::numbers::pi / 180.0 : 1.0);
      if (angle > kHalfTurn)
        over_half_turn_[name] = {over_half_turn_[name].first + 1,
                                 std::max(angle, over_half_turn_[name].second)};
    }
    return read.pose;
  }

  /// A missing velocity is an error: NaN would silently reach the models that use it.
  void add_velocities(const CsvRow& row, Sample& sample) {
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      const CsvJoint& joint = mapping_.velocities[i];
      const double v = value(row, velocities_[i], joint.unit);
      if (std::isnan(v)) {
        bad_cell(row, joint.columns.front(),
                 fmt::format("has no velocity of joint '{}'; every row needs one", joint.name));
      }
      if (!joint.unit.degrees && !joint.unit.millimetres) {
        doubt(row, "the velocity of joint '" + joint.name + "'", v, 4.0 * std::numbers::pi,
              "rad/s or m/s");
      }
      sample.joint_velocities.push_back(v);
    }
  }

  /// Adds the features of one entry to those of its sensor.
  /// @param next, next_pose  indices in points_ and object_poses_ of its first one; advanced past its last one
  void add_features(const CsvRow& row, const CsvObservation& observation, const Indices& column,
                    const Indices& ids, std::size_t& next, std::size_t& next_pose,
                    std::vector<Feature>& features) {
    std::string frame = observation.frame;
    if (!column.empty()) frame += (frame.empty() ? "" : "_") + text(row, column.front());
    const std::size_t before = features.size();
    for (const auto& point : observation.constants) features.push_back({frame, point});
    for (const auto& point : observation.points) {
      Vector3<double> p;
      const bool may_be_far = !point[2].empty();  // a range of nothing
      for (Eigen::Index k = 0; k < 3; ++k) {
        p(k) = value(row, points_[next++], observation.unit, may_be_far);
      }
      if (!observation.unit.millimetres && !point[2].empty()) {
        doubt(row, "sensor '" + observation.sensor + "'", p.cwiseAbs().maxCoeff(), 100.0, "metres");
      }
      features.push_back({frame, p});
    }
    for (const Pose<double>& pose : observation.constant_poses) {
      features.push_back({frame, pose.translation, pose.rotation});
    }
    for (std::size_t i = 0; i < observation.poses.size(); ++i) {
      const auto pose =
          pose_of(row, observation.form, object_poses_[next_pose++], observation.sensor);
      const Vector3<double> not_seen =
          Vector3<double>::Constant(std::numeric_limits<double>::quiet_NaN());
      features.push_back({frame, pose ? pose->translation : not_seen,
                          pose ? pose->rotation : Matrix3<double>(Matrix3<double>::Identity())});
    }
    add_ids(row, observation.ids, ids, before, features);
  }

  /// Sets the ids of the features from `first` on.  A feature with neither point nor id was not
  /// seen.
  void add_ids(const CsvRow& row, const std::vector<int>& ids, const Indices& columns,
               std::size_t first, std::vector<Feature>& features) {
    for (std::size_t i = 0; i < ids.size(); ++i) features[first + i].id = ids[i];
    std::size_t at = first;
    for (const auto& column : columns) {
      const double number = value(row, {column}, {});
      if (std::isnan(number) && !features[at].point.allFinite()) {
        features.erase(features.begin() + static_cast<std::ptrdiff_t>(at));
        continue;
      }
      features[at].id = feature_id(number);
      if (!features[at++].id) {
        bad_cell(row, *column.second, "has no id; an id is a whole number from 0");
      }
    }
  }

  /// The name in a cell; empty for a bad cell, which is reported.
  [[nodiscard]] std::string text(const CsvRow& row, const Indices::value_type& column) {
    const bool exists = column.first < row.cells.size();
    std::string name = exists ? row.cells[column.first] : "";
    if (name.empty()) bad_cell(row, *column.second, "is empty; it names the frame of the row");
    return name;
  }

  Indices find(const CsvSum& sum) {
    Indices indices;
    for (const CsvColumn& column : sum) {
      if (const auto index = columns_.find(column)) indices.emplace_back(*index, &column);
    }
    return indices;
  }

  /// Warns once of a number so large that its unit is probably wrong.
  void doubt(const CsvRow& row, const std::string& what, double number, double most,
             const char* unit) {
    if (!(std::abs(number) > most) || !doubted_.insert(what).second) return;
    diagnostics_.warning({file_, row.line}, fmt::format("{} is at {} {}; is a unit missing in the "
                                                        "columns' file?",
                                                        what, number, unit));
  }

  void bad_cell(const CsvRow& row, const CsvColumn& column, const std::string& what) {
    bad_row(row, fmt::format("column '{}' {}", column.name, what));
  }
  void bad_row(const CsvRow& row, const std::string& what) {
    if (++bad_cells_ <= kReported) diagnostics_.error({file_, row.line}, what);
  }

  /// Radians, metres or pixels; zero without columns, and for a bad cell, which is reported.
  /// @param may_be_far  infinite: not seen, as scanners write it
  [[nodiscard]] double value(const CsvRow& row, const Indices& columns, const CsvUnit& unit,
                             bool may_be_far = false) {
    double sum = 0.0;
    for (const auto& [index, column] : columns) {
      if (index >= row.cells.size()) {
        bad_cell(row, *column,
                 fmt::format("is missing: the row has {} cell{}", row.cells.size(),
                             row.cells.size() == 1 ? "" : "s"));
        continue;
      }
      const std::string& cell = row.cells[index];
      const std::optional<double> number = csv_number(cell);
      if (may_be_far && number && std::isinf(*number)) {
        sum = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      if (!number || std::isinf(*number)) {
        const bool comma = cell.find(',') != std::string::npos;
        bad_cell(row, *column,
                 fmt::format("is '{}', which is not a {}number{}", cell, number ? "finite " : "",
                             !comma ? ""
                             : mapping_.separator == ','
                                 ? "; write a decimal point, not a comma"
                                 : "; its comma may separate thousands, or other numbers "
                                   "of the column have a point: write decimal points"));
        continue;
      }
      // Moving the decimal point of a single length avoids a second rounding.
      if (unit.millimetres && columns.size() == 1 && std::isfinite(*number)) {
        return metres_from_millimetres(cell).value_or(0.0);
      }
      sum += *number;
    }
    if (unit.degrees) return sum * (std::numbers::pi / 180.0);
    return unit.millimetres ? sum / 1000.0 : sum;
  }

  const CsvMapping& mapping_;
  std::vector<const CsvObservation*> observations_;  ///< those in this table
  std::vector<std::size_t> sensors_;                 ///< their places in a sample
  CsvColumns columns_;
  const CsvRow& units_;
  std::string file_;
  Diagnostics& diagnostics_;
  /// In the order of the mapping.
  std::vector<Indices> joints_, poses_, velocities_, conditions_, frames_, ids_, points_,
      object_poses_;
  std::size_t bad_cells_ = 0;
  std::map<std::string, std::pair<int, double>>
      over_half_turn_;             ///< rows of poses, and the largest angle, radians
  std::set<std::string> doubted_;  ///< joints and sensors with a warning
};

/// Adds up conditions that a table gives as increments.
class Increments {
 public:
  explicit Increments(const CsvMapping& mapping) {
    for (const CsvCondition& condition : mapping.conditions) {
      if (condition.increment) sums_[condition.name] = 0.0;
    }
    has_start_ = mapping.joints.empty() && mapping.poses.empty() && mapping.observations.empty() &&
                 std::all_of(mapping.conditions.begin(), mapping.conditions.end(),
                             [](const CsvCondition& condition) {
                               return condition.increment || condition.name == kRun;
                             });
    for (const auto& [name, sum] : sums_) {
      if (!name.ends_with("_yaw")) continue;
      const std::string body = name.substr(0, name.size() - 3);
      if (sums_.contains(body + "x") && sums_.contains(body + "y")) bodies_.push_back(body);
    }
  }

  /// Adds the sample of a row, and before the first of a run one where it began, if increments are all that it has: of what is
  /// absolute no row says where it was then, and the first row is the start.  A row in which an increment is missing is left
  /// out: nothing says how the rows around it belong together, and nothing compares them.
  /// @returns  false if it was left out
  bool add(Sample sample, std::vector<Sample>& samples) {
    if (sums_.empty()) {
      samples.push_back(std::move(sample));
      return true;
    }
    const auto missing = [&](const auto& sum) {
      return std::isnan(sample.conditions.at(sum.first));
    };
    if (std::any_of(sums_.begin(), sums_.end(), missing)) return false;
    const auto run = sample.conditions.find(kRun);
    const std::optional<double> of =
        run == sample.conditions.end() ? std::nullopt : std::optional(run->second);
    if (has_start_ && (samples.empty() || of != run_)) {
      Sample& start = samples.emplace_back(sample);
      for (const auto& [name, sum] : sums_) start.conditions[name] = sum;
    }
    run_ = of;
    for (const std::string& body : bodies_) {
      double &x = sums_[body + "x"], &y = sums_[body + "y"];
      const PlanarMotion<double> moved =
          PlanarMotion<double>::at(x, y, sums_[body + "yaw"]) *
          PlanarMotion<double>::at(sample.conditions[body + "x"], sample.conditions[body + "y"],
                                   0.0);
      sample.conditions[body + "x"] = moved.x - x;
      sample.conditions[body + "y"] = moved.y - y;
    }
    for (auto& [name, sum] : sums_) sample.conditions[name] = sum += sample.conditions[name];
    samples.push_back(std::move(sample));
    return true;
  }

 private:
  std::map<std::string, double> sums_;  ///< by name
  std::vector<std::string> bodies_;     ///< "track_", of which x, y and yaw are increments
  std::optional<double> run_;           ///< of the last row
  bool has_start_ = false;              ///< a run has a sample where it began
};

/// Warns of a header with only numbers, unless it counts the columns.
void doubt_csv_header(const CsvRow& row, const std::string& file, Diagnostics& diagnostics) {
  bool counts = true;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& cell : row.cells) {
    const std::optional<double> number = csv_number(cell);
    if (!number) return;
    counts =
        counts && (std::isnan(before) ? *number == 0.0 || *number == 1.0 : *number == before + 1.0);
    before = *number;
  }
  if (counts) return;
  diagnostics.warning({file, row.line},
                      "row 1 looks like data, but counts as the header; if it is data, write "
                      "'header: false' in the columns' file and give columns by number, from 1");
}

/// A table, and the samples of its rows.
struct CsvRead {
  CsvTable table;
  std::vector<Sample> samples;
  std::vector<std::size_t> rows;  ///< of each sample, in the table

  /// What a column says in the row of each sample.
  /// @returns  empty, with an error, if there is no such column
  [[nodiscard]] std::vector<std::string> cells(const CsvColumn& column,
                                               Diagnostics& diagnostics) const {
    const auto index = CsvColumns(table, diagnostics).find(column);
    std::vector<std::string> all;
    for (std::size_t s = 0; index && s < samples.size(); ++s) {
      const std::vector<std::string>& row = table.rows[rows[s]].cells;
      all.push_back(*index < row.size() ? row[*index] : "");
    }
    return all;
  }
};

[[nodiscard]] CsvRead read_csv_rows(std::string_view text, const CsvMapping& mapping,
                                    const std::string& file, Diagnostics& diagnostics) {
  CsvRead read;
  read.table =
      csv_table(text, mapping.separator, mapping.header ? CsvHeader::present : CsvHeader::absent,
                file, diagnostics);
  const CsvTable& table = read.table;
  if (table.rows.empty()) {
    diagnostics.error({file, 0}, "the table has no rows");
    return read;
  }
  if (mapping.header) doubt_csv_header(table.header, file, diagnostics);
  const std::size_t before = diagnostics.errors.size();
  CsvSamples reader(mapping, CsvColumns(table, diagnostics), table.units, file, diagnostics);
  if (diagnostics.errors.size() != before) return read;  // they would repeat in every row
  Increments increments(mapping);
  int missing = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    auto sample = reader.sample(table.rows[i]);
    if (!sample) continue;
    if (!increments.add(std::move(*sample), read.samples)) ++missing;
    read.rows.resize(read.samples.size(), i);
  }
  reader.finish();
  if (missing > 0) {
    diagnostics.note({file, 0}, fmt::format("{} row{} without all increments {} left out", missing,
                                            missing == 1 ? "" : "s", missing == 1 ? "is" : "are"));
  }
  if (read.samples.empty() && diagnostics.errors.size() == before) {
    diagnostics.error({file, 0}, mapping.poses.empty() ? "no row has a position of every joint"
                                                       : "no row has every joint and pose");
  }
  return read;
}

/// Reads a table of features as samples without joints.
[[nodiscard]] CsvRead read_own_rows(const CsvObservation& observation, std::string_view content,
                                    const std::string& file, Diagnostics& diagnostics) {
  CsvMapping own;
  own.observations = {observation};
  own.observations.front().table.clear();
  const std::optional<std::string> points = point_file_table(content, file);
  own.separator = points ? ',' : observation.separator;
  own.header = points ? true : observation.header;
  return read_csv_rows(points ? *points : content, own, file, diagnostics);
}

/// Adds features to those of their sensor in a sample.
void add_to(Sample& sample, Observation all) {
  if (all.features.empty()) return;
  const auto same = [&](const Observation& o) { return o.sensor == all.sensor; };
  auto& seen = sample.observations;
  const auto known = std::find_if(seen.begin(), seen.end(), same);
  if (known == seen.end()) {
    seen.push_back(std::move(all));
  } else {
    known->features.insert(known->features.end(), all.features.begin(), all.features.end());
  }
}

/// The features of some rows.
[[nodiscard]] Observation observed_in(const CsvRead& read, const CsvObservation& observation,
                                      std::span<const std::size_t> samples) {
  Observation all{observation.sensor, {}, {}};
  for (const std::size_t i : samples) {
    const std::vector<Feature>& features = read.samples[i].observations.front().features;
    all.features.insert(all.features.end(), features.begin(), features.end());
  }
  return all;
}

/// Adds the features of a table to the samples they belong to.
/// @param text  of the table
void add_own_table(const CsvObservation& observation, std::string_view text,
                   const std::string& file, CsvRead& of_samples, Diagnostics& diagnostics) {
  const CsvRead read = read_own_rows(observation, text, file, diagnostics);
  if (read.samples.empty()) return;
  const bool matches = !observation.match.empty();
  std::vector<std::string> own, cells;
  if (matches) {
    own = read.cells(observation.match.front(), diagnostics);
    cells = of_samples.cells(observation.match.front(), diagnostics);
    if (own.size() != read.samples.size() || cells.size() != of_samples.samples.size()) return;
  }
  std::map<std::string, std::vector<std::size_t>> rows;  // by what they match; "" without
  for (std::size_t i = 0; i < read.samples.size(); ++i) rows[matches ? own[i] : ""].push_back(i);
  std::set<std::string> used;
  for (std::size_t s = 0; s < of_samples.samples.size(); ++s) {
    const auto found = rows.find(matches ? cells[s] : "");
    if (found == rows.end()) continue;
    used.insert(found->first);
    add_to(of_samples.samples[s], observed_in(read, observation, found->second));
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!used.insert(own[i]).second) continue;
    diagnostics.warnings.push_back(
        fmt::format("{}: no sample has {} '{}'; the features are left out", read.samples[i].source,
                    observation.match.front().name, own[i]));
  }
}

/// The files that match a name with one *, in natural order.
[[nodiscard]] std::vector<std::string> matching_files(const std::string& pattern) {
  const std::filesystem::path path(pattern);
  const std::string name = path.filename().string();
  const std::string begin = name.substr(0, name.find('*')), end = name.substr(name.find('*') + 1);
  std::vector<std::string> names;
  std::error_code unreadable;
  const std::string folder = path.parent_path().empty() ? "." : path.parent_path().string();
  for (const auto& file : std::filesystem::directory_iterator(folder, unreadable)) {
    const std::string one = file.path().filename().string();
    const bool is_one = one.size() >= begin.size() + end.size() && one.starts_with(begin) &&
                        one.ends_with(end) && !one.starts_with('.');
    if (is_one && file.is_regular_file()) names.push_back(one);
  }
  std::sort(names.begin(), names.end(), file_naturally_before);
  for (std::string& one : names) one = (path.parent_path() / one).string();
  return names;
}

/// The file of each sample; empty after an error.
[[nodiscard]] std::vector<std::string> sample_files(const CsvObservation& observation,
                                                    const CsvRead& of_samples,
                                                    Diagnostics& diagnostics) {
  std::vector<std::string> files;
  if (observation.table.find('{') == std::string::npos) {
    const std::vector<std::string> all = matching_files(observation.table);
    if (all.size() != of_samples.table.rows.size()) {
      diagnostics.error(observation.table_place,
                        fmt::format("table '{}': {} for {} of the samples' table; each row needs "
                                    "one, or name the files by a column: {{column}}",
                                    observation.table, counted(all.size(), "file"),
                                    counted(of_samples.table.rows.size(), "row")));
      return {};
    }
    for (const std::size_t row : of_samples.rows) files.push_back(all[row]);
    return files;
  }
  files.assign(of_samples.samples.size(), "");
  std::string rest = observation.table;
  while (!rest.empty()) {
    const std::size_t begin = rest.find('{'), end = rest.find('}', begin);
    const bool has_column = end != std::string::npos;
    for (std::string& file : files) file += rest.substr(0, has_column ? begin : rest.size());
    if (!has_column) break;
    const std::vector<std::string> cells = of_samples.cells(
        {rest.substr(begin + 1, end - begin - 1), observation.table_place}, diagnostics);
    if (cells.size() != files.size()) return {};
    for (std::size_t s = 0; s < files.size(); ++s) files[s] += cells[s];
    rest = rest.substr(end + 1);
  }
  return files;
}

/// Adds the features of a file to each sample.
void add_own_files(const CsvObservation& observation, CsvRead& of_samples,
                   Diagnostics& diagnostics) {
  const std::vector<std::string> files = sample_files(observation, of_samples, diagnostics);
  for (std::size_t s = 0; s < files.size(); ++s) {
    Sample& sample = of_samples.samples[s];
    std::error_code unknown;
    if (!std::filesystem::exists(files[s], unknown)) {
      diagnostics.error({sample.source, 0},
                        "its table '" + printable(files[s]) + "' does not exist");
      return;
    }
    const std::string content = read_text_file(files[s]);
    Diagnostics own;
    const CsvRead read = read_own_rows(observation, content, files[s], own);
    if (read.table.rows.empty()) {
      diagnostics.warning({files[s], 0}, "has no points; " + sample.source + " is without them");
      continue;
    }
    std::vector<std::size_t> all(read.samples.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    diagnostics.errors.insert(diagnostics.errors.end(), own.errors.begin(), own.errors.end());
    for (const std::string& warning : own.warnings) {
      if (s == 0) diagnostics.warnings.push_back(warning);  // the others are alike
    }
    if (!own.errors.empty()) return;  // they would repeat in every file
    add_to(sample, observed_in(read, observation, all));
  }
}

/// Leaves the first of the samples whose rows have the same cell.
void keep_one_of_each_group(const CsvColumn& column, CsvRead& read, Diagnostics& diagnostics) {
  constexpr double kSame = 1e-6;  // radians or metres
  const std::vector<std::string> cells = read.cells(column, diagnostics);
  if (cells.size() != read.samples.size()) return;
  std::map<std::string, std::size_t> firsts;
  std::vector<Sample> samples;
  std::vector<std::size_t> rows;
  for (std::size_t s = 0; s < cells.size(); ++s) {
    const auto [first, is_first] = firsts.try_emplace(cells[s], samples.size());
    if (is_first) {
      samples.push_back(std::move(read.samples[s]));
      rows.push_back(read.rows[s]);
      continue;
    }
    const Sample &one = samples[first->second], &other = read.samples[s];
    std::string moved;
    for (std::size_t j = 0; j < one.joint_positions.size(); ++j) {
      const double by = one.joint_positions[j] - other.joint_positions[j];
      if (std::abs(by) > kSame && moved.empty()) moved = one.joint_names[j];
    }
    for (const auto& [joint, pose] : one.poses) {
      const Pose<double>& then = other.poses.at(joint);
      const bool is_same = (pose.translation - then.translation).norm() <= kSame &&
                           (pose.rotation - then.rotation).norm() <= kSame;
      if (!is_same && moved.empty()) moved = joint;
    }
    if (moved.empty()) continue;
    diagnostics.error({other.source, 0},
                      fmt::format("'{}' is not where it is in {}, although both have {} '{}' and "
                                  "are one sample",
                                  moved, one.source, column.name, cells[s]));
    break;
  }
  read.samples = std::move(samples);
  read.rows = std::move(rows);
}

}  // namespace
}  // namespace detail

std::vector<Sample> csv_samples(std::string_view text, const CsvMapping& mapping,
                                const std::string& file, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  CsvMapping of_samples = mapping;
  for (CsvObservation& observation : of_samples.observations) {
    const bool is_same = observation.points.empty() && observation.poses.empty();
    if (mapping.group.empty() || is_same || !observation.table.empty()) continue;
    observation.table = file;
    observation.match = mapping.group;
  }
  detail::CsvRead read = detail::read_csv_rows(text, of_samples, file, diagnostics);
  if (!mapping.group.empty() && diagnostics.errors.size() == before) {
    detail::keep_one_of_each_group(mapping.group.front(), read, diagnostics);
  }
  for (std::size_t i = 0; i < mapping.observations.size(); ++i) {
    const CsvObservation& observation = of_samples.observations[i];
    if (observation.table.empty() || diagnostics.errors.size() != before) continue;
    if (mapping.observations[i].table.empty()) {
      detail::add_own_table(observation, text, file, read, diagnostics);
    } else if (observation.has_files()) {
      detail::add_own_files(observation, read, diagnostics);
    } else {
      detail::add_own_table(observation, detail::read_text_file(observation.table),
                            observation.table, read, diagnostics);
    }
  }
  std::erase_if(read.samples, [&](const Sample& sample) {
    return !mapping.observations.empty() && sample.observations.empty();
  });
  return std::move(read.samples);
}

std::vector<Sample> read_csv_samples(const std::string& csv, const std::string& mapping,
                                     Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  const CsvMapping columns = read_csv_mapping(mapping, diagnostics);
  const std::string text = read_pose_table(csv);
  if (diagnostics.errors.size() != before) return {};
  std::vector<Sample> samples = csv_samples(text, columns, csv, diagnostics);
  set_joint_moves(samples);
  return samples;
}

bool is_csv_table(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::error_code unknown;
  if ((ending != ".csv" && ending != ".tsv" && ending != ".txt" && ending != ".dat") ||
      !std::filesystem::is_regular_file(path, unknown)) {
    return false;
  }
  std::string begin(4096, '\0');
  std::ifstream file(path);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find("joint_states:") == std::string::npos &&
         begin.find("observations:") == std::string::npos;
}

std::vector<Sample> read_csv_by_columns_beside(const std::string& csv, Diagnostics& diagnostics) {
  const std::filesystem::path columns = std::filesystem::path(csv).parent_path() / "columns.yaml";
  if (std::filesystem::exists(columns)) {
    diagnostics.note({csv, 0}, "is a table, read by " + columns.string());
    return read_csv_samples(csv, columns.string(), diagnostics);
  }
  throw InputError(fmt::format(
      "{}: is a table, not samples, and has no columns.yaml beside it, which says what its columns "
      "mean; propose one: {}; then "
      "convert the table: {}",
      csv,
      ShellCommand({"kinecal", "init", "--urdf", "robot.urdf"}).add_option("--from", {csv}).str(),
      ShellCommand{"kinecal", "convert", shell_file(csv), "samples.yaml", "--columns",
                   "columns.yaml"}
          .str()));
}

}  // namespace kinecal
