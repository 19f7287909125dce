// Several cameras around a robot of which only the poses of the flange are known: cameras and board from nothing, in one solve.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/cell_metric.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using test::MetricCell;
using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

constexpr double kMostMetres = 0.8e-3;                             // of the set: see its README
constexpr double kMostRadians = 0.025 * 3.14159265358979 / 180.0;  // the same

class Cell : public test::FolderTest {
 protected:
  [[nodiscard]] MetricCell cell(const std::vector<int>& cameras = {1, 2, 3, 4}) const {
    MetricCell all(cameras, folder_);
    all.drop_outliers();
    return all;
  }
  [[nodiscard]] static Calibration assembled(const MetricCell& cell,
                                             const std::vector<Sample>& samples, bool plain) {
    Diagnostics diagnostics;
    const Config config = parse_config(cell.config(plain), "calibrate.yaml", diagnostics);
    Calibration calibration = assemble(config, cell.robot, samples, diagnostics);
    diagnostics.throw_if_errors();
    return calibration;
  }
};

TEST_F(Cell, ReachesTheReferenceCostFromNothing) {
  KINECAL_NEEDS_DATA("cell_metric")
  const MetricCell cell = this->cell();
  const CalibrationResult result = calibrate(assembled(cell, cell.samples, true));
  ASSERT_TRUE(result.converged) << result.termination;
  EXPECT_EQ(result.steps.front().num_parameters, 30);
  EXPECT_NEAR(result.steps.front().final_cost / 12.485902, 1.0, 1e-6)
      << to_string(result.steps.front().starts);
  for (std::size_t c = 0; c < cell.cameras.size(); ++c) {
    const auto off =
        test::distance(test::pose_of_camera(result.table, cell.cameras[c]), cell.truth[c]);
    EXPECT_LE(off.metres, kMostMetres) << cell.cameras[c];
    EXPECT_LE(off.radians, kMostRadians) << cell.cameras[c];
  }
}

TEST_F(Cell, IsSearchedForCameraByCamera) {
  KINECAL_NEEDS_DATA("cell_metric")
  const MetricCell cell = this->cell();
  const Calibration calibration = assembled(cell, cell.samples, true);
  const CalibrationStep& step = calibration.steps.front();
  const auto stages = detail::search_stages(*step.excerpt, step.unknown_frames);
  ASSERT_THAT(stages, SizeIs(4));
  EXPECT_THAT(stages[0].frames, SizeIs(2)) << "a camera, and the board";
  for (std::size_t s = 0; s < stages.size(); ++s) {
    if (s > 0) {
      EXPECT_THAT(stages[s].frames, SizeIs(1));
    }
    EXPECT_THAT(stages[s].terms, SizeIs(1));
  }
}

/// Ten poses show three to five views to each camera.
TEST_F(Cell, FromTenPosesIsBetterThanSingleSolves) {
  KINECAL_NEEDS_DATA("cell_metric")
  const MetricCell cell = this->cell();
  std::vector<MetricCell> single;
  for (int camera = 1; camera <= 4; ++camera) single.push_back(this->cell({camera}));
  double together = 0.0, alone = 0.0;
  int count = 0;
  constexpr std::size_t kSets = 12;  // every twelfth pose: ten or eleven
  for (std::size_t set = 0; set < kSets; ++set) {
    const auto is_in = [&](std::size_t s) { return s % kSets == set; };
    const std::vector<Sample> samples = cell.some(is_in);
    Calibration calibration = assembled(cell, samples, false);
    const JudgedResult judged = calibrate_and_judge(calibration, samples);
    const CalibrationResult& result = judged.result;
    ASSERT_TRUE(result.converged) << set << ": " << result.termination;
    for (std::size_t c = 0; c < 4; ++c) {
      const double off =
          test::distance(test::pose_of_camera(result.table, cell.cameras[c]), cell.truth[c]).metres;
      double variance = 0.0;
      for (const char* axis : {"x", "y", "z"}) {
        const auto sigma = judged.deviation(result.table.find(cell.cameras[c] + "_joint_" + axis));
        ASSERT_TRUE(sigma) << cell.cameras[c];
        variance += *sigma * *sigma;
      }
      EXPECT_LE(off, kMostMetres + 3.0 * std::sqrt(variance))
          << "set " << set << ", " << cell.cameras[c];
      const std::vector<Sample> own = single[c].some(is_in);
      const auto views = std::count_if(own.begin(), own.end(), [](const Sample& sample) {
        return sample.observations.size() > 1;
      });
      if (views < 3) continue;  // alone it would be anywhere
      const CalibrationResult one = calibrate(assembled(single[c], own, true));
      const double off_alone =
          test::distance(test::pose_of_camera(one.table, single[c].cameras[0]), single[c].truth[0])
              .metres;
      if (off_alone > 0.05) continue;  // it is lost, which would decide the sum
      together += off * off;
      alone += off_alone * off_alone;
      ++count;
    }
  }
  EXPECT_GE(count, 30);
  EXPECT_LE(together, alone);
  std::printf("from ten poses: %d cameras are %.2f mm off in one solve, %.2f mm alone (rms)\n",
              count, 1e3 * std::sqrt(together / count), 1e3 * std::sqrt(alone / count));
}

TEST_F(Cell, HalvesAgreeWithinTheirPlusMinus) {
  KINECAL_NEEDS_DATA("cell_metric")
  const MetricCell cell = this->cell();
  std::vector<JudgedResult> halves;
  for (const std::size_t half : {0U, 1U}) {
    const std::vector<Sample> samples = cell.some([&](std::size_t s) { return s % 2 == half; });
    Calibration calibration = assembled(cell, samples, false);
    ProcedureOptions options;
    options.between = {"c1", "c2", "c3", "c4"};
    halves.push_back(calibrate_and_judge(calibration, samples, options));
    ASSERT_TRUE(halves.back().result.converged);
    ASSERT_THAT(halves.back().assessments.back().between, SizeIs(6));
  }
  double squares = 0.0;
  int count = 0;
  for (const std::string& camera : cell.cameras) {
    for (const char* axis : {"x", "y", "z", "a", "b", "c"}) {
      const int p = halves[0].result.table.find(camera + "_joint_" + axis);
      const double by = halves[0].result.table[p].value - halves[1].result.table[p].value;
      const double sigma = std::hypot(*halves[0].deviation(p), *halves[1].deviation(p));
      EXPECT_LE(std::abs(by), 4.0 * sigma) << camera << axis;
      squares += by * by / (sigma * sigma);
      ++count;
    }
  }
  EXPECT_LE(squares / count, 1.0 + 3.0 * std::sqrt(2.0 / 8.0))
      << "the 24 differences count for 8 or so";
}

}  // namespace
}  // namespace kinecal
