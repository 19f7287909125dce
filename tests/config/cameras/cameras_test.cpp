// Cameras alone: photographs of a board, and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>

#include "kinecal/config/cameras/initial_cameras.hpp"
#include "kinecal/config/cameras/lens_start.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "kinecal/trust/online.hpp"
#include "support/camera_rig.hpp"
#include "support/cameras_alone.hpp"
#include "support/data.hpp"

namespace kinecal {
namespace {

using test::Cameras, test::cameras_config, test::two_cameras, test::two_fisheyes;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// The corners of lens_mrcal, with nothing known of the camera but the size of its image.
std::vector<Sample> overpass(const std::string& folder) {
  std::ifstream file(folder + "/lens_mrcal/corners.csv");
  std::map<int, Sample> views;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    int view = 0, row = 0, col = 0;
    double u = 0.0, v = 0.0, weight = 0.0;
    EXPECT_EQ(std::sscanf(line.c_str(), "%d,%d,%d,%lf,%lf,%lf", &view, &row, &col, &u, &v, &weight),
              6);
    Sample& sample = views[view];
    if (sample.observations.empty()) {
      CameraInfo info;
      info.width = 6016;
      info.height = 4016;
      sample.observations = {{"board", {}, {}}, {"camera", {}, info}};
      sample.source = "view " + std::to_string(view);
    }
    sample.observations[0].features.push_back({"board", {0.077 * col, 0.077 * row, 0.0}});
    sample.observations[1].features.push_back({"camera", {u, v, 0.0}, {}, 1.0 / weight});
  }
  std::vector<Sample> samples;
  for (auto& [view, sample] : views) samples.push_back(std::move(sample));
  return samples;
}

/// 93 views of a board by a wide lens, from nothing but the corners: costs of an independent implementation.
TEST(CamerasAlone, AWideLensFromNothingButCorners) {
  KINECAL_NEEDS_DATA("lens_mrcal")
  const std::vector<Sample> samples = overpass(test::data_folder().string());
  ASSERT_EQ(samples.size(), 93U);
  const auto rms = [](double cost) { return std::sqrt(2.0 * cost / 9300.0); };
  Cameras rational(
      cameras_config({"camera"}, "rational_polynomial", "k1 k2 p1 p2 k3 k4 k5 k6", true), samples);
  ASSERT_THAT(rational.diagnostics.errors, IsEmpty());
  EXPECT_NEAR(rms(rational.cost()), 0.773296, 1e-5);
  EXPECT_NEAR(rational.info("camera").k[0], 2073.8396, 0.05);
  EXPECT_NEAR(rational.info("camera").d[5], 0.7641705, 1e-3);
  // w0 and w1 of the reference: deflections in the middle of a board of 0.693 m
  EXPECT_NEAR(rational.value("board_bend_x"), 8.0 * 0.00104705 / (0.693 * 0.693), 2e-4);
  EXPECT_NEAR(rational.value("board_bend_y"), -8.0 * 0.000517389 / (0.693 * 0.693), 2e-4);
  Cameras fisheye(cameras_config({"camera"}, "equidistant", "k1 k2 k3 k4", true), samples);
  ASSERT_THAT(fisheye.diagnostics.errors, IsEmpty());
  EXPECT_NEAR(rms(fisheye.cost()), 0.824034, 1e-5);
  Cameras flat(cameras_config({"camera"}, "rational_polynomial", "k1 k2 p1 p2 k3 k4 k5 k6"),
               samples);
  EXPECT_NEAR(rms(flat.cost()), 1.159241, 1e-5);
}

/// Evidence prefers the rational lens, and says why not plumb_bob.
TEST(CamerasAlone, TheLensIsFoundByEvidence) {
  KINECAL_NEEDS_DATA("lens_mrcal")
  Cameras cameras(cameras_config({"camera"}, "auto", "", true),
                  overpass(test::data_folder().string()));
  ASSERT_THAT(cameras.diagnostics.errors, IsEmpty());
  EXPECT_EQ(cameras.config.steps.front().models.back().lens, "rational_polynomial");
  EXPECT_THAT(cameras.diagnostics.notes,
              testing::Contains(HasSubstr("taken as rational_polynomial")));
}

/// The truth is found from pixels alone.
TEST(CamerasAlone, ARigFromPixelsAlone) {
  const auto [left, right, samples, boards] = two_fisheyes();
  Cameras rig(cameras_config({"left", "right"}, "equidistant", "k1 k2 k3 k4"), samples);
  ASSERT_THAT(rig.diagnostics.errors, IsEmpty());
  ASSERT_TRUE(rig.result.converged);
  EXPECT_LE(rig.cost(), 1e-9);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(rig.info("left").d[i], left.d[i], 1e-5);
    EXPECT_NEAR(rig.info("left").k[4], left.k[4], 1e-3);
  }
  EXPECT_NEAR(rig.value("right_joint_x"), 0.12, 1e-6);
  EXPECT_NEAR(rig.value("right_joint_y"), -0.01, 1e-6);
}

/// As `init --cameras left,right` writes it: no lens is given, and no lens waits for that of the other camera.
TEST(CamerasAlone, TheLensesOfARigAreFoundByEvidence) {
  const auto [left, right, samples, boards] = two_fisheyes(0.2);
  Cameras rig(initial_cameras({"left", "right"}), samples);
  ASSERT_THAT(rig.diagnostics.errors, IsEmpty());
  ASSERT_TRUE(rig.result.converged);
  // Another lens may fit as well with fewer coefficients: what counts is where it images points.
  for (const auto& [name, truth] : {std::pair("left", left), std::pair("right", right)}) {
    const Lens found(rig.info(name), ImageKind::raw), was(truth, ImageKind::raw);
    for (const double angle : {0.1, 0.5, 0.9}) {
      for (const double about : {0.0, 1.6, 3.1, 4.7}) {
        const Vector3<double> p(std::sin(angle) * std::cos(about),
                                std::sin(angle) * std::sin(about), std::cos(angle));
        EXPECT_LE((found.project(p) - was.project(p)).norm(), 0.5) << name << " at " << angle;
      }
    }
  }
  EXPECT_NEAR(rig.value("right_joint_x"), 0.12, 5e-4);
}

/// Sample by sample, with the start of each board, it ends where the whole does; a sample in which the cameras
/// contradict each other is left out.
TEST(CamerasAlone, FollowedOnlineTheyEndTheSame) {
  const auto [left, right, samples, boards] = two_fisheyes(0.2);
  Cameras rig(cameras_config({"left", "right"}, "equidistant", "k1 k2 k3 k4"), samples);
  ASSERT_THAT(rig.diagnostics.errors, IsEmpty());
  const JudgedResult whole = calibrate_and_judge(rig.calibration, rig.samples);
  const CalibrationStep& step = rig.calibration.steps.back();
  const Eigen::VectorXd start = rig.calibration.table.values();
  OnlineCalibration online([&] { return step.problem->without_samples(); }, step.free,
                           {start.data(), static_cast<std::size_t>(start.size())}, {"right"},
                           {"left"});
  OnlineState state;
  for (const Sample& sample : rig.samples) state = online.add(sample);
  EXPECT_EQ(state.samples, 30);
  const Assessment& of = whole.assessments.back();
  for (const int p : step.free.parameters()) {
    EXPECT_NEAR(online.values()[static_cast<std::size_t>(p)], whole.result.table[p].value,
                0.02 * of.deviation(p).value())
        << whole.result.table[p].name;
  }
  EXPECT_NEAR(state.noise, 1.0, 0.05);  // by the estimated noise
  EXPECT_TRUE(state.known);
  double squares = 0.0;
  for (const char* axis : {"x", "y", "z"}) {
    const double deviation =
        of.deviation(whole.result.table.find(std::string("right_joint_") + axis)).value();
    squares += deviation * deviation;
  }
  EXPECT_GT(state.position, 0.5 * std::sqrt(squares / 3.0));
  EXPECT_LT(state.position, 2.0 * std::sqrt(squares));
  EXPECT_FALSE(online.next_move(0.1).has_value());
  Sample contradicts = rig.samples[1];
  for (Observation& seen : contradicts.observations) {
    if (seen.sensor != "right") continue;
    for (Feature& feature : seen.features) feature.point.x() += 8.0;
  }
  EXPECT_FALSE(online.add(contradicts).fits);
}

/// An ordinary lens gets the model that all programs read, without a coefficient that it does not need, even if a
/// fisheye with fewer of them fits as well.
TEST(CamerasAlone, AnOrdinaryLensIsPlumbBob) {
  const auto [left, right, samples, boards] = two_cameras(
      "plumb_bob", 900.0, {-0.03, 0.01, 0.0, 0.0, 0.0}, {-0.28, 0.09, 1e-3, 0.0, 0.0}, 0.2);
  Cameras rig(initial_cameras({"left", "right"}), samples);
  ASSERT_THAT(rig.diagnostics.errors, IsEmpty());
  ASSERT_TRUE(rig.result.converged);
  EXPECT_EQ(rig.config.steps.front().models[1].lens, "plumb_bob");
  EXPECT_EQ(rig.config.steps.front().models[2].lens, "plumb_bob");
  EXPECT_EQ(rig.info("left").d.at(4), 0.0);
  EXPECT_EQ(rig.info("right").d.at(4), 0.0);
  EXPECT_NEAR(rig.info("right").d.at(0), -0.28, 0.02);
  EXPECT_THAT(rig.diagnostics.notes,
              ElementsAre(HasSubstr("taken as plumb_bob k1"), HasSubstr("taken as plumb_bob k1"),
                          HasSubstr("no camera shows where the target was")));
}

/// A rig in which each sample has the image that the right camera took in another one.
std::vector<Sample> paired_with(const std::vector<Sample>& right, std::vector<Sample> samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    auto& seen = samples[s].observations;
    std::erase_if(seen, [](const Observation& o) { return o.sensor == "right"; });
    const Observation* other = right[s].observation("right");
    if (other != nullptr) seen.push_back(*other);
  }
  return samples;
}

TEST(CamerasAlone, ImagesThatWereNotTakenTogetherAreNamed) {
  const std::vector<Sample> samples = two_fisheyes(0.2).samples;
  const std::string text = cameras_config({"left", "right"}, "equidistant", "k1 k2 k3 k4");
  std::vector<Sample> order = samples;
  std::rotate(order.begin(), order.begin() + 2, order.end());
  EXPECT_THAT(Cameras(text, paired_with(order, samples)).diagnostics.errors,
              ElementsAre(HasSubstr("with its images of 2 samples before it stays where it is")));
  std::reverse(order.begin(), order.end());
  EXPECT_THAT(Cameras(text, paired_with(order, samples)).diagnostics.errors,
              ElementsAre(HasSubstr("were images that are in one sample taken at once")));
}

/// Views of one camera that see the whole board.
std::vector<Sample> whole_views(std::size_t count, double off_by = 0.0) {
  std::vector<Sample> views;
  for (Sample& sample :
       two_cameras("plumb_bob", 520.0, {-0.1, 0.02, 1e-3, 0.0, 0.0}, {0, 0, 0, 0, 0}, 0.2)
           .samples) {
    if (sample.observation("left")->features.size() < 48 || views.size() == count) continue;
    std::erase_if(sample.observations, [](const Observation& o) { return o.sensor == "right"; });
    for (Observation& seen : sample.observations) {
      if (seen.sensor == "left" && views.size() == 1) seen.features[7].point.x() += off_by;
    }
    views.push_back(std::move(sample));
  }
  return views;
}

TEST(CamerasAlone, FewViewsAreNoResult) {
  const std::string text = cameras_config({"left"}, "plumb_bob", "k1 k2");
  const auto judged = [&](std::size_t count) {
    Cameras camera(text, whole_views(count));
    EXPECT_THAT(camera.diagnostics.errors, IsEmpty());
    return calibrate_and_judge(camera.calibration, camera.samples).judgement;
  };
  EXPECT_EQ(judged(1).verdict, Grade::do_not_use);
  EXPECT_THAT(judged(1).reasons,
              testing::Contains(HasSubstr("1 view is too few for the lens of 'left'")));
  EXPECT_THAT(judged(5).reasons, testing::Contains(HasSubstr("5 views are too few")));
  EXPECT_THAT(judged(9).reasons, Not(testing::Contains(HasSubstr("too few"))));
}

/// Photographs of a board that nobody moved count as one.
TEST(CamerasAlone, ViewsThatRepeatAreOneView) {
  const std::vector<Sample> two = whole_views(2);
  SeededRandom random(5);
  std::vector<Sample> samples;
  for (int i = 0; i < 20; ++i) {
    Sample& sample = samples.emplace_back(two[static_cast<std::size_t>(i % 2)]);
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "left") continue;
      for (Feature& feature : seen.features) feature.point.x() += 0.2 * random.normal();
    }
  }
  Cameras camera(cameras_config({"left"}, "plumb_bob", "k1 k2"), samples);
  ASSERT_THAT(camera.diagnostics.errors, IsEmpty());
  const Judgement judged = calibrate_and_judge(camera.calibration, camera.samples).judgement;
  EXPECT_EQ(judged.verdict, Grade::do_not_use);
  EXPECT_THAT(judged.reasons, testing::Contains(HasSubstr("2 different views are too few")));
}

TEST(CamerasAlone, HeldCoefficientsAreZero) {
  Cameras camera(cameras_config({"left"}, "plumb_bob", "k1 k2 p1 p2"), whole_views(9));
  ASSERT_THAT(camera.diagnostics.errors, IsEmpty());
  EXPECT_EQ(camera.info("left").d.at(4), 0.0);
  EXPECT_NEAR(camera.info("left").d.at(0), -0.1, 0.02);
}

TEST(CamerasAlone, OneBadCornerDoesNotDecideTheLens) {
  Cameras camera(initial_cameras({"left"}), whole_views(9, 120.0));
  ASSERT_THAT(camera.diagnostics.errors, IsEmpty());
  EXPECT_EQ(camera.config.steps.front().models[1].lens, "plumb_bob");
}

/// The errors of a camera whose lens is searched for.
std::vector<std::string> errors_of(std::vector<Sample> samples,
                                   const std::string& text = initial_cameras({"left"})) {
  return Cameras(text, std::move(samples)).diagnostics.errors;
}

TEST(CamerasAlone, AnotherBoardIsAskedFor) {
  for (const int columns : {6, 7}) {
    std::vector<Sample> samples = whole_views(9);
    for (Sample& sample : samples) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != "board") continue;
        for (int i = 0; i < 48; ++i) {  // eight are right
          seen.features[static_cast<std::size_t>(i)].point = {0.06 * (i % columns),
                                                              0.06 * (i / columns), 0.0};
        }
      }
    }
    EXPECT_THAT(
        errors_of(samples),
        ElementsAre(testing::AllOf(HasSubstr("no lens fits"),
                                   HasSubstr("are the columns, rows and ids of the target right?"),
                                   Not(HasSubstr("not a number")))));
  }
}

/// Views of a board that is parallel to the image.
std::vector<Sample> parallel_views(unsigned seed) {
  CameraInfo info;
  info.k = {620, 0, 645, 0, 620, 470, 0, 0, 1};
  info.d = {-0.27, 0.07, 0.0, 0.0, 0.0};
  const auto camera = any_built_in(lens_camera("plumb_bob", ImageKind::raw));
  const auto settings = camera->settings({"left", {}, info});
  std::vector<Sample> samples(20, whole_views(1)[0]);
  SeededRandom random(seed);
  for (Sample& sample : samples) {
    const Pose<double> pose{
        exp(Vector3<double>(0, 0, random.uniform(-0.3, 0.3))),
        {random.uniform(-0.3, -0.05), random.uniform(-0.2, -0.05), random.uniform(0.6, 1.2)}};
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "left") continue;
      for (Feature& feature : seen.features) {
        const int i = *feature.id;
        const Vector3<double> p = pose * Vector3<double>(0.06 * (i % 8), 0.06 * (i / 8), 0.0);
        feature.point.head<2>() =
            camera->predict(p, settings) + 0.3 * Eigen::Vector2d(random.normal(), random.normal());
      }
    }
  }
  return samples;
}

/// Whether some lens fits by chance, or none.
TEST(CamerasAlone, ParallelViewsAreToBeTilted) {
  for (const unsigned seed : {1U, 6U}) {
    Cameras camera(initial_cameras({"left"}), parallel_views(seed));
    const std::vector<std::string> said =
        camera.diagnostics.errors.empty()
            ? calibrate_and_judge(camera.calibration, camera.samples).judgement.reasons
            : camera.diagnostics.errors;
    EXPECT_THAT(said, testing::Contains(HasSubstr("tilt the target by 30 degrees to all sides")))
        << seed;
  }
}

/// The first view of 'left'.
Observation& left_of(Sample& sample) {
  return *std::find_if(sample.observations.begin(), sample.observations.end(),
                       [](const Observation& seen) { return seen.sensor == "left"; });
}

TEST(CamerasAlone, CornersThatWereNotSeenAreNamed) {
  std::vector<Sample> samples = whole_views(9);
  left_of(samples[1]).features[3].point = {-1.0, -1.0, 0.0};
  EXPECT_THAT(errors_of(samples),
              ElementsAre(HasSubstr(": a feature of sensor 'left' is at (-1, -1), outside its "
                                    "image, the first here; leave out corners")));
  samples = whole_views(9);
  for (std::size_t i = 0; i < 2; ++i) left_of(samples[1]).features[i].point.setZero();
  EXPECT_THAT(errors_of(samples),
              ElementsAre(HasSubstr("2 features of sensor 'left' are at (0, 0), the first here")));
}

TEST(CamerasAlone, CameraInfoThatCannotBeHasItsPlace) {
  std::vector<Sample> samples = whole_views(9);
  for (Sample& sample : samples) {
    CameraInfo& info = *left_of(sample).camera;
    info.k = {600, 0, 640, 0, 600, 480, 0, 0, 1};
    info.p = {600, 0, 640, 0, 0, 600, 480, 0, 0, 0, 1, 0};
    info.distortion_model = "plumb_bob";
    info.d = {0.1, 0.2, 0.3};
  }
  EXPECT_THAT(errors_of(samples),
              ElementsAre(samples[0].source +
                          ": sensor 'left': plumb_bob has 5 distortion coefficients, not 3"));
  for (Sample& sample : samples) {
    left_of(sample).camera->d.clear();
    left_of(sample).camera->k[0] = -600.0;
  }
  EXPECT_THAT(errors_of(samples),
              ElementsAre(samples[0].source +
                          ": sensor 'left': the focal lengths in camera_info are not positive"));
}

TEST(CamerasAlone, ASizeThatIsMissingIsNamed) {
  std::vector<Sample> samples = whole_views(9);
  const std::string text = cameras_config({"left"}, "plumb_bob", "k1 k2");
  left_of(samples[4]).camera.reset();
  EXPECT_THAT(errors_of(samples, text),
              ElementsAre(testing::AllOf(
                  HasSubstr(samples[4].source + ": sensor 'left' has no camera_info"),
                  HasSubstr("it is 1280x960 pixels"))));
  for (Sample& sample : samples) left_of(sample).camera.reset();
  const Cameras none(text, samples);
  EXPECT_THAT(none.diagnostics.errors, IsEmpty());
  EXPECT_THAT(none.diagnostics.warnings,
              testing::Contains(HasSubstr("the size of its images is in no sample")));
}

TEST(CamerasAlone, WhatCannotBeIsSaid) {
  const std::string text = cameras_config({"camera"}, "equidistant", "k1");
  const auto errors = [](const std::string& config, std::vector<Sample> samples) {
    return Cameras(config, std::move(samples)).diagnostics.errors;
  };
  Sample one;
  one.source = "samples.yaml:1";
  one.observations = {{"board", {{"board", {0, 0, 0}}, {"board", {0.1, 0, 0}}}, {}},
                      {"camera", {{"camera", {10, 20, 0}}, {"camera", {30, 20, 0}}}, CameraInfo{}}};
  EXPECT_THAT(errors(text, {one}), ElementsAre(HasSubstr("no view of 'board' has four corners")));
  Sample misnamed = one;
  misnamed.observations[0].sensor = "arm";
  EXPECT_THAT(errors(text, {misnamed}),
              ElementsAre(HasSubstr(
                  "model 'board': no sample has a sensor of that name; did you mean 'arm'?")));
  std::string held = text;
  held.replace(held.find("camera_fx, "), 11, "");
  EXPECT_THAT(errors(held, {one}), ElementsAre(HasSubstr("its intrinsics are not known; free")));
  std::string unknown = text;
  unknown.replace(unknown.find("[board]"), 7, "[bord]");
  EXPECT_THAT(
      errors(unknown, {one}),
      testing::Contains(HasSubstr("per_sample: 'bord' is neither a joint of the robot nor")));
  std::string base = text;
  base.replace(base.find("base_link: camera"), 17, "base_link: board");
  EXPECT_THAT(errors(base, {one}),
              testing::Contains(HasSubstr("cameras.yaml:2: per_sample: 'board' is the base_link")));
}

TEST(CamerasAlone, AFrameThatIsNamedTwiceIsOneFrame) {
  std::string text = cameras_config({"camera"}, "equidistant", "k1");
  text.replace(text.find("[board]"), 7, "[board, board]");
  Diagnostics diagnostics;
  EXPECT_EQ(parse_config(text, "cameras.yaml", diagnostics).per_sample.size(), 1u);
  EXPECT_THAT(diagnostics.errors, testing::IsEmpty());
}

/// The start of a lens is close to the lens that it is to be like.
TEST(LensStart, IsCloseToAFisheye) {
  const RoundLens like = rough_fisheye(400.0);
  for (const auto& [lens, degrees] : std::map<std::string, double>{{"plumb_bob", 40},
                                                                   {"rational_polynomial", 80},
                                                                   {"equidistant", 100},
                                                                   {"double_sphere", 90}}) {
    const std::vector<double> d = lens_start(lens, like, degrees);
    CameraInfo info;
    info.k = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    info.distortion_model = lens;
    info.d = d;
    const auto camera = any_built_in(lens_camera(lens, ImageKind::raw));
    for (double t = 0.1; t < degrees / 57.3; t += 0.1) {
      const Eigen::Vector2d at =
          camera->predict({std::sin(t), 0.0, std::cos(t)}, camera->settings({"c", {}, info}));
      EXPECT_NEAR(at.x(), t, 0.03) << lens << " at " << t;
    }
  }
}

}  // namespace
}  // namespace kinecal
