// Definitions of read_csv_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/csv/read_csv_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "kinecal/files/csv/csv_samples.ipp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/samples/joint_moves.hpp"

namespace kinecal {

namespace detail {
namespace {

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

/// The samples of a table, and what a column says in the row of each.
struct CsvRead {
  std::vector<Sample> samples;
  std::vector<std::string> cells;  ///< of the column; empty without one
};

[[nodiscard]] CsvRead read_csv_rows(std::string_view text, const CsvMapping& mapping,
                                    const CsvSum& column, const std::string& file,
                                    Diagnostics& diagnostics) {
  CsvRead read;
  std::vector<CsvRow> rows = csv_rows(text, mapping.separator, file, diagnostics);
  if (rows.size() < (mapping.header ? 2u : 1u)) {
    diagnostics.error({file, 0}, "the table has no rows");
    return read;
  }
  std::size_t columns = 0;
  for (const CsvRow& row : rows) columns = std::max(columns, row.cells.size());
  std::vector<std::string> header;
  if (mapping.header) {
    doubt_csv_header(rows.front(), file, diagnostics);
    header = rows.front().cells;
    columns = header.size();
    rows.erase(rows.begin());
  }
  const std::size_t before = diagnostics.errors.size();
  CsvColumns found(header, columns, diagnostics);
  const auto key = column.empty() ? std::nullopt : found.find(column.front());
  CsvSamples reader(mapping, std::move(found), file, diagnostics);
  if (diagnostics.errors.size() != before) return read;  // they would repeat in every row
  for (const CsvRow& row : rows) {
    auto sample = reader.sample(row);
    if (!sample) continue;
    read.samples.push_back(std::move(*sample));
    if (key) read.cells.push_back(*key < row.cells.size() ? row.cells[*key] : "");
  }
  reader.finish();
  if (read.samples.empty() && diagnostics.errors.size() == before) {
    diagnostics.error({file, 0}, mapping.poses.empty() ? "no row has a position of every joint"
                                                       : "no row has every joint and pose");
  }
  return read;
}

/// Adds the features of a table to the samples they belong to.
/// @param cells  of the samples, in the column that both tables have
void add_own_table(const CsvMapping& mapping, const CsvObservation& observation,
                   std::span<const std::string> cells, std::vector<Sample>& samples,
                   Diagnostics& diagnostics) {
  CsvMapping own;
  own.separator = mapping.separator;
  own.header = mapping.header;
  own.observations = {observation};
  own.observations.front().table.clear();
  const std::string text = read_text_file(observation.table);
  const CsvRead read = read_csv_rows(text, own, observation.match, observation.table, diagnostics);
  if (read.cells.size() != (observation.match.empty() ? 0 : read.samples.size())) return;
  std::set<std::string> used;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Observation all{observation.sensor, {}, {}};
    for (std::size_t i = 0; i < read.samples.size(); ++i) {
      if (!read.cells.empty() && (cells.size() <= s || read.cells[i] != cells[s])) continue;
      if (!read.cells.empty()) used.insert(read.cells[i]);
      for (const Feature& feature : read.samples[i].observations.front().features) {
        all.features.push_back(feature);
      }
    }
    if (all.features.empty()) continue;
    const auto same = [&](const Observation& o) { return o.sensor == all.sensor; };
    auto& seen = samples[s].observations;
    const auto known = std::find_if(seen.begin(), seen.end(), same);
    if (known == seen.end()) {
      seen.push_back(std::move(all));
    } else {
      known->features.insert(known->features.end(), all.features.begin(), all.features.end());
    }
  }
  for (std::size_t i = 0; i < read.cells.size(); ++i) {
    if (!used.insert(read.cells[i]).second) continue;
    diagnostics.warnings.push_back(
        fmt::format("{}: no sample has {} '{}'; the features are left out", read.samples[i].source,
                    observation.match.front().name, read.cells[i]));
  }
}

}  // namespace
}  // namespace detail

std::vector<Sample> csv_samples(std::string_view text, const CsvMapping& mapping,
                                const std::string& file, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors.size();
  CsvSum match;  // of the first table that has one; others may only repeat it
  for (const CsvObservation& observation : mapping.observations) {
    if (observation.match.empty()) continue;
    if (!match.empty() && match.front().name != observation.match.front().name) {
      diagnostics.error(observation.match.front().place,
                        fmt::format("matches by column '{}', another table by '{}'; use one",
                                    observation.match.front().name, match.front().name));
    }
    match = observation.match;
  }
  detail::CsvRead read = detail::read_csv_rows(text, mapping, match, file, diagnostics);
  for (const CsvObservation& observation : mapping.observations) {
    if (observation.table.empty() || diagnostics.errors.size() != before) continue;
    detail::add_own_table(mapping, observation, read.cells, read.samples, diagnostics);
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
  const std::string text = detail::read_text_file(csv);
  if (diagnostics.errors.size() != before) return {};
  std::vector<Sample> samples = csv_samples(text, columns, csv, diagnostics);
  set_joint_moves(samples);
  return samples;
}

}  // namespace kinecal
