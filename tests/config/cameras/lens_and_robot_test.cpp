// The lens and the robot in one problem, against two steps: first the lens, with a pose of the board in each image, then the
// robot with the lens held.  On simulated Fetches whose arm holds a board.
//
//   KINECAL_REPETITIONS=40 tools_tests --gtest_filter=LensAndRobot.*     prints the figures of MANUAL.md
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/cameras_alone.hpp"
#include "support/lens_fetch.hpp"
#include "support/repetitions.hpp"

namespace kinecal {
namespace {

using test::kOptical, test::TrueFetch;
using test::OraclePose, test::OracleValues;

constexpr const char* kLensParameters =
    ", camera_fx, camera_fy, camera_cx, camera_cy, camera_k1, camera_k2, camera_p1, camera_p2";

std::string config_text(bool with_lens) {
  const std::string free = ", x: true, y: true, z: true, roll: true, pitch: true, yaw: true}\n";
  return std::string(
             "base_link: base_link\nmodels:\n - {name: board, type: chain3d, frame: gripper_link}\n"
             " - {name: camera, type: camera2d, frame: ") +
         kOptical +
         "}\nfree_params: [shoulder_lift_joint, upperarm_roll_joint, elbow_flex_joint, "
         "forearm_roll_joint, wrist_flex_joint" +
         (with_lens ? kLensParameters : "") + "]\nfree_frames:\n - {name: head_camera_rgb_joint" +
         free + " - {name: board" + free +
         "error_blocks:\n - {name: corners, type: chain3d_to_camera2d, model_3d: board, model_2d: "
         "camera}\n";
}

/// A calibrated robot with its lens.
struct CalibratedFetch {
  CalibrationResult result;
  CameraInfo lens;
};

CalibratedFetch calibrated(const TrueFetch& fetch, const CameraInfo& lens, bool with_lens) {
  test::Simulated problem{"Fetch", fetch.robot, test::config_of(config_text(with_lens)),
                          fetch.samples, fetch.truth};
  for (Sample& sample : problem.exact) sample.observations[1].camera = lens;
  const Calibration calibration = problem.calibration(problem.exact);
  CalibratedFetch done{calibrate(calibration), lens};
  EXPECT_TRUE(done.result.converged);
  const Eigen::VectorXd values = done.result.table.values();
  for (const MountedSensor& sensor : calibration.steps.back().problem->sensors()) {
    if (sensor.mount().name != "camera") continue;
    done.lens = sensor.sensor().calibrated(
        lens, sensor.own_values({values.data(), static_cast<std::size_t>(values.size())}));
  }
  return done;
}

/// The lens from the same images alone.
CameraInfo lens_alone(const TrueFetch& fetch) {
  std::vector<Sample> images = fetch.samples;
  for (Sample& image : images) {
    image.joint_names.clear();
    image.joint_positions.clear();
    for (Feature& feature : image.observations[1].features) feature.frame = "camera";
  }
  const test::Cameras alone(test::cameras_config({"camera"}, "plumb_bob", "k1 k2 p1 p2"), images);
  EXPECT_TRUE(alone.diagnostics.errors.empty()) << alone.diagnostics.errors.front();
  return alone.info("camera");
}

/// Errors of a calibrated robot.
struct Errors {
  double gripper =
      0.0;  ///< RMS of the board where the camera says it is, millimetres across the ray
  double held_out = 0.0;  ///< RMS of a corner, pixels
};

Errors errors_of(const TrueFetch& fetch, const CalibratedFetch& found) {
  const ParameterTable true_table = fetch.table();
  const Eigen::VectorXd of_truth = true_table.values(), of_found = found.result.table.values();
  const OracleValues<double> truth(true_table, of_truth), values(found.result.table, of_found);
  const Lens true_lens(fetch.lens, ImageKind::raw), lens(found.lens, ImageKind::raw);
  Errors errors;
  double corners = 0.0;
  for (const Sample& sample : fetch.held_out) {
    const auto in_camera = [&](const OracleValues<double>& by) {
      const auto pose = [&](const char* link, const char* frame) {
        return oracle_pose(fetch.robot, "base_link", link, frame, sample, by);
      };
      return pose(kOptical, "").inverse().then(pose("gripper_link", "board"));
    };
    const OraclePose<double> now = in_camera(values), was = in_camera(truth);
    for (const Feature& feature : sample.observations[1].features) {
      const auto f = static_cast<std::size_t>(&feature - sample.observations[1].features.data());
      const Vector3<double> corner = test::corners()[f], p = was(corner);
      const Eigen::Vector2d pixel = lens.project(now(corner));
      const double per_pixel = 1e3 * p.z() / fetch.lens.k[0];  // millimetres
      errors.gripper += (pixel - true_lens.project(p)).squaredNorm() * per_pixel * per_pixel;
      errors.held_out += (pixel - feature.point.head<2>()).squaredNorm();
      corners += 1.0;
    }
  }
  return {std::sqrt(errors.gripper / corners), std::sqrt(errors.held_out / corners)};
}

/// Mean errors of one problem and of two steps over robots.
struct Compared {
  Errors one, two;
  int one_is_better = 0;
};

Compared compare(int robots, double joint_noise) {
  Compared all;
  const auto add = [&](Errors& to, const Errors& of) {
    to.gripper += of.gripper / robots;
    to.held_out += of.held_out / robots;
  };
  for (int i = 0; i < robots; ++i) {
    const TrueFetch fetch(300 + std::uint64_t(i), joint_noise);
    const Errors one = errors_of(fetch, calibrated(fetch, fetch.nominal, true));
    const Errors two = errors_of(fetch, calibrated(fetch, lens_alone(fetch), false));
    all.one_is_better += one.gripper < two.gripper ? 1 : 0;
    add(all.one, one);
    add(all.two, two);
  }
  std::printf(
      "joints stop within %.1f mrad: one problem %.3f mm at the gripper (held out %.3f px), two "
      "steps %.3f mm (%.3f px); one problem is better on %d of %d robots\n",
      1e3 * joint_noise, all.one.gripper, all.one.held_out, all.two.gripper, all.two.held_out,
      all.one_is_better, robots);
  return all;
}

/// Exact joints tell more of the lens than poses of the board do.
TEST(LensAndRobot, InOneProblemAreBetterWhereJointsAreExact) {
  const Compared all = compare(test::repetitions_of_study(40, 1), 0.0);
  EXPECT_LT(all.one.gripper, 0.5 * all.two.gripper);
  EXPECT_LT(all.one.held_out, all.two.held_out);
}

/// Where joints do not stop as they say, that bends the lens; a pose of the board in each image keeps it out.
TEST(LensAndRobot, InTwoStepsAreBetterWhereJointsScatter) {
  const Compared all = compare(test::repetitions_of_study(40, 1), 2e-3);
  EXPECT_GT(all.one.gripper, all.two.gripper);
  EXPECT_GT(all.one.held_out, all.two.held_out);
  if (std::getenv("KINECAL_REPETITIONS") == nullptr) return;
  (void)compare(test::repetitions_of_study(40, 1), 5e-4);  // between them: printed only
}

/// Recordings of the robot's board, and some in which a person holds one: a pose of its own in these only.
JudgedResult with_held_board(const TrueFetch& fetch, bool with_recording) {
  std::string text = config_text(true);
  text.replace(text.find("models:\n"), 8,
               "per_sample: [held]\nmodels:\n - {name: held, type: chain3d, frame: held}\n");
  text +=
      " - {name: corners_of_held, type: chain3d_to_camera2d, model_3d: held, model_2d: camera}\n";
  std::vector<Sample> samples(fetch.samples.begin(), fetch.samples.begin() + 15);
  if (!with_recording) text = config_text(true);
  for (Sample sample : with_recording ? fetch.held_out : std::vector<Sample>()) {
    sample.observations[0].sensor = "held";
    for (Feature& feature : sample.observations[0].features) feature.frame = "held";
    samples.push_back(sample);
  }
  Diagnostics diagnostics;
  Config config = parse_config(text, "calibrate.yaml", diagnostics);
  Robot robot = fetch.robot;
  EXPECT_TRUE(prepare_cameras(robot, config, samples, diagnostics));
  Calibration calibration = assemble(config, robot, samples, diagnostics);
  EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
  return calibrate_and_judge(calibration, samples);
}

TEST(LensAndRobot, ABoardThatAPersonHoldsInOneRecordingTellsMoreOfTheLens) {
  const TrueFetch fetch(3, 0.0);
  const JudgedResult both = with_held_board(fetch, true), robot = with_held_board(fetch, false);
  ASSERT_TRUE(both.result.converged);
  const auto deviation = [](const JudgedResult& of, const char* name) {
    return of.assessments.back().deviation(of.result.table.find(name)).value();
  };
  EXPECT_EQ(both.judgement.verdict, Grade::good) << testing::PrintToString(both.judgement.reasons);
  for (const char* name : {"camera_k1", "camera_k2"}) {
    EXPECT_LT(deviation(both, name), 0.95 * deviation(robot, name)) << name;
  }
  for (const auto& [name, value] : fetch.truth) {
    const int p = both.result.table.find(name);
    ASSERT_GE(p, 0) << name;
    if (const auto of = both.assessments.back().deviation(p)) {
      EXPECT_NEAR(both.result.table[p].value, value, 4.5 * *of) << name;
    }
  }
}

}  // namespace
}  // namespace kinecal
