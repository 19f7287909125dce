#include "kinecal/files/poses/pose_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "kinecal/geometry/rpy.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRounding = 1e-14, kDegree = std::numbers::pi / 180.0;

/// The pose that all forms below describe: angles 10, 20, 30 degrees about x, y, z, fixed axes.
const Pose<double>& expected() {
  static const Pose<double> pose{rotation_from_rpy({10 * kDegree, 20 * kDegree, 30 * kDegree}),
                                 {0.4, -0.2, 1.1}};
  return pose;
}

void expect_same(const char* name, const std::vector<double>& numbers) {
  const auto form = pose_form(name);
  ASSERT_TRUE(form) << name;
  EXPECT_TRUE(form->has_size(numbers.size())) << name;
  const NumberedPose read = pose_from_numbers(*form, numbers);
  EXPECT_THAT(read.wrong, IsEmpty()) << name;
  EXPECT_LE((read.pose.rotation - expected().rotation).norm(), kRounding) << name;
  EXPECT_LE((read.pose.translation - expected().translation).norm(), kRounding) << name;
}

TEST(PoseNumbers, EachFormOfOnePoseGivesThisPose) {
  const Eigen::Matrix3d r = expected().rotation;
  const Eigen::Quaterniond q(r);
  const Eigen::AngleAxisd turn(r);
  const Eigen::Vector3d v = turn.angle() * turn.axis();
  expect_same("quaternion_xyzw", {0.4, -0.2, 1.1, q.x(), q.y(), q.z(), q.w()});
  expect_same("quaternion_wxyz", {0.4, -0.2, 1.1, q.w(), q.x(), q.y(), q.z()});
  expect_same("abb", {400, -200, 1100, -q.w(), -q.x(), -q.y(), -q.z()});
  expect_same("rotation_vector", {0.4, -0.2, 1.1, v.x(), v.y(), v.z()});
  expect_same("ur", {0.4, -0.2, 1.1, v.x(), v.y(), v.z()});
  expect_same("rpy", {0.4, -0.2, 1.1, 10 * kDegree, 20 * kDegree, 30 * kDegree});
  expect_same("fanuc", {400, -200, 1100, 10, 20, 30});  // W P R about fixed x y z
  expect_same("kuka", {400, -200, 1100, 30, 20, 10});   // A B C about z y x that turn along
  expect_same("euler_zyx", {0.4, -0.2, 1.1, 30 * kDegree, 20 * kDegree, 10 * kDegree});
  std::vector<double> matrix;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix.push_back(r(i, j));
    matrix.push_back(expected().translation(i));
  }
  expect_same("matrix", matrix);
  matrix.insert(matrix.end(), {0.0, 0.0, 0.0, 1.0});
  expect_same("matrix", matrix);
}

TEST(PoseNumbers, ControllersAreKnownByName) {
  for (const char* name : {"fairino", "yaskawa", "techman", "dobot", "elite"}) {
    expect_same(name, {400, -200, 1100, 10, 20, 30});
  }
  expect_same("jaka", {400, -200, 1100, 10 * kDegree, 20 * kDegree, 30 * kDegree});
  expect_same("nachi", {400, -200, 1100, 30, 20, 10});
  const Eigen::Matrix3d& r = expected().rotation;
  const Eigen::Vector3d xyz = r.eulerAngles(0, 1, 2) / kDegree,
                        zyz = r.eulerAngles(2, 1, 2) / kDegree;
  expect_same("staubli", {400, -200, 1100, xyz.x(), xyz.y(), xyz.z()});
  expect_same("doosan", {400, -200, 1100, zyz.x(), zyz.y(), zyz.z()});
}

TEST(PoseNumbers, ARotationVectorOfMoreThanATurnIsNone) {
  PoseForm form = *pose_form("rotation_vector");
  form.degrees = true;
  EXPECT_THAT(pose_from_numbers(form, std::vector<double>{0, 0, 0, 300, 250, 0}).wrong,
              HasSubstr("write their form: fixed_xyz"));
  EXPECT_THAT(pose_from_numbers(form, std::vector<double>{0, 0, 0, 300, 0, 0}).wrong, IsEmpty());
}

TEST(PoseNumbers, AnglesTurnAboutTheirAxesInTheirOrder) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const double a = 0.3, b = -0.7, c = 1.9;
  const auto rotation = [&](const char* name) {
    return Eigen::Matrix3d(
        pose_from_numbers(*pose_form(name), std::vector<double>{0, 0, 0, a, b, c}).pose.rotation);
  };
  const Eigen::Matrix3d zyz = (AngleAxisd(a, Vector3d::UnitZ()) * AngleAxisd(b, Vector3d::UnitY()) *
                               AngleAxisd(c, Vector3d::UnitZ()))
                                  .toRotationMatrix();
  EXPECT_LE((rotation("euler_zyz") - zyz).norm(), kRounding);
  const Eigen::Matrix3d yxz =  // fixed: the last turn stands first
      (AngleAxisd(c, Vector3d::UnitZ()) * AngleAxisd(b, Vector3d::UnitX()) *
       AngleAxisd(a, Vector3d::UnitY()))
          .toRotationMatrix();
  EXPECT_LE((rotation("fixed_yxz") - yxz).norm(), kRounding);
}

TEST(PoseNumbers, AnInverseIsTurnedRound) {
  PoseForm form = *pose_form("rpy");
  form.inverse = true;
  const std::vector<double> numbers = {0.4, -0.2, 1.1, 10 * kDegree, 20 * kDegree, 30 * kDegree};
  const Pose<double> product = pose_from_numbers(form, numbers).pose * expected();
  EXPECT_LE((product.rotation - Matrix3<double>::Identity()).norm(), kRounding);
  EXPECT_LE(product.translation.norm(), kRounding);
}

std::string wrong(const char* name, const std::vector<double>& numbers) {
  return pose_from_numbers(*pose_form(name), numbers).wrong;
}

TEST(PoseNumbers, NumbersThatContradictTheirUnitSayWhatToWrite) {
  EXPECT_EQ(wrong("ur", {589.28, 0, 0, 0, 0, 1}),
            "the position is 589.28 m away; it looks like millimetres: write 'unit: millimetres'");
  EXPECT_EQ(wrong("rpy", {0.5, 0, 0, 0, 179, 1}),
            "an angle of 179 rad is more than a turn; if these are degrees, write 'angles: "
            "degrees'");
  EXPECT_THAT(wrong("ur", {0.5, 0, 0, 0, 90, 0}), HasSubstr("more than a turn"));
  EXPECT_THAT(wrong("kuka", {500, 0, 0, 180, 0, -180}), IsEmpty());
  EXPECT_THAT(wrong("quaternion_xyzw", {0, 0, 0, 0.5, 0.5, 0.5, 0.6}),
              HasSubstr("a unit quaternion has length 1, not 1.0535"));
  EXPECT_THAT(wrong("quaternion_xyzw", {0, 0, 0, 0, 0, 0, 0}), HasSubstr("length 1, not 0"));
  EXPECT_THAT(wrong("matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0}),
              HasSubstr("are not a rotation"));
  EXPECT_THAT(wrong("matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 1}),
              HasSubstr("not 0 0 0 1; write it by rows"));
}

TEST(PoseNumbers, OnlyThreeAxesOfWhichNeighboursDifferAreAForm) {
  for (const char* name : {"euler_zzx", "euler_zy", "fixed_xya", "fixed_", "KUKA", ""}) {
    EXPECT_FALSE(pose_form(name)) << name;
  }
  for (const std::string& name : pose_form_names()) EXPECT_TRUE(pose_form(name)) << name;
}

}  // namespace
}  // namespace kinecal
