#include "kinecal/testing/check_sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/sensors.hpp"
#include "support/division_lens.hpp"
#include "support/fisheye.hpp"
#include "support/open_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(CheckSensor, HoldsForTheBuiltInSensorsAndThatOfAUser) {
  EXPECT_EQ(check_sensor(ChainPoint{}), kLawsHold);
  EXPECT_EQ(check_sensor(ChainPose{}), kLawsHold);
  EXPECT_EQ(check_sensor(BentBoard{}), kLawsHold);
  EXPECT_EQ(check_sensor(DepthCamera{}), kLawsHold);
  EXPECT_EQ(check_sensor(PinholeCamera{}), kLawsHold);
  EXPECT_EQ(check_sensor(test::DrawWire{}), kLawsHold);
}

TEST(CheckSensor, HoldsForCamerasWithAnyLensThatOfAUserToo) {
  EXPECT_EQ(check_sensor(LensCamera<Equidistant>{}), kLawsHold);
  EXPECT_EQ(check_sensor(LensCamera<DoubleSphere>{}), kLawsHold);
  EXPECT_EQ(check_sensor(LensCamera<test::Division>{}), kLawsHold);
}

TEST(CheckSensor, TakesRecordedObservations) {
  Observation seen{"camera", {{"optical", {0.2, -0.1, 0.9}}}, CameraInfo{}};
  EXPECT_THROW((void)check_sensor(DepthCamera{}, {seen}), SettingsError) << "no focal length";
  seen.camera->p = {550, 0, 320, 0, 0, 545, 240, 0, 0, 0, 1, 0};
  EXPECT_EQ(check_sensor(DepthCamera{}, {seen}), kLawsHold);
}

/// A depth camera of which something is replaced.
struct Depth {
  static constexpr std::string_view kType = "depth";
  static constexpr std::array kParameters = {ParameterInfo{"scale"}, ParameterInfo{"offset", "m"}};
};
template <class M, class S, class Q>
Vector3<S> along_the_ray(const Measurement<M, Q>& m, const std::array<S, 2>& v) {
  const S factor = S(1.0) + v[0] + v[1] / m.point.z();
  return {m.point.x() * factor, m.point.y() * factor, m.point.z() * factor};
}

/// Its own derivatives: wrong by a sign.
template <class Q>
struct WrongDerivatives {
  Pose<Q> pose;
  std::array<double, 2> v;

  WrongDerivatives(const Pose<Q>& at, const std::array<Q, 0>&, std::span<const double> own)
      : pose(at), v{own[0], own[1]} {}
  Vector3<Q> place(const Vector3<Q>& m, std::span<const int> chosen, Vector3<Q>* changes) const {
    const Q factor = Q(1.0 + v[0]) + Q(v[1]) / m.z();
    const Vector3<Q> by_scale = rotated(pose.rotation, m);
    for (const int k : chosen) {
      const Q by = k == 0 ? Q(1.0) : Q(-1.0) / m.z();
      *changes++ = Vector3<Q>(by_scale.x() * by, by_scale.y() * by, by_scale.z() * by);
    }
    return pose * Vector3<Q>(m.x() * factor, m.y() * factor, m.z() * factor);
  }
};
struct WrongCorrected : Depth {
  template <class Q>
  using Corrected = WrongDerivatives<Q>;
  template <class S, class Q>
  Vector3<S> place(const Measurement<WrongCorrected, Q>& m, const std::array<S, 2>& v) const {
    return along_the_ray(m, v);
  }
};

TEST(CheckSensor, FindsDerivativesThatDisagreeWithTheValuesAndPrintsBothMatrices) {
  const Verdict v = check_sensor(WrongCorrected{});
  EXPECT_FALSE(v);
  EXPECT_THAT(v.text, StartsWith("sensor 'depth', Corrected: derivatives disagree with its values; "
                                 "one row per value, one column per variable\ngiven:\n"));
  EXPECT_THAT(v.text, HasSubstr("\ncentral differences of the values:\n"));
  EXPECT_THAT(v.text, HasSubstr("\nparameters:\n"));
}

struct PlacesWithoutADerivative : Depth {
  template <class S, class Q>
  Vector3<S> place(const Measurement<PlacesWithoutADerivative, Q>& m,
                   const std::array<S, 2>& v) const {
    return along_the_ray(m, std::array<S, 2>{v[0], S(value_of(v[1]))});
  }
};
struct PlacesByABranch : Depth {
  template <class S, class Q>
  Vector3<S> place(const Measurement<PlacesByABranch, Q>& m, const std::array<S, 2>& v) const {
    return along_the_ray(m, lane(m.point.z(), 0) > 1.0 ? v : std::array<S, 2>{v[0], v[0] * v[1]});
  }
};
struct Moves : Depth {
  template <class S, class Q>
  Vector3<S> place(const Measurement<Moves, Q>& m, const std::array<S, 2>& v) const {
    return along_the_ray(m, std::array<S, 2>{v[0] + 0.01, v[1]});
  }
};

TEST(CheckSensor, FindsADroppedDerivativeABranchAndAPointThatIsNotTheRecordedOne) {
  EXPECT_THAT(check_sensor(PlacesWithoutADerivative{}).text,
              StartsWith("sensor 'depth', place(): derivatives disagree with its values; one row "
                         "per value, one column per variable\nby jets:\n"));
  EXPECT_THAT(check_sensor(PlacesByABranch{}).text,
              StartsWith("sensor 'depth', place(): values in packets differ"));
  EXPECT_THAT(check_sensor(Moves{}).text,
              StartsWith("sensor 'depth', place(): with the initial parameters it is not what was "
                         "recorded\nrecorded:\n"));
}

/// The ray forgets the corrected focal length.
struct MissingRay {
  static constexpr std::string_view kType = "missing_ray";
  static constexpr std::array kParameters = {ParameterInfo{"f"}};

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 1>& v) const {
    const S f = 500.0 * (1.0 + v[0]);
    return {f * p.x() / p.z(), f * p.y() / p.z()};
  }
  template <class S, class Q>
  Ray<S> place(const Measurement<MissingRay, Q>& m, const std::array<S, 1>&) const {
    const S f(500.0);
    return {.direction = {m.point.x() / f, m.point.y() / f, S(1.0)}};
  }
};
/// A camera without rays whose pixels drop a derivative.
struct FixedFocus {
  static constexpr std::string_view kType = "fixed_focus";

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 0>&) const {
    return {500.0 * p.x() / S(value_of(p.z())), 500.0 * p.y() / p.z()};
  }
};

TEST(CheckSensor, FindsARayThatMissesThePoint) {
  EXPECT_THAT(
      check_sensor(MissingRay{}).text,
      StartsWith("sensor 'missing_ray', place(): the ray to the pixel of predict() does not "
                 "go through the point\npoint:\n"));
  EXPECT_THAT(check_sensor(FixedFocus{}).text,
              StartsWith("sensor 'fixed_focus', predict(): derivatives disagree"));
}

/// Projects points in front of it and behind it alike.
struct SeesBehind {
  static constexpr std::string_view kType = "sees_behind";

  template <class S, class Q>
  Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 0>&,
                                 const std::array<S, 0>&) const {
    return {500.0 * p.x() / p.z(), 500.0 * p.y() / p.z()};
  }
};
/// The same, seeing only what is in front of it.
struct SeesInFront : SeesBehind {
  template <class S>
  auto sees(const Vector3<S>& p) const {
    return p.z() > S(0.0);
  }
};

TEST(CheckSensor, LooksAllAroundACameraAndAlongItsAxis) {
  EXPECT_EQ(check_sensor(test::Fisheye{}), kLawsHold);
  EXPECT_EQ(check_sensor(SeesInFront{}), kLawsHold);
  EXPECT_THAT(
      check_sensor(SeesBehind{}).text,
      StartsWith("sensor 'sees_behind', predict(): a point and the opposite one, behind the "
                 "camera, have the same pixel; state which points the camera sees: "
                 "sees(p)\nrecorded:\n"));
  EXPECT_THAT(check_sensor(test::HollowFisheye{}).text,
              StartsWith("sensor 'hollow_fisheye', predict(): it is not a number on the axis"));
  EXPECT_THAT(check_sensor(test::KinkedFisheye{}).text,
              StartsWith("sensor 'kinked_fisheye', predict(): a derivative is not a number, though "
                         "the value is one\nby jets:\n"));
  EXPECT_THAT(check_sensor(test::StraightFisheye{}).text,
              StartsWith("sensor 'straight_fisheye', predict(): derivatives disagree"));
}

}  // namespace
}  // namespace kinecal
