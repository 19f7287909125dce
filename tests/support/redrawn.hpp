// Calibrations with some samples of a real recording, and other samples of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "kinecal/trust.hpp"
#include "kinecal/trust/noise/joint_effects.ipp"
#include "support/calibrated.hpp"
#include "support/data.hpp"
#include "support/slip_size.hpp"

namespace kinecal::test {

/// A real recording and how it is drawn from.
struct RecordingKind {
  const char* name;
  const char* folder;  ///< of the data sets
  const char* urdf;
  const char* config;
  const char* samples;
  int poses;  ///< calibrated
  int again;  ///< new poses
};

inline constexpr RecordingKind kRecordingKinds[] = {
    {"UR5 and tracker, 60 poses", "ur5_tracker", "ur5.urdf", "full.yaml", "grid.yaml", 60, 6},
    {"Panda and sockets, 36 poses in front", "mukca_panda", "panda.urdf", "panda_6/stable.yaml",
     "panda_6/front.yaml", 36, 5},
    {"Panda and sockets, 38 poses at the right", "mukca_panda", "panda.urdf", "panda_6/stable.yaml",
     "panda_6/right.yaml", 38, 8},
};

/// A calibration with poses drawn at random, and new ones.
class Redrawn {
 public:
  Redrawn(const RecordingKind& recording, unsigned seed) {
    const auto folder = data_folder() / recording.folder;
    Diagnostics diagnostics;
    const std::vector<Sample> all =
        read_samples((folder / recording.samples).string(), diagnostics);
    std::vector<Sample> drawn;
    std::mt19937 random(seed);
    std::sample(all.begin(), all.end(), std::back_inserter(drawn),
                recording.poses + recording.again, random);
    std::shuffle(drawn.begin(), drawn.end(), random);
    fresh.assign(drawn.begin() + recording.poses, drawn.end());
    drawn.resize(static_cast<std::size_t>(recording.poses));
    calibrated_ = calibrate_samples(read_urdf((folder / recording.urdf).string()),
                                    folder / recording.config, std::move(drawn));
    values_ = calibrated_.result.table.values();
    assessment_ =
        assess(calibrated_.calibration, calibrated_.result, calibrated_.samples, {.folds = 0})
            .back();
  }
  /// Names of the joints that move what is measured.
  [[nodiscard]] std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const auto& [name, repeats] : detail::repeatable_joints(*problem())) names.push_back(name);
    return names;
  }
  /// The encoder of a joint reads less by so much.
  void slip(const std::string& joint, double by) {
    for (Sample& sample : fresh) sample.add_to_position(joint, -by);
  }
  /// How far a slip moves the features of new samples: see slip_size().
  [[nodiscard]] double size_of(const std::string& joint, double slip) const {
    return slip_size(*problem(), values(), fresh, assessment_.noise[0], joint, slip);
  }
  [[nodiscard]] Drift check(double level) const {
    return check_drift(*problem(), fresh, calibrated_state(assessment_, values()), {level});
  }

  std::vector<Sample> fresh;  ///< the new samples

 private:
  [[nodiscard]] ParameterValues values() const {
    return {values_.data(), static_cast<std::size_t>(values_.size())};
  }
  [[nodiscard]] std::unique_ptr<AnyProblem> problem() const {
    auto all = calibrated_.calibration.steps.back().problem->without_samples();
    for (const Sample& sample : fresh) all->add_sample(sample);
    return all;
  }

  Calibrated calibrated_;
  Eigen::VectorXd values_;
  Assessment assessment_;
};

}  // namespace kinecal::test
