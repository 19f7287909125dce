#include "kinecal/testing/check_block.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/errors.hpp"
#include "support/blocks.hpp"
#include "support/open_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(CheckBlock, HoldsForTheBuiltInBlocks) {
  using V = Vector3<double>;
  EXPECT_EQ(check_block(PointToPoint{}), kLawsHold);
  EXPECT_EQ(check_block(PointToPixel{}), kLawsHold);
  EXPECT_EQ(check_block(PointToPlane{0.1, 0.2, 2.0, -0.4}, V(4, 0, 0)), kLawsHold);
  EXPECT_EQ(check_block(PlaneToPlane{2.0, 3.0}), kLawsHold);
  EXPECT_EQ(check_block(PoseToPose{1000.0, 700.0}), kLawsHold);
  EXPECT_EQ(check_block(RayToRay{}), kLawsHold);
  EXPECT_EQ(check_block(PointToRay{}, V(2, 4, 6), Ray<double>{{0, 0, 0}, {1, 2, 3}}), kLawsHold);
  EXPECT_EQ(check_block(PointDistance{0.3}, V(1, 0.2, 0.3), V(1, 0.2, 0)), kLawsHold);
  EXPECT_EQ(check_block(PointToSphere{{0.1, 0.2, 0.3}, 0.4}, V(0.1, 0.6, 0.3)), kLawsHold);
  EXPECT_EQ(check_block(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5}), V(1.1, 1.8, -0.2)),
            kLawsHold);
}

TEST(CheckBlock, HoldsForBlocksOfUsers) {
  using V = Vector3<double>;
  EXPECT_EQ(check_block(test::UnknownDifference{}), kLawsHold);
  EXPECT_EQ(check_block(test::HiddenDifference{}), kLawsHold);
  EXPECT_EQ(check_block(test::Distance{}, V(0.2, 0, 0), V(0, 0, 0)), kLawsHold);
  EXPECT_EQ(check_block(test::BetweenPoints{}, V(0, 0, 0), V(1, 2, 3), V(2, 4, 6)), kLawsHold);
  EXPECT_EQ(check_block(test::ShiftedPixel{}, PixelObservation<double>{{3, 4}, {3, 4}}), kLawsHold);
  EXPECT_EQ(check_block(test::WireLength{}, V(1, 1, 0.5), Reading<double>{{1, 1, 0}, 0.5}),
            kLawsHold);
  EXPECT_EQ(check_block(test::ThermalBar{}, V(0.4, 0, 0), V(0, 0, 0)), kLawsHold);
  EXPECT_EQ(check_block(test::WarmPixel{}, PixelObservation<double>{{3, 4}, {3, 4}}), kLawsHold);
}

/// A derivative is lost: the number takes the place of the jet.
struct DropsADerivative {
  static constexpr const char* kType = "drops_a_derivative";
  template <class S>
  Vector3<S> operator()(const Vector3<S>& a, const Vector3<S>& b) const {
    return {a.x() - b.x(), a.y() - S(value_of(b.y())), a.z() - b.z()};
  }
};

TEST(CheckBlock, FindsADroppedDerivativeAndPrintsBothMatrices) {
  const Verdict v = check_block(DropsADerivative{});
  EXPECT_FALSE(v);
  EXPECT_THAT(v.text,
              StartsWith("error block 'drops_a_derivative': where the sensors agree, derivatives "
                         "disagree with its values; one row per value, one column per variable\n"
                         "by jets:\n"));
  EXPECT_THAT(v.text, HasSubstr("\n              0             1             0             0"
                                "             0             0\n"));
  EXPECT_THAT(v.text, HasSubstr("\ncentral differences of the values:\n"));
  EXPECT_THAT(v.text, HasSubstr("\n              0             1             0             0"
                                "            -1             0\n"));
  EXPECT_THAT(v.text, HasSubstr("\narguments:\n"));
}

/// The first lane decides for all.
struct Branches {
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p) const {
    const bool above = lane(value_of(p.z()), 0) > 0.0;
    return Eigen::Matrix<S, 1, 1>(above ? p.z() : S(2.0 * p.z()));
  }
};

TEST(CheckBlock, FindsABranch) {
  const Verdict v = check_block(Branches{});
  EXPECT_THAT(v.text, StartsWith("error block: values in packets differ from those in double; do "
                                 "not branch on values, write select(x < y, a, b)\nin packets:\n"));
  EXPECT_THAT(v.text, HasSubstr("\nin double:\n"));
}

struct NotZero {
  template <class S>
  Vector3<S> operator()(const Vector3<S>& a, const Vector3<S>& b) const {
    return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z() + 0.001};
  }
};
/// An absolute value: a kink where the sensors agree.
struct Kink {
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& a, const Vector3<S>& b) const {
    using std::abs;
    return Eigen::Matrix<S, 1, 1>(abs(S(a.x() - b.x())));
  }
};
struct NeverANumber {
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p) const {
    using std::sqrt;
    return Eigen::Matrix<S, 1, 1>(sqrt(S(-9.0 - p.x())));
  }
};
struct Counts {
  mutable int calls = 0;
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p) const {
    return Eigen::Matrix<S, 1, 1>(p.x() * static_cast<double>(++calls));
  }
};

TEST(CheckBlock, FindsAResidualWhereTheSensorsAgree) {
  EXPECT_THAT(check_block(NotZero{}).text,
              StartsWith("error block: the residual is not zero where the sensors agree\n"
                         "residual:\n"));
  EXPECT_THAT(
      check_block(PointDistance{0.3}, Vector3<double>(1, 0, 0), Vector3<double>(0, 0, 0)).text,
      StartsWith("error block 'point_distance': the residual is not zero"));
  EXPECT_THAT(check_block(Kink{}).text, HasSubstr("derivatives disagree"));
}

/// An absolute value in place of a signed distance.
struct HeightWithoutSign {
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p) const {
    return Eigen::Matrix<S, 1, 1>(abs(p.z()));
  }
};
/// The same beside a parameter.
struct DistanceWithoutSign {
  static constexpr std::array kParameters = {ParameterInfo{"length", "m", 0.5}};
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& a, const Vector3<S>& b,
                                    const std::array<S, 1>& own) const {
    return Eigen::Matrix<S, 1, 1>(abs((a - b).norm() - own[0]));
  }
};

TEST(CheckBlock, FindsAKinkWhereTheResidualIsZeroWithoutSuchArguments) {
  EXPECT_THAT(check_block(HeightWithoutSign{}).text,
              StartsWith("error block: where the residual is zero, derivatives disagree"));
  EXPECT_THAT(check_block(DistanceWithoutSign{}).text,
              StartsWith("error block: where the residual is zero, derivatives disagree"));
  EXPECT_EQ(check_block(PointToPlane{0.1, 0.2, 2.0, -0.4}), kLawsHold);
  EXPECT_EQ(check_block(PointToSphere{{0.1, 0.2, 0.3}, 0.4}), kLawsHold);
  EXPECT_EQ(check_block(PointToLine({0.1, -0.2, 0.3}, {1.0, 2.0, -0.5})), kLawsHold);
  EXPECT_EQ(check_block(PointDistance{0.3}), kLawsHold);
  EXPECT_EQ(check_block(PointToRay{}), kLawsHold);
  EXPECT_EQ(check_block(test::WireLength{}), kLawsHold);
  EXPECT_EQ(check_block(test::ThermalBar{}), kLawsHold);
}

TEST(CheckBlock, FindsWhatHasNoValueOrAnotherEachTime) {
  EXPECT_EQ(check_block(NeverANumber{}).text,
            "error block: the residual is not a number at any of 32 random inputs");
  EXPECT_THAT(check_block(Counts{}).text, StartsWith("error block: two calls"));
}

}  // namespace
}  // namespace kinecal
