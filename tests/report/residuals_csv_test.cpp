// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/residuals_csv.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "kinecal/report/residual_rows.ipp"
#include "support/hostile_names.hpp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) all.push_back(cell);
  return all;
}

/// The table of a scene that is solved.
std::string csv_of(const test::NoisyScene& scene) {
  const Findings findings =
      findings_of(test::mobile_manipulator(), scene.calibration,
                  judge_result(scene.calibration, scene.result, scene.samples), scene.samples);
  return residuals_csv(scene.calibration, findings);
}

TEST(ResidualsCsv, HasARowForEachFeatureWithItsDistance) {
  test::NoisyScene scene(12);
  scene.solve();
  std::istringstream text(csv_of(scene));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line,
            "error_block,sample,source,feature,unit,distance,residual_1,residual_2,residual_3");
  int rows = 0;
  double squares = 0.0;
  while (std::getline(text, line)) {
    const std::vector<std::string> row = cells(line);
    ASSERT_EQ(row.size(), 9U) << line;
    EXPECT_EQ(row[0], "points");
    EXPECT_EQ(row[1], std::to_string(rows / 4 + 1));
    EXPECT_EQ(row[3], std::to_string(rows % 4 + 1));
    const double distance = std::stod(row[5]);
    EXPECT_NEAR(distance, std::hypot(std::stod(row[6]), std::stod(row[7]), std::stod(row[8])),
                1e-12);
    squares += distance * distance;
    ++rows;
  }
  EXPECT_EQ(rows, 12 * 4);
  EXPECT_NEAR(0.5 * squares, scene.result.steps[0].final_cost * 1e-6, 1e-12);
}

/// What a spreadsheet makes of a cell: without its quotes.
std::string read_cell(std::string cell) {
  if (!cell.starts_with('"')) return cell;
  cell = cell.substr(1, cell.size() - 2);
  for (std::size_t at = 0; (at = cell.find("\"\"", at)) != std::string::npos; ++at)
    cell.erase(at, 1);
  return cell;
}

TEST(ResidualsCsv, NamesAreNoFormulasAndCanBeReadBack) {
  for (const std::string& name : test::kHostileNames) {
    std::string cell = read_cell(detail::csv_cell(name));
    EXPECT_EQ(std::string("=+-@").find(cell.front()), std::string::npos) << cell;
    if (cell.starts_with('\'')) cell.erase(0, 1);
    EXPECT_EQ(cell, name);
  }
}

TEST(ResidualsCsv, NumbersFeaturesAsTheSampleListsThemAndGivesTheirIds) {
  test::NoisyScene scene(12);
  scene.samples[0].observations[0].features[1].point.x() = std::nan("");
  std::vector<Observation>& seen = scene.samples[1].observations;
  for (Observation& observation : seen) {
    for (std::size_t i = 0; i < 4; ++i) observation.features[i].id = 20 + static_cast<int>(i);
  }
  std::reverse(seen[1].features.begin(), seen[1].features.end());  // the block's first sensor
  seen[0].features.erase(seen[0].features.begin());
  scene.solve();
  std::istringstream text(csv_of(scene));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line,
            "error_block,sample,source,feature,id,unit,distance,residual_1,residual_2,residual_3");
  std::map<std::string, std::string> features;  // of each sample: feature and id
  while (std::getline(text, line)) {
    const std::vector<std::string> row = cells(line);
    ASSERT_EQ(row.size(), 10U) << line;
    features[row[1]] += " " + row[3] + ":" + row[4];
  }
  EXPECT_EQ(features["1"], " 1: 3: 4:");
  EXPECT_EQ(features["2"], " 3:21 2:22 1:23");
  EXPECT_EQ(features["3"], " 1: 2: 3: 4:");
}

TEST(ResidualsCsv, RowsOfASmallerBlockEndWithEmptyCells) {
  const std::vector<detail::CsvResidual> rows = {
      {"points,1,a.yaml:1", {}, "m", 5.0, {3.0, 0.0, 4.0}},
      {"plane,2,a.yaml:9", {}, "m", 2.0, {-2.0}}};
  EXPECT_EQ(detail::csv_text(rows),
            "error_block,sample,source,feature,unit,distance,residual_1,residual_2,residual_3\n"
            "points,1,a.yaml:1,1,m,5,3,0,4\n"
            "plane,2,a.yaml:9,1,m,2,-2,,\n");
}

}  // namespace
}  // namespace kinecal
