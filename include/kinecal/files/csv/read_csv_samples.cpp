// Definitions of read_csv_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/read_csv_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "kinecal/files/csv/csv_columns.ipp"
#include "kinecal/files/csv/csv_table.hpp"
#include "kinecal/files/samples/feature_id_parameters.ipp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/samples/joint_moves.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Converts rows to samples.  After a few bad cells it only counts the rest.
class CsvSamples {
 public:
  CsvSamples(const CsvMapping& mapping, CsvColumns columns, std::string file,
             Diagnostics& diagnostics)
      : mapping_(mapping),
        columns_(std::move(columns)),
        file_(std::move(file)),
        diagnostics_(diagnostics) {
    for (const CsvJoint& joint : mapping.joints) joints_.push_back(find(joint.columns));
    for (const CsvJoint& joint : mapping.velocities) velocities_.push_back(find(joint.columns));
    for (const CsvCondition& condition : mapping.conditions) {
      conditions_.push_back(find(condition.columns));
    }
    for (const CsvObservation& observation : mapping.observations) {
      frames_.push_back(find(observation.frame_column));
      ids_.push_back(find(observation.id_columns));
      for (const auto& point : observation.points) {
        for (const CsvSum& sum : point) points_.push_back(find(sum));
      }
    }
  }

  /// The sample of a row; a warning and nullopt if a joint's position is missing.
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
    if (complete) add_velocities(row, sample);
    for (std::size_t i = 0; i < conditions_.size(); ++i) {
      sample.conditions[mapping_.conditions[i].name] = value(row, conditions_[i], {});
    }
    std::size_t next = 0;
    for (std::size_t i = 0; i < mapping_.observations.size(); ++i) {
      add_features(row, mapping_.observations[i], frames_[i], ids_[i], next, sample);
    }
    if (!complete) return std::nullopt;
    return sample;
  }

  /// Reports the number of bad cells that were only counted.
  void finish() {
    if (bad_cells_ <= kReported) return;
    const std::size_t more = bad_cells_ - kReported;
    diagnostics_.error({file_, 0}, fmt::format("{} more cell{} like these cannot be read", more,
                                               more == 1 ? "" : "s"));
  }

 private:
  static constexpr std::size_t kReported = 20;  ///< bad cells, one by one
  using Indices = std::vector<std::pair<std::size_t, const CsvColumn*>>;

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

  /// Adds the features of one entry to the observation of its sensor.
  /// @param next  index in points_ of its first number; advanced past its last one
  void add_features(const CsvRow& row, const CsvObservation& observation, const Indices& column,
                    const Indices& ids, std::size_t& next, Sample& sample) {
    const std::string frame = column.empty() ? observation.frame : text(row, column.front());
    auto seen = std::find_if(sample.observations.begin(), sample.observations.end(),
                             [&](const Observation& o) { return o.sensor == observation.sensor; });
    if (seen == sample.observations.end()) {
      seen = sample.observations.insert(seen, Observation{observation.sensor, {}});
    }
    const std::size_t before = seen->features.size();
    for (const auto& point : observation.constants) seen->features.push_back({frame, point});
    for (const auto& point : observation.points) {
      Vector3<double> p;
      for (Eigen::Index k = 0; k < 3; ++k) p(k) = value(row, points_[next++], observation.unit);
      if (!observation.unit.millimetres && !point[2].empty()) {
        doubt(row, "sensor '" + observation.sensor + "'", p.cwiseAbs().maxCoeff(), 100.0, "metres");
      }
      seen->features.push_back({frame, p});
    }
    add_ids(row, observation.ids, ids, before, seen->features);
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
    if (++bad_cells_ > kReported) return;
    diagnostics_.error({file_, row.line}, fmt::format("column '{}' {}", column.name, what));
  }

  /// Radians, metres or pixels; zero without columns, and for a bad cell, which is reported.
  [[nodiscard]] double value(const CsvRow& row, const Indices& columns, const CsvUnit& unit) {
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
      if (!number || std::isinf(*number)) {
        const bool comma = cell.find(',') != std::string::npos;
        bad_cell(row, *column,
                 fmt::format("is '{}', which is not a {}number{}", cell, number ? "finite " : "",
                             comma ? "; write a decimal point, not a comma" : ""));
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
  CsvColumns columns_;
  std::string file_;
  Diagnostics& diagnostics_;
  /// In the order of the mapping.
  std::vector<Indices> joints_, velocities_, conditions_, frames_, ids_, points_;
  std::size_t bad_cells_ = 0;
  std::set<std::string> doubted_;  ///< joints and sensors with a warning
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

}  // namespace
}  // namespace detail

std::vector<Sample> csv_samples(std::string_view text, const CsvMapping& mapping,
                                const std::string& file, Diagnostics& diagnostics) {
  std::vector<detail::CsvRow> rows = detail::csv_rows(text, mapping.separator, file, diagnostics);
  std::vector<Sample> samples;
  if (rows.size() < (mapping.header ? 2u : 1u)) {
    diagnostics.error({file, 0}, "the table has no rows");
    return samples;
  }
  std::size_t columns = 0;
  for (const detail::CsvRow& row : rows) columns = std::max(columns, row.cells.size());
  std::vector<std::string> header;
  if (mapping.header) {
    detail::doubt_csv_header(rows.front(), file, diagnostics);
    header = rows.front().cells;
    columns = header.size();
    rows.erase(rows.begin());
  }
  const std::size_t before = diagnostics.errors.size();
  detail::CsvSamples reader(mapping, {header, columns, diagnostics}, file, diagnostics);
  if (diagnostics.errors.size() != before) return samples;  // they would repeat in every row
  for (const detail::CsvRow& row : rows) {
    if (auto sample = reader.sample(row)) samples.push_back(std::move(*sample));
  }
  reader.finish();
  if (samples.empty() && diagnostics.errors.size() == before) {
    diagnostics.error({file, 0}, "no row has a position of every joint");
  }
  return samples;
}

std::vector<Sample> read_csv_samples(const std::string& csv, const std::string& mapping,
                                     Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  const CsvMapping columns = read_csv_mapping(mapping, diagnostics);
  const std::string text = detail::read_text_file(csv);
  if (diagnostics.errors.size() != before) return {};
  std::vector<Sample> samples = csv_samples(text, columns, csv, diagnostics);
  set_joint_moves(samples);
  return samples;
}

}  // namespace kinecal
