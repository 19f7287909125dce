// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/residuals_csv.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) all.push_back(cell);
  return all;
}

TEST(ResidualsCsv, HasARowForEachFeatureWithItsDistance) {
  test::NoisyScene scene(12);
  scene.solve();
  const Findings findings =
      find(test::mobile_manipulator(), scene.calibration, scene.result, scene.samples);
  std::istringstream text(residuals_csv(scene.calibration, findings));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "error_block,sample,source,feature,unit,distance,residual");
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

}  // namespace
}  // namespace kinecal
