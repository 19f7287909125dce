// Lenses by their formulas, by a second implementation, and by the laws of sensors.
#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/testing/check_sensor.hpp"
#include "support/division_lens.hpp"

#ifdef KINECAL_TEST_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace kinecal {
namespace {

/// A camera_info of 640 x 480 pixels.
CameraInfo camera_info(const std::string& model, const std::vector<double>& d) {
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = model;
  info.d = d;
  info.k = {300, 0, 322, 0, 305, 238, 0, 0, 1};
  return info;
}

/// A camera whose features are pixels around the middle: the coefficients of the check are large.
std::vector<Observation> pixels_of(const CameraInfo& info) {
  Observation seen{"camera", {}, info};
  for (double u = 222; u < 440; u += 40) {
    for (double v = 143; v < 340; v += 40) seen.features.push_back({"camera", {u, v, 0.0}});
  }
  return {seen};
}

const std::vector<double> kPlumbBob = {-0.21, 0.09, 1e-3, -2e-3, 0.01};
const std::vector<double> kRational = {0.52, 0.03, 6e-4, -2e-4, 1e-4, 0.81, 0.11, 2e-3};
const std::vector<double> kWideRational = {0.4767,  0.02624, 4.2e-5,  -1.1e-5,
                                           8.66e-5, 0.7642,  0.09528, 1.372e-3};  // of a real lens
const std::vector<double> kThinPrism = {0.52, 0.03, 6e-4,  -2e-4, 1e-4, 0.81,
                                        0.11, 2e-3, -3e-3, 1e-3,  2e-3, -5e-4};
const std::vector<double> kEquidistant = {0.03, -0.004, 2e-3, -3e-4};
const std::vector<double> kDoubleSphere = {-0.21, 0.58};

TEST(Lenses, KeepTheLawsOfSensors) {
  const auto check = [](auto lens, const std::string& model, const std::vector<double>& d) {
    using L = decltype(lens);
    EXPECT_EQ(check_sensor(LensCamera<L>{}, pixels_of(camera_info(model, d))), kLawsHold)
        << L::kName;
  };
  check(PlumbBob{}, "plumb_bob", kPlumbBob);
  check(RationalPolynomial{}, "rational_polynomial", kRational);
  check(ThinPrism{}, "rational_polynomial", kThinPrism);
  check(Equidistant{}, "equidistant", kEquidistant);
  check(DoubleSphere{}, "double_sphere", kDoubleSphere);
}

/// Directions from the axis to an angle, in all azimuths, at distances of 0.3 to 3 m.
std::vector<Vector3<double>> points_up_to(double degrees) {
  std::vector<Vector3<double>> all;
  for (int i = 0; i < 400; ++i) {
    const double angle = degrees * std::numbers::pi / 180.0 * i / 399.0, turn = 2.4 * i;
    const double distance = 0.3 + 2.7 * ((i * 37) % 100) / 100.0;
    all.push_back(distance * Vector3<double>(std::sin(angle) * std::cos(turn),
                                             std::sin(angle) * std::sin(turn), std::cos(angle)));
  }
  return all;
}

/// The pixel of a point and the ray of that pixel, with nothing corrected.
template <class L>
struct Eye {
  explicit Eye(const CameraInfo& info) : settings(camera.settings({"eye", {}, info})) {}
  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& p) const {
    return camera.predict(p, settings, typename LensCamera<L>::Settings{});
  }
  [[nodiscard]] Ray<double> ray(const Eigen::Vector2d& pixel) const {
    return camera.place(
        Measurement<LensCamera<L>, double>{
            .point = {pixel.x(), pixel.y(), 0.0}, .rotation = {}, .settings = settings},
        typename LensCamera<L>::Settings{});
  }

  LensCamera<L> camera{};
  typename LensCamera<L>::Settings settings;
};

template <class L>
void expect_rays_lead_back(const CameraInfo& info, double degrees) {
  const Eye<L> eye(info);
  for (const Vector3<double>& p : points_up_to(degrees)) {
    const Eigen::Vector2d pixel = eye.pixel(p);
    ASSERT_TRUE(pixel.allFinite()) << L::kName << " at " << p.transpose();
    const Ray<double> ray = eye.ray(pixel);
    EXPECT_LE((ray.direction.normalized() - p.normalized()).norm(), 1e-11)
        << L::kName << " at " << p.transpose();
    constexpr double kStep = 1e-5;
    const Vector3<double> moved = (ray.direction + kStep * (ray.by_u - 2.0 * ray.by_v));
    EXPECT_LE((eye.pixel(moved) - pixel - kStep * Eigen::Vector2d(1.0, -2.0)).norm(), 1e-8)
        << L::kName << " at " << p.transpose();
  }
}

TEST(Lenses, ARayLeadsToItsPixelFarFromTheAxis) {
  expect_rays_lead_back<PlumbBob>(camera_info("plumb_bob", kPlumbBob), 50);
  expect_rays_lead_back<RationalPolynomial>(camera_info("rational_polynomial", kWideRational), 85);
  expect_rays_lead_back<ThinPrism>(camera_info("rational_polynomial", kThinPrism), 55);
  expect_rays_lead_back<Equidistant>(camera_info("equidistant", kEquidistant), 100);
  expect_rays_lead_back<Equidistant>(camera_info("equidistant", {0, 0, 0, 0}), 178);
  expect_rays_lead_back<DoubleSphere>(camera_info("double_sphere", kDoubleSphere), 98);
  expect_rays_lead_back<DoubleSphere>(camera_info("double_sphere", {0.3, 0.4}), 120);
}

/// A lens without its own inverse.
template <class L>
struct Forward {
  static constexpr std::string_view kName = L::kName;
  static constexpr auto kCoefficients = L::kCoefficients;
  template <class S, class C>
  static Eigen::Matrix<S, 2, 1> image(const Vector3<S>& p,
                                      const std::array<C, kCoefficients.size()>& d) {
    return L::image(p, d);
  }
};

/// What is found by Newton's method is what the inverse that somebody wrote gives, with its derivatives by place and
/// coefficients.
template <class L>
void expect_found_inverse(const std::vector<double>& coefficients, double degrees) {
  constexpr std::size_t kN = L::kCoefficients.size();
  using J = Jet<double, static_cast<int>(kN) + 2>;
  std::array<double, kN> plain{};
  std::array<J, kN> d;
  for (std::size_t i = 0; i < kN; ++i) {
    plain[i] = coefficients[i];
    d[i] = J(coefficients[i], static_cast<int>(i) + 2);
  }
  for (const Vector3<double>& p : points_up_to(degrees)) {
    const Eigen::Vector2d at = L::image(p, plain);
    const Eigen::Matrix<J, 2, 1> place(J(at.x(), 0), J(at.y(), 1));
    Sight<J> written = L::sight(place, d), found = detail::sight_of<Forward<L>>(place, d);
    const auto unit = [](Vector3<J> v) {  // lengths may differ, and so may their derivatives
      const J length = sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
      return Vector3<J>(v.x() / length, v.y() / length, v.z() / length);
    };
    const auto turn = [&](const Sight<J>& sight, const Vector3<J>& by) {  // how the ray turns
      const Vector3<J>& u = sight.direction;
      const J length = u.x() * u.x() + u.y() * u.y() + u.z() * u.z();
      return Vector3<J>((u.y() * by.z() - u.z() * by.y()) / length,
                        (u.z() * by.x() - u.x() * by.z()) / length,
                        (u.x() * by.y() - u.y() * by.x()) / length);
    };
    const auto expect_same = [&](const Vector3<J>& a, const Vector3<J>& b) {
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a(i).a, b(i).a, 1e-10) << L::kName << " at " << p.transpose();
        EXPECT_LE((a(i).v - b(i).v).norm(), 1e-8 * (1.0 + b(i).v.norm())) << L::kName;
      }
    };
    expect_same(unit(found.direction), unit(written.direction));
    expect_same(turn(found, found.by_x), turn(written, written.by_x));
    expect_same(turn(found, found.by_y), turn(written, written.by_y));
  }
}

TEST(Lenses, WithoutAnInverseHaveOne) {
  expect_found_inverse<PlumbBob>(kPlumbBob, 45);
  expect_found_inverse<RationalPolynomial>(kWideRational, 80);
  expect_found_inverse<ThinPrism>(kThinPrism, 50);
  expect_found_inverse<Equidistant>(kEquidistant, 100);
  expect_found_inverse<Equidistant>({0, 0, 0, 0}, 170);
  expect_found_inverse<DoubleSphere>(kDoubleSphere, 98);
  expect_found_inverse<DoubleSphere>({0.3, 0.4}, 110);
  EXPECT_EQ(check_sensor(LensCamera<Forward<DoubleSphere>>{},
                         pixels_of(camera_info("double_sphere", kDoubleSphere))),
            kLawsHold);
  const std::array<double, 2> d = {kDoubleSphere[0], kDoubleSphere[1]};
  EXPECT_FALSE(
      detail::sight_of<Forward<DoubleSphere>>(Eigen::Vector2d(9.0, 0.0), d).direction.allFinite())
      << "outside of its image";
}

/// Close to the axis, series replace quotients of small numbers.
TEST(Lenses, AreSmoothAtTheAxis) {
  const auto check = [](const auto& eye, const std::string& name) {
    for (double angle = 1e-9; angle < 0.1; angle *= 1.3) {
      const Vector3<double> p(std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle));
      const Ray<double> ray = eye.ray(eye.pixel(p));
      EXPECT_NEAR(ray.direction.normalized().head<2>().norm() / std::sin(angle), 1.0,
                  1e-11 + 1e-13 / angle)
          << name << " at " << angle;
    }
  };
  check(Eye<Equidistant>(camera_info("equidistant", kEquidistant)), "equidistant");
  check(Eye<DoubleSphere>(camera_info("double_sphere", kDoubleSphere)), "double_sphere");
  const Eye<Equidistant> fisheye(camera_info("equidistant", kEquidistant));
  EXPECT_LE((fisheye.pixel({0, 0, 2}) - Eigen::Vector2d(322, 238)).norm(), 1e-12);
  EXPECT_FALSE(fisheye.pixel({0, 0, -2}).allFinite()) << "just behind it";
}

/// The double sphere by its construction: a point on a unit sphere, on a second one, in a pinhole.
TEST(Lenses, DoubleSphereIsTheConstructionOfTwoSpheres) {
  const double xi = -0.21, alpha = 0.58;
  const Eye<DoubleSphere> eye(camera_info("double_sphere", {xi, alpha}));
  for (const Vector3<double>& p : points_up_to(95)) {
    Vector3<double> on_sphere = p.normalized();
    on_sphere.z() += xi;
    on_sphere.normalize();
    on_sphere.z() += alpha / (1.0 - alpha);
    // the image plane of the pinhole lies as far before it as makes the focal length that of the axis
    const Eigen::Vector2d at = on_sphere.head<2>() / on_sphere.z() / (1.0 - alpha);
    const Eigen::Vector2d expected(322 + 300 * at.x(), 238 + 305 * at.y());
    EXPECT_LE((eye.pixel(p) - expected).norm(), 1e-9) << p.transpose();
  }
}

TEST(Lenses, ALensSeesNothingBeyondItsDomain) {
  const Eye<DoubleSphere> narrow(camera_info("double_sphere", kDoubleSphere));
  EXPECT_TRUE(narrow.pixel({1, 0, -0.1}).allFinite());
  EXPECT_FALSE(narrow.pixel({0.2, 0, -1}).allFinite());
  EXPECT_FALSE(narrow.ray({3000, 238}).direction.allFinite()) << "outside of its image";
  const Eye<Equidistant> fisheye(camera_info("equidistant", {0, 0, 0, 0}));
  EXPECT_FALSE(fisheye.ray({322 + 300 * 3.2, 238}).direction.allFinite()) << "beyond 180 degrees";
  const Eye<PlumbBob> folds(camera_info("plumb_bob", {-0.3, 0, 0, 0, 0}));  // at r = 1.054
  EXPECT_TRUE(folds.ray({322 + 300 * 0.70, 238}).direction.allFinite());
  EXPECT_FALSE(folds.ray({322 + 300 * 0.71, 238}).direction.allFinite()) << "beyond the fold";
  EXPECT_FALSE(LensCamera<PlumbBob>::sees(Vector3<double>(0, 0, -1)));
}

/// With coefficients held, a camera evaluates them as settings: the same to the last bit.
TEST(Lenses, HeldCoefficientsAreSettings) {
  const CameraInfo info = camera_info("rational_polynomial", kRational);
  const LensCamera<RationalPolynomial> camera;
  const auto settings = camera.settings({"eye", {}, info});
  std::array<double, 12> v{0.01, -0.02, 0.003, 0.004, 0.1, 0.2, 1e-3, 2e-3, 0.01, 0.02, 0.03, 0.04};
  const Vector3<double> p(0.7, -0.9, 0.6);
  const Eigen::Vector2d all = camera.predict(p, settings, v),
                        few = camera.predict(p, camera.with_held(settings, v),
                                             std::array{v[0], v[1], v[2], v[3]});
  EXPECT_EQ(all, few);
}

#ifdef KINECAL_TEST_OPENCV
cv::Mat matrix(const CameraInfo& info) {
  return cv::Mat(3, 3, CV_64F, const_cast<double*>(info.k.data())).clone();
}
std::vector<cv::Point3d> in_opencv(const std::vector<Vector3<double>>& points) {
  std::vector<cv::Point3d> all;
  for (const Vector3<double>& p : points) all.emplace_back(p.x(), p.y(), p.z());
  return all;
}

template <class L>
void expect_as_opencv(const CameraInfo& info, double degrees) {
  const Eye<L> eye(info);
  const std::vector<Vector3<double>> points = points_up_to(degrees);
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d none(0, 0, 0);
  if constexpr (std::same_as<L, Equidistant>) {
    cv::fisheye::projectPoints(in_opencv(points), pixels, none, none, matrix(info), info.d);
  } else {
    cv::projectPoints(in_opencv(points), none, none, matrix(info), info.d, pixels);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((eye.pixel(points[i]) - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-9)
        << L::kName << " at " << points[i].transpose();
  }
}

TEST(Lenses, AgreeWithOpenCV) {
  expect_as_opencv<PlumbBob>(camera_info("plumb_bob", kPlumbBob), 60);
  expect_as_opencv<RationalPolynomial>(camera_info("rational_polynomial", kRational), 80);
  expect_as_opencv<ThinPrism>(camera_info("rational_polynomial", kThinPrism), 80);
  expect_as_opencv<Equidistant>(camera_info("equidistant", kEquidistant), 89);
}
#endif

CameraInfo calibrated(const CameraInfo& info, auto lens, const std::vector<double>& changes) {
  const LensCamera<decltype(lens)> camera{ImageKind::raw};
  typename LensCamera<decltype(lens)>::Settings v{};
  std::copy(changes.begin(), changes.end(), v.begin() + 4);
  return camera.calibrated(info, v);
}

TEST(Lenses, TheirCoefficientsGoOutAsTheyCameIn) {
  const CameraInfo five = camera_info("plumb_bob", kPlumbBob);
  EXPECT_EQ(calibrated(five, PlumbBob{}, {}).d, five.d) << "nothing changed";
  CameraInfo now = calibrated(five, PlumbBob{}, {0.01, 0, 0, 0, 0.02});
  EXPECT_EQ(now.distortion_model, "plumb_bob");
  EXPECT_EQ(now.d, (std::vector<double>{-0.21 + 0.01, 0.09, 1e-3, -2e-3, 0.01 + 0.02}));

  CameraInfo four = five;  // OpenCV's: k3 = 0
  four.d.resize(4);
  EXPECT_EQ(calibrated(four, PlumbBob{}, {0.01}).d.size(), 4U);
  EXPECT_EQ(calibrated(four, PlumbBob{}, {0, 0, 0, 0, 0.1}).d.size(), 5U);

  now = calibrated(five, RationalPolynomial{}, {0.01});
  EXPECT_EQ(now.distortion_model, "plumb_bob") << "which can hold it";
  now = calibrated(five, RationalPolynomial{}, {0.01, 0, 0, 0, 0, 0.5});
  EXPECT_EQ(now.distortion_model, "rational_polynomial");
  EXPECT_EQ(now.d, (std::vector<double>{-0.21 + 0.01, 0.09, 1e-3, -2e-3, 0.01, 0.5, 0, 0}));

  CameraInfo fourteen = camera_info("rational_polynomial", kRational);
  fourteen.d.resize(14, 0.0);
  now = calibrated(fourteen, RationalPolynomial{}, {0.01});
  EXPECT_EQ(now.d.size(), 14U) << "as its driver writes them";
  EXPECT_EQ(now.distortion_model, "rational_polynomial");
  now = calibrated(fourteen, ThinPrism{}, {0, 0, 0, 0, 0, 0, 0, 0, 1e-3});
  EXPECT_EQ(now.d.size(), 14U);
  EXPECT_EQ(now.d[8], 1e-3);
  EXPECT_EQ(now.distortion_model, "rational_polynomial");

  CameraInfo none = camera_info("", {});
  now = calibrated(none, PlumbBob{}, {0.01});
  EXPECT_EQ(now.distortion_model, "plumb_bob");
  EXPECT_EQ(now.d, (std::vector<double>{0.01, 0, 0, 0, 0}));
  EXPECT_EQ(calibrated(none, Equidistant{}, {0.01}).distortion_model, "equidistant");
  const CameraInfo fisheye = camera_info("fisheye", kEquidistant);
  EXPECT_EQ(calibrated(fisheye, Equidistant{}, {0.01}).distortion_model, "fisheye");
}

/// Every refusal says what is there and what it should be; no coefficient is silently left out.
TEST(Lenses, CoefficientsOfAnotherLensOrNumberAreRefused) {
  const auto fault = [](auto lens, const std::string& model, const std::vector<double>& d) {
    try {
      (void)LensCamera<decltype(lens)>{ImageKind::raw}.settings({"eye", {}, camera_info(model, d)});
      return std::string();
    } catch (const SettingsError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(fault(PlumbBob{}, "plumb_bob", {0.1}),
            "plumb_bob has 5 distortion coefficients, not 1");
  EXPECT_EQ(fault(PlumbBob{}, "plumb_bob", {0.1, 0, 0, 0, 0, 0.2}),
            "plumb_bob has 5 distortion coefficients, not 6");
  EXPECT_EQ(fault(PlumbBob{}, "rational_polynomial", kRational),
            "its lens is plumb_bob, but camera_info has the 8 distortion coefficients of "
            "rational_polynomial");
  EXPECT_EQ(fault(PlumbBob{}, "rational_polynomial", {0.1, 0.2, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(fault(RationalPolynomial{}, "plumb_bob", kPlumbBob), "");
  EXPECT_EQ(fault(RationalPolynomial{}, "equidistant", {0, 0, 0, 0}),
            "its lens is rational_polynomial, but camera_info has the lens equidistant");
  EXPECT_EQ(fault(Equidistant{}, "equidistant", {0.1, 0.2}),
            "equidistant has 4 distortion coefficients, not 2");
  EXPECT_EQ(fault(Equidistant{}, "equidistant", {0.1, 0.2, std::nan(""), 0.0}),
            "a distortion coefficient of camera_info is not a number");
  EXPECT_TRUE(fault(PlumbBob{}, "bowl", {0.1}).starts_with("distortion model 'bowl' is not"));
  std::vector<double> tilted = kThinPrism;
  tilted.resize(14, 1e-3);
  EXPECT_TRUE(fault(ThinPrism{}, "rational_polynomial", tilted).find("tilt the image plane") !=
              std::string::npos);
}

TEST(Lenses, ALensOfAUserHasTheCoefficientsOfItsNameInCameraInfo) {
  using Own = LensCamera<test::Division>;
  const auto settings = [](const std::string& model, const std::vector<double>& d) {
    return Own{}.settings({"eye", {}, camera_info(model, d)});
  };
  EXPECT_EQ(settings("division", {-0.2})[4], -0.2);
  EXPECT_EQ(settings("division", {})[4], 0.0);
  EXPECT_THROW((void)settings("division", {0.1, 0.2}), SettingsError);
  EXPECT_THROW((void)settings("equidistant", kEquidistant), SettingsError);
  const CameraInfo now = calibrated(camera_info("division", {-0.2}), test::Division{}, {0.05});
  EXPECT_EQ(now.distortion_model, "division");
  EXPECT_EQ(now.d, (std::vector<double>{-0.2 + 0.05}));
  EXPECT_TRUE(contains_lens("division", "division"));
  EXPECT_FALSE(contains_lens("division", "plumb_bob"));
}

}  // namespace
}  // namespace kinecal
