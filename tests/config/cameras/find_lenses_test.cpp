// Which lens `lens: auto` takes, and how good it is: a study of simulated cameras, narrow ones and fisheyes, with few views and
// many.
//
//   KINECAL_REPETITIONS=500 cameras_tests --gtest_filter=FindLenses.ImagesAsWellAsAnyOther     prints how good the choice is
#include "kinecal/config/cameras/find_lenses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <regex>

#include "kinecal/config/cameras/initial_cameras.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/report_data.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/cameras_alone.hpp"
#include "support/repetitions.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::Cameras, test::Chance;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kOneDegree = std::numbers::pi / 180.0;

/// A camera that is simulated.
struct TrueCamera {
  CameraInfo info;
  double view = 60.0;  ///< angle across its image, degrees
  double noise = 0.2;  ///< pixels
  int views = 20;
};

/// Photographs of a board of 9 x 7 corners that fills a third of the image or more, tilted by up to 40 degrees.
/// @param sigma   of each pixel, as a detector may say; 0: it says nothing
/// @param points  receives the corners that are seen: (3) each, metres, in the camera
std::vector<Sample> photographs(const TrueCamera& camera, Chance& chance, double sigma = 0.0,
                                std::vector<Vector3<double>>* points = nullptr) {
  const std::string lens = lens_of(camera.info);
  const auto eye = any_built_in(lens_camera(lens, ImageKind::raw));
  const auto settings = eye->settings({"camera", {}, camera.info});
  const double square = 0.04, board = 8 * square;
  std::vector<Sample> samples;
  while (std::ssize(samples) < camera.views) {
    const double off = chance(0.0, 0.4 * camera.view) * kOneDegree, about = chance(-3.1, 3.1);
    const Matrix3<double> towards =
        exp(Vector3<double>(off * std::cos(about), off * std::sin(about), 0.0));
    const Matrix3<double> turn = exp(Vector3<double>(chance(-0.7, 0.7), chance(-0.7, 0.7), 0.0)) *
                                 exp(Vector3<double>(0.0, 0.0, chance(-3.1, 3.1)));
    const double covers = std::min(60.0, camera.view) * chance(0.35, 0.8) * kOneDegree;
    Pose<double> pose{Matrix3<double>(towards * turn),
                      towards * Vector3<double>(0.0, 0.0, 0.5 * board / std::tan(0.5 * covers))};
    pose.translation -= pose.rotation * Vector3<double>(4 * square, 3 * square, 0.0);
    CameraInfo blank;
    blank.width = camera.info.width;
    blank.height = camera.info.height;
    Sample sample;
    std::vector<Vector3<double>> corners;
    sample.observations = {{"board", {}, {}}, {"camera", {}, blank}};
    for (int i = 0; i < 63; ++i) {
      const Vector3<double> corner(square * (i % 9), square * (i / 9), 0.0), p = pose * corner;
      const Eigen::Vector2d at = eye->predict(p, settings);
      const double u = at.x() + camera.noise * chance.normal(),
                   v = at.y() + camera.noise * chance.normal();
      const double angle = std::atan2(p.head<2>().norm(), p.z());
      if (!(angle < 0.55 * camera.view * kOneDegree && u > 0.0 && u < blank.width && v > 0.0 &&
            v < blank.height))
        continue;
      sample.observations[0].features.push_back({"board", corner, {}, {}, i});
      Feature& seen =
          sample.observations[1].features.emplace_back(Feature{"camera", {u, v, 0.0}, {}, {}, i});
      if (sigma > 0.0) seen.sigma = sigma;
      corners.push_back(p);
    }
    if (corners.size() < 25) continue;
    if (points != nullptr) points->insert(points->end(), corners.begin(), corners.end());
    sample.source = "view " + std::to_string(samples.size());
    samples.push_back(std::move(sample));
  }
  return samples;
}

CameraInfo camera_of(const std::string& lens, double focal, const std::vector<double>& d) {
  CameraInfo info;
  info.width = 1280;
  info.height = 960;
  info.distortion_model = lens;
  info.k = {focal, 0, 645.0, 0, focal, 470.0, 0, 0, 1};
  info.d = d;
  return info;
}

/// An ordinary lens or a fisheye, by its view.
TrueCamera drawn_camera(Chance& chance) {
  TrueCamera camera;
  camera.view = chance(25.0, 190.0);
  camera.noise = chance(0.1, 0.4);
  camera.views = static_cast<int>(std::lround(std::exp(chance(std::log(8.0), std::log(100.0)))));
  const double half = 0.5 * camera.view * kOneDegree;
  if (camera.view < 100.0) {
    const double r2 = std::tan(half) * std::tan(half), k1 = chance(-0.15, 0.08) / r2;
    const bool is_plain = chance(0.0, 1.0) < 0.3;
    const std::vector<double> none(5, 0.0),
        d = {k1, chance(-0.02, 0.03) / (r2 * r2), chance(-1e-3, 1e-3), chance(-1e-3, 1e-3), 0.0};
    camera.info = camera_of("plumb_bob", 640.0 / std::tan(half), is_plain ? none : d);
  } else {
    camera.info = camera_of("equidistant", 640.0 / half,
                            {chance(-0.03, 0.03), chance(-5e-3, 5e-3), chance(-1e-3, 1e-3), 0.0});
  }
  return camera;
}

/// The errors of the lenses that were tried, and that of the one that was taken, pixels.
struct HeldOutErrors {
  double least = HUGE_VAL, taken = 0.0;

  explicit HeldOutErrors(const std::vector<std::string>& notes) {
    const auto note = std::find_if(notes.begin(), notes.end(), [](const std::string& one) {
      return one.find("taken as ") != std::string::npos;
    });
    if (note == notes.end()) return;
    const std::string name = note->substr(note->find("taken as ") + 9);
    const std::regex error(R"(([a-z_]+ [a-z0-9 ]+) ([0-9.]+) px(?=,|:))");
    for (std::sregex_iterator at(note->begin(), note->end(), error), end; at != end; ++at) {
      const double value = std::stod((*at)[2]);
      least = std::min(least, value);
      if ((*at)[1] == name) taken = value;
    }
  }
};

/// How far a camera puts points from where the true one sees them: root of the mean square, pixels, after the rigid motion
/// of the camera that fits best, which a camera alone cannot know: as the report's +- of a pixel.
/// @param points  (3) each, metres, in the true camera
double error_of(const Cameras& found, const TrueCamera& truth,
                const std::vector<Vector3<double>>& points) {
  const Lens was(truth.info, ImageKind::raw), now(found.info("camera"), ImageKind::raw);
  Pose<double> moved;
  double error = 0.0;
  for (int step = 0; step < 6; ++step) {
    Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    double sum = 0.0;
    for (const Vector3<double>& point : points) {
      const Vector3<double> at = moved * point;
      const Eigen::Vector2d off = now.project(at) - was.project(point);
      if (!off.allFinite()) return HUGE_VAL;
      constexpr double kStep = 1e-6;
      Eigen::Matrix<double, 2, 6> by;
      for (int i = 0; i < 6; ++i) {
        const Vector3<double> axis = Vector3<double>::Unit(i % 3),
                              way = i < 3 ? Vector3<double>(axis.cross(at)) : axis;
        by.col(i) = (now.project(at + kStep * way) - now.project(at)) / kStep;
      }
      squares += by.transpose() * by;
      right += by.transpose() * off;
      sum += off.squaredNorm();
    }
    error = std::sqrt(sum / static_cast<double>(points.size()));
    const Eigen::Matrix<double, 6, 1> change = -squares.ldlt().solve(right);
    moved = Pose<double>{exp(Vector3<double>(change.head<3>())), change.tail<3>()} * moved;
  }
  return error;
}

/// The same as the report expects it: root of the mean square of the +- of pixels where the points are seen.
double expected_error(const ProjectionMap& map, const TrueCamera& truth,
                      const std::vector<Vector3<double>>& points) {
  const Lens was(truth.info, ImageKind::raw);
  double sum = 0.0;
  int seen = 0;
  for (const Vector3<double>& point : points) {
    const Eigen::Vector2d pixel = was.project(point);
    const KnownPixel* cell = map.at(pixel.x(), pixel.y());
    if (cell == nullptr || cell->features == 0) continue;
    sum += cell->deviation() * cell->deviation();
    ++seen;
  }
  return std::sqrt(sum / seen);
}

/// Within 2 % of the smallest error held out in 95 of 100 cameras; what is good images as the true camera does, as far
/// as its +- of a pixel says.
TEST(FindLenses, ImagesAsWellAsAnyOther) {
  const int cameras = test::repetitions_of_study(500, test::kIsSlow ? 2 : 6);
  int near = 0, solved = 0, good = 0, wrong = 0;
  double worst = 0.0;
  std::vector<double> ratios;  // of the error to what the report expects, of those that are good
  const auto print = [&] {
    std::ranges::sort(ratios);
    const auto quantile = [&](double part) {
      return ratios.empty() ? 0.0 : ratios[std::size_t(part * double(ratios.size() - 1))];
    };
    std::printf(
        "%d cameras of 25 to 190 degrees, 8 to 100 views: %d within 2 %% of the smallest error "
        "held out, %d good, of which %d image a feature more than 1 px off (the worst %.2f px); "
        "error to its +-: median %.2f, 9 in 10 %.2f, worst %.2f\n",
        solved, near, good, wrong, worst, quantile(0.5), quantile(0.9), quantile(1.0));
    std::fflush(stdout);
  };
  for (int n = 0; n < cameras; ++n) {
    if (n > 0 && n % 10 == 0) print();  // all of them take hours
    Chance chance(4000 + std::uint64_t(n));
    const TrueCamera truth = drawn_camera(chance);
    std::vector<Vector3<double>> points;
    Cameras found(initial_cameras({"camera"}), photographs(truth, chance, 0.0, &points));
    ASSERT_TRUE(found.diagnostics.errors.empty()) << n << ": " << found.diagnostics.errors.front();
    const HeldOutErrors errors(found.diagnostics.notes);
    ASSERT_GT(errors.taken, 0.0) << n;
    ++solved;
    const bool is_near = errors.taken <= 1.02 * errors.least;
    near += is_near ? 1 : 0;
    if (!is_near) std::printf("camera %d: %s\n", n, found.diagnostics.notes.front().c_str());
    const JudgedResult judged = calibrate_and_judge(found.calibration, found.samples);
    if (judged.judgement.verdict != Grade::good) continue;
    ++good;
    const ProjectionMap& map = judged.assessments.back().maps.front();
    EXPECT_TRUE(map.is_known()) << n;
    const double error = error_of(found, truth, points);
    ratios.push_back(error / expected_error(map, truth, points));
    if (ratios.back() > 2.0) {
      std::printf("camera %d: %.3f px off, %.1f times the +-: %s\n", n, error, ratios.back(),
                  found.diagnostics.notes.front().c_str());
    }
    worst = std::max(worst, error);
    if (error > 0.5) std::printf("camera %d: %.2f px\n", n, error);
    wrong += error > 1.0 ? 1 : 0;
  }
  print();
  EXPECT_GE(near, test::binomial_band(solved, 0.95, 0.01).least);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(good, solved / 2);
}

/// A narrow lens is a plumb_bob with hardly any coefficient, whichever of its views are there.
TEST(FindLenses, ANarrowLensNeedsNoCoefficients) {
  for (int n = 0; n < (test::kIsSlow ? 1 : 2); ++n) {
    Chance chance(70 + std::uint64_t(n));
    const TrueCamera truth{camera_of("plumb_bob", 3440.0, {0, 0, 0, 0, 0}), 21.0, 0.3, 8 + 8 * n};
    Cameras found(initial_cameras({"camera"}), photographs(truth, chance));
    ASSERT_THAT(found.diagnostics.errors, testing::IsEmpty());
    EXPECT_THAT(found.diagnostics.notes,
                Contains(HasSubstr("taken as plumb_bob without distortion")));
    const JudgedResult judged = calibrate_and_judge(found.calibration, found.samples);
    EXPECT_EQ(judged.judgement.verdict, Grade::good)
        << testing::PrintToString(judged.judgement.reasons);
    EXPECT_NEAR(found.info("camera").k[0], 3440.0, 60.0);
  }
}

/// A lens with a coefficient that is known to a few per cent only, is taken where its pixels are better.
TEST(FindLenses, PixelsDecideNotCoefficients) {
  Chance chance(5);
  const TrueCamera truth{camera_of("plumb_bob", 1456.0, {0.25, -1.26, 1e-3, 0.0, 2.16}), 47.0, 0.12,
                         10};
  const Cameras found(initial_cameras({"camera"}), photographs(truth, chance));
  ASSERT_THAT(found.diagnostics.errors, testing::IsEmpty());
  EXPECT_THAT(found.diagnostics.notes, Contains(HasSubstr("taken as plumb_bob k1 k2 p1 p2 k3")));
  const HeldOutErrors errors(found.diagnostics.notes);
  EXPECT_LT(errors.taken, 0.2);  // sqrt(2) * 0.12
}

/// fx and xi of a narrow double_sphere make up for each other: that is said, with what is known, and the result is not good.
TEST(FindLenses, WhatMakesUpForFxIsSaid) {
  Chance chance(3);
  const TrueCamera truth{camera_of("plumb_bob", 3440.0, {0, 0, 0, 0, 0}), 21.0, 0.2, 16};
  Cameras found(test::cameras_config({"camera"}, "double_sphere", "xi alpha"),
                photographs(truth, chance));
  ASSERT_THAT(found.diagnostics.errors, testing::IsEmpty());
  const JudgedResult judged = calibrate_and_judge(found.calibration, found.samples);
  EXPECT_EQ(judged.judgement.verdict, Grade::use_with_care);
  EXPECT_THAT(judged.judgement.reasons,
              Contains(HasSubstr("make up for each other: only its focal length at the axis")));
  EXPECT_THAT(judged.judgement.reasons, Not(Contains(HasSubstr("tilt the target"))));
  const ProjectionMap& map = judged.assessments.back().maps.front();
  const CameraNumber* focal = map.number(ProjectionMap::kAxisFocal);
  ASSERT_NE(focal, nullptr);
  EXPECT_NEAR(focal->value, 3440.0, 4.0 * *focal->deviation);
  EXPECT_LT(*focal->deviation, 60.0);
  EXPECT_TRUE(map.is_known());
}

/// A sigma of features changes weights, not units: the same error in pixels, noise and lens.
TEST(FindLenses, ASigmaOfFeaturesIsNoUnit) {
  const TrueCamera truth{camera_of("plumb_bob", 900.0, {-0.2, 0.05, 0, 0, 0}), 70.0, 0.2, 12};
  const auto found = [&](double sigma) {
    Chance chance(11);
    return Cameras(initial_cameras({"camera"}), photographs(truth, chance, sigma));
  };
  Cameras plain = found(0.0);
  ASSERT_THAT(plain.diagnostics.errors, testing::IsEmpty());
  const JudgedResult as_is = calibrate_and_judge(plain.calibration, plain.samples);
  for (const double sigma : {0.01, 0.2, 5.0}) {
    Cameras weighted = found(sigma);
    EXPECT_NEAR(HeldOutErrors(weighted.diagnostics.notes).taken,
                HeldOutErrors(plain.diagnostics.notes).taken, 1e-3)
        << sigma;
    const JudgedResult judged = calibrate_and_judge(weighted.calibration, weighted.samples);
    const BlockNoise &noise = judged.assessments.back().noise[0],
                     &was = as_is.assessments.back().noise[0];
    EXPECT_NEAR(noise.sigma, was.sigma, 1e-3) << sigma;
    EXPECT_NEAR(noise.given, sigma, 1e-9);
    EXPECT_NEAR(judged.assessments.back().held_out[0].held_out,
                as_is.assessments.back().held_out[0].held_out, 1e-3);
    const bool is_doubted = sigma < 0.05;  // the noise is 0.2 px
    EXPECT_EQ(judged.judgement.verdict, is_doubted ? Grade::use_with_care : Grade::good)
        << sigma << testing::PrintToString(judged.judgement.reasons);
  }
}

/// Nobody knew the intrinsics before: the report begins with what they are, and has no change in per cent.
TEST(FindLenses, TheReportHasTheCameraInPixelsFirst) {
  Chance chance(21);
  const TrueCamera truth{camera_of("plumb_bob", 800.0, {-0.2, 0.05, 0, 0, 0}), 77.0, 0.2, 12};
  Cameras found(initial_cameras({"camera"}), photographs(truth, chance));
  ASSERT_THAT(found.diagnostics.errors, testing::IsEmpty());
  const Findings findings =
      findings_of(found.robot, found.calibration,
                  calibrate_and_judge(found.calibration, found.samples), found.samples);
  const std::string text = findings_text(findings);
  EXPECT_THAT(
      text,
      testing::ContainsRegex(
          "Camera 'camera': a pixel is known to [^\n]*\n  fx [78][0-9.]* .- [0-9.]+, fy .*, cx .*, "
          "cy .* px; plumb_bob k1 "));
  EXPECT_THAT(text, Not(HasSubstr("camera_fx  ")));
  EXPECT_LT(text.find("Camera 'camera'"), text.find("Parameters;"));
  const ReportData data = report_data(found.calibration, findings, found.samples);
  const std::string page = html_report(data, "{}");
  EXPECT_LT(page.find("<h3>Camera <code><bdi>camera</bdi></code></h3><ul><li>fx "),
            page.find("Fit, before and after"));
  EXPECT_THAT(page, Not(HasSubstr("<bdi>camera_k1</bdi></code> ")));
}

}  // namespace
}  // namespace kinecal
