// Calibrations of the scene whose features err together: joints stop elsewhere than they say, and all
// features of a sample, and all readings of a pose, share that.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/trust/verify/drift.hpp"
#include "support/noisy_scene.hpp"
#include "support/slip_size.hpp"

namespace kinecal::test {

/// How samples are recorded.
struct SampleKind {
  const char* name;
  bool pixels;   ///< seen by the colour camera, else measured by the depth camera
  int features;  ///< of a sample
  int readings;  ///< samples of a pose, one after another
  double joint;  ///< standard deviation of a joint's position, radians
  double noise;  ///< of a coordinate of a feature, metres or pixels
  int poses;     ///< calibrated
  int again;     ///< new poses
};

inline constexpr SampleKind kSampleKinds[] = {
    {"one point", false, 1, 1, 5e-4, 1e-4, 40, 6},
    {"three points, joints repeat to 0.1 mrad", false, 3, 1, 1e-4, 5e-5, 30, 6},
    {"three points, independent", false, 3, 1, 0.0, 1e-4, 30, 6},
    {"board of 48 corners, joints to 0.3 mrad", true, 48, 1, 3e-4, 0.2, 25, 6},
    {"depth camera, 4 points, joints to 1 mrad", false, 4, 1, 1e-3, 1e-3, 25, 5},
    {"one point, four readings of a pose", false, 1, 4, 3e-4, 1e-4, 40, 6},
    {"three points, three readings of a pose", false, 3, 3, 3e-4, 1e-4, 25, 5},
};

/// What the calibration frees: all of it is observable.
inline std::vector<std::string> free_names(const SampleKind& kind) {
  std::vector<std::string> names = {"shoulder_lift", "elbow",      "wrist",
                                    "head_tilt",     "head_pan_x", "head_pan_y"};
  if (kind.pixels) names.insert(names.end(), {"eye_fx", "eye_cy"});
  if (!kind.pixels && kind.features > 1) names.push_back("camera_z_offset");
  return names;
}

/// A calibration and new samples of the same robot.
class RepeatedScene {
 public:
  RepeatedScene(const SampleKind& kind, unsigned seed) : kind_(kind), random_(seed + 100000) {
    const ParameterTable table = scene_table();
    truth_ = table.values();
    const std::vector<double> far = random_values(table, 0.02, 7);
    for (const std::string& name : free_names(kind)) {
      truth_(table.index(name)) = far[static_cast<std::size_t>(table.index(name))];
    }
    old_ = recorded(kind.poses, 2 * seed + 1);
    calibration_ = {table_with_units(), {}};
    calibration_.steps.push_back(
        {"calibrate", 1000, problem(old_), free_of(table, free_names(kind)), {}});
    result_ = calibrate(calibration_);
    EXPECT_TRUE(result_.converged) << result_.termination;
    assessment_ = assess(calibration_, result_, old_, {.folds = 0}).back();
    record(2 * seed + 2);
  }
  /// True value of a parameter, when new samples are recorded.
  [[nodiscard]] double& truth(const std::string& name) { return truth_(result_.table.index(name)); }
  /// Records new samples.
  void record(unsigned seed) {
    seed_ = seed;
    fresh = recorded(kind_.again, seed);
  }
  /// Names of the joints that are calibrated.
  [[nodiscard]] static std::vector<std::string> joint_names() {
    return {"shoulder_lift", "elbow", "wrist", "head_tilt"};
  }
  /// Records the new poses again, with a joint that is off by so much more.
  void slip(const std::string& joint, double by) {
    truth(joint) += by;
    record(seed_);
  }
  /// How far a slip moves the features of new samples: see slip_size().
  [[nodiscard]] double size_of(const std::string& joint, double slip) const {
    const Eigen::VectorXd values = result_.table.values();
    return slip_size(*problem(fresh), {values.data(), static_cast<std::size_t>(values.size())},
                     fresh, assessment_.noise[0], joint, slip);
  }
  [[nodiscard]] const Assessment& assessment() const { return assessment_; }

  [[nodiscard]] Drift check(double level) const {
    const auto with = problem(fresh);
    const Eigen::VectorXd values = result_.table.values();
    const CalibratedState state =
        calibrated_state(assessment_, {values.data(), static_cast<std::size_t>(values.size())});
    return check_drift(*with, fresh, state, {level});
  }

  std::vector<Sample> fresh;  ///< the new samples

 private:
  [[nodiscard]] std::unique_ptr<AnyProblem> problem(const std::vector<Sample>& with) const {
    auto all = make_problem(mobile_manipulator(), "base_link", table_with_units(), kSceneFrames);
    all->add_built_in(ChainPoint{}, {"arm", "hand"});
    if (kind_.pixels) {
      all->add_built_in(PinholeCamera{}, {"eye", "camera_optical_frame"});
      all->add_built_in("seen", PointToPixel{}, {"arm", "eye"}, {});
    } else {
      all->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
      all->add_built_in("seen", PointToPoint{}, {"camera", "arm"}, {});
    }
    for (const Sample& sample : with) all->add_sample(sample);
    return all;
  }
  [[nodiscard]] std::vector<Sample> recorded(int poses, unsigned seed) {
    const std::vector<Sample> exact =
        exact_samples(scene_problem(), {truth_.data(), static_cast<std::size_t>(truth_.size())},
                      poses, "hand", seed, kind_.features);
    std::normal_distribution<double> normal;
    std::vector<Sample> all;
    for (Sample sample : exact) {
      sample.observations.erase(sample.observations.begin() + (kind_.pixels ? 1 : 2));
      for (double& position : sample.joint_positions) position += kind_.joint * normal(random_);
      for (int reading = 0; reading < kind_.readings; ++reading) {
        Sample again = sample;
        for (Feature& feature : again.observations[1].features) {
          for (int k = 0; k < (kind_.pixels ? 2 : 3); ++k) {
            feature.point(k) += kind_.noise * normal(random_);
          }
        }
        all.push_back(std::move(again));
      }
    }
    return all;
  }

  SampleKind kind_;
  unsigned seed_ = 0;  ///< of the new samples
  std::mt19937 random_;
  Eigen::VectorXd truth_;
  std::vector<Sample> old_;
  Calibration calibration_;
  CalibrationResult result_;
  Assessment assessment_;
};

/// Calibrates, and checks with new samples of a robot that has not changed.
inline Drift check_again(const SampleKind& kind, unsigned seed, double level) {
  return RepeatedScene(kind, seed).check(level);
}

}  // namespace kinecal::test
